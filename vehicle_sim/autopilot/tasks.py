"""What a mode does from moment to moment: each task turns the estimate into the setpoint to fly.

A task is advanced at the autopilot's rate and never reads a clock of its own. Positions are relative to the
estimator's origin; heights are above home.
"""

from dataclasses import replace
from enum import Enum, auto
from math import hypot, inf
from typing import Final

import numpy as np

from vehicle_sim.autopilot.modes import Event
from vehicle_sim.autopilot.rally import Destination
from vehicle_sim.parameters import FlightSettings
from vehicle_sim.signals import FREE, Estimate, PartialVector, Setpoint, Vector

_REACHED_HEIGHT_M: Final = 0.3
_SLOW_M_S: Final = 0.5


def stopping_place(estimate: Estimate, settings: FlightSettings) -> Vector:
    """Return where the vehicle comes to rest if it brakes from now on."""
    north, east, down = estimate.position_ned_m
    v_north, v_east, v_down = estimate.velocity_ned_m_s
    speed = hypot(v_north, v_east)
    seconds = speed / (2.0 * settings.braking_m_s2) + settings.reaction_s
    return (north + v_north * seconds, east + v_east * seconds, down + v_down * 0.5)


class Task:
    """Base of all tasks: a setpoint that stands until something changes it."""

    landing = False
    taking_off = False
    acts_on_ground = False
    event = Event.TAKEN_OFF
    """What has happened to the mode once the task has finished."""
    _settings: FlightSettings

    def __init__(self, setpoint: Setpoint) -> None:
        """Begin with `setpoint`."""
        self.setpoint = setpoint
        self.finished = False
        self.speed_m_s: float | None = None
        self.climb_m_s: float | None = None
        self.descent_m_s: float | None = None
        self.yaw_rate_rad_s = inf

    @property
    def goal(self) -> PartialVector:
        """The place that it leads to."""
        return self.setpoint.position_ned_m

    def lifts(self, estimate: Estimate) -> bool:
        """Whether a vehicle that stands on the ground should leave it now."""
        del estimate
        return False

    def configure(self, settings: FlightSettings) -> None:
        """Go by other settings from now on; what was decided by the former ones stays decided."""
        self._settings = settings

    def advance(self, now_s: float, estimate: Estimate) -> None:
        """Bring `setpoint` up to date."""

    def turn(self, yaw_rad: float) -> None:
        """Look into another direction from now on."""
        self.setpoint = replace(self.setpoint, yaw_rad=yaw_rad, yaw_rate_rad_s=None)


class HoldTask(Task):
    """Stay at a place; where none is given, where the vehicle comes to rest."""

    def __init__(
        self, estimate: Estimate, settings: FlightSettings, *, place: PartialVector = FREE, yaw_rad: float | None = None
    ) -> None:
        """Keep `place` (axes left free: where the vehicle is) and `yaw_rad` (free: the present one)."""
        here = stopping_place(estimate, settings)
        north, east, down = (here[i] if value is None else value for i, value in enumerate(place))
        yaw = estimate.yaw_rad if yaw_rad is None else yaw_rad
        super().__init__(Setpoint(position_ned_m=(north, east, down), yaw_rad=yaw))


class LevelTask(Task):
    """Keep the height and stay level: manual modes with the sticks centred."""

    def __init__(self, estimate: Estimate) -> None:
        """Keep the present height and yaw."""
        down = estimate.position_ned_m[2] + 0.5 * estimate.velocity_ned_m_s[2]
        super().__init__(Setpoint(position_ned_m=(None, None, down), yaw_rad=estimate.yaw_rad))


