"""Visits of regions whose triangles are thin: the path goes on to where there is room."""

import math

import numpy as np
import pytest
import shapely

from mission.plan import FlightPlan, plan_mission
from mission.plan.loiter import loiter_stops
from mission.spec.loader import parse_mission
from tests.support.steered_plans import BY_FIELDS, fields_of

MISSION = """\
domain:
  boundary: [[0, 0], [120, 0], [120, 80], [0, 80]]
regions:
  home: {{kind: home, polygon: [[5, 5], [20, 5], [20, 20], [5, 20]]}}
  spot: {{kind: survey, {shape}}}
  post: {{kind: area, centre: [80, 40], radius_m: 1.5}}
mission:
  formula: {formula}
start:
  position_m: [12, 12]
flight: {{speed_m_s: 3, disturbance_m_s2: {tube}}}
"""


def planned(shape: str, tube: float, formula: str = "F spot & F G home") -> FlightPlan:
    return plan_mission(parse_mission((MISSION.format(shape=shape, tube=tube, formula=formula) + BY_FIELDS).encode()))


def depths(plan: FlightPlan) -> list[float]:
    """How deep inside its region the vehicle stands at each of its stops."""
    return [
        stop.depth_m
        for stop in loiter_stops(
            fields_of(plan), plan.trajectory.curve, plan.partition, plan.labelling, plan.spec.regions
        )
    ]


@pytest.mark.parametrize(("radius_m", "tube"), [(6.0, 1.0), (4.0, 0.5), (20.0, 0.0), (20.0, 2.0), (3.0, 1.2)])
def test_who_loiters_in_a_circle_stands_near_its_middle(radius_m: float, tube: float) -> None:
    plan = planned(f"centre: [80, 40], radius_m: {radius_m}, loiter_s: 5", tube)
    assert plan.certificate.holds
    (depth_m,) = depths(plan)
    assert 0.85 * radius_m < depth_m <= radius_m
    ((s, seconds),) = plan.stops
    assert seconds == 5.0
    assert math.dist(plan.curve.position([s])[0], (80.0, 40.0)) < 0.15 * radius_m
    # Once only: the way there and back has no other stop than its turn.
    assert plan.trajectory.duration_s < 5.0 + 1.6 * plan.curve.length_m / plan.spec.flight.speed_m_s


def test_a_visit_of_a_small_circle_goes_where_the_tube_has_room() -> None:
    plan = planned("centre: [80, 40], radius_m: 3", 1.2)
    (visit,) = [segment for segment in fields_of(plan).segments if segment.lanes]
    assert visit.lanes is not None
    there = visit.lanes.corners_m[1]
    assert math.dist(there, (80.0, 40.0)) < 1.0
    assert plan.passed_over == ()


def test_the_way_stays_inside_and_keeps_out_of_what_is_forbidden() -> None:
    for formula in ("F spot & F G home & G !post", "F spot & F G home"):
        plan = planned("centre: [80, 40], radius_m: 12, loiter_s: 2", 0.3, formula)
        assert plan.certificate.holds
        curve = shapely.LineString(plan.curve.position(np.linspace(0.0, plan.curve.duration_s, 4000)))
        crossed = curve.distance(shapely.Point(80, 40)) < 1.5
        assert crossed is ("post" not in formula)
        (depth_m,) = depths(plan)
        assert depth_m > 4.0


def test_laps_loiter_in_the_middle_each_time() -> None:
    plan = planned("centre: [80, 40], radius_m: 8, loiter_s: 2", 0.5, "G F spot & G F home")
    assert plan.certificate.holds
    assert plan.trajectory.lap is not None
    assert min(depths(plan)) > 6.0


def test_where_triangles_have_room_nothing_is_added() -> None:
    plan = planned("polygon: [[95, 10], [112, 10], [112, 26], [95, 26]], loiter_s: 2", 0.5)
    assert [segment for segment in fields_of(plan).segments if segment.lanes] == []
