"""How fast the trajectory is gone along: at its own pace, or slower where the vehicle does not keep up.

Trajectory time s is a function of vehicle time t that is linear in pieces, s' = rate, and never runs backwards. The
rate is 1 but where the vehicle is off by more than a share of the tube; there it falls, down to ``LEAST_RATE`` at the
edge of the tube. What the vehicle is ahead of the trajectory does not count: to slow down there would bring it farther
ahead. The path stays the same, so does what is proved of it: only when its points are asked for changes.

With the path r(s), the velocity asked for is r' s', and the acceleration r'' s'^2 + r' s''. The last term brakes by no
more than ``_BRAKING_M_S2``, and by what the trajectory itself accelerates there.
"""

import math
from collections import deque
from typing import Final, NamedTuple

from mission.link.course import Reference
from mission.monitor.gaps import GAP_S

LEAST_RATE: Final = 0.3

_EASY: Final = 0.4
"""Share of the tube within which the trajectory keeps its pace."""

_HARD: Final = 0.95
"""Share of the tube at which it has the least one."""

_RESPONSE_S: Final = 0.5
_BRAKING_M_S2: Final = 1.0
_SLOWEST_M_S: Final = 0.3
_MOST_PIECES: Final = 512


class Beat(NamedTuple):
    """Trajectory time from a vehicle time on, until the next beat.

    Attributes:
        from_s: Vehicle time.
        trajectory_s: Trajectory time then.
        rate: Its growth from then on.
        growth_per_s: How fast the rate itself grew there.
    """

    from_s: float
    trajectory_s: float
    rate: float
    growth_per_s: float


class Pace:
    """The trajectory's time, which begins with the first call of ``begin``; minus infinity before."""

    def __init__(self, tube_m: float) -> None:
        """Keep to the trajectory's own pace where the vehicle stays inside ``tube_m``; always, if that is 0."""
        self._tube_m = tube_m
        self._adapted_s = math.inf
        self._beats: deque[Beat] = deque((Beat(math.inf, 0.0, 1.0, 0.0),), maxlen=_MOST_PIECES)

    def begin(self, at_s: float) -> None:
        """Let trajectory time be 0 at a vehicle time."""
        self._beats.clear()
        self._beats.append(Beat(at_s, 0.0, 1.0, 0.0))

    def beat(self, at_s: float) -> Beat:
        """What holds at a vehicle time; before the first piece that is remembered, the first one."""
        for beat in reversed(self._beats):  # mostly the last one
            if beat.from_s <= at_s:
                return beat
        return self._beats[0]

    def elapsed_s(self, at_s: float) -> float:
        """Trajectory time at a vehicle time; negative before its start."""
        beat = self.beat(at_s)
        return beat.trajectory_s + beat.rate * (at_s - beat.from_s)

    def pause(self, from_s: float, until_s: float) -> None:
        """Let trajectory time stand between two vehicle times, the second of which is now."""
        stood_s, before = self.elapsed_s(from_s), self.beat(from_s)
        while self._beats and self._beats[-1].from_s >= from_s:
            self._beats.pop()
        self._beats.append(Beat(from_s, stood_s, 0.0, 0.0))
        self._beats.append(Beat(until_s, stood_s, before.rate, 0.0))

    def keep(self, at_s: float) -> None:
        """Go on from a vehicle time, not before the last beat, at the rate that holds there."""
        beat = self.beat(at_s)
        if beat.growth_per_s and math.isfinite(beat.from_s):
            self._beats.append(Beat(at_s, self.elapsed_s(at_s), beat.rate, 0.0))

    def adapt(self, at_s: float, error_m: float, most_rate: float, own: Reference, calm: float = 1.0) -> None:
        """Go on from now at the rate that the error asks for.

        Args:
            at_s: Vehicle time, not before that of the last call.
            error_m: The larger of the distances on the axes, as it was reported last, less what is ahead.
            most_rate: The rate at which the vehicle can fly what comes next.
            own: The point of the trajectory at its own pace.
            calm: Less than 1 where the error is that of long ago: the rate follows it more slowly by this factor.
        """
        passed_s = min(max(at_s - self._adapted_s, 0.0), GAP_S)
        self._adapted_s = at_s
        beat, wanted = self.beat(at_s), max(min(self._wanted(error_m), most_rate), LEAST_RATE)
        if wanted == beat.rate == 1.0:
            if beat.growth_per_s:
                self._beats.append(Beat(at_s, self.elapsed_s(at_s), 1.0, 0.0))
            return
        speed_m_s = max(math.hypot(*own.velocity_m_s), _SLOWEST_M_S)
        gained_m_s2 = sum(v * a for v, a in zip(own.velocity_m_s, own.acceleration_m_s2, strict=True)) / speed_m_s
        up, down = _BRAKING_M_S2, _BRAKING_M_S2 + max(beat.rate**2 * gained_m_s2, 0.0)
        growth = max(-down / speed_m_s, min(calm * (wanted - beat.rate) / _RESPONSE_S, up / speed_m_s))
        rate = beat.rate + growth * passed_s
        rate, growth = (1.0, 0.0) if rate > 1.0 - 1e-3 and wanted == 1.0 else (max(rate, LEAST_RATE), growth)
        self._beats.append(Beat(at_s, self.elapsed_s(at_s), rate, growth))

    def _wanted(self, error_m: float) -> float:
        if self._tube_m == 0.0 or error_m <= _EASY * self._tube_m:
            return 1.0
        return 1.0 - (1.0 - LEAST_RATE) * (error_m / self._tube_m - _EASY) / (_HARD - _EASY)
