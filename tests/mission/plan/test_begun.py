"""Visits under way: lanes that were flown are not flown again, those that were not are, and stays last their rest."""

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import shapely

from mission.coverage.flown import covered_share, swath_of
from mission.logic.formula.word import LassoWord
from mission.monitor.coverage import CoverageWatch
from mission.plan import FlightPlan, plan_from_json, plan_mission, plan_to_json
from mission.plan.rest import Rest, plan_rest
from mission.spec.loader import parse_mission
from mission.spec.model import MissionSpec
from mission.steering.rounded import RoundedPolyline
from tests.mission.plan.test_rest import faults, flown, spelled
from tests.support.small_missions import FLOWN_BRISKLY
from tests.support.usual_cases import sampled

FIELD = """\
name: A field
domain:
  boundary: [[0, 0], [60, 0], [60, 40], [0, 40]]
regions:
  home: {kind: home, polygon: [[4, 4], [14, 4], [14, 12], [4, 12]]}
  field:
    kind: survey
    polygon: [[24, 6], [54, 6], [54, 34], [24, 34]]
    cover: {camera: {field_of_view_deg: [90, 60], overlap: 0.5, sidelap: 0.5}, heading_deg: 90, share: 0.9}
mission:
  formula: FORMULA
start:
  position_m: START
"""


def field(formula: str, start: str = "[9, 8]", laps: int = 1) -> MissionSpec:
    text = FIELD.replace("FORMULA", f"{formula}\n  laps: {laps}").replace("START", start) + FLOWN_BRISKLY
    return parse_mission(text.encode())


@cache
def planned(formula: str) -> FlightPlan:
    return plan_mission(field(formula))


ONCE = "F (field & F home)"
STEP_S = 0.01
NEAR_M = 0.2


@sampled("share", [0.1, 0.3, 0.42, 0.55, 0.75], [0.1, 0.42, 0.75])
def test_the_rest_of_the_lanes_is_flown_and_no_lane_twice(share: float) -> None:
    plan = planned(ONCE)
    at_s = share * plan.trajectory.duration_s
    rest = flown(plan, at_s)
    left = plan_rest(plan, rest)
    assert faults(left) == []
    assert left.instead == ""
    (was,), (now,) = plan.covers, left.covers
    place_s = float(plan.trajectory.parameter([at_s])[0])
    ahead = was.lanes_s[:, 1] > place_s
    assert len(now.lanes_m) == ahead.sum()
    assert np.array_equal(now.lanes_m[1:], was.lanes_m[ahead][1:])
    # The first one goes on where it was left.
    assert np.allclose(now.lanes_m[0, 1], was.lanes_m[ahead][0, 1])
    flown_m = max(0.0, place_s - float(was.lanes_s[ahead][0, 0])) * plan.spec.flight.speed_m_s
    assert np.linalg.norm(now.lanes_m[0, 0] - was.lanes_m[ahead][0, 0]) == pytest.approx(flown_m, abs=1e-6)
    # What both cover together is what the one would have covered.
    area = plan.area_of("field")
    assert now.planned_share == pytest.approx(was.planned_share, abs=0.01)
    covered = swath_of(
        [plan.trajectory.position(np.arange(0.0, at_s, 0.1)), left.trajectory.position(np.arange(0.0, 200.0, 0.1))],
        now.spacing_m,
    )
    assert covered_share(area, covered) >= was.planned_share - 0.01
    onward = spelled(left)
    assert plan.required.satisfied_by(LassoWord(rest.word + onward, onward[-1:]))


def pictures(plan: FlightPlan, until_s: float = np.inf) -> list[tuple[float, float]]:
    """Where a camera releases that counts the distance itself, in steps of the trajectory."""
    found, time_s = [], 0.0
    for stretch in plan.photographs:
        times = np.append(np.arange(stretch.begin_s, stretch.end_s, STEP_S), stretch.end_s)
        gone_m = np.inf
        for time_s, before, place in zip(
            times, plan.trajectory.position(times - STEP_S), plan.trajectory.position(times), strict=True
        ):
            gone_m += np.hypot(*(place - before))
            if gone_m >= (stretch.distance_m or np.inf) and time_s <= until_s:
                found.append((float(place[0]), float(place[1])))
                gone_m = 0.0 if np.isinf(gone_m) else gone_m - (stretch.distance_m or 0.0)
    return found


@pytest.mark.parametrize("share", [0.3, 0.36, 0.42, 0.55])
def test_pictures_of_a_lane_go_on_in_their_distance(share: float) -> None:
    """Those that are taken before and after are those of the whole plan, also where a rest is left once more."""
    plan = planned(ONCE)
    at_s = share * plan.trajectory.duration_s
    left = plan_rest(plan, flown(plan, at_s))
    again_s = 0.5
    again = plan_rest(left, flown(left, again_s))
    assert faults(left) == faults(again) == []
    whole = np.array(pictures(plan))
    parts = np.array([*pictures(plan, at_s), *pictures(left, again_s), *pictures(again)])
    assert len(parts) == pytest.approx(len(whole), abs=1)  # one may be due just where the plan is left
    assert shapely.hausdorff_distance(*map(shapely.multipoints, (whole, parts))) <= NEAR_M


