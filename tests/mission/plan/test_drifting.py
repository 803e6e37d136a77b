"""What a flight that is late meets of what moves, against its square and the polygon at many times."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from mission.errors import NoPlanError, SpecError
from mission.export.placed_plan import placed_plan
from mission.export.uploads import autopilot_plan
from mission.geometry.geodesy import LatLon
from mission.plan.drifting import Drifting
from mission.plan.fence import fence_of
from mission.plan.rest import Rest, plan_rest, plan_return
from tests.support.drawn_cases import tried
from tests.support.drifting_flights import k_at, planned_still

MOTIONS = st.sampled_from(
    (
        "{velocity_m_s: [0, 2], until_s: 20}",
        "{velocity_m_s: [0, 1], from_s: 8, until_s: 40}",
        "{velocity_m_s: [1.5, 0], until_s: 20}",
        "{waypoints: [[15, 0, 0], [30, -30, 22], [50, 20, 50]], smooth: true}",
    )
)
NEAR_M = 0.35


def drifting_of(motion: str, kind: str = "restricted", formula: str = "F (S1 & F G home)") -> Drifting:
    plan = planned_still(formula, motion, kind)
    assert plan.moving is not None
    return Drifting(plan, plan.moving)


@tried(10)
@given(MOTIONS, st.integers(0, 20), st.integers(1, 30), st.integers(1, 4))
def test_a_flight_that_is_late_meets_what_the_polygon_meets(motion: str, flown: int, late: int, part: int) -> None:
    plan = planned_still(motion=motion)
    assert plan.moving is not None
    late_s = late + part / 100
    times = np.arange(flown, plan.trajectory.duration_s, 0.05)
    half_m = plan.certificate.tube_m
    squares = [shapely.box(x - half_m, y - half_m, x + half_m, y + half_m) for x, y in plan.trajectory.position(times)]
    apart = [k_at(plan.spec, t + late_s).distance(square) for t, square in zip(times.tolist(), squares, strict=True)]
    found = drifting_of(motion).ahead(float(flown), late_s)
    if min(apart, default=np.inf) == 0.0 and times[np.argmin(apart)] + late_s < plan.moving.last_s:
        assert found == "K"
    elif min(apart, default=np.inf) > NEAR_M:
        assert not found


@tried(10)
@given(MOTIONS, st.tuples(st.integers(5, 155), st.integers(5, 85)), st.integers(0, 60))
def test_what_comes_to_a_place_is_what_comes_over_it(motion: str, place: tuple[int, int], from_s: int) -> None:
    plan = planned_still(motion=motion)
    square = shapely.Point(place).buffer(3.0, cap_style="square")
    later = np.arange(from_s, 70.0, 0.1)
    apart = np.array([k_at(plan.spec, t).distance(square) for t in later.tolist()])
    found = drifting_of(motion).comes((float(place[0]), float(place[1])), 3.0, float(from_s))
    if apart.min() == 0.0:
        assert found is not None
        when_s, name = found
        assert name == "K"
        assert from_s <= when_s <= later[apart == 0.0][0] + 0.1
        assert k_at(plan.spec, when_s).distance(square) < 2.0 * 2.5  # an instant of the mesh before
    elif apart.min() > NEAR_M:
        assert found is None


def test_on_time_nothing_is_asked_for_and_what_is_only_visited_may_be_met() -> None:
    motion = "{velocity_m_s: [0, 2], until_s: 20}"
    assert drifting_of(motion).ahead(0.0, 0.04) == ""
    assert drifting_of(motion).ahead(0.0, 1.0) == "K"
    assert drifting_of(motion, "survey").ahead(0.0, 1.0) == ""
    assert drifting_of(motion, "survey", "F (S1 & F G home) & G !K").ahead(0.0, 1.0) == "K"


def test_nothing_is_planned_anew_nor_uploaded_where_something_moves() -> None:
    plan = planned_still()
    for planned in (plan_rest, plan_return):
        with pytest.raises(NoPlanError, match="nothing is planned anew while it is flown"):
            planned(plan, Rest((), plan.start_m))
    with pytest.raises(SpecError, match="what it meets of regions that move is proved of the trajectory"):
        autopilot_plan(placed_plan(plan, LatLon(47.0, 8.0), 0.2), "px4")


def test_what_moves_is_no_part_of_the_fence() -> None:
    for kind, formula in (("restricted", "F (S1 & F G home)"), ("survey", "F (S1 & F G home) & G !K")):
        plan = planned_still(formula, "{velocity_m_s: [0, 2], until_s: 20}", kind)
        assert not fence_of(plan).exclusions
