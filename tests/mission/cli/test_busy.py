"""What is said while nothing else is seen: at once on a terminal, gone afterwards, nowhere else."""

import io
import os
import re
import shutil
import signal
import sys
from typing import NoReturn

import pytest

from mission.cli import main, schema
from mission.cli.busy import doing as told
from mission.cli.busy import erase
from mission.cli.signals import EndingSignals
from tests.support.commands import MISSIONS, ran


class Terminal(io.StringIO):
    """Knows what a terminal of one line shows."""

    def isatty(self) -> bool:
        return True

    @property
    def line(self) -> str:
        cells: list[str] = []
        at = 0
        for character in self.getvalue():
            if character == "\r":
                at = 0
                continue
            cells[at : at + 1] = [character]
            at += 1
        return "".join(cells).rstrip()


def on_terminal(monkeypatch: pytest.MonkeyPatch) -> Terminal:
    """Standard error becomes one. No fixture: pytest gives each test streams of its own once those are made."""
    screen = Terminal()
    monkeypatch.setattr(sys, "stderr", screen)
    monkeypatch.setattr(shutil, "get_terminal_size", lambda *_, **__: os.terminal_size((40, 24)))
    monkeypatch.setenv("TERM", "xterm")
    return screen


def test_what_is_done_is_said_meanwhile_and_gone_afterwards(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = on_terminal(monkeypatch)
    with told("drawing the whole of the report"):
        assert terminal.line == "drawing the whole of the report ..."
        with told("loading"):
            assert terminal.line == "loading ..."
        assert terminal.line == "drawing the whole of the report ..."
    assert terminal.line == ""
    erase()
    assert terminal.line == ""


def test_a_failure_takes_it_away_too(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = on_terminal(monkeypatch)
    with pytest.raises(KeyboardInterrupt), told("planning"):
        raise KeyboardInterrupt
    assert terminal.line == ""


@pytest.mark.parametrize("name", ["n" * 200, "漢" * 200])
def test_no_line_goes_on_in_the_next(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = on_terminal(monkeypatch)
    with told(name):
        assert len(terminal.line) * (1 if name.isascii() else 2) < 40
    assert terminal.line == ""


def test_a_program_that_ends_on_the_spot_leaves_no_line(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = on_terminal(monkeypatch)
    with told("planning survey.yaml"):
        terminal.write("^C")  # as terminals echo it
        erase()
        assert terminal.line == ""


def test_a_second_signal_leaves_no_line_either(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = on_terminal(monkeypatch)

    def ended(code: int) -> NoReturn:
        assert terminal.line == ""
        raise SystemExit(code)

    monkeypatch.setattr(os, "_exit", ended)
    with EndingSignals() as signals, told("drawing the report"):
        with pytest.raises(KeyboardInterrupt):
            signals._interrupt(signal.SIGINT, None)
        with pytest.raises(SystemExit, match="130"):
            signals._interrupt(signal.SIGINT, None)


def test_planning_is_said_on_a_terminal_only(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    terminal = on_terminal(monkeypatch)
    file = str(MISSIONS / "broken" / "formula_syntax.yaml")
    assert main(["check", str(MISSIONS / "survey.yaml")]) == 0
    assert "loading ..." in terminal.getvalue()
    assert re.search(r"planning survey\.yaml \.\.\.\r +\r$", terminal.getvalue())
    assert capsys.readouterr().out.startswith(str(MISSIONS / "survey.yaml"))
    monkeypatch.setattr(terminal, "isatty", lambda: False)
    assert "loading" not in ran(capsys, "check", file).err


def test_an_interruption_that_a_flight_takes_for_itself_ends_without_a_traceback(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(_: object) -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr(schema, "run", interrupted)
    assert ran(capsys, "schema") == (130, "", "")
