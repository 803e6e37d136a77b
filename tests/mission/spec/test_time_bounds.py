"""What a mission asks for in seconds: keys of tasks and bounds in its formula, as formulas of both kinds."""

import json

import pytest

from mission.errors import SpecError
from mission.spec.document import document_of
from mission.spec.loader import parse_mission
from mission.spec.specification import formula_of, of_mission, timed_of
from mission.spec.tasks import task_text
from tests.support.timed_missions import timed


@pytest.mark.parametrize(
    ("task", "formula", "in_time"),
    [
        ("{visit: [near, far], by_s: 120}", "F near & F far", "F[0,120] near & F[0,120] far"),
        (
            "{ordered_visit: [near, far], by_s: 12.5}",
            "F (near & F far) & !far U near",
            "F[0,12.5] near & F[0,12.5] far",
        ),
        ("{avoid: {region: gate, until: near}, by_s: 9}", "!gate U near", "!gate U[0,9] near"),
        ("{wait: {in: home, until: near}, by_s: 9}", "home U near", "home U[0,9] near"),
        ("{react: {when: far, then: near}, within_s: 30}", "G (far -> F near)", "G (far -> F[0,30] near)"),
        ("{patrol: near, every_s: 60}", "G F near", "G (near -> G F[0,60] near)"),
    ],
)
def test_a_task_asks_for_a_formula_and_for_one_in_time(task: str, formula: str, in_time: str) -> None:
    spec = timed("F home", f"[{task}]")
    assert str(formula_of(spec)) == f"F home & {formula}"
    assert " & ".join(map(str, timed_of(spec))) == in_time
    assert task_text(spec.tasks[0]).endswith(task.rpartition(", ")[2].strip("}"))
    assert parse_mission(json.dumps(document_of(spec)).encode()) == spec


def test_a_formula_with_bounds_is_asked_for_in_time_and_the_word_has_what_is_left_of_it() -> None:
    spec = timed("F G home & F[0,60] far & G[0,12] !gate & X home")
    required = of_mission(spec, ())
    assert str(required.formula) == "F G home & F far & X home & F near & F far"
    assert [str(each) for each in required.timed] == ["F[0,60] far", "G[0,12] !gate"]
    assert str(required).endswith("F[0,60] far & G[0,12] !gate")


def test_what_is_dropped_is_not_asked_for_in_time_either() -> None:
    spec = timed("F home & F[0,9] near", "[{visit: far, by_s: 8, weight: 2}]")
    assert [str(each) for each in timed_of(spec)] == ["F[0,9] near", "F[0,8] far"]
    assert [str(each) for each in timed_of(spec, [0])] == ["F[0,9] near"]


@pytest.mark.parametrize(
    ("task", "words"),
    [
        ("{visit: near, by_s: 0}", "0 is less than 0.001"),
        ("{visit: near, by_s: .inf}", "inf"),
        ("{visit: near, by_s: .nan}", "nan"),
        ("{visit: near, by_s: soon}", "expected a number"),
        ("{sequenced_visit: [near, far], by_s: 9}", "has no `by_s`"),
        ("{avoid: {region: gate, after: near}, by_s: 9}", "has no `by_s`"),
        ("{react: {when: far, then: near, how: bound}, within_s: 9}", "has no `within_s`"),
        ("{visits: {region: near, at_least: 2}, by_s: 9}", "has no `by_s`"),
        ("{by_s: 9}", "a task is missing here"),
    ],
)
def test_a_bound_that_has_no_meaning_is_a_fault(task: str, words: str) -> None:
    with pytest.raises(SpecError, match=words.replace(".", r"\.")):
        timed("F home", f"[{task}]")


@pytest.mark.parametrize(
    ("formula", "words"),
    [("F[3,1] near", "end before they begin"), ("F[0,9] X near", "X counts triangles"), ("F[0,9] nir", "no region")],
)
def test_bounds_in_a_formula_that_are_none_are_a_fault(formula: str, words: str) -> None:
    with pytest.raises(SpecError, match=words):
        timed(formula)
