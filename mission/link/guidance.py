"""Setpoints along a course, at the vehicle's own time and in its own frame."""

import math
from typing import Final

from mission.link.correction import Correction
from mission.link.course import Course, Reference
from mission.link.frames import Anchor, Vector, ned_from_enu
from mission.link.pace import Pace
from mission.link.stillness import Stillness
from mission.link.values import LocalSetpoint
from mission.monitor.gaps import GAP_S, Gap, Missing

_AHEAD_S: Final = (0.0, 0.75, 1.5)
"""On the trajectory: where it is looked whether the vehicle can fly so fast."""

_SHARE_OF_LEAN: Final = 0.9


class Guidance:
    """Leads the vehicle: to the start of the course, along it, and at its end.

    The trajectory goes on while setpoints are sent. Where none was for a while, it goes on from where the last one
    stood: what was not asked for was not flown either, and a setpoint that leaps leads across what was not proved.
    Where the vehicle does not keep up, it goes on more slowly (``pace``), and what is asked for differs from what is
    planned by a bounded ``correction``.

    Attributes:
        course: What is flown.
        anchor: Ties the domain to the vehicle's local frame.
        correction: What is asked for beyond what is planned.
    """

    def __init__(self, course: Course, anchor: Anchor, period_s: float) -> None:
        """Ask for the start of the course, every ``period_s`` of vehicle time, until ``begin``."""
        self.course = course
        self.anchor = anchor
        self._period_s = period_s
        self._next_s = -math.inf
        self.correction = Correction(course.bounds.reach_m)
        self._pace = Pace(course.bounds.tube_m)
        self._until_s = math.inf
        self._sent_s = math.inf
        self._stillness = Stillness()

    @property
    def next_s(self) -> float:
        """Vehicle time of the next setpoint."""
        return self._next_s

    @property
    def off_m(self) -> float:
        """Horizontal distance of the last report from the setpoint; infinite before the first."""
        return self._stillness.off_m

    def begin(self, vehicle_s: float) -> None:
        """Let the trajectory begin now."""
        self._pace.begin(vehicle_s)

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
        """Time on the trajectory, which stands where no setpoint is sent; negative before its start."""
        return self._pace.elapsed_s(self._sent_s if at_s - self._sent_s > GAP_S else at_s)

    def reference(self, at_s: float) -> Reference:
        """The point to be at, at a vehicle time, with velocity and acceleration by the pace at which it is passed."""
        position, velocity, acceleration = self.course.reference(self.flown_s(at_s))
        beat = self._pace.beat(at_s)
        if beat.rate == 1.0 and beat.growth_per_s == 0.0:
            return Reference(position, velocity, acceleration)
        square, growth = beat.rate**2, beat.growth_per_s
        (vx, vy, vz), (ax, ay, az) = velocity, acceleration
        return Reference(
            position,
            (beat.rate * vx, beat.rate * vy, beat.rate * vz),
            (square * ax + growth * vx, square * ay + growth * vy, square * az + growth * vz),
        )

    def observe(
        self, at_s: float, position_m: Vector, velocity_m_s: Vector, attitude_rad: Vector | None = None
    ) -> Reference:
        """Take a report: how far the vehicle is off, and since when it has been still where it should be.

        Returns:
            Where it should have been, and how fast.
        """
        planned = self.reference(at_s)
        wanted = planned.position_m
        error = (position_m[0] - wanted[0], position_m[1] - wanted[1])
        if self.trajectory_s(at_s) is None or at_s - self._sent_s > GAP_S:
            self.correction.rest()
        else:
            self.correction.observe(at_s, error, planned, velocity_m_s, attitude_rad)
        facing = self.course.faces(None if attitude_rad is None else attitude_rad[2])
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
        gap = self._pause_until(vehicle_s)
        self._sent_s = vehicle_s
        self._next_s = max(self._next_s + self._period_s, vehicle_s + 0.5 * self._period_s)
        if (trajectory_s := self.trajectory_s(vehicle_s)) is not None:
            ahead = [self.course.reference(trajectory_s + later_s) for later_s in _AHEAD_S]
            lean_m_s2 = _SHARE_OF_LEAN * self.course.bounds.lean_m_s2
            most_rate = min(self.correction.rate_within(lean_m_s2, point) for point in ahead)
            self._pace.adapt(vehicle_s, self.correction.behind_m, most_rate, ahead[0])
        reference = self.reference(vehicle_s)
        led = self.reference(vehicle_s + self.correction.lead_s)
        place = self.reference(vehicle_s + self.correction.delay_s)
        asked = self.correction.corrected(led._replace(position_m=place.position_m))
        yaw_rad = self.course.turn(reference, self.flown_s(vehicle_s), vehicle_s)
        setpoint = LocalSetpoint(
            time_boot_ms=round(vehicle_s * 1000.0),
            position_ned_m=self.anchor.to_vehicle(asked.position_m),
            velocity_ned_m_s=ned_from_enu(asked.velocity_m_s),
            acceleration_ned_m_s2=ned_from_enu(asked.acceleration_m_s2),
            yaw_rad=yaw_rad,
            yaw_rate_rad_s=self.course.yaw_rate_rad_s,
        )
        return reference, setpoint, gap

    def _pause_until(self, vehicle_s: float) -> Gap | None:
        """Let the trajectory go on from where the last setpoint stood, where that is too old."""
        gap_s = vehicle_s - self._sent_s
        if gap_s <= GAP_S or not 0.0 <= self._elapsed_s(self._sent_s) < self.course.duration_s:
            return None
        self._pace.pause(self._sent_s, vehicle_s)
        return Gap(Missing.SETPOINT, self._sent_s, gap_s)
