"""Each row of the checker: a sound plan beside a mission that asks for a little more is wrong there, and says why."""

import json
from collections.abc import Callable
from functools import cache
from typing import Any

import pytest

from mission.errors import SpecError
from mission.plan import plan_to_json
from mission.verify.plans import claims
from tests.support.small_missions import FIELDS, PHOTOGRAPHED, ROUNDS, SMALL, plan_of

SLOW = ROUNDS.replace("kind: survey,", "kind: survey, speed_m_s: 1.5,", 1)
Change = Callable[[dict[str, Any]], None]


@cache
def written(text: str) -> str:
    return plan_to_json(plan_of(text + FIELDS))


def told(text: str, change: Change) -> dict[str, str]:
    """What is wrong by row, once the plan of a mission was changed."""
    document = json.loads(written(text))
    change(document)
    return {claim.name: claim.fault for claim in claims(json.dumps(document)) if claim.fault}


def region(name: str, **values: object) -> Change:
    return lambda plan: plan["mission"]["regions"][name].update(values)


def formula(text: str) -> Change:
    return lambda plan: plan["mission"]["mission"].update(formula=text)


def limit(**values: float) -> Change:
    return lambda plan: plan["mission"]["limits"].update(values)


@pytest.mark.parametrize(
    ("text", "change", "row", "words"),
    [
        (
            ROUNDS,
            region("pond", polygon=[[4, 21], [14, 21], [14, 28], [4, 28]]),
            "domain",
            "as its mission makes it",
        ),
        (ROUNDS, lambda plan: plan["mission"]["mission"].update(laps=3), "mission", "trajectory.laps"),
        (ROUNDS, formula("G F east & G F north & G !pond & G (east -> !X !east)"), "run", "violates the mission"),
        (ROUNDS, formula("G F east & G F north & G !home"), "words", "may spell a word that violates"),
        (ROUNDS, formula("G F east & G F north & G (north -> G !home)"), "words", "the way back may violate"),
        (ROUNDS, region("east", kind="restricted"), "tube", "name triangles of east, which must not be entered"),
        (ROUNDS, region("east", loiter_s=3.0), "stops", "there is no stop in east"),
        (SMALL, region("goal", loiter_s=3.0), "stops", "is not in a region in which to loiter for 2 s"),
        (ROUNDS, limit(speed_m_s=1.0), "time law", "m/s at"),
        (ROUNDS, region("east", speed_m_s=1.0), "time law", "in east, there may be"),
        (ROUNDS, limit(acceleration_m_s2=0.5), "time law", "m/s^2 at"),
        (PHOTOGRAPHED, lambda plan: plan["covers"][0].update(planned_share=1.0), "lanes", "is covered to"),
        (
            PHOTOGRAPHED,
            lambda plan: plan["covers"][0].update(first_s=plan["covers"][0]["lanes_s"][0][0] + 2.0),
            "lanes",
            "takes its first picture after",
        ),
        (PHOTOGRAPHED, lambda plan: plan["covers"].clear(), "photographs", "there are 0 lanes"),
        (SMALL, lambda plan: plan["trajectory"]["legs"][0]["curve"]["base_m"].reverse(), "curve", "off the series"),
        (SMALL, lambda plan: plan["path"]["segments"][2]["g"].reverse(), "path", "`path.segments."),
        (SMALL, lambda plan: plan["certificate"].update(clearance_m=99.0), "figures", "is 99 m in the plan"),
    ],
)
def test_what_is_not_so_is_told_in_its_row(text: str, change: Change, row: str, words: str) -> None:
    assert words in told(text, change)[row]


@pytest.mark.parametrize("text", [ROUNDS, SMALL, PHOTOGRAPHED, SLOW])
def test_a_plan_as_it_was_written_is_true(text: str) -> None:
    assert told(text, lambda _: None) == {}


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"mission": 3}', '{"mission": {}, "x": NaN}'])
def test_what_is_no_plan_is_refused(text: str) -> None:
    with pytest.raises(SpecError):
        list(claims(text))


def test_lanes_that_end_with_the_flight_may_do_so_but_for_rounding() -> None:
    document = json.loads(plan_to_json(plan_of(PHOTOGRAPHED.replace("F (field & F G home)", "F field"))))
    [visit] = document["covers"]
    for beyond, wrong in ((1e-12, False), (1e-6, True)):
        visit["lanes_s"][-1][1] += beyond * visit["lanes_s"][-1][1]
        judged = {claim.name: claim.fault for claim in claims(json.dumps(document))}
        assert (judged["lanes"] == "field has lanes that are not in order") is wrong
