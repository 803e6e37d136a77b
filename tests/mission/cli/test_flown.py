"""`mission verify --flight`: what is printed of logs, and the exit codes."""

import json
import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from mission.cli import main
from mission.geometry.arrays import FloatArray
from tests.support.commands import MISSIONS, ROOT, ran
from tests.support.logs import HOME as EARTHLY
from tests.support.logs import flight, local, picture, tlog, world
from tests.support.small_missions import ROUNDS, SMALL

LOG = ROOT / "tests" / "golden" / "logs" / "ardupilot_survey_auto.tlog.gz"
SURVEY, FARM = (str(MISSIONS / f"{name}.yaml") for name in ("survey", "farm"))
Place = tuple[float, float]

HOME, GOAL, EAST, NORTH, POND = (9.0, 8.0), (31.0, 8.0), (31.0, 8.0), (31.0, 23.0), (9.0, 24.0)


def along(*places: Place, speed_m_s: float = 3.0) -> tuple[FloatArray, FloatArray]:
    """Times and places at 10 Hz along straight lines, from 30 s on."""
    parts = [np.array([places[0]])]
    for begin, end in pairwise(places):
        steps = math.ceil(math.dist(begin, end) / speed_m_s / 0.1)
        parts.append(np.linspace(begin, end, steps + 1)[1:])
    positions = np.concatenate(parts)
    return np.linspace(30.0, 30.0 + 0.1 * (len(positions) - 1), len(positions)), positions


@pytest.fixture
def small(tmp_path: Path) -> str:
    file = tmp_path / "small.yaml"
    file.write_text(SMALL, encoding="utf-8")
    return str(file)


def logged(tmp_path: Path, *places: Place, without: tuple[float, float] = (0.0, 0.0)) -> str:
    """A log of a flight along places, with nothing told between two times."""
    file = tmp_path / "flight.tlog"
    times, positions = along(*places)
    told = flight(times, positions)
    file.write_bytes(tlog(each for each in told if not without[0] < each[0] < without[1]))
    return str(file)


def test_a_flight_of_another_autopilot_is_judged(capsys: pytest.CaptureFixture[str]) -> None:
    result = ran(capsys, "verify", "--mission", SURVEY, "--flight", str(LOG))
    assert (result.code, result.err) == (0, "")
    lines = [line.split(maxsplit=1) for line in result.out.splitlines()]
    told = dict(lines)
    assert told["word"] == "{home} {} {S1} {} {S2} {} {S3} {} {home}"
    assert told["verdict"] == "achieved: the word that was flown satisfies the specification"
    assert next(words for name, words in lines if name == "nearest").startswith("0.43 m from K1 at ")


def test_values_for_programs(capsys: pytest.CaptureFixture[str]) -> None:
    result = ran(capsys, "verify", "--mission", SURVEY, "--flight", str(LOG), "--json")
    told = json.loads(result.out)
    assert result.code == 0
    assert told["achieved"] is True
    assert [near["region"] for near in told["restricted"]] == ["K1", "K2"]
    assert told["log"]["kind"] == "telemetry log"
    assert told["log"]["ends_whole"] is True
    assert told["word"][0]["regions"] == ["home"]
    assert told["word"][0]["utc_s"] == pytest.approx(1_795_987_256.1, abs=0.2)
    assert told["deviation"] is None


