"""``mission automaton``: every form of the same automaton."""

import json
from pathlib import Path

import pytest

from mission.cli import main
from mission.logic.automata.translate import translate, translate_generalised
from mission.logic.formula.parser import parse_formula
from mission.logic.hoa.text import parse_generalised, parse_hoa

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


def test_the_generalised_automaton_reads_back_too(capsys: pytest.CaptureFixture[str]) -> None:
    formula = "G F a & G F b"
    assert main(["automaton", formula, "--generalised"]) == 0
    again = parse_generalised(capsys.readouterr().out)
    assert again == translate_generalised(parse_formula(formula))
    assert (again.size, again.sets) == (1, 2)


@pytest.mark.parametrize(("suffix", "magic"), [(".png", b"\x89PNG"), (".svg", b"<?xml"), (".PDF", b"%PDF")])
def test_a_picture_is_written_beside_the_table(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, suffix: str, magic: bytes
) -> None:
    file = tmp_path / f"automaton{suffix}"
    assert "3 states, 6 edges, deterministic" in shown(capsys, "--picture", str(file))
    drawn = file.read_bytes()
    assert drawn.startswith(magic)
    shown(capsys, "--picture", str(file))
    assert file.read_bytes() == drawn
    assert list(tmp_path.iterdir()) == [file]


@pytest.mark.parametrize(
    ("formula", "file", "reason", "hint"),
    [
        (FORMULA, "a.gif", "which kind of picture", "ends in .pdf, .png or .svg"),
        (FORMULA, "a", "which kind of picture", "ends in .pdf, .png or .svg"),
        (FORMULA, "nowhere/a.png", "cannot be written: no such file or directory", "a place that can be written to"),
        ("F a & F b & F c & F d & F e", "a.png", "of 32 states cannot be read", "with --dot for a drawing program"),
        ("F a & F b & F c & F d", "a.png", "of 81 edges cannot be read", "print it as a table"),
    ],
)
def test_a_picture_that_cannot_be_drawn(
    *, capsys: pytest.CaptureFixture[str], tmp_path: Path, formula: str, file: str, reason: str, hint: str
) -> None:
    assert main(["automaton", formula, "--picture", str(tmp_path / file)]) == 2
    printed = capsys.readouterr()
    assert not printed.out
    assert reason in printed.err
    assert hint in printed.err
    assert not list(tmp_path.iterdir())


def test_dot_has_a_line_for_each_edge(capsys: pytest.CaptureFixture[str]) -> None:
    text = shown(capsys, "--dot")
    assert text.count("[label=") == automaton_edges()
    assert "q2 [shape=doublecircle];" in text


def automaton_edges() -> int:
    return translate(parse_formula(FORMULA)).edge_count


def test_a_formula_with_a_fault_is_shown_with_its_column(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["automaton", "F (a &"]) == 2
    assert "column" in capsys.readouterr().err