def test_a_flight_that_goes_on_is_judged_by_what_was_covered_before_as_well() -> None:
    plan = planned(ONCE)
    left = plan_rest(plan, flown(plan, 0.5 * plan.trajectory.duration_s))
    watch = CoverageWatch(left)
    times = np.arange(0.0, left.trajectory.duration_s, 0.1)
    for t_s, (x, y) in zip(times.tolist(), left.trajectory.position(times).tolist(), strict=True):
        watch.report(t_s, t_s, (x, y))
    [covered] = watch.covered(left.trajectory)
    assert left.covers[0].before is not None
    assert covered.share == pytest.approx(left.covers[0].planned_share, abs=0.01)
    assert covered.enough


def test_what_was_covered_before_is_written_and_judged() -> None:
    left = plan_rest(planned(ONCE), flown(planned(ONCE), 0.5 * planned(ONCE).trajectory.duration_s))
    text = plan_to_json(left)
    again = plan_from_json(text)
    assert plan_to_json(again) == text
    assert shapely.equals(again.covers[0].before, left.covers[0].before)
    data = json.loads(text)
    data["covers"][0]["before"] = None
    assert faults_of(json.dumps(data)) == ["lanes"]


def faults_of(text: str) -> list[str]:
    return [fault.split(":")[0] for fault in faults(plan_from_json(text))]


def test_a_rest_of_a_rest_forgets_nothing() -> None:
    plan = planned(ONCE)
    half = plan_rest(plan, flown(plan, 0.4 * plan.trajectory.duration_s))
    rest = flown(half, 0.4 * half.trajectory.duration_s)
    last = plan_rest(half, rest)
    assert faults(last) == []
    assert len(last.covers[0].lanes_m) < len(half.covers[0].lanes_m)
    assert last.covers[0].planned_share == pytest.approx(plan.covers[0].planned_share, abs=0.01)


def test_pushed_out_of_a_region_the_vehicle_comes_back_to_where_it_was() -> None:
    plan = planned(ONCE)
    rest = flown(plan, 0.5 * plan.trajectory.duration_s)
    left = plan_rest(plan, replace(rest, word=(*rest.word, frozenset()), place_m=(20.0, 20.0)))
    assert faults(left) == []
    due = plan_rest(plan, rest)
    assert np.array_equal(left.covers[0].lanes_m, due.covers[0].lanes_m)


def test_of_laps_the_lanes_under_way_are_ended_first() -> None:
    plan = plan_mission(field("G F field & G F home", laps=2))
    visit = plan.covers[0]
    at_s = float(plan.trajectory.time_at(0.5 * (visit.lanes_s[0, 0] + visit.lanes_s[-1, 1]))[0])
    left = plan_rest(plan, flown(plan, at_s))
    assert faults(left) == []
    first, *others = left.covers
    assert len(first.lanes_m) < len(visit.lanes_m)
    assert [len(other.lanes_m) for other in others] == [len(visit.lanes_m)]


def test_a_region_in_which_a_mission_begins_is_covered_from_there() -> None:
    plan = plan_mission(field(ONCE, start="[30, 20]"))
    assert plan.instead == ""
    assert faults(plan) == []
    assert plan.covers[0].planned_share > 0.9


def test_a_stay_lasts_as_long_as_is_left_of_it() -> None:
    text = FIELD.replace("FORMULA", "F (field & F home)").replace("START", "[9, 8]") + FLOWN_BRISKLY
    cover = text[text.index("    cover:") : text.index("\nmission:") + 1]
    plan = plan_mission(parse_mission(text.replace(cover, "    loiter_s: 6\n").encode()))
    begin_s = float(plan.trajectory.time_at(plan.stops[0][0])[0])
    left = plan_rest(plan, flown(plan, begin_s + 2.05))
    assert faults(left) == []
    [(place_s, seconds)] = left.stops
    assert place_s == 0.0
    assert seconds == pytest.approx(4.0, abs=0.1)


def test_the_rest_of_a_rounded_polyline_is_what_it_was() -> None:
    corners = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 5.0], [0.0, 5.0]])
    curve = RoundedPolyline(corners, np.array([2.0, 2.0]), 2.0)
    rest = curve.rest(2.5)
    assert rest.corners_m[0].tolist() == [5.0, 0.0]
    later = np.linspace(2.5, curve.duration_s, 50)
    assert np.allclose(rest.position(later - 2.5), curve.position(later))
    assert curve.rest(4.9).reaches_m.tolist() == pytest.approx([0.2, 2.0])
    assert curve.rest(6.0).corners_m.tolist() == [[10.0, 2.0], [10.0, 5.0], [0.0, 5.0]]
    with pytest.raises(ValueError, match="nothing is left"):
        curve.rest(curve.duration_s)


def test_nothing_is_left_of_lanes_of_a_region_that_was_never_entered() -> None:
    plan = planned(ONCE)
    left = plan_rest(plan, Rest((frozenset(("home",)),), plan.start_m, flown_s=0.0))
    assert left.covers[0].before is None
