"""``mission automaton``: every form of the same automaton."""

import json

import pytest

from mission.cli import main
from mission.logic.hoa import parse_hoa
from mission.logic.parser import parse_formula
from mission.logic.translate import translate

FORMULA = "F (S1 & F R) & G !K1"


def shown(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert main(["automaton", FORMULA, *arguments]) == 0
    return capsys.readouterr().out


def test_the_table_names_every_state_and_edge(capsys: pytest.CaptureFixture[str]) -> None:
    lines = shown(capsys).splitlines()
    assert lines[0] == "3 states, 6 edges, deterministic"
    assert [line for line in lines[1:] if not line.startswith(" ")] == ["q0  initial", "q1", "q2  accepting"]
    assert sum("->" in line for line in lines) == 6


def test_json_has_the_figures(capsys: pytest.CaptureFixture[str]) -> None:
    data = json.loads(shown(capsys, "--json"))
    assert (data["states"], data["edges"], data["deterministic"]) == (3, 6, True)
    assert len(data["transitions"]) == 6


def test_hoa_reads_back_as_the_same_automaton(capsys: pytest.CaptureFixture[str]) -> None:
    again = parse_hoa(shown(capsys, "--hoa"))
    automaton = translate(parse_formula(FORMULA))
    assert (again.size, again.initial, again.accepting) == (automaton.size, automaton.initial, automaton.accepting)
    assert again.edge_count == automaton.edge_count


def test_dot_has_a_line_for_each_edge(capsys: pytest.CaptureFixture[str]) -> None:
    text = shown(capsys, "--dot")
    assert text.count("[label=") == automaton_edges()
    assert "q2 [shape=doublecircle];" in text


def automaton_edges() -> int:
    return translate(parse_formula(FORMULA)).edge_count


def test_a_formula_with_a_fault_is_shown_with_its_column(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["automaton", "F (a &"]) == 2
    assert "column" in capsys.readouterr().err
