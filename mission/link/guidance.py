"""Setpoints along a course, at the vehicle's own time and in its own frame."""

import math
from typing import Final

from mission.link.course import Course, Reference
from mission.link.frames import Anchor, Vector, ned_from_enu
from mission.link.values import LocalSetpoint
from mission.monitor.gaps import GAP_S, Gap, Missing

_STEADY_M: Final = 0.3
_STEADY_M_S: Final = 0.3


class Guidance:
    """Leads the vehicle: to the start of the course, along it, and at its end.

    The trajectory goes on while setpoints are sent. Where none was for a while, it goes on from where the last one
    stood: what was not asked for was not flown either, and a setpoint that leaps leads across what was not proved.

    Attributes:
        course: What is flown.
        anchor: Ties the domain to the vehicle's local frame.
    """

    def __init__(self, course: Course, anchor: Anchor, period_s: float) -> None:
        """Ask for the start of the course, every ``period_s`` of vehicle time, until ``begin``."""
        self.course = course
        self.anchor = anchor
        self._period_s = period_s
        self._next_s = -math.inf
        self._from_s = math.inf
        self._until_s = math.inf
        self._sent_s = math.inf
        self._pause = (0.0, 0.0)
        self._paused_s = 0.0
        self._off_m = math.inf
        self._steady_from_s = math.inf

    @property
    def next_s(self) -> float:
        """Vehicle time of the next setpoint."""
        return self._next_s

    @property
    def off_m(self) -> float:
        """Horizontal distance of the last report from the setpoint; infinite before the first."""
        return self._off_m

    def begin(self, vehicle_s: float) -> None:
        """Let the trajectory begin now."""
        self._from_s = vehicle_s

    def end(self, vehicle_s: float) -> None:
        """Lead no further: the trajectory is given up."""
        self._until_s = min(self._until_s, vehicle_s)

    def end_laps(self, vehicle_s: float) -> bool:
        """Let the lap that is flown now be the last; False where none is."""
        return vehicle_s <= self._until_s and self.course.end_laps(self._elapsed_s(vehicle_s))

    def flown_s(self, at_s: float) -> float:
        """How much of the trajectory has been flown at a vehicle time; 0 before its start."""
        return min(max(self._elapsed_s(at_s), 0.0), self.course.duration_s)

    def trajectory_s(self, at_s: float) -> float | None:
        """Time on the trajectory at a vehicle time; None before its start and after its end."""
        elapsed = self._elapsed_s(at_s)
        flown = 0.0 <= elapsed <= self.course.duration_s and at_s <= self._until_s
        return elapsed if flown else None

    def left_s(self, at_s: float) -> float:
        """What is left of the trajectory at a vehicle time."""
        return self.course.duration_s - max(self._elapsed_s(at_s), 0.0)

    def _elapsed_s(self, at_s: float) -> float:
        """Time on the trajectory, which is less than what has passed by its pauses; negative before its start."""
        if at_s - self._sent_s > GAP_S:
            at_s = self._sent_s
        stood_s, went_on_s = self._pause
        return at_s - self._from_s - self._paused_s - (min(max(at_s, stood_s), went_on_s) - stood_s)

    def reference(self, at_s: float) -> Reference:
        """The point to be at, at a vehicle time."""
        return self.course.reference(self.flown_s(at_s))

    def observe(self, at_s: float, position_m: Vector, velocity_m_s: Vector) -> Vector:
        """Take a report: how far the vehicle is off, and since when it has been still where it should be.

        Returns:
            Where it should have been.
        """
        wanted = self.reference(at_s).position_m
        self._off_m = math.hypot(position_m[0] - wanted[0], position_m[1] - wanted[1])
        still = self._off_m <= _STEADY_M and math.hypot(*velocity_m_s) <= _STEADY_M_S
        if not still or abs(position_m[2] - wanted[2]) > 2.0 * _STEADY_M:
            self._steady_from_s = math.inf
        elif math.isinf(self._steady_from_s):
            self._steady_from_s = at_s
        return wanted

    def steady_s(self, at_s: float) -> float:
        """How long the vehicle has been still at the setpoint."""
        return max(at_s - self._steady_from_s, 0.0)

    def due(self, vehicle_s: float) -> tuple[Reference, LocalSetpoint, Gap | None] | None:
        """The setpoint to send now; None where the last one is not old enough, or nothing is led any more.

        With it comes the pause of the trajectory that it ends, if it ends one.
        """
        if vehicle_s < self._next_s or vehicle_s > self._until_s:
            return None
        gap = self._pause_until(vehicle_s)
        self._sent_s = vehicle_s
        self._next_s = max(self._next_s + self._period_s, vehicle_s + 0.5 * self._period_s)
        reference = self.reference(vehicle_s)
        setpoint = LocalSetpoint(
            time_boot_ms=round(vehicle_s * 1000.0),
            position_ned_m=self.anchor.to_vehicle(reference.position_m),
            velocity_ned_m_s=ned_from_enu(reference.velocity_m_s),
            acceleration_ned_m_s2=ned_from_enu(reference.acceleration_m_s2),
            yaw_rad=self.course.turn(reference, self.flown_s(vehicle_s), vehicle_s),
        )
        return reference, setpoint, gap

    def _pause_until(self, vehicle_s: float) -> Gap | None:
        """Let the trajectory go on from where the last setpoint stood, where that is too old."""
        gap_s = vehicle_s - self._sent_s
        if gap_s <= GAP_S or not 0.0 <= self._elapsed_s(self._sent_s) < self.course.duration_s:
            return None
        self._paused_s += self._pause[1] - self._pause[0]
        self._pause = (self._sent_s, vehicle_s)
        return Gap(Missing.SETPOINT, self._sent_s, gap_s)
