"""Setpoints by the affine field at the estimated position: no time law, and no place from which it does not go on.

What is asked for is the velocity of the field where the vehicle is now, by its last report, and the position there, so
that nothing is owed to a point that moves ahead. Where the vehicle is to stand, that point is asked for.
"""

import math
from typing import Final

import numpy as np

from mission.geometry.arrays import FloatArray, IntArray
from mission.link.arrival import Arrival
from mission.link.course import Course, Reference
from mission.link.errand import Order
from mission.link.field_orders import FieldOrders
from mission.link.frames import Anchor, Vector, ned_from_enu
from mission.link.stillness import Stillness
from mission.link.values import LocalSetpoint
from mission.link.vehicle_clock import VehicleClock
from mission.monitor.gaps import GAP_S, Gap
from mission.monitor.monitor import Whereabouts

_NEAR_M: Final = 0.5
"""Where the point to stand at is asked for, and no more the velocity toward it."""

_STANDS_M: Final = 1.0
_STANDS_M_S: Final = 0.5


class FieldGuidance:
    """Leads the vehicle to the start, then by the field until all is done, and lets it stand there.

    Attributes:
        course: The heading and the height; its trajectory is not flown.
        anchor: Ties the domain to the vehicle's local frame.
    """

    def __init__(
        self, course: Course, orders: FieldOrders, anchor: Anchor, period_s: float, arrival: Arrival | None = None
    ) -> None:
        """Ask for the start of the course, every ``period_s`` of vehicle time, until ``begin``.

        What is sent arrives at once where no ``arrival`` says when.
        """
        self.course, self.anchor = course, anchor
        self._arrival = arrival or Arrival(VehicleClock())
        self._orders, self._period_s = orders, period_s
        self._next_s = -math.inf
        self._begun_s = self._until_s = math.inf
        self._stillness = Stillness()
        self._report: tuple[float, Vector, Vector] | None = None
        self._asked = course.reference(0.0)
        self._asked_s = -math.inf
        self._drift = np.zeros(2)
        """How fast what stands moved where the vehicle was when the last setpoint was made, m/s."""
        self._walls: dict[tuple[int, bool], IntArray] = {}
        self._whole_cost = math.inf

    @property
    def next_s(self) -> float:
        """Vehicle time of the next setpoint."""
        return self._next_s

    @property
    def arrives_s(self) -> float:
        """Vehicle time at which it has the last setpoint."""
        return self._asked_s + self._arrival.delay_s

    @property
    def off_m(self) -> float:
        """Horizontal distance of the last report from the last setpoint; infinite before the first."""
        return self._stillness.off_m

    @property
    def sealed(self) -> bool:
        """Whether nothing can be completed from where the vehicle is."""
        return self._orders.errand.sealed

    def begin(self, vehicle_s: float) -> None:
        """Let the flight begin now."""
        self._begun_s = vehicle_s

    def end(self, vehicle_s: float) -> None:
        """Lead no further: the flight is given up."""
        self._until_s = min(self._until_s, vehicle_s)

    def end_laps(self, vehicle_s: float) -> bool:
        """Let the lap that is flown now be the last; False where none is."""
        return self._begun_s <= vehicle_s <= self._until_s and self._orders.errand.end_laps()

    def flown_s(self, at_s: float) -> float:
        """How far the flight is, as a time on the trajectory that was planned, by the share of the cost that is paid.

        Of laps it is the time since the start, for their costs end nowhere.
        """
        if at_s < self._begun_s or not math.isfinite(self._orders.errand.cost):
            return 0.0
        if self._orders.errand.recurrent:
            return min(at_s - self._begun_s, self.course.duration_s)
        left = 0.0 if self._orders.errand.over else min(self._orders.errand.cost / self._whole_cost, 1.0)
        return self.course.duration_s * (1.0 - left)

    def trajectory_s(self, _at_s: float) -> float | None:
        """None: no trajectory is flown."""
        return None

    def left_s(self, _at_s: float) -> float:
        """0 when all is done, and infinite before."""
        return 0.0 if self._orders.errand.over else math.inf

    def observe(
        self, at_s: float, position_m: Vector, velocity_m_s: Vector, _attitude_rad: Vector | None = None
    ) -> Reference:
        """Take a report.

        Returns:
            What was asked for last.
        """
        if all(map(math.isfinite, (*position_m, *velocity_m_s))):
            self._report = (at_s, position_m, velocity_m_s)
        self._stillness.observe(at_s, position_m, velocity_m_s, self._asked.position_m)
        return self._asked

    def steady_s(self, at_s: float) -> float:
        """How long the vehicle has been still at the setpoint."""
        return self._stillness.steady_s(at_s)

    def due(self, vehicle_s: float) -> tuple[Reference, LocalSetpoint, Gap | None] | None:
        """The setpoint to send now; None where the last one is not old enough, or nothing is led any more.

        The flight has no time that could stand still, so it knows of no gap.
        """
        if vehicle_s < self._next_s or vehicle_s > self._until_s:
            return None
        self._next_s = max(self._next_s + self._period_s, vehicle_s + 0.5 * self._period_s)
        self._arrival.settle()
        if vehicle_s >= self._begun_s:
            self._asked = self._wanted(vehicle_s)
        self._asked_s = vehicle_s
        asked = self._asked
        yaw_rad = self.course.turn(asked, 0.0, vehicle_s)
        setpoint = LocalSetpoint(
            time_boot_ms=round(vehicle_s * 1000.0),
            position_ned_m=self.anchor.to_vehicle(asked.position_m),
            velocity_ned_m_s=ned_from_enu(asked.velocity_m_s),
            acceleration_ned_m_s2=ned_from_enu(asked.acceleration_m_s2),
            yaw_rad=yaw_rad,
            yaw_rate_rad_s=self.course.yaw_rate_rad_s,
        )
        return asked, setpoint, None

    def _wanted(self, vehicle_s: float) -> Reference:
        where, report = self._orders.where(), self._report
        if where is None or report is None or vehicle_s - report[0] > GAP_S:
            return self._at_rest(self._asked.position_m[:2])
        reported_s, (x, y, _), (vx, vy, _) = report
        velocity = np.array([vx, vy])
        ahead_s = max(vehicle_s - reported_s, 0.0) + self._arrival.delay_s
        position = np.array([x, y]) + ahead_s * velocity
        errand = self._orders.errand
        stands = self.off_m <= _STANDS_M and self._keeps_still(velocity)
        order = errand.order(where, vehicle_s, stands=stands)
        if order is None:
            return self._at_rest(self._asked.position_m[:2] if stands else (x, y))
        if not math.isfinite(self._whole_cost):
            self._whole_cost = max(errand.cost, 1.0)
        return self._by(order, where, position, velocity, vehicle_s)

    def _by(
        self, order: Order, where: Whereabouts, position: FloatArray, velocity: FloatArray, vehicle_s: float
    ) -> Reference:
        law = self._orders.law
        frame = law.frame(vehicle_s + self._arrival.delay_s - self._begun_s)
        if order.enter is None:
            point = law.stand_m(order.triangle, frame)
            self._drift = law.drift(order.triangle, point, frame)
            if float(np.hypot(*(point - position))) <= _NEAR_M:
                return self._moving_with(point)
            wanted = law.standing(point, position) + self._drift
        else:
            facet = int(np.flatnonzero(law.partition.neighbours[order.triangle] == order.enter)[0])
            self._drift = law.drift(order.triangle, position, frame)
            wanted = self._taken_up(law.leaving(order.triangle, facet, position, frame), velocity, vehicle_s)
        guarded = law.guarded(wanted, position, velocity, self._walls_of(where), frame=frame, drift_m_s=self._drift)
        vx, vy = guarded.tolist()
        return Reference(
            (float(position[0]), float(position[1]), self.course.altitude_m), (vx, vy, 0.0), (0.0, 0.0, 0.0)
        )

    def _taken_up(self, wanted: FloatArray, velocity: FloatArray, vehicle_s: float) -> FloatArray:
        """A velocity on the way to the one that is wanted, as fast as the vehicle can change its own."""
        fresh = vehicle_s - self._asked_s <= GAP_S
        before = np.array(self._asked.velocity_m_s[:2]) if fresh else velocity
        change = wanted - before
        most = self._orders.law.acceleration_m_s2 * min(max(vehicle_s - self._asked_s, self._period_s), GAP_S)
        size = float(np.hypot(*change))
        return wanted if size <= most else np.asarray(before + change * most / size)

    def _keeps_still(self, velocity: FloatArray) -> bool:
        """Whether the vehicle was to stand, and does, against what stands there."""
        (vx, vy), (asked_x, asked_y, _) = velocity - self._drift, self._asked.velocity_m_s
        return math.hypot(vx, vy) <= _STANDS_M_S and (asked_x, asked_y) == tuple(self._drift.tolist())

    def _walls_of(self, where: Whereabouts) -> IntArray:
        key = (where.state, self._orders.errand.returning)
        if key not in self._walls:
            closed = self._orders.policy.closed(where.state, returning=self._orders.errand.returning)
            self._walls[key] = self._orders.law.walls(closed)
        return self._walls[key]

    def _at_rest(self, place_m: tuple[float, ...]) -> Reference:
        self._drift = np.zeros(2)
        return self._moving_with(np.array(place_m))

    def _moving_with(self, point: FloatArray) -> Reference:
        """To stand at a point that drifts as what stands there."""
        (x, y), (east, north) = point.tolist(), self._drift.tolist()
        return Reference((x, y, self.course.altitude_m), (east, north, 0.0), (0.0, 0.0, 0.0))
