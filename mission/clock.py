"""Time as an argument: what the flight loop reads instead of the machine's clock."""

import time
from typing import Final, Protocol

_LONGEST_S: Final = 1.0
"""Between two looks at the clock; a program that waits looks twenty times a second."""


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


class SteadyClock:
    """A clock in which hardly any time passes that this program did not live through.

    Where two looks at it are far apart, the program stood still (it planned, or the machine slept) or the clock was
    set: silence of that length tells nothing about a vehicle. So it leaps by a second at most, and never runs
    backwards.

    Attributes:
        left_out_s: How much was left out so far, backward steps included.
    """

    def __init__(self, clock: Clock) -> None:
        """Go on from what the clock shows now."""
        self._clock = clock
        self._shown_s = self._seen_s = clock.now_s()
        self.left_out_s = 0.0

    def now_s(self) -> float:
        """Seconds that passed for this program, from what the clock showed at first."""
        seen_s = self._clock.now_s()
        if seen_s == self._seen_s:
            return self._shown_s
        passed_s, self._seen_s = seen_s - self._seen_s, seen_s
        counted_s = min(max(passed_s, 0.0), _LONGEST_S)
        self._shown_s += counted_s
        self.left_out_s += abs(passed_s - counted_s)
        return self._shown_s


class TimeOfDay:
    """What time of the day it is by another clock, as by a vehicle's that runs faster than the machine's."""

    def __init__(self, clock: Clock, now_us: int | None = None) -> None:
        """Let it be ``now_us`` now, microseconds since 1970; by default, what the machine says."""
        self._clock, self._began_s = clock, clock.now_s()
        self._began_us = time.time_ns() // 1000 if now_us is None else now_us

    def us(self) -> int:
        """Microseconds since 1970."""
        return self._began_us + round((self._clock.now_s() - self._began_s) * 1e6)
