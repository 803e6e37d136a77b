"""The progress of a flight on the terminal: the stage, the leg, the automaton, the time left."""

from types import TracebackType
from typing import Self

from rich.markup import escape
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn

from mission.cli.screen import err
from mission.fly import Progress as Moment
from mission.plan import FlightPlan


class Display:
    """A bar that follows one flight; on what is no terminal, one line for each stage."""

    def __init__(self, plan: FlightPlan) -> None:
        self._plan = plan
        self._bar = Progress(
            SpinnerColumn(), TextColumn("{task.description}"), BarColumn(bar_width=24), console=err, transient=True
        )
        self._task = self._bar.add_task("starting", total=plan.trajectory.duration_s)
        self._said = ""

    def __enter__(self) -> Self:
        if err.is_terminal:
            self._bar.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._bar.stop()

    def show(self, moment: Moment) -> None:
        """Show one moment."""
        words = moment.stage.value
        if moment.waiting_for:
            words += f": {moment.waiting_for}"
        if not err.is_terminal:
            if words != self._said:
                err.print(words, markup=False)
            self._said = words
            return
        flying = 0.0 < moment.trajectory_s < moment.duration_s
        shown = self._flying(moment) if flying else words
        self._bar.update(self._task, description=escape(shown), completed=moment.trajectory_s, total=moment.duration_s)

    def _flying(self, moment: Moment) -> str:
        parts = [f"leg {moment.leg + 1}/{moment.legs}", f"automaton {moment.done}/{moment.total}"]
        if self._plan.run.recurrent:
            parts.append(f"lap {min(moment.laps + 1, self._plan.spec.flight.laps)}/{self._plan.spec.flight.laps}")
        if moment.awaited:
            parts.append(f"waits for {' or '.join(moment.awaited)}")
        parts.append(f"{moment.left_s:.0f} s left")
        return " · ".join(parts)
