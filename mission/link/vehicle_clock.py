"""The vehicle's own time, as far as it can be known here.

Telemetry carries ``time_boot_ms``; between two messages the vehicle's time is extrapolated at the rate at which it
has been running against the clock here. So a simulator at 20 times real time, one in lock-step and a real vehicle are
flown by the same code. Two promises: the time shown never runs backwards, and it never runs more than ``AHEAD_S``
ahead of the newest telemetry, so that a vehicle whose clock stops is not left behind by its trajectory.

A time stamp that contradicts all before it, long past or far ahead of what has passed here, is a packet that strayed
or was garbled before it was sent, unless its successors go on from it: then the vehicle's clock was set, or began anew.
A step in the vehicle's clock is no time that has passed, so the time shown goes on from where it was.
"""

import math
from collections import deque
from dataclasses import dataclass
from typing import Final

from mission.monitor.gaps import GAP_S

AHEAD_S: Final = 0.2
"""Most vehicle time that is shown beyond the newest telemetry."""

_WINDOW_S: Final = 1.0
_SHORTEST_S: Final = 0.02
_MOST_SAMPLES: Final = 256
_WRAP_MS: Final = 1 << 32

_ODD_MS: Final = 3000
"""Further back no packet comes late; further ahead a stamp needs as much time here, at the rate of late, or half."""

_SUCCESSORS: Final = 5
_ANEW_MS: Final = 1000
_ANEW_LOCAL_S: Final = 0.2
"""A block of late packets goes on from its first one too, but it comes all at once."""


@dataclass(slots=True)
class _Other:
    """Time stamps that contradict the vehicle's time, and go on from each other."""

    first_ms: int
    last_ms: int
    since_s: float
    successors: int = 0


