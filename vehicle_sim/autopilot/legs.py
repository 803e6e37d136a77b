"""Flying between places: a reference point that moves as the vehicle can, and the tasks that follow it.

The reference keeps to the straight line from one place to the next, within limits of speed and acceleration in the
horizontal plane and in the vertical. At the end of a leg it either stops, or goes round the corner at the speed that an
arc tangent to both legs allows within the acceptance radius d: with turning angle theta the radius of the arc is
d / tan(theta / 2), and the acceleration is speed^2 over it. It waits for a vehicle that falls behind.
"""

from dataclasses import dataclass
from math import atan2, cos, hypot, inf, pi, sin, sqrt, tan, tau
from typing import Final

from vehicle_sim.autopilot.mission_items import SpeedAxis
from vehicle_sim.autopilot.tasks import Task
from vehicle_sim.parameters import FlightSettings
from vehicle_sim.signals import Estimate, PartialVector, Setpoint, Vector

_SHARE: Final = 0.7
"""What the reference uses of the acceleration limits; the rest is for keeping up with it."""
_ARRIVAL_PER_S: Final = 0.8
_LINE_PER_S: Final = 1.0
_LAG_M: Final = 3.0
_LONGEST_TICK_S: Final = 0.1
_ON_THE_SPOT_M: Final = 0.05
_NO_COURSE_M: Final = 0.5


def distance_m(a: Vector, b: Vector) -> float:
    """Return the straight distance between two places."""
    return hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2])


def course_rad(a: Vector, b: Vector) -> float | None:
    """Return the compass course from `a` to `b`; None where they stand above each other."""
    north, east = b[0] - a[0], b[1] - a[1]
    return atan2(east, north) if hypot(north, east) > _NO_COURSE_M else None


def arrival_speed(left_m: float, end_m_s: float, braking_m_s2: float, gain_per_s: float = _ARRIVAL_PER_S) -> float:
    """Return the speed at `left_m` before a place from which braking leads to `end_m_s` there.

    Proportional to the distance near the place, a square root beyond; both pieces join with equal slope.
    """
    near_m = braking_m_s2 / gain_per_s**2
    still = gain_per_s * left_m if left_m < near_m else sqrt(2.0 * braking_m_s2 * (left_m - 0.5 * near_m))
    return hypot(still, end_m_s)


def corner_speed(before: Vector, corner: Vector, after: Vector, radius_m: float, acceleration_m_s2: float) -> float:
    """Return the greatest speed for the corner between two legs; infinite where they go straight on."""
    a, b = _unit(before, corner), _unit(corner, after)
    if a is None or b is None:
        return 0.0
    cosine = max(-1.0, min(a[0] * b[0] + a[1] * b[1] + a[2] * b[2], 1.0))
    half = tan(0.5 * atan2(sqrt(1.0 - cosine * cosine), cosine))
    tangent_m = min(radius_m, 0.5 * distance_m(before, corner), 0.5 * distance_m(corner, after))
    return sqrt(acceleration_m_s2 * tangent_m / half) if half > 0.0 else inf


def _unit(a: Vector, b: Vector) -> Vector | None:
    length = distance_m(a, b)
    if length < _ON_THE_SPOT_M:
        return None
    return ((b[0] - a[0]) / length, (b[1] - a[1]) / length, (b[2] - a[2]) / length)


@dataclass(slots=True)
class Reference:
    """The point that is followed: position in metres and velocity in m/s, north, east, down."""

    place: Vector
    velocity: Vector
    acceleration: Vector = (0.0, 0.0, 0.0)

    def halt(self, place: Vector) -> None:
        """Stand still at `place`."""
        self.place, self.velocity, self.acceleration = place, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)

    def steer(self, aside: Vector, ahead: Vector, horizontal_m_s2: float, vertical_m_s2: float, seconds: float) -> None:
        """Change the velocity towards `aside` + `ahead` as fast as the accelerations allow, and move on.

        Getting back to the line comes first: what that leaves of the acceleration is for the speed along the line.
        """
        if seconds <= 0.0:
            return
        v, most, size = self.velocity, horizontal_m_s2 * seconds, hypot(ahead[0], ahead[1])
        u_n, u_e = (ahead[0] / size, ahead[1] / size) if size else (0.0, 0.0)
        # On a slope the way back to the line has a part along it, too.
        with_it = aside[0] * u_n + aside[1] * u_e
        speed, along = v[0] * u_n + v[1] * u_e, size + with_it
        d_n = aside[0] - with_it * u_n - (v[0] - speed * u_n)
        d_e = aside[1] - with_it * u_e - (v[1] - speed * u_e)
        change = hypot(d_n, d_e)
        if change > most:
            d_n, d_e, change = d_n * most / change, d_e * most / change, most
        left = sqrt(most * most - change * change)
        faster = max(-left, min(along - speed, left))
        most = vertical_m_s2 * seconds
        d_d = max(-most, min(aside[2] + ahead[2] - v[2], most))
        d_n, d_e = d_n + faster * u_n, d_e + faster * u_e
        self.velocity = (v[0] + d_n, v[1] + d_e, v[2] + d_d)
        self.acceleration = (d_n / seconds, d_e / seconds, d_d / seconds)
        n, e, d = self.place
        self.place = (n + self.velocity[0] * seconds, e + self.velocity[1] * seconds, d + self.velocity[2] * seconds)


