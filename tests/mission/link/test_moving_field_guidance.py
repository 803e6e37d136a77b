"""Guidance by the field to a region that drifts, with a vehicle that is a point: it goes there, and goes along."""

import numpy as np
import pytest

from mission.fly.by_field import field_orders
from mission.link.course import Course
from mission.link.field_guidance import FieldGuidance
from mission.monitor.flight import FlightMonitor
from tests.support.carried_plans import drifting_by_field
from tests.support.sessions import Straight, anchor_at_start

STEP_S, LAG_S = 0.05, 0.4
DRIFT_M_S, UNTIL_S = 0.5, 40.0
K_M = np.array([[64.0, 12.0], [80.0, 28.0]])
"""Its lower left and its upper right corner at first."""


class Point:
    """A vehicle that takes up what is asked of it with a lag, and tells where it is."""

    def __init__(self) -> None:
        plan = drifting_by_field("F G K", f"{{velocity_m_s: [0, {DRIFT_M_S}], until_s: {UNTIL_S}}}", kind="survey")
        self.monitor = FlightMonitor(plan).monitor
        orders = field_orders(plan, self.monitor)
        assert orders is not None
        self.guidance = FieldGuidance(Course(Straight(), 0.0), orders, anchor_at_start((0.0, 0.0, 0.0)), STEP_S)
        self.guidance.begin(0.0)
        self.place, self.velocity, self.asked, self.time_s = np.array(plan.start_m), np.zeros(2), np.zeros(2), 0.0
        self.fastest_m_s = 0.0

    def fly(self, until_s: float) -> None:
        while self.time_s < until_s:
            (x, y), (vx, vy) = self.place.tolist(), self.velocity.tolist()
            self.monitor.observe(self.time_s, (x, y))
            self.guidance.observe(self.time_s, (x, y, 5.0), (vx, vy, 0.0))
            due = self.guidance.due(self.time_s)
            if due is not None:
                (*place, _), (*velocity, _), _ = due[0]
                self.asked = np.array(velocity) + np.array(place) - self.place
            self.velocity = self.velocity + (self.asked - self.velocity) * STEP_S / LAG_S
            self.place = self.place + STEP_S * self.velocity
            self.fastest_m_s = max(self.fastest_m_s, float(np.hypot(*self.velocity)))
            self.time_s += STEP_S


def test_it_goes_to_a_region_that_drifts_goes_along_with_it_and_stays_where_that_does() -> None:
    vehicle = Point()
    vehicle.fly(35.0)
    shift = np.array([0.0, DRIFT_M_S * 35.0])
    assert (K_M[0] + shift < vehicle.place).all()
    assert (vehicle.place < K_M[1] + shift).all()
    assert vehicle.velocity == pytest.approx([0.0, DRIFT_M_S], abs=0.05)
    assert vehicle.guidance.left_s(vehicle.time_s) == 0.0  # it has stood there, against what stands there
    assert vehicle.fastest_m_s < 4.5
    vehicle.fly(50.0)
    assert vehicle.velocity == pytest.approx([0.0, 0.0], abs=0.05)
    assert (K_M[0] + [0.0, DRIFT_M_S * UNTIL_S] < vehicle.place).all()
    assert (vehicle.place < K_M[1] + [0.0, DRIFT_M_S * UNTIL_S]).all()
