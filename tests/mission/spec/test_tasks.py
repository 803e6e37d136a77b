"""Tasks: from the file to values, to formulas, and back."""

from typing import Any

import pytest
import yaml

from mission.spec.document import document_of
from mission.spec.loader import parse_mission
from mission.spec.model import MissionSpec
from mission.spec.task import Task, TaskKind, TaskMode
from mission.spec.tasks import task_data, task_formula, task_of, task_text

FRAME = """\
domain:
  nodes: [[0, 0], [40, 0], [40, 30], [0, 30], [20, 15]]
regions:
  a: {kind: survey, at: [20, 25]}
  b: {kind: home, triangle: [0, 1, 4]}
  c: {kind: survey, at: [5, 15]}
  k: {kind: restricted, at: [35, 15]}
start:
  position_m: [5, 15]
"""

FORMULAS = [
    ("visit: a", "F a", "visit a"),
    ("visit: [a, b]", "F a & F b", "visit [a, b]"),
    ("sequenced_visit: [a, b, a]", "F (a & F (b & F a))", "sequenced_visit [a, b, a]"),
    ("ordered_visit: [a, b]", "F (a & F b) & !b U a", "ordered_visit [a, b]"),
    (
        "strict_ordered_visit: [a, b]",
        "F (a & F b) & !b U a & !a U (a & (a | !b & !c) U (!a U b))",
        "strict_ordered_visit [a, b]",
    ),
    (
        "fair_visit: [a, b]",
        "F a & F b & G (a -> (a | !b & !c) W (!a W b)) & G (b -> (b | !a & !c) W (!b W a))",
        "fair_visit [a, b]",
    ),
    ("patrol: [a, b]", "G F a & G F b", "patrol [a, b]"),
    ("sequenced_patrol: [a, b]", "G F (a & F b)", "sequenced_patrol [a, b]"),
    ("ordered_patrol: [a, b]", "G F a & G F b & !b U a & G (b -> (b | !a & !c) W (!b W a))", "ordered_patrol [a, b]"),
    (
        "strict_ordered_patrol: [a, b]",
        "(!a & !b) U a & G (a -> (a | !b & !c) U ((!a & !b) U b)) & G (b -> (b | !a & !c) U ((!a & !b) U a))",
        "strict_ordered_patrol [a, b]",
    ),
    (
        "fair_patrol: [a, b]",
        "G F a & G F b & G (a -> (a | !b & !c) W (!a W b)) & G (b -> (b | !a & !c) W (!b W a))",
        "fair_patrol [a, b]",
    ),
    ("avoid: k", "G !k", "avoid k"),
    ("avoid: [k, c]", "G !k & G !c", "avoid [k, c]"),
    ("avoid: {region: a, until: b}", "!a U b", "avoid {region: a, until: b}"),
    ("avoid: {region: a, after: b}", "G (b -> G !a)", "avoid {region: a, after: b}"),
    ("visits: {region: a, at_most: 1}", "!a W ((a | !b & !c) W G !a)", "visits {region: a, at_most: 1}"),
    ("visits: {region: a, at_least: 2}", "F (a & F (!a & (b | c) & F a))", "visits {region: a, at_least: 2}"),
    ("visits: {region: a, exactly: 1}", "!a U (a & (a | !b & !c) W G !a)", "visits {region: a, exactly: 1}"),
    ("wait: {in: a, until: b}", "a U b", "wait {in: a, until: b}"),
    ("react: {when: a, then: b}", "G (a -> F b)", "react {when: a, then: b, how: delayed}"),
    (
        "react: {when: a, then: b, how: instantaneous}",
        "G (a -> b)",
        "react {when: a, then: b, how: instantaneous}",
    ),
    (
        "react: {when: a, then: b, how: prompt}",
        "G (a -> a U (!c U b))",
        "react {when: a, then: b, how: prompt}",
    ),
    ("react: {when: a, then: b, how: bound}", "G (a <-> b)", "react {when: a, then: b, how: bound}"),
    (
        "react: {when: a, then: b, how: bound_delay}",
        "G (a -> a U (!c U b)) & (b | !b W a) & G (b -> (b | !a & !c) W (!b W a))",
        "react {when: a, then: b, how: bound_delay}",
    ),
]


def spec_of(*tasks: str) -> MissionSpec:
    return parse_mission((FRAME + "tasks:\n" + "".join(f"  - {{{task}}}\n" for task in tasks)).encode())


@pytest.mark.parametrize(("text", "formula", "shown"), FORMULAS)
def test_each_task_is_a_formula_and_is_written_as_it_was(text: str, formula: str, shown: str) -> None:
    spec = spec_of(text)
    (task,) = spec.tasks
    assert str(task_formula(task, spec.regions)) == formula
    assert task_text(task) == shown
    assert task_of(task_data(task)) == task


def test_every_kind_and_every_form_is_among_them() -> None:
    tasks = [spec_of(text).tasks[0] for text, _, _ in FORMULAS]
    assert {task.kind for task in tasks} == set(TaskKind)
    assert {task.mode for task in tasks} == set(TaskMode)


def test_a_mission_of_tasks_is_written_as_a_file_of_the_same_tasks() -> None:
    spec = spec_of(*(text for text, _, _ in FORMULAS), "visit: [c], weight: 2.5")
    document: dict[str, Any] = document_of(spec)
    assert "formula" not in document["mission"]
    again = parse_mission(yaml.safe_dump(document).encode())
    assert again.tasks == spec.tasks
    assert again.tasks[-1] == Task(TaskKind.VISIT, ("c",), weight=2.5)
    assert again.formula == ""