class TakeoffTask(Task):
    """Climb straight up to a height, then stay there."""

    taking_off = True

    def __init__(self, estimate: Estimate, settings: FlightSettings, *, down_m: float) -> None:
        """Climb to `down_m` in the estimator's frame above where the vehicle stands."""
        north, east, _ = estimate.position_ned_m
        super().__init__(Setpoint(position_ned_m=(north, east, down_m), yaw_rad=estimate.yaw_rad))
        self.down_m = down_m
        self.climb_m_s = settings.takeoff_m_s

    def lifts(self, estimate: Estimate) -> bool:
        """Leave the ground at once."""
        del estimate
        return True

    def advance(self, now_s: float, estimate: Estimate) -> None:
        """Finish when the height is reached and the climb has slowed down."""
        del now_s
        close = abs(estimate.position_ned_m[2] - self.down_m) < _REACHED_HEIGHT_M
        if close and abs(estimate.velocity_ned_m_s[2]) < _SLOW_M_S:
            self.finished = True
            self.taking_off = False


class GuidedTask(Task):
    """Fly the setpoints that come from outside, and stop when those that need renewal are not renewed."""

    def __init__(
        self,
        estimate: Estimate,
        settings: FlightSettings,
        *,
        lifts_off: bool,
        stops: bool,
        place: PartialVector = FREE,
    ) -> None:
        """Begin by holding `place`, by default where the vehicle comes to rest.

        `lifts_off`: setpoints may lift the vehicle from the ground (PX4). `stops`: velocity is zeroed when
        setpoints with velocity or acceleration end (ArduPilot).
        """
        super().__init__(HoldTask(estimate, settings, place=place).setpoint)
        self._settings = settings
        self._lifts_off = lifts_off
        self._stops = stops
        self._renewed_s = inf
        self.in_control = False

    def take(self, setpoint: Setpoint, now_s: float) -> None:
        """Fly `setpoint` from now on."""
        self.setpoint = setpoint
        self._renewed_s = now_s if setpoint.asks_motion else inf
        self.in_control = True

    def go_to(self, setpoint: Setpoint) -> None:
        """Fly to a place that needs no renewal."""
        self.setpoint = setpoint
        self._renewed_s = inf
        self.in_control = True

    def halt(self, estimate: Estimate) -> None:
        """Stop where the vehicle is."""
        self.go_to(HoldTask(estimate, self._settings).setpoint)

    def lifts(self, estimate: Estimate) -> bool:
        """Leave the ground when a setpoint asks for a climb, where the flavour does that at all."""
        if not (self._lifts_off and self.in_control):
            return False
        down = self.setpoint.position_ned_m[2]
        sink = self.setpoint.velocity_ned_m_s[2]
        return (down is not None and down < estimate.position_ned_m[2] - _REACHED_HEIGHT_M) or (
            down is None and sink is not None and sink < 0.0
        )

    def advance(self, now_s: float, estimate: Estimate) -> None:
        """Zero the velocity, and keep the last position if there was one, once setpoints have ended."""
        del estimate
        if not self._stops or now_s - self._renewed_s <= self._settings.setpoint_timeout_s:
            return
        last = self.setpoint
        still = tuple(0.0 if place is None else None for place in last.position_ned_m)
        self.setpoint = Setpoint(
            position_ned_m=last.position_ned_m, velocity_ned_m_s=(still[0], still[1], still[2]), yaw_rad=last.yaw_rad
        )
        self._renewed_s = inf


class LandTask(Task):
    """Descend over one place until the ground stops the vehicle; without a position, descend level."""

    landing = True

    def __init__(
        self, estimate: Estimate, settings: FlightSettings, *, home_down_m: float, place: PartialVector = FREE
    ) -> None:
        """Land at `place` (free: where the vehicle comes to rest); heights count from `home_down_m`."""
        here: PartialVector = stopping_place(estimate, settings) if estimate.status.position_ok else FREE
        north, east = (here[i] if place[i] is None else place[i] for i in range(2))
        self._settings = settings
        self._home_down_m = home_down_m
        self._place: PartialVector = (north, east, None)
        super().__init__(self._descent(estimate.yaw_rad, self._sink_m_s(estimate)))

    def _sink_m_s(self, estimate: Estimate) -> float:
        height = self._home_down_m - estimate.position_ned_m[2]
        return float(np.interp(height, self._settings.landing_heights_m, self._settings.landing_m_s))

    def _descent(self, yaw_rad: float | None, sink_m_s: float) -> Setpoint:
        return Setpoint(position_ned_m=self._place, velocity_ned_m_s=(None, None, sink_m_s), yaw_rad=yaw_rad)

    def advance(self, now_s: float, estimate: Estimate) -> None:
        """Slow down near the ground; let go of the place if the position is lost."""
        del now_s
        if self._place != FREE and not estimate.status.position_ok:
            self._place = FREE
        sink = self._sink_m_s(estimate)
        if sink != self.setpoint.velocity_ned_m_s[2] or self._place != self.setpoint.position_ned_m:
            self.setpoint = self._descent(self.setpoint.yaw_rad, sink)