def test_a_flight_that_does_not_satisfy_the_mission(
    small: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    result = ran(capsys, "verify", "--mission", small, "--flight", logged(tmp_path, HOME, (20.0, 8.0), HOME))
    assert result.code == 1
    assert "verdict   not achieved: the word that was flown does not satisfy the specification" in result.out


def test_a_violation_has_its_time_and_place(small: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    # The pond begins 14 m north of home: at 3 m/s, 4.7 s after 30 s since boot, which is 20 s after ...:13:20.
    result = ran(capsys, "verify", "--mission", small, "--flight", logged(tmp_path, HOME, POND, HOME, GOAL, HOME))
    assert result.code == 1
    (line,) = [line for line in result.out.splitlines() if line.startswith("violation")]
    assert line.endswith("entered a restricted region (pond) at 14:13:54.7, at (9.0, 22.0)")
    assert "nearest   0.00 m from pond at 14:13:54.7" in result.out


def test_a_gap_is_a_gap_in_the_verdict(small: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = logged(tmp_path, HOME, GOAL, HOME, without=(31.05, 41.95))
    result = ran(capsys, "verify", "--mission", small, "--flight", log)
    assert result.code == 1
    assert "not told  between 14:13:51.0 and 14:14:02.0: whether it entered pond" in result.out
    assert "verdict   cannot be told: " in result.out
    assert "word      {home} ... {} {home}" in result.out


def test_the_speed_of_the_vehicle_bounds_what_a_gap_leaves_open(
    small: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = logged(tmp_path, HOME, GOAL, HOME, without=(33.05, 36.95))
    slow = ran(capsys, "verify", "--mission", small, "--flight", log, "--fastest", "3.1")
    assert slow.code == 0, slow.out
    fast = ran(capsys, "verify", "--mission", small, "--flight", log)
    assert fast.code == 1, fast.out


def test_a_plan_adds_the_distance_from_its_path(small: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plan = str(tmp_path / "plan.json")
    assert main(["plan", small, "--out", plan]) == 0
    capsys.readouterr()
    log = logged(tmp_path, HOME, GOAL, (20.0, 8.0), (20.0, 11.0), HOME)
    for words in (("--mission", small, "--plan", plan), ("--plan", plan), (plan,)):
        result = ran(capsys, "verify", *words, "--flight", log)
        assert result.code == 0, result.out + result.err
        (line,) = [line for line in result.out.splitlines() if line.startswith("path")]
        assert 0.5 < float(line.split()[3]) < 5.0
    other = tmp_path / "other.yaml"
    other.write_text(SMALL.replace("altitude_m: 6", "altitude_m: 7"), encoding="utf-8")
    result = ran(capsys, "verify", "--mission", str(other), "--plan", plan, "--flight", log)
    assert result.code == 2
    assert "not a plan of" in result.err


def test_laps_are_counted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mission = tmp_path / "rounds.yaml"
    mission.write_text(ROUNDS, encoding="utf-8")
    lap = (EAST, NORTH)
    log = logged(tmp_path, HOME, *lap, *lap, *lap, HOME)
    result = ran(capsys, "verify", "--mission", str(mission), "--flight", log)
    assert result.code == 0, result.out
    assert "of 2 laps were flown, nothing was violated so far" in result.out
    result = ran(capsys, "verify", "--mission", str(mission), "--flight", logged(tmp_path, HOME, *lap, HOME))
    assert result.code == 1
    assert "verdict   not achieved: " in result.out


def test_tasks_that_may_be_given_up_are_judged_each(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mission = tmp_path / "wishes.yaml"
    text = SMALL.replace(
        "  formula: F (goal & F G home) & G !pond",
        "  formula: F (goal & F G home)\ntasks:\n  - {visit: [goal], weight: 2}\n  - {avoid: goal, weight: 1}",
    )
    mission.write_text(text, encoding="utf-8")
    result = ran(capsys, "verify", "--mission", str(mission), "--flight", logged(tmp_path, HOME, GOAL, HOME))
    assert result.code == 0, result.out + result.err
    wishes = [line for line in result.out.splitlines() if line.startswith("wish")]
    assert wishes == ["wish      visit goal: met", "wish      avoid goal: not met"]
    # So they are where something else was violated.
    result = ran(capsys, "verify", "--mission", str(mission), "--flight", logged(tmp_path, HOME, GOAL, POND, HOME))
    assert result.code == 1
    assert [line for line in result.out.splitlines() if line.startswith("wish")] == wishes


def test_what_was_covered_and_photographed_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mission = tmp_path / "covered.yaml"
    cover = "goal: {kind: survey, cover: {spacing_m: 8, share: 0.5}, polygon"
    mission.write_text(SMALL.replace("goal: {kind: survey, polygon", cover).replace(", loiter_s: 2", ""))
    times, positions = along(HOME, GOAL, (36.0, 8.0), GOAL, HOME)
    told = flight(times, positions)
    photographed = [20, 60, 70, 80]  # 6 m, 18 m, 21 m and 24 m on the way; goal begins 17 m from home
    told = [
        each
        for k, message in enumerate(told)
        for each in ((message, picture(message[0], number=k - 5)) if k - 5 in photographed else (message,))
    ]
    file = tmp_path / "covered.tlog"
    file.write_bytes(tlog(told))
    result = ran(capsys, "verify", "--mission", str(mission), "--flight", str(file))
    assert result.code == 0, result.out + result.err
    # A strip 8 m wide through the middle of a region of 10 m by 8 m is all of it.
    assert "covered   100.0% of goal, 50.0% is asked" in result.out
    assert "pictures  4, 3 over goal, nothing was heard of 57 more" in result.out
    narrow = mission.read_text().replace("spacing_m: 8", "spacing_m: 3")
    mission.write_text(narrow)
    result = ran(capsys, "verify", "--mission", str(mission), "--flight", str(file))
    assert result.code == 1
    assert "too little of goal was covered, 50.0% is asked" in result.out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "nothing to verify"),
        (("--flight", str(LOG)), "--mission FILE"),
        (("--flight", "no.tlog", "--mission", SURVEY), "no such file"),
        (("--flight", SURVEY, "--mission", SURVEY), "no log that can be read"),
        (("--flight", str(LOG), "--mission", SURVEY, "--flight-number", "2"), "one flight"),
        (("--flight", str(LOG), "--mission", SURVEY, "--system", "9"), "vehicle 9"),
        (("--flight", str(LOG).replace("tlog", "bin"), "--mission", SURVEY, "--system", "1"), "leave --system out"),
        (("--flight", str(LOG).replace("ardupilot_survey_auto", "px4_survey"), "--mission", FARM), "km away"),
    ],
)
def test_what_cannot_be_used_is_said(
    arguments: tuple[str, ...], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    result = ran(capsys, "verify", *arguments)
    assert result.code == 2
    assert words in result.err


def test_a_vehicle_outside_the_domain_has_left_it(
    small: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    result = ran(capsys, "verify", "--mission", small, "--flight", logged(tmp_path, HOME, (9.0, -4.0), HOME))
    assert result.code == 1
    assert "violation left the domain at " in result.out


def test_a_flight_that_begins_elsewhere_is_said_to(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mission = tmp_path / "elsewhere.yaml"
    place = f"origin: {{latitude_deg: {EARTHLY.latitude_deg + 0.01}, longitude_deg: {EARTHLY.longitude_deg}}}\n"
    mission.write_text(SMALL + place, encoding="utf-8")
    file = tmp_path / "flight.tlog"
    file.write_bytes(tlog(flight(*along(HOME, GOAL, HOME), world)))
    result = ran(capsys, "verify", "--mission", str(mission), "--flight", str(file))
    assert result.code == 1
    assert "verdict   not achieved: the flight begins outside of the domain" in result.out


def test_one_position_is_a_flight(small: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "one.tlog"
    file.write_bytes(tlog([local(3.0, 1.0, 1.0, 0.0)]))
    result = ran(capsys, "verify", "--mission", small, "--flight", str(file))
    assert result.code == 1
    assert "word      {home}\n" in result.out
    assert "does not satisfy the specification" in result.out
