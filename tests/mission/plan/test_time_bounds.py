"""Plans in time: what they keep, with which margin, and how they are refused."""

import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from mission.errors import NoPlanError, SpecError
from mission.export.placed_plan import placed_plan
from mission.export.uploads import autopilot_plan
from mission.geometry.geodesy import LatLon
from mission.logic.timed.behaviour import Piece, from_to, staying
from mission.logic.timed.judge import satisfied
from mission.plan import FlightPlan, plan_from_json, plan_mission, plan_to_json
from mission.plan.rest import Rest, plan_rest
from mission.plan.time_bounds import FOLLOWED_S
from mission.verify.plans import claims
from tests.support.timed_missions import timed, timed_plan

NUMBER = re.compile(r"\d+\.\d+")
BOTH = "[visit: [near, far]]"
WAITS = "F G home & F[0,60] far & G[0,12] !gate"


def visited(plan: FlightPlan) -> list[str]:
    return [name for letter in plan.certificate.word for name in letter]


def margins(plan: FlightPlan) -> dict[str, float]:
    return {str(bound.formula): bound.margin_s for bound in plan.bounds}


def faults(text: str) -> dict[str, str]:
    return {claim.name: claim.fault for claim in claims(text) if claim.fault}


@pytest.mark.parametrize(
    ("formula", "tasks"),
    [
        (WAITS, BOTH),
        ("F G home", "[{visit: near, by_s: 9}, visit: far]"),
        ("F G home", "[visit: [near, far], {react: {when: far, then: near}, within_s: 30}]"),
        ("F[20,40] far & F G home", "[visit: near]"),
        ("F G home", "[{avoid: {region: gate, until: near}, by_s: 20}, visit: far]"),
        ("G F home", "[{patrol: [near, far], every_s: 60}]"),
    ],
)
def test_what_is_planned_keeps_its_bounds_and_is_proved_again(formula: str, tasks: str) -> None:
    plan = timed_plan(formula, tasks)
    assert plan.bounds
    assert all(bound.kept for bound in plan.bounds)
    text = plan_to_json(plan)
    assert not faults(text)
    assert margins(plan_from_json(text)) == margins(plan)


@pytest.mark.parametrize("aside", [(0.0, 0.0), (1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)])
def test_flights_in_the_tube_keep_their_bounds_and_tightened_by_the_margin(aside: tuple[float, float]) -> None:
    plan = timed_plan(WAITS, BOTH)
    times = np.linspace(0.0, plan.trajectory.duration_s, 2000)
    places = plan.trajectory.position(times) + 0.999 * plan.certificate.tube_m * np.array(aside)
    letters = [plan.labelling.label(triangle) for triangle in plan.locator.triangle_at(places).tolist()]
    exact = [Fraction(t_s) for t_s in times.tolist()]
    spans = zip(exact, [*exact[1:], exact[-1] + 1], letters, strict=True)
    flown = staying([Piece(from_to(begin, end), letter, letter) for begin, end, letter in spans])
    assert all(satisfied(flown, formula) for formula in plan.required.timed)


def test_what_would_come_too_soon_is_waited_for_where_the_flight_begins() -> None:
    at_once, waits = timed_plan("F G home", BOTH), timed_plan(WAITS, BOTH)
    waited_s = waits.trajectory.duration_s - at_once.trajectory.duration_s
    assert 2.0 < waited_s < 5.0
    assert np.abs(waits.trajectory.position([0.5 * waited_s]) - waits.start_m).max() < 1e-9
    assert FOLLOWED_S <= margins(waits)["G[0,12] !gate"] < FOLLOWED_S + 0.01


def test_what_is_due_last_is_there_where_the_flight_comes_to_rest() -> None:
    # It ends as soon as the tube is inside, from where a landing may drift out again.
    plan = timed_plan("F[0,60] far", "[visit: near]")
    (bound,) = plan.bounds
    assert bound.margin_s == pytest.approx(60.0 - plan.trajectory.duration_s, abs=0.01)
    assert not faults(plan_to_json(plan))


