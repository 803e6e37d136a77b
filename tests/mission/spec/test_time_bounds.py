"""What a mission asks for in seconds: keys of tasks and bounds in its formula, as formulas of both kinds."""

import json
from typing import Final

import pytest

from mission.errors import SpecError
from mission.spec.document import document_of
from mission.spec.loader import parse_mission
from mission.spec.specification import formula_of, of_mission, timed_of
from mission.spec.task import TaskKind
from mission.spec.tasks import task_text
from tests.support.timed_missions import timed

BOTH_AGAIN: Final = "G (near -> G F[0,60] near) & G (far -> G F[0,60] far)"

OF_KINDS: Final = (
    (TaskKind.VISIT, "[near, far]", "by_s: 120", "F[0,120] near & F[0,120] far"),
    (TaskKind.SEQUENCED_VISIT, "[near, far]", "by_s: 9", "write `ordered_visit`"),
    (TaskKind.ORDERED_VISIT, "[near, far]", "by_s: 12.5", "F[0,12.5] near & F[0,12.5] far"),
    (TaskKind.STRICT_ORDERED_VISIT, "[near, far]", "by_s: 9", "F[0,9] near & F[0,9] far"),
    (TaskKind.FAIR_VISIT, "[near, far]", "by_s: 9", "F[0,9] near & F[0,9] far"),
    (TaskKind.PATROL, "near", "every_s: 60", "G (near -> G F[0,60] near)"),
    (TaskKind.SEQUENCED_PATROL, "[near, far]", "every_s: 60", BOTH_AGAIN),
    (TaskKind.ORDERED_PATROL, "[near, far]", "every_s: 60", BOTH_AGAIN),
    (TaskKind.STRICT_ORDERED_PATROL, "[near, far]", "every_s: 60", BOTH_AGAIN),
    (TaskKind.FAIR_PATROL, "[near, far]", "every_s: 60", BOTH_AGAIN),
    (TaskKind.AVOID, "{region: gate, until: near}", "by_s: 9", "!gate U[0,9] near"),
    (TaskKind.AVOID, "{region: gate, after: near}", "by_s: 9", "has no `by_s`"),
    (TaskKind.AVOID, "gate", "by_s: 9", "has no `by_s`"),
    (TaskKind.VISITS, "{region: near, at_least: 2}", "by_s: 9", "say it by a formula with bounds"),
    (TaskKind.WAIT, "{in: home, until: near}", "by_s: 9", "home U[0,9] near"),
    (TaskKind.REACT, "{when: far, then: near}", "within_s: 30", "G (far -> F[0,30] near)"),
    (TaskKind.REACT, "{when: far, then: near, how: prompt}", "within_s: 30", "G (far -> F[0,30] near)"),
    (TaskKind.REACT, "{when: far, then: near, how: bound_delay}", "within_s: 30", "G (far -> F[0,30] near)"),
    (TaskKind.REACT, "{when: far, then: near, how: bound}", "within_s: 9", "has no `within_s`"),
    (TaskKind.REACT, "{when: far, then: near, how: instantaneous}", "within_s: 9", "has no `within_s`"),
    (TaskKind.VISIT, "near", "within_s: 9", "write `by_s`"),
    (TaskKind.PATROL, "near", "by_s: 9", "write `every_s`"),
)
"""Kinds of tasks with a bound: what each asks for in time, or what is said of one that it has not."""


def test_each_kind_of_task_is_in_the_table() -> None:
    assert {kind for kind, *_ in OF_KINDS} == set(TaskKind)


@pytest.mark.parametrize(("kind", "value", "bound", "means"), OF_KINDS)
def test_a_bound_has_its_meaning_by_the_kind_of_its_task(kind: TaskKind, value: str, bound: str, means: str) -> None:
    task = f"{{{kind}: {value}, {bound}}}"
    if "`" in means or "say it" in means:
        with pytest.raises(SpecError) as refused:
            timed("F home", f"[{task}]")
        (fault,) = refused.value.faults
        assert means in f"{fault.message} {fault.hint}"
        return
    spec, without = timed("F home", f"[{task}]"), timed("F home", f"[{kind}: {value}]")
    assert " & ".join(map(str, timed_of(spec))) == means
    assert formula_of(spec) is formula_of(without)
    assert task_text(spec.tasks[0]).endswith(f", {bound}")
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
