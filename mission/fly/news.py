"""What a flight has to tell to ground stations, in words and in figures."""

import math
from typing import Final

from mission.fly.result import Progress
from mission.link.announcer import Announcer, Severity
from mission.monitor.stage import Stage
from mission.monitor.verdict import Verdict

_FIGURES: Final = {Verdict.TRUE: 1.0, Verdict.OPEN: 0.0, Verdict.FALSE: -1.0}
_TOLD: Final = (Stage.TAKE_OFF, Stage.HOLD, Stage.TOUCH_DOWN)
"""Stages that those who watch would want to know of, beside the flight itself, and that last."""


class News:
    """Tells what has changed since it was told last.

    Args:
        announcer: Sends it.
        name: Of the mission.
    """

    def __init__(self, announcer: Announcer, name: str) -> None:
        self.announcer = announcer
        self._name = name
        self._told: Progress | None = None

    def say(self, text: str) -> None:
        """Tell something in its turn."""
        self.announcer.say(f"{self._name}: {text}")

    def frames(self, t_s: float, progress: Progress, state: int) -> list[bytes]:
        """What is to be sent at a vehicle time, with the state of the mission's automaton, -1 where it has none."""
        for text in self._changes(progress):
            self.say(text)
        if progress.verdict is Verdict.FALSE and (self._told is None or self._told.verdict is not Verdict.FALSE):
            self.announcer.say(f"{self._name}: what was flown violates the mission", Severity.WARNING)
        self._told = progress
        return self.announcer.frames(t_s, _figures(progress, state))

    def last_frames(self, t_s: float, progress: Progress, state: int, verdict: str, *, achieved: bool) -> list[bytes]:
        """The verdict, and what has not been sent yet."""
        head, severity = ("ACHIEVED", Severity.NOTICE) if achieved else ("NOT ACHIEVED", Severity.WARNING)
        self.announcer.say(f"{self._name}: {head}, {verdict}", severity)
        return self.announcer.last_frames(t_s, _figures(progress, state))

    def _changes(self, now: Progress) -> list[str]:
        before, told = self._told, []
        entered = before is None or before.stage is not now.stage
        if now.stage in _TOLD and entered:
            told.append(str(now.stage))
        if now.laps and (before is None or before.laps != now.laps):
            told.append(f"lap {now.laps}{'' if now.laps_asked is None else f' of {now.laps_asked}'} done")
        if now.stage is Stage.FLY and (entered or before is None or before.done != now.done):
            following = f", next {' or '.join(now.awaited)}" if now.awaited and now.done < now.total else ""
            told.append(f"{now.done} of {now.total} done{following}")
        for number, bound in enumerate(now.bounds):
            if bound.met is not None and (before is None or before.bounds[number : number + 1] != (bound,)):
                told.append(bound.text(now.since_s))
        if now.returning and (before is None or not before.returning):
            told.append("returning")
        return told


def _figures(progress: Progress, state: int) -> dict[str, float]:
    """By names of at most ten letters: seconds left, per cent flown, state, letters done, and the verdict so far."""
    share = progress.trajectory_s / progress.duration_s if progress.duration_s > 0.0 else 0.0
    until = {"ltl_left_s": progress.left_s} if math.isfinite(progress.left_s) else {}
    return {
        **until,
        "ltl_pct": 100.0 * min(max(share, 0.0), 1.0),
        "ltl_state": float(state),
        "ltl_done": float(progress.done),
        "ltl_so_far": _FIGURES[progress.verdict],
    }
