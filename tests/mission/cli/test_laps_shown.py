"""What the commands say of laps, and what they take for a number of them."""

import io
import json
from dataclasses import replace
from pathlib import Path
from typing import Literal

import pytest
from rich.console import Console

from mission.cli import live
from mission.cli.arguments import build_parser
from mission.cli.extent import extent
from mission.cli.flight_folder import begin_folder
from mission.cli.given import changes_of
from mission.cli.inputs import planned
from mission.cli.live import Display
from mission.clock import WallClock
from mission.fly import Progress
from mission.monitor.laps import laps_text
from mission.monitor.stage import Stage
from mission.monitor.verdict import Verdict
from mission.plan import FlightPlan
from mission.spec.loader import load_mission
from tests.mission.spec.test_drawn_files import drawn, mission
from tests.support.commands import ran
from tests.support.small_missions import ROUNDS, SMALL, plan_of


@pytest.fixture(scope="module")
def rounds() -> FlightPlan:
    return plan_of(ROUNDS)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "rounds.yaml"
    path.write_text(ROUNDS, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("text", "laps"), [("3", 3), ("until-stopped", "until_stopped"), ("until_stopped", "until_stopped")]
)
def test_a_number_of_laps_overrides_that_of_the_file(file: Path, text: str, laps: int | str) -> None:
    arguments = build_parser().parse_args(["fly", str(file), "--laps", text])
    plan = planned(arguments.file, arguments.run, changes_of(arguments))
    assert plan.spec.flight.laps == laps
    assert plan.trajectory.laps == (laps if isinstance(laps, int) else None)


def test_laps_of_a_mission_without_any_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "small.yaml"
    file.write_text(SMALL, encoding="utf-8")
    refused = ran(capsys, "fly", str(file), "--laps", "3", "--out", str(tmp_path / "flights"))
    assert refused.code == 2
    assert "--laps: this mission has no laps: it ends once it is done" in refused.err
    assert not (tmp_path / "flights").exists()


def test_the_folder_of_a_flight_has_the_laps_that_were_asked_for(file: Path) -> None:
    arguments = build_parser().parse_args(["fly", str(file), "--laps", "3", "--out", str(file.parent / "flights")])
    given = changes_of(arguments)
    plan = planned(arguments.file, arguments.run, given)
    kept = begin_folder(Path(arguments.out), plan, file, WallClock(), given)
    with kept:
        assert load_mission(kept.path / "mission.yaml") == plan.spec


@pytest.mark.parametrize(
    ("flown", "asked", "text"),
    [
        (1, 2, "1 of 2 laps were flown"),
        (4, 2, "4 laps were flown, 2 were asked for"),
        (2, 1, "2 laps were flown, 1 was asked for"),
        (1, None, "1 lap was flown"),
    ],
)
def test_laps_are_counted_in_words(flown: int, asked: int | None, text: str) -> None:
    assert laps_text(flown, asked) == text


