"""``mission simulate`` as a person or a script uses it."""

import csv
import json
from pathlib import Path

import pytest

from tests.support.commands import MISSIONS, ran

PAPER = str(MISSIONS / "paper.yaml")


def test_the_figures_of_the_paper_are_drawn_and_the_flight_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = tmp_path / "states.csv"
    result = ran(capsys, "simulate", PAPER, "--pictures", str(tmp_path / "drawn"), "--csv", str(table))
    assert result.code == 0
    assert "0.329 m and 0.02 m/s beside the steering law" in result.out
    assert "achieved: the word that was flown satisfies the specification" in result.out
    drawn = sorted(path.name for path in (tmp_path / "drawn").iterdir())
    assert drawn == ["08_true_states.png", "09_true_control.png", "10_true_path.png"]
    rows = list(csv.DictReader(table.read_text().splitlines()))
    assert float(rows[0]["x_m"]) == 11.0
    assert float(rows[-1]["t_s"]) == pytest.approx(842.92, abs=0.01)
    assert all(float(row["ux_m_s2"]) == pytest.approx(float(row["rax_m_s2"]), abs=1e-12) for row in rows[-100:])


def test_json_and_the_exit_code_tell_a_violation(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    result = ran(capsys, "simulate", PAPER, "--off", "-4.7,-2.2", "--no-pictures", "--json")
    values = json.loads(result.out)
    assert (result.code, values["achieved"]) == (1, False)
    assert "K1" in values["reason"]
    assert not list(tmp_path.iterdir())


def test_a_folder_that_cannot_be_written_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").write_text("")
    result = ran(capsys, "simulate", PAPER, "--pictures", str(tmp_path / "file"))
    assert (result.code, result.out) == (2, "")
    assert "--pictures" in result.err