class VehicleClock:
    """Follows one vehicle's clock; the local time is an argument everywhere.

    Attributes:
        restarted: Whether the vehicle's clock was seen to begin anew: the vehicle was rebooted.
    """

    def __init__(self) -> None:
        """Start without having heard of the vehicle's time."""
        self.restarted = False
        self._samples: deque[tuple[float, float]] = deque(maxlen=_MOST_SAMPLES)
        self._newest_ms: int | None = None
        self._stamp_ms = 0
        self._other: _Other | None = None
        self._rate = 0.0
        self._shown_s = 0.0
        self._shown_at_s: float | None = None
        self._seen_s = 0.0

    @property
    def rate(self) -> float:
        """Vehicle seconds in each local second; 0 until two moments are known."""
        return self._rate

    @property
    def heard_s(self) -> float:
        """When the newest time was heard, on the clock here; minus infinity before the first."""
        return self._samples[-1][0] if self._samples else -math.inf

    @property
    def newest_s(self) -> float | None:
        """The newest time that the vehicle itself has told; None before the first."""
        return None if self._newest_ms is None else self._newest_ms / 1000.0

    @property
    def seen_s(self) -> float:
        """How much vehicle time was seen to pass: a gap, in which nothing was heard, counts no more than ``GAP_S``.

        So what must not last is judged alike whichever message comes first after a gap.
        """
        return self._seen_s

    def unwrapped_s(self, time_boot_ms: int) -> float:
        """The vehicle time that a time stamp means: its 32 bits wrap after 49.7 days."""
        if self._newest_ms is None:
            return time_boot_ms / 1000.0
        return (self._newest_ms + _later_by_ms(time_boot_ms, self._stamp_ms)) / 1000.0

    def observe(self, time_boot_ms: int, local_s: float) -> bool:
        """Take a time stamp that arrived at ``local_s``; late ones, reordered on the way, change nothing.

        Returns:
            False where it contradicts those before it, so that what came with it is not to be believed.
        """
        if self._newest_ms is None:
            self._go_on(time_boot_ms, time_boot_ms, local_s)
            return True
        later = _later_by_ms(time_boot_ms, self._stamp_ms)
        if -_ODD_MS <= later <= self._most_ahead_ms(local_s):
            if later > 0:
                self._other = None
                self._go_on(self._newest_ms + later, time_boot_ms, local_s)
            return True
        return self._go_over(time_boot_ms, local_s, begins_anew=later < 0)

    def _most_ahead_ms(self, local_s: float) -> float:
        elapsed_s = local_s - self._samples[-1][0]
        return _ODD_MS + 2000.0 * self._rate * max(elapsed_s, 0.0)

    def _go_over(self, time_boot_ms: int, local_s: float, *, begins_anew: bool) -> bool:
        """Whether a stamp that contradicts the others has enough before it to be followed instead of them."""
        other, newest_ms = self._other, self._newest_ms or 0
        step = 0 if other is None else _later_by_ms(time_boot_ms, other.last_ms)
        if other is None or abs(step) > _ODD_MS:
            self._other = _Other(time_boot_ms, time_boot_ms, local_s)
            return False
        if step <= 0:
            return False
        other.last_ms = time_boot_ms
        other.successors += 1
        passed_ms = _later_by_ms(other.last_ms, other.first_ms)
        anew = passed_ms >= _ANEW_MS and local_s - other.since_s >= _ANEW_LOCAL_S
        if other.successors < _SUCCESSORS or (begins_anew and not anew):
            return False
        self.restarted |= begins_anew and len(self._samples) > 1  # or else the first one of all was astray
        self._other = None
        self._samples.clear()
        self._go_on(newest_ms + passed_ms, time_boot_ms, local_s)
        return True

    def _go_on(self, newest_ms: int, stamp_ms: int, local_s: float) -> None:
        passed_ms = 0 if self._newest_ms is None else newest_ms - self._newest_ms
        self._seen_s += min(passed_ms / 1000.0, GAP_S)
        self._newest_ms, self._stamp_ms = newest_ms, stamp_ms
        self._shown_at_s = None
        samples = self._samples
        samples.append((local_s, newest_ms / 1000.0))
        while len(samples) > 2 and local_s - samples[1][0] >= _WINDOW_S:  # noqa: PLR2004 - a rate needs two
            samples.popleft()
        elapsed = local_s - samples[0][0]
        if elapsed >= _SHORTEST_S:  # what came in one burst says nothing about the rate
            self._rate = (samples[-1][1] - samples[0][1]) / elapsed

    def now_s(self, local_s: float) -> float | None:
        """The vehicle's time at ``local_s``; None before the vehicle has told any."""
        if local_s == self._shown_at_s:  # as where nothing was heard in between
            return self._shown_s
        if not self._samples:
            return None
        heard_s, told_s = self._samples[-1]
        ahead = min(max(local_s - heard_s, 0.0) * self._rate, AHEAD_S)
        self._shown_s, self._shown_at_s = max(self._shown_s, told_s + ahead), local_s
        return self._shown_s

    def ago_s(self, local_s: float, for_s: float) -> float:
        """Vehicle time so long before ``local_s``; minus infinity before the vehicle has told any."""
        return (self.now_s(local_s) or -math.inf) - for_s

    def local_until(self, vehicle_s: float, local_s: float) -> float:
        """How long from ``local_s`` until this vehicle time is shown; infinite where only telemetry can bring it."""
        now = self.now_s(local_s)
        if now is None:
            return float("inf")
        if vehicle_s <= now:
            return 0.0
        heard_s, told_s = self._samples[-1]
        if self._rate <= 0.0 or vehicle_s > told_s + AHEAD_S:
            return float("inf")
        return max(heard_s + (vehicle_s - told_s) / self._rate - local_s, 0.0)


def _later_by_ms(stamp_ms: int, than_ms: int) -> int:
    """How much later the one of two time stamps is, of 32 bits that wrap after 49.7 days; negative where earlier."""
    return (stamp_ms - than_ms + _WRAP_MS // 2) % _WRAP_MS - _WRAP_MS // 2
