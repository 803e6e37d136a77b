"""Watches for a local frame that moves under a flight: every setpoint would mean another place."""

import math
from typing import Final

from mission.link.values import Origin

_AGAIN_S: Final = 0.2
"""On the clock here: what comes sooner is the same report, twice on its way. Until then it is asked for."""


class OriginWatch:
    """Compares what is told of the origin with what the flight began with; one report may be astray."""

    def __init__(self, began_with: Origin | None) -> None:
        """Begin."""
        self._began_with = began_with
        self._moved_s = math.inf

    @property
    def doubts(self) -> bool:
        """Whether the last report was of another place, so that the origin is to be told again."""
        return math.isfinite(self._moved_s)

    def moved(self, origin: Origin, now_s: float) -> bool:
        """Take a report; whether it confirms that the origin is elsewhere."""
        if self._began_with is None or not origin.is_elsewhere(self._began_with):
            self._moved_s = math.inf
            return False
        self._moved_s = min(self._moved_s, now_s)
        return now_s - self._moved_s >= _AGAIN_S
