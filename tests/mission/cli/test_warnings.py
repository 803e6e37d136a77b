"""What commands say of missions that can be flown but are odd, and of missions that cannot."""

import json
from pathlib import Path

import pytest

from mission.cli import main
from tests.support.small_missions import SMALL

REFUSALS = Path(__file__).parents[2] / "golden" / "refusals"


@pytest.fixture
def odd(tmp_path: Path) -> str:
    file = tmp_path / "odd.yaml"
    file.write_text(SMALL.replace("formula: F (goal", "formula: F home & F (goal"), encoding="utf-8")
    return str(file)


@pytest.mark.parametrize("command", ["plan", "check"])
def test_warnings_go_to_standard_error(command: str, odd: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([command, odd]) == 0
    shown = capsys.readouterr()
    assert "warning: `F home` already holds where the flight starts (home)" in shown.err
    assert "already holds" not in shown.out


def test_the_summary_holds_the_warnings(odd: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["plan", "--json", odd]) == 0
    (warning,) = json.loads(capsys.readouterr().out)["warnings"]
    assert warning.startswith("`F home`")


def test_a_refusal_names_the_parts_one_to_a_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(REFUSALS / "behind_a_wall.yaml")]) == 3
    assert "\n    F silo\n    wall is restricted: it is never entered\n" in capsys.readouterr().err
