"""Time as an argument: what the flight loop reads instead of the machine's clock."""

import time
from typing import Protocol


class Clock(Protocol):
    """A clock that never runs backwards; its zero means nothing."""

    def now_s(self) -> float:
        """Seconds, to be compared with other readings of the same clock only."""
        ...


class WallClock:
    """The machine's monotonic clock."""

    def now_s(self) -> float:
        """Seconds since some moment before the program began."""
        return time.monotonic()