def test_what_is_due_before_that_is_not_made_late_by_the_wait() -> None:
    tasks = "[{visit: near, by_s: 9}, visit: far]"
    plan = timed_plan("F G home & G[0,15] !gate", tasks)
    assert all(bound.kept for bound in plan.bounds)
    assert plan.trajectory.duration_s > timed_plan("F G home", tasks).trajectory.duration_s + 3.0
    assert not faults(plan_to_json(plan))


def test_what_is_due_is_visited_first() -> None:
    assert visited(timed_plan("F G home", BOTH)) == ["home", "gate", "far", "gate", "near", "home"]
    due = timed_plan("F G home", "[{visit: near, by_s: 9}, visit: far]")
    assert visited(due) == ["home", "near", "gate", "far", "gate", "home"]


def said(text: str, figures: list[float]) -> str:
    """A text with a dash for each number with decimals, all of which are about those that are due."""
    found = [float(number) for number in NUMBER.findall(text)]
    assert found == pytest.approx(figures, abs=0.5)  # the time law is as fast as its method finds
    return NUMBER.sub("-", text)


LATE = yaml.safe_load((Path(__file__).parents[2] / "golden" / "late.yaml").read_text(encoding="utf-8"))


@pytest.mark.parametrize("case", LATE, ids=[f"{case['mission']} {case['tasks']}" for case in LATE])
def test_a_refusal_says_which_bound_fails_by_how_much_and_what_is_known_of_the_soonest(case: dict[str, Any]) -> None:
    spec = timed(case["mission"], case["tasks"])
    with pytest.raises(NoPlanError) as refused:
        plan_mission(replace(spec, flight=replace(spec.flight, **case.get("flight", {}))))
    figures = [float(number) for number in NUMBER.findall(case["refused"])]
    assert said(str(refused.value), figures) == NUMBER.sub("-", case["refused"].strip())


def test_a_wish_for_which_there_is_no_time_is_given_up() -> None:
    plan = timed_plan("F G home", "[visit: near, {visit: far, by_s: 8, weight: 2}]")
    assert [task.task for task in plan.dropped] == ["visit far, by_s: 8"]
    reason = said(plan.dropped[0].reason, [5.7, 13.7])
    why = "no flight is there before - s, even in straight lines at 4 m/s"
    assert reason == f"there is no time: F[0,8] far fails by at least - s: {why}"
    assert "far" not in visited(plan)
    assert not faults(plan_to_json(plan))


def test_a_margin_that_is_too_good_is_not_believed() -> None:
    text = plan_to_json(timed_plan(WAITS, BOTH))
    margin = margins(timed_plan(WAITS, BOTH))["F[0,60] far"]
    assert "spare, and not" in faults(text.replace(f'"margin_s": {margin}', f'"margin_s": {margin + 1.0}'))["in time"]
    stricter = text.replace("F[0,60] far", "F[0,10] far").replace(f'"margin_s": {margin}', '"margin_s": 1.0')
    assert faults(stricter)["in time"] == "a flight within the tube may violate F[0,10] far"
    assert "not those that its mission" in faults(text.replace('"bounds": [', '"bounds": [], "was": ['))["in time"]


def test_a_plan_without_bounds_says_nothing_of_them() -> None:
    text = plan_to_json(timed_plan("F G home", BOTH))
    assert '"bounds"' not in text
    assert not faults(text)


def test_what_keeps_no_time_law_is_refused() -> None:
    plan = timed_plan(WAITS, BOTH)
    with pytest.raises(NoPlanError, match="its rest is not planned anew"):
        plan_rest(plan, Rest((), plan.start_m))
    with pytest.raises(SpecError, match="who flies waypoints keeps no time law"):
        autopilot_plan(placed_plan(plan, LatLon(47.0, 8.0), 0.2), "px4")
