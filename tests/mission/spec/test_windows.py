"""Regions that are there for a time only: what a mission asks for by them, and what is wrong with them."""

import json

import pytest

from mission.errors import SpecError
from mission.spec.document import document_of
from mission.spec.loader import parse_mission
from mission.spec.specification import formula_of, timed_of
from mission.spec.windows import window_text
from tests.support.closing_missions import closing

GATE = "[10, 40]"


@pytest.mark.parametrize(
    ("formula", "tasks", "kind", "untimed", "in_time"),
    [
        ("F G home", "[visit: far]", "restricted", "F G home & F far", "G !gate[10,40]"),
        ("F far & G !gate", "[visit: near]", "restricted", "F far & F near", "G !gate[10,40]"),
        ("F far & G !gate", "[visit: near]", "area", "F far & F near", "G !gate[10,40]"),
        ("F gate", "[visit: near]", "area", "F gate & F near", "F gate[10,40]"),
        ("F far", "[avoid: gate]", "area", "F far", "G !gate[10,40]"),
        ("F far", "[{visit: gate, by_s: 30}]", "area", "F far & F gate", "F gate[10,40] & F[0,30] gate[10,40]"),
        ("F far", "[react: {when: gate, then: near}]", "area", "F far", "G (gate[10,40] -> F near)"),
        ("F[0,9] (far & !gate)", "[visit: near]", "area", "F far & F near", "F[0,9] (far & !gate[10,40])"),
    ],
)
def test_a_proposition_is_true_inside_while_the_region_is_there(
    formula: str, tasks: str, kind: str, untimed: str, in_time: str
) -> None:
    spec = closing(formula, tasks, kind=kind, gate=GATE)
    assert str(formula_of(spec)) == untimed
    assert " & ".join(map(str, timed_of(spec))) == in_time


@pytest.mark.parametrize(
    ("window", "ends", "text"),
    [
        ("[60, 180]", (60.0, 180.0), "from 60 to 180 s"),
        ("[null, 12.5]", (0.0, 12.5), "until 12.5 s"),
        ("[0, 12.5]", (0.0, 12.5), "until 12.5 s"),
        ("[60, null]", (60.0, float("inf")), "from 60 s on"),
    ],
)
def test_a_window_is_written_with_ends_that_may_be_open(window: str, ends: tuple[float, float], text: str) -> None:
    spec = closing(gate=window)
    (gate,) = (region for region in spec.regions if region.name == "gate")
    assert (gate.active_s, gate.forbidden, window_text(gate)) == (ends, False, text)
    assert parse_mission(json.dumps(document_of(spec)).encode()) == spec


def test_what_is_there_all_the_time_is_forbidden_as_ever() -> None:
    spec = closing()
    assert [region.name for region in spec.regions if region.forbidden] == ["gate"]
    assert timed_of(spec) == ()


@pytest.mark.parametrize(
    ("window", "words"),
    [
        ("[40, 10]", "regions.gate.active_s 40 to 10 s is no time"),
        ("[10, 10]", "regions.gate.active_s 10 to 10 s is no time"),
        ("[null, null]", "regions.gate.active_s `gate` would be there all the time"),
        ("[10]", "regions.gate.active_s expected 2 items, found 1"),
        ("30", "regions.gate.active_s expected a list, found `30`"),
        ("[-5, 10]", "regions.gate.active_s[0] expected null or a number from 0 to 86400, found `-5`"),
        ("[0, soon]", "regions.gate.active_s[1] expected null or a number from 0 to 86400, found the text `soon`"),
        ("[0, .inf]", "regions.gate.active_s[1] expected null or a number from 0 to 86400"),
        ("[0, 40], cover: {}", "regions.gate.active_s `gate` is covered lane by lane, whenever that is"),
    ],
)
def test_what_is_no_window_is_refused(window: str, words: str) -> None:
    with pytest.raises(SpecError) as refused:
        closing(kind="survey", gate=window)
    told = [f"{fault.path} {fault.message}" for fault in refused.value.faults]
    assert any(each.startswith(words) for each in told), told


def test_nothing_counts_triangles_or_reads_an_automaton_of_what_is_there_for_a_time() -> None:
    with pytest.raises(SpecError, match="X counts triangles, and `gate` is there for a time only"):
        closing("F far & F (near & X !gate)", gate=GATE)
    assert closing("F far & F (near & X !home)", gate=GATE)
    document = document_of(closing(gate=GATE))
    edges = [{"from": "a", "to": "a", "when": "!gate"}]
    document["mission"] = {"automaton": {"states": ["a"], "accepting": ["a"], "edges": edges}}
    with pytest.raises(SpecError, match="the automaton speaks of `gate`, which is there for a time only"):
        parse_mission(json.dumps(document).encode())


def test_what_a_restricted_region_is_not_entered_for_is_no_task() -> None:
    with pytest.raises(SpecError, match="`gate`, which is restricted"):
        closing(tasks="[visit: gate]", gate=GATE)
