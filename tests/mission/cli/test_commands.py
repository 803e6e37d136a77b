"""Each command as a person or a script uses it: what it says on which stream, and its exit code."""

import json
import math
import re
from pathlib import Path

import pytest

from mission.cli import main
from tests.support.commands import MISSIONS, Ran, ran
from tests.support.small_missions import SMALL

PAPER = str(MISSIONS / "paper.yaml")


def test_without_a_command_the_help_is_shown_and_it_is_an_error(capsys: pytest.CaptureFixture[str]) -> None:
    result = ran(capsys)
    assert (result.code, result.out) == (2, "")
    assert "exit codes:" in result.err


@pytest.mark.parametrize("command", ["check", "plan", "simulate", "fly", "report", "verify", "schema"])
def test_each_command_explains_itself(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        main([command, "--help"])
    assert end.value.code == 0
    assert capsys.readouterr().out.startswith(f"usage: mission {command}")


def test_the_version_is_that_of_the_distribution(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        main(["--version"])
    assert end.value.code == 0
    assert re.fullmatch(r"mission \d+\.\d+\.\d+\n", capsys.readouterr().out)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["plan", PAPER, "--run", "x"], "'x' is not a whole number from 0"),
        (["plan", PAPER, "--run", "-1"], "'-1' is not a whole number from 0"),
        (["plan", PAPER, "--run", "9" * 30], "is not a whole number from 0"),
        (["plan", PAPER, "--runs", "0"], "write a whole number from 1"),
        (["fly", PAPER, "--speed", "0"], "0 is not positive"),
        (["fly", PAPER, "--speed", "inf"], "'inf' is not a finite number"),
        (["fly", PAPER, "--seed", str(2**32)], "a seed is less than 2^32"),
        (["fly", PAPER, "--wind", "abc"], "write NORTH,EAST or SPEED@FROM_DEGREES, not 'abc'"),
        (["fly", PAPER, "--wind", "nan,1"], "'nan' is not a finite number"),
        (["fly", PAPER, "--wind", "-3@270"], "the speed -3 is negative"),
        (["nonsense"], "invalid choice: 'nonsense'"),
    ],
)
def test_an_option_that_cannot_be_used(options: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        main(options)
    assert end.value.code == 2
    assert words in capsys.readouterr().err


def test_no_command_speaks_of_a_proof_where_the_field_leads(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, plan = tmp_path / "field.yaml", tmp_path / "plan.json"
    file.write_text(SMALL.replace("flight:", "flight:\n  guidance: field"), encoding="utf-8")
    checked = ran(capsys, "check", str(file)).out
    assert checked.endswith("led by the field, without a proof of a tube\n")
    shown = ran(capsys, "plan", str(file), "--out", str(plan)).out
    assert "no tube is proved" in shown
    verified = ran(capsys, "verify", str(plan)).out
    assert "this is about the plan alone: the flight is led by the field" in verified


class TestCheck:
    def test_a_sound_file(self, capsys: pytest.CaptureFixture[str]) -> None:
        result = ran(capsys, "check", PAPER)
        assert result == Ran(0, f"{PAPER}: sound; 13 triangles, 4 shortest runs, 34.0 m in 843 s, proved\n", "")

    def test_a_fault_is_shown_in_its_line_with_a_caret(self, capsys: pytest.CaptureFixture[str]) -> None:
        file = MISSIONS / "broken" / "formula_syntax.yaml"
        result = ran(capsys, "check", str(file))
        assert (result.code, result.out) == (2, "")
        first, line, caret, hint = result.err.splitlines()
        assert first == f"{file}:9:22: mission.formula: & has no left operand (column 11)"
        assert line == "    |   formula: F Field & & G !Keep & F G Home"
        assert line[caret.index("^") :].startswith("& G")
        assert hint == "    a proposition, true, false, ! F G X or ( is expected here"

    def test_every_file_is_looked_at_and_the_worst_counts(
        self, tmp_path: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        contradiction = tmp_path / "contradiction.yaml"
        contradiction.write_text(Path(PAPER).read_text(encoding="utf-8").replace("& G !K1", "& G !S1"), "utf-8")
        result = ran(capsys, "check", str(tmp_path / "no.yaml"), PAPER, str(contradiction), str(tmp_path))
        assert result.code == 3
        assert f"{PAPER}: sound" in result.out
        assert f"{tmp_path / 'no.yaml'}: there is no such file" in result.err
        assert f"{contradiction}: error: " in result.err
        assert f"{tmp_path}: this is a directory" in result.err
        assert result.err.splitlines()[-1] == "3 of 4 files cannot be flown"

    @pytest.mark.parametrize(
        "content", [b"\x7fELF\x02\x01\x01\x00\x00", bytes(range(256)) * 20, b"\0", b"%PDF-1.7\n\xff"]
    )
    def test_what_is_no_text_at_all(self, content: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
        file = tmp_path / "photo.yaml"
        file.write_bytes(content)
        result = ran(capsys, "check", str(file))
        assert result.code == 2
        assert all(character.isprintable() or character == "\n" for character in result.err)

    def test_a_file_cannot_colour_or_clear_the_terminal(
        self, tmp_path: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        file = tmp_path / "evil.yaml"
        file.write_text("name: [bold]x[/bold] \x1b[2J\n", "utf-8")
        result = ran(capsys, "check", str(file))
        assert result.code == 2
        assert "\x1b" not in result.err
        assert "name: [bold]x[/bold] ?[2J" in result.err

    @pytest.mark.parametrize("command", ["check", "plan", "verify", "fly", "report"])
    def test_neither_can_the_name_of_one(
        self, command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        result = ran(capsys, command, str(tmp_path / "no\x1b[2J\n\u202esuch"))
        assert result.code == 2
        assert result.err.startswith(f"{tmp_path}/no\\x1b[2J\\n\\u202esuch: ")
        assert all(character.isprintable() or character == "\n" for character in result.err)

    def test_nor_can_the_name_in_one_that_is_sound(self, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
        file = tmp_path / "evil\x1b[31m.yaml"
        file.write_text(SMALL.replace("Small round", r'"small \u202Emission"'), "utf-8")
        assert ran(capsys, "plan", str(file)).out.startswith("small \\u202emission\n")
        assert ran(capsys, "check", str(file)).out.startswith(f"{tmp_path}/evil\\x1b[31m.yaml: sound")

    def test_nothing_depends_on_the_width_of_the_terminal(
        self, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
    ) -> None:
        files = [str(file) for file in sorted((MISSIONS / "broken").glob("f*.yaml"))]
        said = []
        for width in ("20", "400"):
            monkeypatch.setenv("COLUMNS", width)
            said.append(ran(capsys, "check", PAPER, *files))
        assert said[0] == said[1]


def test_a_formula_with_a_fault_is_shown_with_a_caret(capsys: pytest.CaptureFixture[str]) -> None:
    result = ran(capsys, "automaton", "F (S1 & & F R)")
    assert (result.code, result.out) == (2, "")
    first, line, caret, _ = result.err.splitlines()
    assert first.startswith("error: & has no left operand")
    assert line[caret.index("^") :] == "& F R)"


class TestPlan:
    def test_the_json_of_the_paper(self, capsys: pytest.CaptureFixture[str]) -> None:
        result = ran(capsys, "plan", PAPER, "--json")
        assert (result.code, result.err) == (0, "")
        assert result.out.count("\n") == 1
        plan = json.loads(result.out)
        assert plan["triangles"] == 13
        # At (5, 5), between (11, 2) and (11, 0); and from (0, 0) to (11, 0).
        assert plan["smallest_angle_deg"] == pytest.approx(math.degrees(math.atan(5 / 6) - math.atan(3 / 6)))
        assert plan["largest_edge_m"] == pytest.approx(11.0)
        assert plan["automaton_states"] == 3
        assert plan["product_states"] == 39
        assert plan["shortest_runs"] == 4
        assert plan["run"] == [0, 8, 11, 12, 4, 5, 7, 3, 1, 5, 4, 12, 10]
        assert plan["controls"] == [1, 3, 3, 1, 1, 3, 1, 2, 2, 2, 3, 2, 0]
        assert plan["length_m"] == pytest.approx(35.19, abs=0.01)
        assert plan["duration_s"] == pytest.approx(842.7, abs=0.1)
        assert plan["certificate"]["holds"] is True

    def test_the_json_holds_runs_and_transitions_on_request(self, capsys: pytest.CaptureFixture[str]) -> None:
        plan = json.loads(ran(capsys, "plan", PAPER, "--json", "--runs", "9", "--transitions").out)
        assert len(plan["runs"]) == 4
        assert plan["runs"][0]["prefix"] + plan["runs"][0]["suffix"] == plan["run"]
        assert plan["transitions"]["T"][0] == [0, 8, -1, 2]
        assert len(plan["transitions"]["A"]) == plan["automaton_edges"]

    def test_the_tables(self, capsys: pytest.CaptureFixture[str]) -> None:
        lines = ran(capsys, "plan", PAPER, "--runs", "2", "--transitions").out.splitlines()
        assert "       0  5 8 2               8 - 2                 S2" in lines
        assert "Mesh           13 triangles, smallest angle 13.2 degrees, largest edge 11.00 m" in lines
        assert "T  13 states" in lines
        assert "A  3 states, 6 edges, deterministic" in lines
        assert "P  39 states, 34 of them reachable" in lines
        assert "Best runs      4, of 13 transitions each" in lines
        assert "     0  0 8 11 12 4 5 7 3 1 5 4 12 (10)*" in lines
        assert "  0, u0 -> 0   0, u1 -> 8   0, u2 -> -1   0, u3 -> 2" in lines

    def test_what_is_flown_and_proved_comes_first_and_tables_on_request(
        self, capsys: pytest.CaptureFixture[str]
    ) -> None:
        lines = ran(capsys, "plan", str(MISSIONS / "patrol.yaml")).out.splitlines()
        figures = [line for line in lines if line and line[0] != " "][1:]
        assert figures[0].startswith("Flight         2 laps of ")
        assert figures[1].startswith("Certificate    holds within 0.5 m")
        assert len(lines) < 30
        assert all(line.endswith(", with one lap") for line in lines if line.startswith(("Path ", "Smoothing ")))
        plan = json.loads(ran(capsys, "plan", str(MISSIONS / "patrol.yaml"), "--json").out)
        assert plan["flight_length_m"] > 1.5 * plan["curve_length_m"]
        assert f"{plan['flight_length_m']:.1f} m in" in figures[0]

    def test_another_run_by_its_number(self, capsys: pytest.CaptureFixture[str]) -> None:
        plan = json.loads(ran(capsys, "plan", PAPER, "--json", "--run", "3").out)
        assert plan["run_index"] == 3
        assert plan["run"] == [0, 8, 11, 12, 4, 5, 1, 3, 7, 5, 4, 12, 10]

    def test_a_run_that_does_not_exist(self, capsys: pytest.CaptureFixture[str]) -> None:
        result = ran(capsys, "plan", PAPER, "--run", "4")
        assert (result.code, result.out) == (2, "")
        assert f"{PAPER}: --run: there is no run 4" in result.err
        assert "from 0 to 3" in result.err

    def test_no_plan(self, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
        file = tmp_path / "contradiction.yaml"
        file.write_text(Path(PAPER).read_text(encoding="utf-8").replace("& G !K1", "& G !S1"), "utf-8")
        result = ran(capsys, "plan", str(file), "--json", "--out", str(tmp_path / "plan.json"))
        assert (result.code, json.loads(result.out)["exit_code"]) == (3, 3)
        assert result.err.startswith(f"{file}: error: ")
        assert list(tmp_path.iterdir()) == [file]

    def test_what_is_asked_for_is_written_whole(self, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
        plan, pictures = tmp_path / "plan.json", tmp_path / "a" / "pictures"
        plan.write_text("an older plan")
        result = ran(capsys, "plan", PAPER, "--out", str(plan), "--pictures", str(pictures))
        assert result.code == 0
        assert json.loads(plan.read_text(encoding="utf-8"))["shortest_runs"] == 4
        assert f"Plan           {plan}\nPictures       {pictures}\n" in result.out
        assert all(file.read_bytes().startswith(b"\x89PNG") for file in pictures.iterdir())
        assert len(list(pictures.iterdir())) == 6
        assert sorted(file.name for file in tmp_path.iterdir()) == ["a", "plan.json"]

    @pytest.mark.parametrize("option", ["--out", "--pictures"])
    def test_a_place_that_cannot_be_written(
        self, option: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
    ) -> None:
        monkeypatch.chdir(tmp_path)
        (tmp_path / "file").write_text("kept")
        result = ran(capsys, "plan", PAPER, option, "file/x")
        assert (result.code, result.out) == (2, "")
        assert result.err.startswith(f"{option}: ")
        assert [file.read_text() for file in tmp_path.iterdir()] == ["kept"]

    def test_a_plan_without_a_name(self, capsys: pytest.CaptureFixture[str]) -> None:
        result = ran(capsys, "plan", PAPER, "--out", "")
        assert (result.code, result.out) == (2, "")
        assert result.err.startswith("--out: this names no file")
