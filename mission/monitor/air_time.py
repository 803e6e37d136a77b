"""The time from arming to landing while it runs: what `flight.longest_s` asks for, of a whole flight."""

from mission.monitor.monitor import Outcome
from mission.monitor.stage import ALOFT, LANDED, Stage
from mission.monitor.time_bounds import BoundNow
from mission.spec.air_time import longest_text


class AirWatch:
    """Follows the time of one flight, by whichever plans it is flown.

    Args:
        longest_s: How long it may be; None for as long as it takes.
    """

    def __init__(self, longest_s: float | None) -> None:
        self._longest_s = longest_s
        self._armed_s: float | None = None
        self._began_s: float | None = None
        self._last_s = 0.0
        self._landed = False

    def report(self, stage: Stage | None, t_s: float) -> None:
        """Take a report into account that came in a stage; None before the first."""
        if self._armed_s is None:
            self._armed_s = t_s if stage in ALOFT else None
        elif not self._landed:
            self._last_s, self._landed = t_s, stage in LANDED
        if self._began_s is None and stage is Stage.FLY:
            self._began_s = t_s

    @property
    def now(self) -> tuple[BoundNow, ...]:
        """What is known of it, by the clock of the trajectory; nothing where nothing is asked for."""
        if self._longest_s is None:
            return ()
        name, taken_s = longest_text(self._longest_s), self._taken_s
        if self._landed or taken_s > self._longest_s:
            return (BoundNow(name, taken_s <= self._longest_s, None),)
        if self._armed_s is None or self._began_s is None:
            return (BoundNow(name, None, None),)
        return (BoundNow(name, None, self._armed_s + self._longest_s - self._began_s, will=False),)

    def judged(self, outcome: Outcome) -> Outcome:
        """A verdict on the flight as if it ended now, with what becomes of this."""
        if not outcome.achieved or self._longest_s is None or self._taken_s <= self._longest_s:
            return outcome
        return Outcome(
            achieved=False,
            reason=f"{longest_text(self._longest_s)} was missed: from arming to landing were {self._taken_s:.1f} s",
        )

    @property
    def _taken_s(self) -> float:
        """From arming to landing, or up to the last report."""
        return 0.0 if self._armed_s is None else max(self._last_s - self._armed_s, 0.0)