class CruiseTask(Task):
    """Fly straight to a place, stay there for a time or go on at a corner's speed."""

    def __init__(
        self,
        reference: Reference,
        settings: FlightSettings,
        *,
        start: Vector,
        end: Vector,
        speeds: dict[SpeedAxis, float],
        accept_m: float,
        accept_height_m: float,
        corner_m_s: float = 0.0,
        hold_s: float = 0.0,
        yaw_rad: float | None = None,
    ) -> None:
        """Begin at `reference`, which may still move; the line leads from `start` to `end`.

        `speeds` replace the settings' wherever they have an axis, also when they change later. The place is reached
        where the vehicle is within `accept_m` of it, and within `accept_height_m` of its height.
        """
        super().__init__(Setpoint(position_ned_m=reference.place, yaw_rad=yaw_rad))
        self.reference = reference
        self.end = end
        self.paused = False
        self._settings = settings
        self._start = start
        self._along = _unit(start, end)
        self._speeds = speeds
        self._accept = (accept_m, accept_height_m)
        self._corner_m_s = corner_m_s
        self._hold_s = hold_s
        self._now_s: float | None = None
        self._reached_s: float | None = None

    @property
    def reached(self) -> bool:
        """Whether the vehicle has been there."""
        return self._reached_s is not None

    def advance(self, now_s: float, estimate: Estimate) -> None:
        """Move the reference on, and finish once the vehicle has stayed for as long as it should."""
        seconds = 0.0 if self._now_s is None else min(now_s - self._now_s, _LONGEST_TICK_S)
        self._now_s = now_s
        here = estimate.position_ned_m
        # A reference that has left its vehicle behind goes slower, until it waits.
        behind = distance_m(here, self.reference.place)
        pace = max(0.0, min(1.0, 2.0 - behind / _LAG_M))
        self._move(seconds * pace)
        n, e, d = self.reference.velocity
        a_n, a_e, a_d = self.reference.acceleration
        square = pace * pace
        self.setpoint = Setpoint(
            position_ned_m=self.reference.place,
            velocity_ned_m_s=(n * pace, e * pace, d * pace),
            acceleration_ned_m_s2=(a_n * square, a_e * square, a_d * square),
            yaw_rad=self.setpoint.yaw_rad,
        )
        radius, height = self._accept
        near = hypot(here[0] - self.end[0], here[1] - self.end[1]) <= radius and abs(here[2] - self.end[2]) <= height
        if near and self._reached_s is None:
            self._reached_s = now_s
        if self._reached_s is not None and now_s - self._reached_s >= self._hold_s and not self.paused:
            self.finished = True

    def _move(self, seconds: float) -> None:
        reference, settings, along = self.reference, self._settings, self._along
        horizontal, vertical = _SHARE * settings.acceleration_m_s2, _SHARE * settings.vertical_acceleration_m_s2
        left = distance_m(reference.place, self.end)
        corner = 0.0 if self.reached else self._corner_m_s
        if along is None or (left < _ON_THE_SPOT_M and corner == 0.0):
            reference.halt(self.end)
            return
        start, place = self._start, reference.place
        n, e, d = place[0] - start[0], place[1] - start[1], place[2] - start[2]
        gone = n * along[0] + e * along[1] + d * along[2]
        ahead = distance_m(start, self.end) - gone
        level, slope = hypot(along[0], along[1]), abs(along[2])
        cruise = self._limit(SpeedAxis.HORIZONTAL, settings.cruise_m_s)
        # Back to the line, from wherever the last corner has left it; the rest of the speed is for going on.
        aside = (n - gone * along[0], e - gone * along[1], d - gone * along[2])
        off, level_off = hypot(*aside), hypot(aside[0], aside[1])
        back = min(_LINE_PER_S, arrival_speed(off, 0.0, min(horizontal, vertical)) / off) if off else 0.0
        back = min(back, cruise / level_off) if level_off else back
        back = min(back, self._vertical_limit(-aside[2]) / abs(aside[2])) if aside[2] else back
        with_it = max(-back * aside[2] * along[2], 0.0) / slope if slope else 0.0
        speed = min(
            (cruise - back * level_off) / level if level else inf,
            max(self._vertical_limit(along[2]) - with_it, 0.0) / slope if slope else inf,
        )
        braking = min(horizontal / level if level else inf, vertical / slope if slope else inf)
        if self.paused:
            speed = 0.0
        elif ahead >= 0.0:
            # The turn begins before the corner, where the arc touches the leg.
            left = max(ahead - (self._accept[0] if corner else 0.0), 0.0)
            speed = min(speed, arrival_speed(left, corner, braking, settings.arrival_per_s))
        else:
            speed = -min(speed, arrival_speed(-ahead, 0.0, braking, settings.arrival_per_s))
        reference.steer(
            (-back * aside[0], -back * aside[1], -back * aside[2]),
            (speed * along[0], speed * along[1], speed * along[2]),
            horizontal,
            vertical,
            seconds,
        )

    def _limit(self, axis: SpeedAxis, default_m_s: float) -> float:
        return self._speeds.get(axis, default_m_s)

    def _vertical_limit(self, down: float) -> float:
        if down < 0.0:
            return self._limit(SpeedAxis.UP, self._settings.climb_m_s)
        return self._limit(SpeedAxis.DOWN, self._settings.descent_m_s)


