"""The progress of a flight on the terminal: the stage, the leg, the automaton, the time left; where the vehicle is."""

import contextlib
import math
from collections.abc import Iterator, Sequence
from types import TracebackType
from typing import Final, NamedTuple, Self

from rich.cells import cell_len
from rich.console import RenderableType
from rich.markup import escape
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn
from rich.table import Column
from rich.text import Text

from mission.cli.screen import err
from mission.fly import Progress as Moment
from mission.monitor.stage import Stage
from mission.plan import FlightPlan
from mission.printable import printable

_WIDE: Final = 100
_BAR: Final = 24
_MARGIN: Final = 4
"""Columns that stay empty: the terminal shows ``^C`` at the end of the last line, and nothing may go on in the next."""

_SPINNER: Final = 2
_AGAIN_S: Final = 10.0
_SEPARATOR: Final = " · "


class Part(NamedTuple):
    """Of a line; where there is no room for all, those with the largest numbers are left out.

    Attributes:
        words: What is said.
        rank: How soon it is left out.
    """

    words: str
    rank: int


class _Bar(Progress):
    """A bar, and a line of figures below.

    Attributes:
        figures: That line; empty where there is none.
    """

    figures = ""

    def get_renderables(self) -> Iterator[RenderableType]:
        """Both, each on a line of its own."""
        yield self.make_tasks_table(self.tasks)
        if self.figures:
            yield Text(f"{'':{_SPINNER}}{self.figures}", no_wrap=True, overflow="ellipsis")


class Display:
    """A bar that follows one flight; on what is no terminal, one line for each stage, and more where it takes long.

    On narrow terminals each line has fewer parts.

    What stages do not tell, of pilots and of other plans, has lines of its own on both.

    Nothing that goes wrong here, such as a closed pipe, reaches the flight.

    Attributes:
        heard: Whether a vehicle was heard.
    """

    def __init__(self, plan: FlightPlan) -> None:
        self.heard = False
        self._plan = plan
        bar = [BarColumn(bar_width=_BAR)] if err.width >= _WIDE else []
        self._taken = _MARGIN + _SPINNER + (_BAR + 1) * len(bar)
        words = TextColumn("{task.description}", table_column=Column(no_wrap=True, overflow="ellipsis"))
        self._bar = _Bar(SpinnerColumn(), *bar, words, console=err, transient=True, refresh_per_second=5)
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
        if self._live:
            flying = 0.0 < moment.trajectory_s < moment.duration_s
            shown = self._flying(moment) if flying else [Part(words, 0)]
            if moment.behind_s:
                shown.append(Part(f"does not keep up: {moment.behind_s:.1f} s behind", 1))
            self._bar.figures = fitted(figures(moment), err.width - _MARGIN - _SPINNER)
            self._bar.update(
                self._task,
                description=escape(fitted(shown, err.width - self._taken)),
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

    def _flying(self, moment: Moment) -> list[Part]:
        parts = [Part(f"{moment.left_s:.0f} s left" if math.isfinite(moment.left_s) else "Ctrl-C returns", 0)]
        parts.append(Part(f"leg {moment.leg + 1}/{moment.legs}", 4))
        if self._plan.run.recurrent:
            parts.append(Part(_lap(moment), 2))
        parts.append(Part(f"automaton {moment.done}/{moment.total}", 5))
        watched = [bound for bound in moment.bounds if bound.met is not True]
        parts += [Part(bound.text(moment.since_s), 2 if bound.met is None else 1) for bound in watched]
        if moment.awaited:
            parts.append(Part(f"waits for {' or '.join(moment.awaited)}", 3))
        return parts


def figures(moment: Moment) -> list[Part]:
    """Where the vehicle is and how it does, as far as that is known."""
    told = (
        ("{:.1f} m high", moment.altitude_m, 3),
        ("{:.1f} m/s", moment.speed_m_s, 4),
        ("error {:.2f} m", moment.error_m, 2),
        ("battery {:.0f} %", moment.battery_percent, 1),
    )
    near = [] if moment.nearest is None else [Part(f"{moment.nearest[1]:.1f} m from {moment.nearest[0]}", 0)]
    return [*(Part(words.format(value), rank) for words, value, rank in told if value is not None), *near]


def fitted(parts: Sequence[Part], width: int) -> str:
    """Parts in their order, as many as have room in so many columns; one at least, which is cut where it has none."""
    shown = [Part(printable(part.words), part.rank) for part in parts]
    while len(shown) > 1 and cell_len(_SEPARATOR.join(part.words for part in shown)) > width:
        shown.remove(max(shown, key=lambda part: part.rank))
    return _SEPARATOR.join(part.words for part in shown)


def _lap(moment: Moment) -> str:
    asked = moment.laps_asked
    lap = moment.laps + 1 if asked is None else min(moment.laps + 1, asked)
    return f"lap {lap}{'' if asked is None else f'/{asked}'}{', then back' if moment.returning else ''}"


def _total(duration_s: float) -> float | None:
    """What a bar is out of; None where that is not known."""
    return duration_s if math.isfinite(duration_s) else None
