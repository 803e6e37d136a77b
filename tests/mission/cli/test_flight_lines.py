"""The lines of a flight: what is proved, what was given up, how closely it was followed."""

import errno
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from mission.cli import fly
from mission.fly import FlightResult
from mission.link.ending import Ending
from mission.plan import FlightPlan
from tests.support.commands import Ran, ran
from tests.support.small_missions import SMALL, plan_of

WISHES = SMALL.replace(
    "mission:\n  formula: F (goal & F G home) & G !pond\n",
    "mission:\n  formula: F G home\ntasks: [{visit: goal, weight: 3}, {avoid: goal, weight: 2}]\n",
)
NO_TUBE = SMALL.replace("disturbance_m_s2: 0.5", "disturbance_m_s2: 0")


def result_of(plan: FlightPlan, **values: Any) -> FlightResult:  # noqa: ANN401 - fields of all types
    flown = FlightResult(
        plan=plan,
        achieved=True,
        reason="the word that was flown satisfies the specification",
        ending=Ending.LANDED,
        interrupted=False,
        vehicle="ArduPilot",
        began_s=10.0,
        ended_s=60.0,
        largest_error_m=0.45,
        largest_distance_m=0.64,
        beyond_tube_s=0.0,
        word=plan.certificate.word,
        laps=0,
        gaps=(),
        violations=(),
    )
    return replace(flown, **values)


def shown(text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Ran:
    """What `mission fly` prints of a flight that achieved its mission."""
    file = tmp_path / "small.yaml"
    file.write_text(text, encoding="utf-8")
    flown = fly._Flown(tmp_path, heard=False, exit_code=0, result=result_of(plan_of(text)))
    monkeypatch.setattr(fly, "_flown", lambda *_: flown)
    monkeypatch.setattr(fly, "_report", lambda *_, **__: None)
    return ran(capsys, "fly", str(file))


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (ZeroDivisionError("division by zero"), "an error of this program, ZeroDivisionError: division by zero"),
        (OSError(errno.ENOSPC, "full"), "no space left on device"),
    ],
)
def test_a_report_that_fails_costs_no_verdict(
    error: Exception, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise error

    report = fly._report
    monkeypatch.setattr(fly, "write_again", fail)
    shown(SMALL, tmp_path, monkeypatch, capsys)
    monkeypatch.setattr(fly, "_report", report)
    flown = ran(capsys, "fly", str(tmp_path / "small.yaml"))
    assert flown.code == 0
    assert flown.out.splitlines()[-1].startswith("ACHIEVED  ")
    assert "report  " not in flown.out
    assert f"the report could not be written: {words}; try `mission report {tmp_path}`" in flown.err
    told = json.loads(ran(capsys, "fly", str(tmp_path / "small.yaml"), "--json").out)
    assert (told["exit_code"], told["achieved"], told["report"]) == (0, True, None)


def test_wishes_that_were_given_up_are_named_first_and_last(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    first, *_, last = shown(WISHES, tmp_path, monkeypatch, capsys).out.splitlines()
    assert first.endswith("; without avoid goal (weight 2)")
    assert last == ("ACHIEVED  the word that was flown satisfies the specification; without avoid goal (weight 2)")


def test_warnings_are_said_before_the_flight(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    result = shown(SMALL.replace("altitude_m: 6", "altitude_m: 3000"), tmp_path, monkeypatch, capsys)
    assert "warning: flight.altitude_m: 3000 m" in result.err


@pytest.mark.parametrize(
    ("text", "values", "line"),
    [
        (SMALL, {}, "at most 0.45 m per axis from the trajectory, within the 0.5 m per axis of the proof"),
        (
            SMALL,
            {"largest_error_m": 0.75, "beyond_tube_s": 1.25},
            "at most 0.75 m per axis from the trajectory, beyond the 0.5 m per axis of the proof for up to 1.2 s",
        ),
        (NO_TUBE, {"beyond_tube_s": 843.0}, "at most 0.45 m per axis from the trajectory"),
    ],
)
def test_how_closely_it_was_followed(text: str, values: dict[str, object], line: str) -> None:
    assert fly.tracked(result_of(plan_of(text), **values)) == f"{line} (largest distance 0.64 m)"


@pytest.mark.parametrize(("off_m_s", "word"), [(0.3, "within"), (1.3, "beyond")])
def test_the_velocity_is_told_with_what_goes_with_the_tube(off_m_s: float, word: str) -> None:
    said = fly.tracked(result_of(plan_of(SMALL), largest_velocity_error_m_s=off_m_s))
    assert said.endswith(
        f"; at most {off_m_s:.2f} m/s per axis from its velocity, {word} the 1.2 m/s that go with the tube"
    )


def test_what_never_took_off_followed_nothing() -> None:
    stood = result_of(plan_of(SMALL), achieved=False, began_s=None, largest_error_m=0.0, largest_distance_m=0.0)
    assert fly.tracked(stood) == "none: the trajectory was not begun"
