"""The progress of a flight on the terminal: the stage, the leg, the automaton, the time left."""

import contextlib
import math
from types import TracebackType
from typing import Self

from rich.markup import escape
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn

from mission.cli.screen import err
from mission.fly import Progress as Moment
from mission.monitor.stage import Stage
from mission.plan import FlightPlan
from mission.printable import printable

_WIDE = 100
_AGAIN_S = 10.0


class Display:
    """A bar that follows one flight; on what is no terminal, one line for each stage, and more where it takes long.

    What stages do not tell, of pilots and of other plans, has lines of its own on both.

    Nothing that goes wrong here, such as a closed pipe, reaches the flight.

    Attributes:
        heard: Whether a vehicle was heard.
    """

    def __init__(self, plan: FlightPlan) -> None:
        self.heard = False
        self._plan = plan
        bar = [BarColumn(bar_width=24)] if err.width >= _WIDE else []
        self._bar = Progress(
            SpinnerColumn(), *bar, TextColumn("{task.description}"), console=err, transient=True, refresh_per_second=5
        )
        self._task = self._bar.add_task("starting", total=_total(plan.trajectory.duration_s))
        self._live = err.is_terminal and not err.is_dumb_terminal
        self._said = ""
        self._told = 0
        self._since_s: float | None = None
        self._again_s = _AGAIN_S

    def __enter__(self) -> Self:
        if self._live:
            self._bar.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        if self._live:
            with contextlib.suppress(OSError):
                self._bar.stop()

    def show(self, moment: Moment) -> None:
        """Show one moment."""
        self.heard = self.heard or moment.stage is not Stage.CONNECT
        stage = moment.stage.value
        if moment.returning and moment.stage is Stage.FLY:
            stage += " the last lap, then back"
        words = stage + (f": {moment.waiting_for}" if moment.waiting_for else "")
        behind = f" · does not keep up: {moment.behind_s:.1f} s behind" if moment.behind_s else ""
        if self._live:
            flying = 0.0 < moment.trajectory_s < moment.duration_s
            shown = printable(self._flying(moment) if flying else words)
            self._bar.update(
                self._task,
                description=escape(shown + behind),
                completed=moment.trajectory_s,
                total=_total(moment.duration_s),
            )
        elif line := self._line(stage, words, moment.t_s):
            self._print(line)
        for news in moment.told[self._told :]:
            self._print(printable(news))
        self._told = len(moment.told)

    @staticmethod
    def _print(line: str) -> None:
        with contextlib.suppress(OSError):
            err.print(line, markup=False)

    def _line(self, stage: str, words: str, now_s: float | None) -> str:
        """What is said where lines stay: each stage once, and what it waits for again after ever more seconds."""
        if stage != self._said:
            self._said, self._since_s, self._again_s = stage, now_s, _AGAIN_S
            return words
        if self._since_s is None:
            self._since_s = now_s
        waited_s = 0.0 if now_s is None or self._since_s is None else now_s - self._since_s
        if words == stage or waited_s < self._again_s:
            return ""
        self._again_s *= 2.0
        return f"{words} ({waited_s:.0f} s)"

    def _flying(self, moment: Moment) -> str:
        parts = [f"{moment.left_s:.0f} s left"] if math.isfinite(moment.left_s) else ["Ctrl-C returns"]
        parts.append(f"leg {moment.leg + 1}/{moment.legs}")
        if self._plan.run.recurrent:
            parts.append(_lap(moment))
        parts.append(f"automaton {moment.done}/{moment.total}")
        if moment.awaited:
            parts.append(f"waits for {' or '.join(moment.awaited)}")
        return " · ".join(parts)


def _lap(moment: Moment) -> str:
    asked = moment.laps_asked
    lap = moment.laps + 1 if asked is None else min(moment.laps + 1, asked)
    return f"lap {lap}{'' if asked is None else f'/{asked}'}{', then back' if moment.returning else ''}"


def _total(duration_s: float) -> float | None:
    """What a bar is out of; None where that is not known."""
    return duration_s if math.isfinite(duration_s) else None
