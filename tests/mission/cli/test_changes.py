"""Values on the command line in the place of those in the file: planned, simulated, kept in the folder of a flight."""

import json
from pathlib import Path

import pytest

from mission.cli.arguments import build_parser, with_negative_pairs
from mission.cli.flight_folder import begin_folder
from mission.cli.given import changes_of
from mission.cli.inputs import planned
from mission.clock import WallClock
from mission.spec.loader import load_mission
from tests.support.commands import MISSIONS, ran
from tests.support.small_missions import SMALL

PAPER = str(MISSIONS / "paper.yaml")


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "small.yaml"
    path.write_text(SMALL, encoding="utf-8")
    return path


def test_each_option_has_its_effect(file: Path) -> None:
    words = ["--formula", "F goal", "--start", "8,7.5", "--altitude", "21", "--flight-speed", "3"]
    arguments = build_parser().parse_args(["plan", str(file), *words, "--set", "limits.jerk_m_s3=2.5"])
    spec = planned(arguments.file, None, changes_of(arguments)).spec
    assert (spec.formula, spec.start.position_m) == ("F goal", (8.0, 7.5))
    assert (spec.flight.altitude_m, spec.flight.speed_m_s, spec.limits.jerk_m_s3) == (21.0, 3.0, 2.5)


def test_frequencies_ask_for_the_series(capsys: pytest.CaptureFixture[str]) -> None:
    few = json.loads(ran(capsys, "plan", PAPER, "--json", "--frequencies", "30").out)
    assert few["frequencies"] == 30


def test_a_formula_takes_the_place_of_an_automaton(capsys: pytest.CaptureFixture[str]) -> None:
    result = ran(capsys, "plan", str(MISSIONS / "pairs.yaml"), "--json", "--formula", "F field", "--speed", "3")
    assert json.loads(result.out)["formula"] == "F field"


def test_the_folder_of_a_flight_has_the_mission_as_it_is_flown(file: Path, tmp_path: Path) -> None:
    given = changes_of(build_parser().parse_args(["fly", str(file), "--altitude", "9", "--formula", "F goal"]))
    plan = planned(str(file), None, given)
    kept = begin_folder(tmp_path / "flights", plan, file, WallClock(), given)
    with kept:
        assert load_mission(kept.path / "mission.yaml") == plan.spec
    assert "altitude_m: 9.0" in (kept.path / "mission.yaml").read_text()
    assert (kept.path / "mission-as-written.yaml").read_bytes() == file.read_bytes()
    given_here = json.loads((kept.path / "overrides.json").read_text())
    assert given_here == {"flight.altitude_m": 9.0, "mission.formula": "F goal"}


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--formula", "F gaol"], "--formula: the formula speaks of `gaol`"),
        (["--start", "-5,3"], "--start: the start"),
        (["--altitude", "90000"], "--altitude: 90000.0 is more than"),
        (["--set", "limits.jerk=2"], "--set limits.jerk: unknown key `jerk`"),
        (["--set", "jerk"], "--set: `jerk` is no KEY=VALUE"),
        (["--set", "limits.jerk_m_s3=[1"], "--set limits.jerk_m_s3: "),
    ],
)
def test_a_fault_is_that_of_the_option(
    options: list[str], told: str, file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    result = ran(capsys, *with_negative_pairs(["plan", str(file), *options]))
    assert result.code == 2
    assert told in result.err


def test_no_frequencies_are_none(file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        ran(capsys, "plan", str(file), "--frequencies", "0")
    assert end.value.code == 2
    assert "--frequencies: write a whole number from 1" in capsys.readouterr().err
