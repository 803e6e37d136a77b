"""Where flights end: their landings drift, and stay where they may be, where there is room for that."""

import json

import numpy as np
import pytest
import shapely

from mission.geometry.arrays import FloatArray
from mission.plan import FlightPlan
from mission.plan.landing import room_to_land
from mission.plan.serial import plan_to_json
from mission.verify.plans.proof import tube_holds, words_satisfy
from mission.verify.plans.written import Written
from tests.support.small_missions import ROUNDS, SMALL, plan_of

TINY = SMALL.replace(
    "home: {kind: home, polygon: [[4, 4], [14, 4], [14, 12], [4, 12]]}",
    "home: {kind: home, polygon: [[4, 4], [14, 4], [14, 5.6], [4, 5.6]]}",
).replace("position_m: [9, 8]", "position_m: [9, 4.8]")


def end_of(plan: FlightPlan) -> FloatArray:
    last = plan.trajectory.legs[-1].curve
    return np.asarray(last.position([last.duration_s])[0])


def square(place_m: FloatArray, half_m: float) -> shapely.Polygon:
    return shapely.box(*(place_m - half_m), *(place_m + half_m))


@pytest.mark.parametrize("text", [SMALL, ROUNDS])
def test_a_landing_that_drifts_stays_at_home(text: str) -> None:
    plan = plan_of(text)
    flight = plan.spec.flight
    assert plan.landing_m == flight.landing_m > 0.0
    assert shapely.covers(plan.area_of("home"), square(end_of(plan), flight.tube_m + flight.landing_m))
    assert not [text for text in plan.warnings if "landing" in text]


def test_where_there_is_little_room_it_is_in_the_middle_and_said() -> None:
    plan = plan_of(TINY)
    assert plan.landing_m == pytest.approx(0.8 - plan.spec.flight.tube_m, abs=0.02)
    assert end_of(plan)[1] == pytest.approx(4.8, abs=0.02)
    [warning] = [text for text in plan.warnings if "landing" in text]
    assert "may drift by 0.5 m from the tube, and where the flight ends there is room for 0.2" in warning


def test_who_may_land_anywhere_lands_at_once() -> None:
    """Of a mission that has been done the end is free, but for what is restricted."""
    plan = plan_of(SMALL.replace("F (goal & F G home) & G !pond", "F goal & G !pond"))
    assert plan.landing_m == plan.spec.flight.landing_m
    x, _ = end_of(plan)
    assert x < 26.0 + 2.0 * plan.spec.flight.tube_m


def test_the_landing_is_looked_at_by_whoever_checks_the_plan() -> None:
    plan = plan_of(TINY)
    data = json.loads(plan_to_json(plan))
    written = Written(data, plan.spec)
    assert (tube_holds(written)[0], words_satisfy(written)[0]) == (None, None)
    data["certificate"]["landing_m"] = plan.spec.flight.landing_m
    assert words_satisfy(Written(data, plan.spec))[0] == (
        "a flight within the tube may spell a word that violates the mission"
    )
    data["certificate"]["landing_m"] = 0.6
    assert "landing_m" in str(tube_holds(Written(data, plan.spec))[0])


def test_a_way_back_from_laps_is_looked_at_with_its_landing() -> None:
    plan = plan_of(ROUNDS)
    data = json.loads(plan_to_json(plan))
    assert words_satisfy(Written(data, plan.spec))[0] is None
    data["homeward"]["certificate"]["landing_m"] = 1.0
    assert "landing_m" in str(tube_holds(Written(data, plan.spec))[0])


def test_each_part_from_which_no_other_is_reached_has_its_own_middle() -> None:
    left, right, small = shapely.box(0, 0, 10, 10), shapely.box(20, 0, 30, 10), shapely.box(22, 4, 23, 6)
    free = shapely.union_all([left, right])
    roomy = room_to_land(shapely.union_all([left, small]), free, 1.0)
    assert shapely.covers(roomy, shapely.box(1, 1, 9, 9))
    [middle] = [part for part in shapely.get_parts(roomy) if shapely.intersects(part, right)]
    assert shapely.covers(small, middle)
    assert middle.centroid.x == pytest.approx(22.5, abs=0.05)