class _Leg(Enum):
    CLIMB = auto()
    CRUISE = auto()
    DESCEND = auto()
    WAIT = auto()
    LAND = auto()


class ReturnTask(Task):
    """Climb, fly home or to a rally point, wait, land."""

    def __init__(self, estimate: Estimate, settings: FlightSettings, *, goal: Destination) -> None:
        """Return to `goal` at the height that it asks for, never lower than now."""
        self._settings = settings
        self._home, self._height_m = goal
        self._leg = _Leg.CLIMB
        self._land: LandTask | None = None
        self._waiting_since_s = inf
        self._start = stopping_place(estimate, settings)
        self.down_m = self._cruise_down_m(estimate)
        place = (self._start[0], self._start[1], self.down_m)
        super().__init__(Setpoint(position_ned_m=place, yaw_rad=estimate.yaw_rad))
        self.speed_m_s = settings.return_speed_m_s

    def configure(self, settings: FlightSettings) -> None:
        """Go by other settings from now on, also in the landing."""
        super().configure(settings)
        if self._land is not None:
            self._land.configure(settings)

    def _cruise_down_m(self, estimate: Estimate) -> float:
        settings = self._settings
        distance = hypot(self._start[0] - self._home[0], self._start[1] - self._home[1])
        height = self._home[2] - estimate.position_ned_m[2]
        if distance < settings.return_min_distance_m:
            wanted = height
        elif settings.return_cone_slope < inf:
            wanted = min(self._height_m, settings.return_cone_slope * distance)
        else:
            wanted = self._height_m
        return self._home[2] - max(height + settings.return_climb_min_m, wanted)

    def advance(self, now_s: float, estimate: Estimate) -> None:
        """Go from leg to leg."""
        north, east, down = estimate.position_ned_m
        home_n, home_e, home_d = self._home
        yaw = self.setpoint.yaw_rad
        if self._leg is _Leg.CLIMB and down < self.down_m + _REACHED_HEIGHT_M:
            self._leg = _Leg.CRUISE
            self.setpoint = Setpoint(position_ned_m=(home_n, home_e, self.down_m), yaw_rad=yaw)
        elif self._leg is _Leg.CRUISE and hypot(north - home_n, east - home_e) < self._settings.reached_m:
            self._leg = _Leg.DESCEND
            lowest = max(self.down_m, home_d - self._settings.return_descent_height_m)
            self.setpoint = Setpoint(position_ned_m=(home_n, home_e, lowest), yaw_rad=yaw)
        elif self._leg is _Leg.DESCEND:
            target = self.setpoint.position_ned_m[2]
            if target is not None and abs(down - target) < 2.0 * _REACHED_HEIGHT_M:
                self._leg = _Leg.WAIT
                self._waiting_since_s = now_s
        elif self._leg is _Leg.WAIT and now_s - self._waiting_since_s >= self._settings.return_wait_s:
            self._leg = _Leg.LAND
            self.landing = True
            self._land = LandTask(estimate, self._settings, home_down_m=home_d, place=(home_n, home_e, None))
        if self._land is not None:
            self._land.advance(now_s, estimate)
            self.setpoint = self._land.setpoint
