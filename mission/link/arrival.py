"""When what is sent now arrives, by the vehicle's clock as it is shown here: measured by TIMESYNC.

Protocol: https://mavlink.io/en/services/timesync.html. A request carries a time of ours (``ts1``), the answer the same
and the vehicle's time when it took the request (``tc1``, since boot in ArduPilot and PX4, as ``time_boot_ms``). The
time that is shown here is older than the vehicle's by the way down, and what is sent arrives later by the way up:
``tc1`` less what was shown when the request was sent is both together, whatever the share of each. Where the two
clocks of a vehicle do not agree, it lies between 0 and the time from the request to its answer in any case.

Only an answer to a request of ours counts, once, and the median of the last ones: so what is lost, doubled, late or
out of order costs a sample at most.

A request that came twice is answered twice, both times before the second answer is heard. Answers that tell of times
farther apart than that allows are of two vehicles with one system id.
"""

import math
from collections import OrderedDict, deque
from statistics import median
from typing import Final

from mission.link.values import TimeAnswer
from mission.link.vehicle_clock import VehicleClock
from mission.monitor.gaps import GAP_S

ASK_S: Final = 0.2
"""Vehicle time between two requests."""

MOST_S: Final = 5.0
"""An answer that takes longer is none."""

_APART_S: Final = 1.0
_APART: Final = 3
"""So far apart, of time here, and so many of them: how long a way takes may change meanwhile."""

_SAMPLES: Final = 9
_WAITING: Final = 64
_FIRST: Final = 3
_SLEWS: Final = 0.2
"""A second of vehicle time changes the delay that is reckoned with by so much while a trajectory is flown.

So much faster than the trajectory do setpoints go meanwhile. With half of that, a jump by half a second each way costs
1.2 m.
"""


class Arrival:
    """The delay of what is sent.

    Attributes:
        delay_s: From the vehicle's time that is shown here to that at which what is sent now arrives; 0 before it is
            known.
        largest_s: The largest that was measured.
        asked: How many requests were sent.
        answered: How many of them were answered; the others were lost, there or on the way back, or still wait.
    """

    def __init__(self, clock: VehicleClock) -> None:
        """Know nothing yet; ``clock`` shows the vehicle's time."""
        self.delay_s = 0.0
        self.largest_s = 0.0
        self.asked = self.answered = 0
        self._clock = clock
        self._asked: OrderedDict[int, float] = OrderedDict()
        self._first_told: OrderedDict[int, tuple[float, int]] = OrderedDict()
        self._apart = 0
        self._seen: deque[float] = deque(maxlen=_SAMPLES)
        self._asked_s: float | None = None
        self._followed_s = math.inf

    def due(self, now_s: float) -> int | None:
        """The request to send now, ``ts1`` in ns; None where none is due.

        Args:
            now_s: The time here.
        """
        shown_s = self._clock.now_s(now_s)
        if shown_s is None or (self._asked_s is not None and shown_s - self._asked_s < ASK_S):
            return None
        stamp = max(round(now_s * 1e9), *self._asked, 0) + 1  # another one for each, and never 0
        self._asked_s = self._asked[stamp] = shown_s
        self.asked += 1
        if len(self._asked) > _WAITING:
            self._asked.popitem(last=False)
        return stamp

    def take(self, answer: TimeAnswer, now_s: float) -> None:
        """Learn from an answer; one that was not asked for, or came already, or too late, changes nothing."""
        if answer.asked_ns in self._first_told:
            self._compare(answer, *self._first_told[answer.asked_ns], now_s)
            return
        asked_s, shown_s = self._asked.pop(answer.asked_ns, None), self._clock.now_s(now_s)
        if answer.told_ns == 0 or asked_s is None or shown_s is None or shown_s - asked_s > MOST_S:
            return
        self.answered += 1
        self._first_told[answer.asked_ns] = asked_s, answer.told_ns
        if len(self._first_told) > _WAITING:
            self._first_told.popitem(last=False)
        told_s = self._clock.unwrapped_s(answer.told_ns // 1_000_000 & 0xFFFFFFFF)
        self._seen.append(min(max(told_s - asked_s, 0.0), shown_s - asked_s))
        if len(self._seen) >= _FIRST:
            self.largest_s = max(self.largest_s, self.measured_s)

    def _compare(self, answer: TimeAnswer, asked_s: float, told_ns: int, now_s: float) -> None:
        """Compare a further answer with the first one to the same request."""
        passed_s = (self._clock.now_s(now_s) or asked_s) - asked_s + _APART_S * max(self._clock.rate, 1.0)
        self._apart += abs(answer.told_ns - told_ns) > passed_s * 1e9

    @property
    def doubled(self) -> bool:
        """Whether two vehicles answer."""
        return self._apart >= _APART

    @property
    def measured_s(self) -> float:
        """The median of the last measurements; 0 before there are enough."""
        return median(self._seen) if len(self._seen) >= _FIRST else 0.0

    def settle(self) -> float:
        """Reckon with what is measured from now on: nothing moves that could leap."""
        self.delay_s = self.measured_s
        return self.delay_s

    def follow(self, shown_s: float) -> float:
        """Reckon with what is measured as far as may be at this time of the vehicle."""
        most = _SLEWS * min(max(shown_s - self._followed_s, 0.0), GAP_S)
        self._followed_s = shown_s
        self.delay_s += min(max(self.measured_s - self.delay_s, -most), most)
        return self.delay_s
