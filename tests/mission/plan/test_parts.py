"""What boundary and clearances take away is told of: what is cut off, left of nothing, or in another part."""

import pytest

from mission.errors import NoPlanError
from mission.plan import plan_mission
from mission.spec.loader import parse_mission
from mission.spec.model import MissionSpec

SITE = """\
domain:
  boundary: %s
  mesh: {smallest_angle_deg: 10}
  clearance_m: %g
regions:
  home: {kind: home, polygon: [[5, 5], [15, 5], [15, 15], [5, 15]]}
  near: {kind: survey, polygon: [[20, 5], [30, 5], [30, 15], [20, 15]]}
  far: {kind: survey, polygon: [[65, 5], [75, 5], [75, 15], [65, 15]]}
mission: {formula: F %s & F G home}
start: {position_m: [10, 10]}
flight: {disturbance_m_s2: 0.2}
"""
PARTS = (
    "{polygons: [{polygon: [[0, 0], [40, 0], [40, 20], [0, 20]]}, {polygon: [[60, 0], [80, 0], [80, 20], [60, 20]]}]}"
)
NECK = (
    "[[0, 0], [40, 0], [40, 8], [60, 8], [60, 0], [80, 0], [80, 20], [60, 20], [60, 12], [40, 12], [40, 20], [0, 20]]"
)

IN_MARGIN = "restricted, polygon: [[79, 5], [80, 5], [80, 15], [79, 15]]"


def site(boundary: str, visited: str, clearance_m: float = 0.0) -> MissionSpec:
    return parse_mission((SITE % (boundary, clearance_m, visited)).encode())


def test_parts_of_a_boundary_are_out_of_reach_of_each_other_and_told_of() -> None:
    plan = plan_mission(site(PARTS, "near"))
    told = "domain.boundary has 2 parts, and no way leads from one to another; far cannot be reached from the start"
    assert told in plan.warnings
    with pytest.raises(NoPlanError) as refused:
        plan_mission(site(PARTS, "far"))
    assert refused.value.cause == "unreachable"
    assert str(refused.value).splitlines()[-1] == told


def test_a_clearance_that_parts_the_boundary_is_told_of_and_refused_where_the_way_is_needed() -> None:
    plan = plan_mission(site(NECK, "near", 2.5))
    told = "domain.clearance_m: 2.5 leaves 2 parts, and no way leads from one to another; far cannot be reached"
    assert f"{told} from the start" in plan.warnings
    with pytest.raises(NoPlanError) as refused:
        plan_mission(site(NECK, "far", 2.5))
    assert refused.value.cause == "clearance"
    assert "two sides of the boundary are 4 m apart near (50, 10); with domain.clearance_m: 1.71" in str(refused.value)


def test_a_region_of_which_clearances_leave_nothing_is_told_of_where_it_is_not_needed() -> None:
    plan = plan_mission(site(NECK.replace("75", "70"), "near", 1.0))
    assert plan.warnings == ()
    text = (SITE % (NECK, 0.0, "near")).replace("[65, 15]]", "[65, 15]], clearance_m: 6")
    plan = plan_mission(parse_mission(text.encode()))
    assert plan.warnings == ("regions.far: clearances leave nothing of it",)
    text = (SITE % (NECK, 1.5, "near")).replace("survey, polygon: [[65, 5], [75, 5], [75, 15], [65, 15]]", IN_MARGIN)
    assert plan_mission(parse_mission(text.encode())).warnings == ()