@pytest.mark.parametrize("text", ["0", "-1", "10001", "for-ever", "2.5"])
def test_what_is_no_number_of_laps(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        build_parser().parse_args(["fly", "rounds.yaml", "--laps", text])
    assert "--laps" in capsys.readouterr().err


def test_how_far_a_flight_of_laps_is(rounds: FlightPlan) -> None:
    lap_s = rounds.trajectory.legs[1].duration_s
    assert extent(rounds).startswith("2 laps of ")
    assert extent(rounds).endswith(f"in {rounds.trajectory.duration_s:.0f} s")
    endless = replace(rounds, trajectory=replace(rounds.trajectory, laps=None))
    assert extent(endless) == f"laps of {rounds.curve.legs[1].length_m:.0f} m in {lap_s:.0f} s each, until Ctrl-C"
    small = plan_of(SMALL)
    assert extent(small, 1) == f"{small.curve.length_m:.1f} m in {small.trajectory.duration_s:.0f} s"


@pytest.mark.parametrize("laps", ["2", "until_stopped"])
def test_a_plan_of_laps_is_shown(laps: str, file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file.write_text(ROUNDS.replace("laps: 2", f"laps: {laps}"), encoding="utf-8")
    written = file.parent / "plan.json"
    shown = ran(capsys, "plan", str(file), "--out", str(written))
    assert (shown.code, shown.err) == (0, "")
    assert "Way back" in shown.out
    assert "on the way back from the laps nothing is violated" in shown.out
    assert ("each, until Ctrl-C" in shown.out) == (laps == "until_stopped")
    numbers = json.loads(ran(capsys, "plan", str(file), "--json").out)
    assert str(numbers["laps"]) == laps
    assert (numbers["flight_duration_s"] is None) == (laps == "until_stopped")
    assert numbers["way_back"]
    assert "proved" in ran(capsys, "check", str(file)).out
    assert ran(capsys, "verify", str(written)).code == 0


def test_a_way_back_that_was_forged_is_not_proved(file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    written = file.parent / "plan.json"
    assert ran(capsys, "plan", str(file), "--out", str(written)).code == 0
    plan = json.loads(written.read_text(encoding="utf-8"))
    back = plan["trajectory"]["legs"][2]["curve"]
    back["controls_m"][-1][-1][1] += 18.0  # it begins where it did, and ends 18 m farther north
    written.write_text(json.dumps(plan), encoding="utf-8")
    refused = ran(capsys, "verify", str(written))
    assert refused.code == 1
    assert "the way back" in refused.out


def moment(**values: object) -> Progress:
    some = Progress(
        stage=Stage.FLY,
        waiting_for="",
        t_s=40.0,
        trajectory_s=20.0,
        duration_s=float("inf"),
        leg=3,
        legs=20,
        done=1,
        total=2,
        awaited=("east",),
        laps=4,
        laps_asked=None,
        returning=False,
        verdict=Verdict.OPEN,
    )
    return replace(some, **values)  # type: ignore[arg-type] # a test's shorthand


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({}, "Ctrl-C returns · leg 4/20 · lap 5 · automaton 1/2 · waits for east"),
        ({"laps_asked": 7, "duration_s": 90.0}, "70 s left · leg 4/20 · lap 5/7 · "),
        ({"laps_asked": 5, "duration_s": 60.0, "returning": True}, "40 s left · leg 4/20 · lap 5/5, then back · "),
    ],
)
def test_the_lap_is_shown_in_flight(
    values: dict[str, object], words: str, rounds: FlightPlan, monkeypatch: pytest.MonkeyPatch
) -> None:
    screen = io.StringIO()
    monkeypatch.setattr(live, "err", Console(file=screen, force_terminal=True, width=160, color_system=None))
    with Display(rounds) as display:
        display.show(moment(**values))
        display._bar.refresh()
    assert words in screen.getvalue()


def test_that_the_vehicle_will_return_is_said_without_a_terminal(
    rounds: FlightPlan, monkeypatch: pytest.MonkeyPatch
) -> None:
    screen = io.StringIO()
    monkeypatch.setattr(live, "err", Console(file=screen, width=160))
    with Display(rounds) as display:
        for returning in (False, False, True, True):
            display.show(moment(returning=returning))
    assert screen.getvalue() == "flying\nflying the last lap, then back\n"


@pytest.mark.parametrize("terminal", [None, True])
def test_what_comes_up_in_flight_is_said_once(
    terminal: Literal[True] | None, rounds: FlightPlan, monkeypatch: pytest.MonkeyPatch
) -> None:
    screen = io.StringIO()
    monkeypatch.setattr(live, "err", Console(file=screen, force_terminal=terminal, width=160, color_system=None))
    told = ("the pilot has it [now]", "going on from here to east")
    with Display(rounds) as display:
        for count in (0, 1, 1, 2, 2):
            display.show(moment(told=told[:count]))
    assert [screen.getvalue().count(words) for words in told] == [1, 1]


def test_what_a_stage_waits_for_is_said_once_and_again_when_it_takes_long(
    rounds: FlightPlan, monkeypatch: pytest.MonkeyPatch
) -> None:
    screen = io.StringIO()
    monkeypatch.setattr(live, "err", Console(file=screen, width=160))
    with Display(rounds) as display:
        for t_s in [None, *range(45)]:
            awaited = "a position" if t_s is not None and t_s > 2 else "a height, a position"
            display.show(moment(stage=Stage.READY, t_s=t_s, waiting_for=awaited))
        display.show(moment(stage=Stage.ARM, t_s=45.0))
    assert screen.getvalue().splitlines() == [
        "waiting for position and health: a height, a position",
        "waiting for position and health: a position (10 s)",
        "waiting for position and health: a position (20 s)",
        "waiting for position and health: a position (40 s)",
        "arming",
    ]


def test_the_folder_of_a_flight_has_what_draws_the_mission(tmp_path: Path) -> None:
    file = tmp_path / "farm.yaml"
    file.write_text(mission("metres"), encoding="utf-8")
    (tmp_path / "farm.json").write_bytes(drawn(degrees=True))
    plan = planned(str(file))
    kept = begin_folder(tmp_path / "flights", plan, file, WallClock())
    with kept:
        assert load_mission(kept.path / "mission.yaml").regions == plan.spec.regions
