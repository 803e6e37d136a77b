"""Plans past what is there for a time: before it comes, when it is gone, or round it, whichever is over soonest."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from mission.errors import LateError, NoPlanError, SpecError
from mission.export.placed_plan import placed_plan
from mission.export.uploads import autopilot_plan
from mission.geometry.geodesy import LatLon
from mission.plan import FlightPlan, plan_from_json, plan_mission, plan_to_json
from mission.plan.fence import fence_of
from mission.plan.rest import Rest, plan_rest
from mission.plan.time_bounds import FOLLOWED_S, bounds_of, met_at_rest
from mission.spec.areas import region_ground
from mission.spec.specification import timed_of
from mission.verify.plans import claims
from tests.support.closing_missions import closing, closing_plan


def margins(plan: FlightPlan) -> dict[str, float]:
    return {str(bound.formula): bound.margin_s for bound in plan.bounds}


def at_gate(plan: FlightPlan) -> list[float]:
    """Times at which the vehicle on its path is in the gate as it is drawn, by samples."""
    times = np.linspace(0.0, plan.trajectory.duration_s, 4000)
    ground = region_ground(next(each for each in plan.spec.regions if each.name == "gate"), plan.spec.domain)
    assert ground is not None
    inside = shapely.contains_xy(ground.drawn, *plan.trajectory.position(times).T)
    return [float(t_s) for t_s in times[inside]]


def fastest_s() -> float:
    return closing_plan(kind="area").trajectory.duration_s


def test_what_closes_later_is_passed_before() -> None:
    plan = closing_plan(gate="[60, 180]")
    assert plan.trajectory.duration_s == fastest_s()
    assert 0.0 < max(at_gate(plan)) < 60.0 - margins(plan)["G !gate[60,180]"] + 1.0


@pytest.mark.parametrize("begins", ["null", "2", "8.5"])
def test_what_there_is_no_way_round_is_passed_when_it_is_gone(begins: str) -> None:
    plan = closing_plan(gate=f"[{begins}, 40]")
    (margin,) = margins(plan).values()
    assert FOLLOWED_S <= margin < FOLLOWED_S + 0.5
    assert 40.0 < min(at_gate(plan)) < 43.0


def test_a_way_round_is_flown_where_that_is_over_sooner_than_a_wait() -> None:
    straight_s = fastest_s()
    waits, round_it = closing_plan(gate="[null, 10]", round_it=True), closing_plan(gate="[null, 60]", round_it=True)
    assert at_gate(waits)
    assert straight_s + 0.5 < waits.trajectory.duration_s < round_it.trajectory.duration_s
    assert not at_gate(round_it)
    assert round_it.trajectory.duration_s < 60.0
    assert margins(round_it) == {"G !gate[0,60]": float("inf")}


def test_a_place_is_visited_while_it_is_there() -> None:
    assert 30.0 < closing_plan(kind="area", far="[30, 35]").trajectory.duration_s < 60.0
    late, in_time = closing("F G home", "[visit: [near, far]]", far="[null, 15.5]", kind="area"), "F far[0,15.5]"
    assert margins(plan_mission(late))[in_time] >= FOLLOWED_S


@pytest.mark.parametrize(
    ("gate", "far", "told"),
    [
        ("[5, null]", "[null, 900]", "G !gate[5,inf] fails by "),
        ("[70, 80]", "[null, 14.5]", "F far[0,14.5] fails by "),
        ("[null, 40]", "[null, 30]", "G !gate[0,40] fails by "),
    ],
)
def test_what_cannot_be_is_refused_with_what_fails_and_by_how_much(gate: str, far: str, told: str) -> None:
    with pytest.raises(LateError, match=rf"keeps its bounds in seconds; the nearest:\n  {re.escape(told)}\d+\.\d\d s"):
        plan_mission(closing(gate=gate, far=far))


def test_what_is_gone_before_any_flight_can_be_there_is_refused_at_once() -> None:
    with pytest.raises(LateError, match=re.escape("F far[0,5] fails by at least ") + r".*no flight is there before \d"):
        plan_mission(closing(far="[null, 5]", gate="[70, 80]"))


def test_who_begins_inside_of_what_closes_at_once_has_no_plan() -> None:
    spec = closing("F far", gate="[null, 30]")
    inside = replace(spec, start=replace(spec.start, position_m=(43.0, 15.0)))
    with pytest.raises(LateError, match=re.escape("G !gate[0,30] fails by 30.05 s")):
        plan_mission(inside)
    assert plan_mission(replace(closing("F far", gate="[30, 60]"), start=inside.start)).certificate.holds


def test_of_laps_each_is_flown_at_its_own_time() -> None:
    tasks = "[patrol: [near, far]]"
    plan = closing_plan("G F home", tasks, gate="[null, 6]")
    lap_s = plan.trajectory.duration_s
    assert all(bound.kept for bound in plan.bounds)
    assert not [claim for claim in claims(plan_to_json(plan)) if claim.fault]
    window = f"[{10 * lap_s:.1f}, {11.2 * lap_s:.1f}]"
    waits = closing_plan("G F home", tasks, gate=window)  # for some lap would come then
    assert waits.trajectory.duration_s > 11.0 * lap_s
    assert not [claim for claim in claims(plan_to_json(waits)) if claim.fault]


def test_a_checker_of_its_own_finds_the_same_and_a_claim_that_is_not_true() -> None:
    plan = closing_plan(gate="[null, 40]")
    text = plan_to_json(plan)
    assert not [claim for claim in claims(text) if claim.fault]
    assert margins(plan_from_json(text)) == margins(plan)
    data = json.loads(text)
    data["bounds"][0]["margin_s"] = 9.0
    assert [claim.name for claim in claims(json.dumps(data)) if claim.fault] == ["in time"]
    text = text.replace("[0.0, 40.0]", "[0.0, 45.0]")
    assert "in time" in [claim.name for claim in claims(text) if claim.fault]


@settings(max_examples=25, deadline=None)
@given(
    window=st.tuples(st.integers(0, 600), st.integers(1, 400)),
    aside=st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)),
    late_s=st.floats(-FOLLOWED_S, FOLLOWED_S),
)
def test_what_is_proved_of_a_window_holds_wherever_in_the_tube_a_flight_is(
    window: tuple[int, int], aside: tuple[float, float], late_s: float
) -> None:
    plan = closing_plan(kind="area")
    begin_s, end_s = window[0] / 10, (window[0] + window[1]) / 10
    (asked,) = timed_of(closing(gate=f"[{begin_s}, {end_s}]"))
    at_rest = met_at_rest(plan.trajectory, plan.certificate, plan.locator)
    (bound,) = bounds_of([asked], plan.trajectory, plan.certificate, at_rest, plan.labelling)
    times = np.arange(0.0, plan.trajectory.duration_s, 0.02)
    places = plan.trajectory.position(times) + 0.999 * plan.certificate.tube_m * np.array(aside)
    inside = plan.labelling.triangles_of("gate")
    met = times[np.isin(plan.locator.triangle_at(places), inside)] + late_s
    spare_s = bound.margin_s if bound.kept else 0.0
    if bound.kept and met.size:
        assert not ((met >= begin_s) & (met <= end_s)).any()
        assert min(spare_s, 1e9) <= np.maximum(begin_s - met, met - end_s).min() + 2 * FOLLOWED_S
    if not bound.kept:  # as late, or as far aside, as it may be, some flight in the tube comes too near to it
        grown = plan.certificate.tube_m
        ground = shapely.box(40.0 - 2 * grown, 0.0, 46.0 + 2 * grown, 30.0)
        near = times[shapely.contains_xy(ground, *plan.trajectory.position(times).T)]
        assert ((near >= begin_s - 1.0) & (near <= end_s + 1.0)).any()


def test_a_static_fence_has_no_part_for_it_and_the_plan_says_so() -> None:
    closes, stays = closing_plan(gate="[60, 180]", round_it=True), closing_plan(round_it=True)
    assert len(fence_of(stays).rims) == len(fence_of(closes).rims) + 1
    (told,) = (warning for warning in closes.warnings if "geofence" in warning)
    assert told.startswith("regions.gate: it is restricted from 60 to 180 s alone")
    assert not any("geofence" in warning for warning in stays.warnings)


def test_what_leaves_the_clock_of_one_trajectory_is_refused() -> None:
    plan = closing_plan(gate="[60, 180]")
    with pytest.raises(NoPlanError, match="its rest is not planned anew"):
        plan_rest(plan, Rest((), plan.start_m))
    with pytest.raises(SpecError, match=re.escape("G !gate[60,180] is proved of the trajectory")):
        autopilot_plan(placed_plan(plan, LatLon(47.0, 8.0), 0.5), "px4")
    spec = closing(gate="[60, 180]")
    with pytest.raises(NoPlanError, match="`guidance: field` leaves it"):
        plan_mission(replace(spec, flight=replace(spec.flight, guidance="field")))