class GoTask(CruiseTask):
    """Fly straight to a place and stay there, until something else is asked for."""

    def __init__(
        self, estimate: Estimate, settings: FlightSettings, *, goal: Setpoint, speeds: dict[SpeedAxis, float]
    ) -> None:
        """Begin where the vehicle is, with its velocity."""
        here = estimate.position_ned_m
        north, east, down = (here[i] if value is None else value for i, value in enumerate(goal.position_ned_m))
        super().__init__(
            Reference(here, estimate.velocity_ned_m_s),
            settings,
            start=here,
            end=(north, east, down),
            speeds=speeds,
            accept_m=-inf,
            accept_height_m=-inf,
            yaw_rad=goal.yaw_rad,
        )

    @property
    def goal(self) -> PartialVector:
        """The place where it ends."""
        return self.end


class CircleTask(Task):
    """Fly whole circles round a place, looking at it."""

    def __init__(
        self,
        reference: Reference,
        settings: FlightSettings,
        *,
        centre: Vector,
        radius_m: float,
        turns: float,
        clockwise: bool,
        speeds: dict[SpeedAxis, float],
    ) -> None:
        """Begin on the circle where `reference` is nearest to it; a radius of 0 turns on the spot."""
        super().__init__(Setpoint(position_ned_m=reference.place))
        self.reference = reference
        self.turned_rad = 0.0
        self._settings = settings
        self.centre = centre
        self.radius_m = radius_m
        self._turns = turns
        self.sign = 1.0 if clockwise else -1.0
        self._speeds = speeds
        self._angle_rad = atan2(reference.place[1] - centre[1], reference.place[0] - centre[0])
        self._rate_rad_s = 0.0
        self._now_s: float | None = None

    def advance(self, now_s: float, estimate: Estimate) -> None:
        """Go on round the circle, no faster than the vehicle can follow."""
        behind = distance_m(estimate.position_ned_m, self.reference.place)
        seconds = 0.0 if self._now_s is None else min(now_s - self._now_s, _LONGEST_TICK_S)
        seconds *= max(0.0, min(1.0, 2.0 - behind / _LAG_M))
        self._now_s = now_s
        settings, radius = self._settings, self.radius_m
        most = abs(settings.circle_rate_rad_s)
        if radius > 0.0:
            speed = self._speeds.get(SpeedAxis.HORIZONTAL, settings.cruise_m_s)
            speed = min(speed, sqrt(0.5 * settings.acceleration_m_s2 * radius))
            most = min(most, speed / radius)
        self._rate_rad_s = min(most, self._rate_rad_s + most * seconds)
        self.turned_rad += self._rate_rad_s * seconds
        self._angle_rad += self.sign * self._rate_rad_s * seconds
        c, s = cos(self._angle_rad), sin(self._angle_rad)
        swing = self.sign * self._rate_rad_s * radius
        centripetal = -(self._rate_rad_s**2) * radius
        self.reference.place = (self.centre[0] + radius * c, self.centre[1] + radius * s, self.centre[2])
        self.reference.velocity = (-swing * s, swing * c, 0.0)
        self.setpoint = Setpoint(
            position_ned_m=self.reference.place,
            velocity_ned_m_s=self.reference.velocity,
            acceleration_ned_m_s2=(centripetal * c, centripetal * s, None),
            yaw_rad=(self._angle_rad + (pi if radius else 0.0)) % tau,
        )
        if self.turned_rad >= tau * self._turns:
            self.finished = True
