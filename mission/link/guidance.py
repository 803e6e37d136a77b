"""Setpoints along a course, at the vehicle's own time and in its own frame."""

import math
from collections import deque
from dataclasses import dataclass
from typing import Final, NamedTuple

from mission.link.arrival import Arrival
from mission.link.correction import Correction
from mission.link.course import Course, Reference
from mission.link.frames import Anchor, Vector, ned_from_enu
from mission.link.pace import Beat, Pace
from mission.link.stillness import Stillness
from mission.link.values import LocalSetpoint
from mission.link.vehicle_clock import VehicleClock
from mission.monitor.gaps import GAP_S, Gap, Missing

_AHEAD_S: Final = (0.0, 0.75, 1.5)
"""On the trajectory: where it is looked whether the vehicle can fly so fast."""

_SHARE_OF_LEAN: Final = 0.9
_MOST_LEGS: Final = 4


@dataclass(frozen=True, eq=False)
class _Leg:
    """A course with the pace at which it is flown, from a vehicle time on."""

    from_s: float
    course: Course
    pace: Pace


class _Moment(NamedTuple):
    """What is flown at a vehicle time, and where on its course that is, by the course's own time.

    That is negative before its start, and stands where no setpoint is sent; up to a promise some are.
    """

    leg: _Leg
    beat: Beat
    elapsed_s: float

    @property
    def within_s(self) -> float:
        """The time on the course, at its start before that and at its end after that."""
        return min(max(self.elapsed_s, 0.0), self.leg.course.duration_s)

    @property
    def reference(self) -> Reference:
        """The point to be at, with velocity and acceleration by the pace at which it is passed."""
        own, beat = self.leg.course.reference(self.within_s), self.beat
        if beat.rate == 1.0 and beat.growth_per_s == 0.0:
            return own
        position, (vx, vy, vz), (ax, ay, az) = own
        rate, square, growth = beat.rate, beat.rate**2, beat.growth_per_s
        return Reference(
            position,
            (rate * vx, rate * vy, rate * vz),
            (square * ax + growth * vx, square * ay + growth * vy, square * az + growth * vz),
        )


