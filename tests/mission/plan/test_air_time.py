"""The longest time from arming to landing: planned, refused, given up for, and proved again."""

import json
from dataclasses import replace
from functools import cache

import pytest

from mission.errors import LateError, NoPlanError
from mission.plan import plan_from_json, plan_mission, plan_to_json
from mission.plan.rest import Rest, plan_rest
from mission.spec.air_time import air_s, landing_s
from mission.spec.document import document_of
from mission.spec.loader import parse_mission
from mission.spec.model import UNTIL_STOPPED, MissionSpec
from mission.verify.plans import claims
from tests.support.timed_missions import timed, timed_plan

BOTH = "[visit: [near, far]]"


@cache
def fastest_s() -> float:
    """From arming to landing, as it is reckoned, with nothing to wait for."""
    plan = timed_plan()
    return air_s(plan.spec.flight.altitude_m, plan.trajectory.duration_s)


def within(longest_s: float, formula: str = "F G home", tasks: str = BOTH) -> MissionSpec:
    spec = timed(formula, tasks)
    return replace(spec, flight=replace(spec.flight, longest_s=longest_s))


def test_climb_and_landing_are_reckoned_as_autopilots_come() -> None:
    assert landing_s(10.0) == 23.0
    assert air_s(15.0, 40.0) == 40.0 + 10.0 + 33.0 + 12.0


def test_it_is_read_and_written_and_not_there_without() -> None:
    spec = within(75.5)
    assert parse_mission(json.dumps(document_of(spec)).encode()) == spec
    assert "longest_s" not in document_of(timed())["flight"]


def test_what_is_planned_has_a_margin_that_is_checked_again() -> None:
    plan = plan_mission(within(fastest_s() + 7.25))
    (bound,) = plan.bounds
    assert bound.margin_s == pytest.approx(7.25)
    assert bound.text == f"{bound.formula} is kept with about 7.2 s to spare from arming to landing"
    text = plan_to_json(plan)
    assert plan_from_json(text).bounds == plan.bounds
    assert [claim.fault for claim in claims(text) if claim.name == "in time"] == [None]
    (fault,) = (claim.fault for claim in claims(text.replace('"margin_s": 7.2', '"margin_s": 9.2')) if claim.fault)
    assert "and not 9.2" in fault
    stricter = text.replace(f'"longest_s": {fastest_s() + 7.25}', '"longest_s": 50.0').replace(str(bound.formula), "?")
    assert any("not those that its mission" in (claim.fault or "") for claim in claims(stricter))
    asked = stricter.replace('"?"', '"flight.longest_s: 50"')
    assert any("may violate flight.longest_s: 50" in (claim.fault or "") for claim in claims(asked))


def test_a_wait_that_is_asked_for_counts() -> None:
    waits = plan_mission(within(fastest_s() + 30.0, "F G home & G[0,12] !gate"))
    at_once = plan_mission(within(fastest_s() + 30.0))
    assert waits.bounds[-1].margin_s < at_once.bounds[-1].margin_s - 2.0


def test_a_flight_that_is_too_long_is_refused_with_figures() -> None:
    with pytest.raises(LateError, match="no plan is found that keeps its bounds in seconds") as refused:
        plan_mission(within(fastest_s() - 5.0))
    words = f"fails by about 5.0 s: from arming to landing are {fastest_s():.1f} s"
    assert str(refused.value).endswith(words)


def test_laps_without_end_are_too_long() -> None:
    spec = within(600.0, "G F home", "[patrol: near]")
    with pytest.raises(LateError, match=r"flight\.longest_s: 600 is not kept by laps without end"):
        plan_mission(replace(spec, flight=replace(spec.flight, laps=UNTIL_STOPPED)))


def test_what_keeps_no_time_law_is_refused() -> None:
    spec = within(600.0)
    with pytest.raises(NoPlanError, match="a flight with `guidance: field` leaves it"):
        plan_mission(replace(spec, flight=replace(spec.flight, guidance="field")))


def test_wishes_for_which_the_flight_is_too_short_are_given_up() -> None:
    plan = plan_mission(within(fastest_s() - 5.0, tasks="[visit: near, {visit: far, weight: 2}]"))
    (dropped,) = plan.dropped
    assert dropped.task == "visit far"
    assert dropped.reason.startswith("there is no time: flight.longest_s:")
    assert plan.bounds[0].kept


def test_what_is_left_of_a_flight_is_planned_whatever_time_is_left() -> None:
    plan = plan_mission(within(fastest_s() + 7.25))
    rest = plan_rest(plan, Rest((frozenset({"home"}),), plan.start_m))
    assert rest.spec.flight.longest_s is None
