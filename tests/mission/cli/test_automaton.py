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


FILE = """\
HOA: v1.1
spot.x: 1
States: 2
Start: 0
AP: 1 "a"
Acceptance: 1 Inf(0)
--BODY--
State: 0 [!0] 0 [0] 1
State: 1 {0}
[t] 1
--END--
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    written = tmp_path / "once.HOA"
    written.write_text("\ufeff" + FILE, encoding="utf-8")
    return written


@pytest.mark.parametrize("form", [(), ("--hoa",), ("--dot",), ("--json",), ("--generalised",)])
def test_a_file_is_shown_as_its_formula_is(
    capsys: pytest.CaptureFixture[str], file: Path, form: tuple[str, ...]
) -> None:
    assert main(["automaton", str(file), *form]) == 0
    of_file = capsys.readouterr().out
    assert main(["automaton", "F a", *form]) == 0
    assert of_file == capsys.readouterr().out


def test_a_file_is_drawn(capsys: pytest.CaptureFixture[str], file: Path, tmp_path: Path) -> None:
    assert main(["automaton", str(file), "--picture", str(tmp_path / "a.svg")]) == 0
    assert "2 states" in capsys.readouterr().out
    assert (tmp_path / "a.svg").read_bytes().startswith(b"<?xml")


@pytest.mark.parametrize(
    ("content", "message", "hint"),
    [
        (None, "cannot be read: no such file or directory", "for the proposition of that name"),
        (FILE.replace("[t] 1", "[t] 3"), "given.hoa:10:5: state 3 does not exist", "[t] 3"),
        (b"\xff\xfeH", "is not UTF-8", "Hanoi Omega-Automata"),
    ],
)
def test_a_file_that_cannot_be_read(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, content: str | bytes | None, message: str, hint: str
) -> None:
    given = tmp_path / "given.hoa"
    if content is not None:
        given.write_bytes(content.encode() if isinstance(content, str) else content)
    assert main(["automaton", str(given)]) == 2
    printed = capsys.readouterr()
    assert not printed.out
    assert message in printed.err
    assert hint in printed.err


def test_a_name_in_quotes_is_a_proposition(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["automaton", '"a.hoa"']) == 0
    assert "a.hoa" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("one", "other", "code", "told"),
    [
        ("F a", "file", 0, "equivalent: both accept the same words"),
        ("file", "!G !a", 0, "equivalent: both accept the same words"),
        ("a U b", "a W b", 1, "not equivalent: ({a})*\n  is accepted by  a W b\n  and not by      a U b"),
        ("file", "X F a", 1, "not equivalent: {a} ({})*\n  is accepted by  file\n  and not by      X F a"),
    ],
)
def test_two_are_compared(
    *, capsys: pytest.CaptureFixture[str], file: Path, one: str, other: str, code: int, told: str
) -> None:
    names = [str(file) if name == "file" else name for name in (one, other)]
    assert main(["automaton", *names]) == code
    assert capsys.readouterr().out.replace(str(file), "file").rstrip("\n") == told
    assert main(["automaton", *names, "--json"]) == code
    data = json.loads(capsys.readouterr().out)
    assert data["equivalent"] is (code == 0)
    assert sorted(data["accepted"]) == ([] if code == 0 else [False, True])


@pytest.mark.parametrize("more", [("--dot",), ("--picture", "a.svg"), ("F b",)])
def test_what_cannot_be_compared(capsys: pytest.CaptureFixture[str], more: tuple[str, ...]) -> None:
    assert main(["automaton", "F a", "G a", *more]) == 2
    assert "two are compared at a time" in capsys.readouterr().err


@pytest.mark.parametrize("form", [(), ("--generalised",)])
@pytest.mark.parametrize("number", [8, 12])
def test_an_automaton_that_nobody_can_read_is_refused_with_what_can_be_shown(
    capsys: pytest.CaptureFixture[str], number: int, form: tuple[str, ...]
) -> None:
    formula = " & ".join(f"G (a{i} -> F b{i})" for i in range(number))
    assert main(["automaton", formula, *form]) == 2
    printed = capsys.readouterr()
    assert not printed.out
    assert "more than 20,000 states, 50,000 edges" in printed.err
    assert f"a conjunction of {number} formulas: give one of them, such as `G (a0 -> F b0)`" in printed.err