class Guidance:
    """Leads the vehicle: to the start of the course, along it, and at its end; or over to another course.

    The trajectory goes on while setpoints are sent. Where none was for a while, it goes on from where the last one
    stood: what was not asked for was not flown either, and a setpoint that leaps leads across what was not proved.
    Where the vehicle does not keep up, it goes on more slowly (``pace``), and what is asked for differs from what is
    planned by a bounded ``correction``. A setpoint is for when it arrives: all times here are the vehicle's at which
    it has one, or was where it reports to be.

    Attributes:
        anchor: Ties the domain to the vehicle's local frame.
        correction: What is asked for beyond what is planned.
    """

    def __init__(self, course: Course, anchor: Anchor, period_s: float, arrival: Arrival | None = None) -> None:
        """Ask for the start of the course, every ``period_s`` of vehicle time, until ``begin``.

        What is sent arrives at once where no ``arrival`` says when.
        """
        self._legs: deque[_Leg] = deque((_Leg(-math.inf, course, Pace(course.bounds.tube_m)),), maxlen=_MOST_LEGS)
        self._flown = self._legs[0]
        self.anchor = anchor
        self._period_s = period_s
        self._next_s = self._steady_until_s = -math.inf
        self.correction = Correction(course.bounds.reach_m)
        self._until_s = math.inf
        self._sent_s = math.inf
        self._arrival = arrival or Arrival(VehicleClock())
        self._stillness = Stillness()

    @property
    def course(self) -> Course:
        """What is flown now."""
        return self._flown.course

    @property
    def next_s(self) -> float:
        """Vehicle time of the next setpoint."""
        return self._next_s

    @property
    def arrives_s(self) -> float:
        """Vehicle time at which it has the last setpoint."""
        return self._sent_s

    @property
    def off_m(self) -> float:
        """Horizontal distance of the last report from the setpoint; infinite before the first."""
        return self._stillness.off_m

    def begin(self, vehicle_s: float) -> None:
        """Let the trajectory begin with the next setpoint, now."""
        self._legs[-1].pace.begin(vehicle_s + self._arrival.settle())

    def redirect(self, course: Course, at_s: float) -> None:
        """Fly another course from a vehicle time on; what was to follow after that is not flown.

        It is to begin with the position, velocity and acceleration that were promised for then (``promise``).
        """
        while len(self._legs) > 1 and self._legs[-1].from_s >= at_s:
            self._legs.pop()
        leg = _Leg(at_s, course, Pace(course.bounds.tube_m))
        leg.pace.begin(at_s)
        self._legs.append(leg)

    def promise(self, at_s: float) -> Reference:
        """What will be asked for at a vehicle time; up to then the pace stays as it is.

        Not before ``arrives_s``: what was sent is not called back.
        """
        pace = self._at(at_s).leg.pace
        if math.isfinite(self._sent_s):
            pace.keep(self._sent_s)
        self._steady_until_s = at_s
        return self.reference(at_s)

    def course_at(self, at_s: float) -> Course:
        """What is flown at a vehicle time."""
        return self._at(at_s).leg.course

    def pace_at(self, at_s: float) -> tuple[float, float]:
        """Where the course is, by its own time, and the rate of that, at a vehicle time."""
        _, beat, elapsed_s = self._at(at_s)
        return elapsed_s, beat.rate

    def end(self, vehicle_s: float) -> None:
        """Lead no further: the trajectory is given up."""
        self._until_s = min(self._until_s, vehicle_s)

    def end_laps(self, vehicle_s: float) -> bool:
        """Let the lap that is flown now be the last; False where none is."""
        if vehicle_s > self._until_s:
            return False
        asked_s = max(vehicle_s, self._sent_s) if math.isfinite(self._sent_s) else vehicle_s
        ended = [leg.course.end_laps(leg.pace.elapsed_s(asked_s)) for leg in self._legs_from(asked_s)]
        return ended[-1]

    def flown_s(self, at_s: float) -> float:
        """How much of the trajectory has been flown at a vehicle time; 0 before its start."""
        moment = self._at(at_s)
        return moment.leg.course.planned_s(moment.within_s) or 0.0

    def trajectory_s(self, at_s: float) -> float | None:
        """Time on the trajectory at a vehicle time; None before its start, after its end, and where none is flown."""
        leg, _, elapsed = self._at(at_s)
        course = leg.course
        flown = 0.0 <= elapsed <= course.duration_s and at_s <= self._until_s
        return course.planned_s(elapsed) if flown else None

    def left_s(self, at_s: float) -> float:
        """What is left of the trajectory at a vehicle time; infinite where it is known that another one follows."""
        leg, _, elapsed_s = self._at(at_s)
        if leg.course.waits or leg is not self._legs[-1]:
            return math.inf
        return leg.course.duration_s - max(elapsed_s, 0.0)

    def _at(self, at_s: float) -> _Moment:
        """A vehicle time on what is flown then, as far as that is remembered."""
        if at_s - self._sent_s > GAP_S and at_s > self._steady_until_s:
            at_s = self._sent_s
        leg = self._legs[-1]
        if leg.from_s > at_s:
            leg = next((leg for leg in reversed(self._legs) if leg.from_s <= at_s), self._legs[0])
        beat = leg.pace.beat(at_s)
        return _Moment(leg, beat, beat.trajectory_s + beat.rate * (at_s - beat.from_s))

    def _legs_from(self, at_s: float) -> list[_Leg]:
        """What is flown at a vehicle time, and what is to follow."""
        now = self._at(at_s).leg
        return [leg for leg in self._legs if leg.from_s >= now.from_s]

    def reference(self, at_s: float) -> Reference:
        """The point to be at, at a vehicle time, with velocity and acceleration by the pace at which it is passed."""
        return self._at(at_s).reference

    def observe(
        self, at_s: float, position_m: Vector, velocity_m_s: Vector, attitude_rad: Vector | None = None
    ) -> Reference:
        """Take a report: how far the vehicle is off, and since when it has been still where it should be.

        Returns:
            Where it should have been, and how fast.
        """
        moment = self._at(at_s)
        course, planned = moment.leg.course, moment.reference
        wanted = planned.position_m
        error = (position_m[0] - wanted[0], position_m[1] - wanted[1])
        if self.trajectory_s(at_s) is None or at_s - self._sent_s > GAP_S:
            self.correction.rest()
        else:
            self.correction.observe(at_s, error, planned, velocity_m_s, attitude_rad)
        facing = course.faces(None if attitude_rad is None else attitude_rad[2])
        self._stillness.observe(at_s, position_m, velocity_m_s, wanted, facing=facing)
        return planned

    def steady_s(self, at_s: float) -> float:
        """How long the vehicle has been still at the setpoint."""
        return self._stillness.steady_s(at_s)

    def due(self, vehicle_s: float) -> tuple[Reference, LocalSetpoint, Gap | None] | None:
        """The setpoint to send now; None where the last one is not old enough, or nothing is led any more.

        With it comes the pause of the trajectory that it ends, if it ends one.
        """
        if vehicle_s < self._next_s or vehicle_s > self._until_s:
            return None
        begun = math.isfinite(self._at(vehicle_s).elapsed_s)
        arrives_s = vehicle_s + (self._arrival.follow(vehicle_s) if begun else self._arrival.settle())
        gap = self._pause_until(arrives_s)
        self._sent_s = arrives_s
        now = self._at(arrives_s)
        before, self._flown = self._flown, now.leg
        if before is not self._flown:
            self.course.follow(before.course)
        self._next_s = max(self._next_s + self._period_s, vehicle_s + 0.5 * self._period_s)
        self.correction.know_delay(self._arrival.delay_s)
        if arrives_s > self._steady_until_s and self.trajectory_s(arrives_s) is not None:
            ahead = (self.course.reference(now.elapsed_s + later_s) for later_s in _AHEAD_S)
            most_rate = self.correction.rate_within(_SHARE_OF_LEAN * self.course.bounds.lean_m_s2, ahead)
            own = self.course.reference(now.elapsed_s)
            self._flown.pace.adapt(arrives_s, self.correction.behind_m, most_rate, own, self.correction.calm)
        now = self._at(arrives_s)
        reference = now.reference
        led = self.reference(arrives_s + self.correction.lead_s)
        place = self.reference(arrives_s + self.correction.delay_s)
        asked = self.correction.corrected(led._replace(position_m=place.position_m))
        yaw_rad = self.course.turn(reference, now.within_s, arrives_s)
        setpoint = LocalSetpoint(
            time_boot_ms=round(arrives_s * 1000.0),
            position_ned_m=self.anchor.to_vehicle(asked.position_m),
            velocity_ned_m_s=ned_from_enu(asked.velocity_m_s),
            acceleration_ned_m_s2=ned_from_enu(asked.acceleration_m_s2),
            yaw_rad=yaw_rad,
            yaw_rate_rad_s=self.course.yaw_rate_rad_s,
        )
        return reference, setpoint, gap

    def _pause_until(self, arrives_s: float) -> Gap | None:
        """Let the trajectory go on from where the last setpoint stood, where that is too old."""
        gap_s = arrives_s - self._sent_s
        if gap_s <= GAP_S:
            return None
        leg, _, elapsed_s = self._at(self._sent_s)
        later = self._legs_from(self._sent_s)[1:]
        if not later and not 0.0 <= elapsed_s < leg.course.duration_s:
            return None
        leg.pace.pause(self._sent_s, arrives_s)
        for each in later:
            self._legs.remove(each)
        for each in later:
            self.redirect(each.course, each.from_s + gap_s)
        return Gap(Missing.SETPOINT, self._sent_s, gap_s)
