"""The least time from lane to lane, or from and to a rest: a lower bound by convex programmes, without the planner.

A flight p(t) keeps |p'| <= V, |p''| <= A and |p'''| <= J. Its divided differences of order k over any knots, times k!,
are means of its k-th derivative weighted by a B-spline (Peano), and so within the same limits, whatever it does between
the knots: what follows is necessary for every flight. Knots are even in time, and threefold where a lane ends or
begins, or the vehicle rests: there velocity and acceleration are known to lie along the lane, or to be none. Twice as
many knots can only raise the bound, as coarse differences are means of finer ones.

For a given duration this is a second-order cone programme. The duration is bisected: let it be between T1 and T2, and
h = T / n the time between knots, a variable of the programme; of h^2 and h^3, which the limits are multiplied with,
the chords from T1 to T2 are taken, which are above. The interval of the least bound is halved until that is narrow.
"""

import heapq
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import clarabel
import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

Floats = NDArray[np.float64]

INTERVALS = 20
_FACTORIALS = (1.0, 1.0, 2.0, 6.0)
_ORDERS = 3
NARROW_S = 0.03
_WIDENING, _WIDER_S = 1.3, 0.2  # of the intervals of durations


@dataclass(frozen=True)
class Pace:
    """How fast the vehicle is; without an acceleration, lengths are counted for times."""

    speed_m_s: float = 1.0
    acceleration_m_s2: float = np.inf
    jerk_m_s3: float = np.inf

    @property
    def limited(self) -> bool:
        return bool(np.isfinite(self.acceleration_m_s2))

    @property
    def settles_s(self) -> float:
        """What it takes to come to full speed from rest; half of that is lost."""
        least = self.acceleration_m_s2**2 / self.jerk_m_s3
        if self.speed_m_s < least:
            return 2.0 * math.sqrt(self.speed_m_s / self.jerk_m_s3)
        return self.speed_m_s / self.acceleration_m_s2 + self.acceleration_m_s2 / self.jerk_m_s3


@dataclass(frozen=True)
class End:
    """How the way begins or ends that is bounded.

    Attributes:
        angle_rad: Of the lane that is left, or begun; any number where there is none.
        window_s: How long the vehicle is on the lane at full speed, before that or after it: what it loses there by
            being slower counts; None where there is no lane.
        rests: Whether the vehicle rests there, instead of flying through, however fast, to wherever.
    """

    angle_rad: float = 0.0
    window_s: float | None = None
    rests: bool = False

    def lane_knots(self, step_s: float) -> int:
        return 0 if self.window_s is None else int(self.window_s / step_s + 1e-9)


@dataclass(frozen=True, eq=False)
class _Programme:
    """What does not depend on the duration.

    Variables are places on the lane before (from its end, backwards), speed and growth of speed there, places between,
    shape (n - 1, 2), the way's end, places on the lane after that (likewise), and the time between knots.

    Attributes:
        count: Of variables.
        end: The first of two, the place where the way ends.
        last: The place farthest out on the lane after it.
        derivatives: For each order, shape (m, 2, count).
    """

    count: int
    end: int
    last: int
    derivatives: tuple[Floats, ...]


@lru_cache(maxsize=512)
def _programme(leave: End, arrive: End, intervals: int, before: int, after: int) -> _Programme:
    speed, inner = before, before + 2
    end = inner + 2 * (intervals - 1)
    beyond = end + 2
    count = beyond + after + 3

    def along(variable: int, angle_rad: float) -> Floats:
        row = np.zeros((2, count))
        row[:, variable] = math.cos(angle_rad), math.sin(angle_rad)
        return row

    def plane(variable: int) -> Floats:
        row = np.zeros((2, count))
        row[0, variable] = row[1, variable + 1] = 1.0
        return row

    known: dict[int, tuple[Floats, Floats]] = {}  # first derivative and half of the second where knots are threefold
    knots = [(-k, along(k - 1, leave.angle_rad)) for k in range(before, 0, -1)]
    for time, place, side, variable in (
        (0, np.zeros((2, count)), leave, speed),
        (intervals, plane(end), arrive, beyond + after),
    ):
        if side.window_s is not None or side.rests:
            moves = 0.0 if side.rests else 1.0
            first, second = along(variable, side.angle_rad), along(variable + 1, side.angle_rad)
            known[time] = moves * first, 0.5 * moves * second
        knots += [(time, place)] * (3 if time in known else 1)
        if time == 0:
            knots += [(i, plane(inner + 2 * (i - 1))) for i in range(1, intervals)]
    knots += [(intervals + k, plane(end) + along(beyond + k - 1, arrive.angle_rad)) for k in range(1, after + 1)]
    times, found = np.array([time for time, _ in knots], dtype=np.float64), []
    values = np.array([value for _, value in knots])
    for order in range(1, _ORDERS + 1):
        gaps = times[order:] - times[:-order]
        differences = np.diff(values, axis=0) / np.where(gaps > 0.0, gaps, 1.0)[:, None, None]
        for i in np.flatnonzero(gaps == 0.0):
            differences[i] = known[int(times[i])][order - 1]
        values = differences
        found.append(_FACTORIALS[order] * values)
    return _Programme(count, end, beyond + after - 1, tuple(found))


@dataclass(frozen=True)
class Way:
    """What is bounded: from the origin to a box.

    Attributes:
        leave: How the origin is left.
        arrive: How the box is arrived in.
        box_m: Least and largest x, least and largest y.
        pace: How fast the vehicle is.
        intervals: Into how many the time between is divided.
        narrow_s: How far apart the least and the largest duration of one programme may be in the end.
    """

    leave: End
    arrive: End
    box_m: tuple[float, float, float, float]
    pace: Pace
    intervals: int = INTERVALS
    narrow_s: float = NARROW_S

    def lasts_s(self, shortest_s: float, longest_s: float) -> float:
        """What a way of such a duration takes at least, with what is lost on lanes; infinite where there is none."""
        n, first, last = self.intervals, shortest_s / self.intervals, longest_s / self.intervals
        before, after = self.leave.lane_knots(last), self.arrive.lane_knots(last)
        programme = _programme(self.leave, self.arrive, n, before, after)
        step, pace = programme.count - 1, self.pace
        bounds = np.zeros((6, programme.count))
        bounds[[0, 1], step] = bounds[[2, 3], programme.end] = bounds[[4, 5], programme.end + 1] = 1.0, -1.0
        rows, offsets = [bounds], [last, -first, self.box_m[1], -self.box_m[0], self.box_m[3], -self.box_m[2]]
        cones = [clarabel.NonnegativeConeT(6)]
        # h^k is at most slope h + rest between the least and the largest h.
        chords = ((1.0, 0.0), (first + last, -first * last), _cubic_chord(first, last))
        limits = (pace.speed_m_s, pace.acceleration_m_s2, pace.jerk_m_s3)
        for order, (limit, (slope, rest)) in enumerate(zip(limits, chords, strict=True), start=1):
            derivatives = programme.derivatives[order - 1]
            if not np.isfinite(limit):
                continue
            unit = 1.0 / last**order
            block = np.zeros((len(derivatives), 3, programme.count))
            block[:, 0, step] = -slope * unit
            block[:, 1:] = -derivatives * (unit / limit)
            rows.append(block.reshape(-1, programme.count))
            offsets += [rest * unit, 0.0, 0.0] * len(derivatives)
            cones += [clarabel.SecondOrderConeT(3)] * len(derivatives)
        cost = np.zeros(programme.count)
        cost[step] = n + before + after
        if before:
            cost[before - 1] = 1.0 / pace.speed_m_s
        if after:
            cost[programme.last] = -1.0 / pace.speed_m_s
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        matrix = sp.csc_matrix(np.concatenate(rows))
        none = sp.csc_matrix((programme.count, programme.count))
        solution = clarabel.DefaultSolver(none, cost, matrix, np.array(offsets), cones, settings).solve()
        if str(solution.status) == "PrimalInfeasible":
            return np.inf
        # The dual is below the least; where it was not found, what is known without is taken.
        return float(solution.obj_val_dual) if str(solution.status) == "Solved" else shortest_s

    def _durations(self) -> Iterator[tuple[float, float]]:
        left, right, low, high = self.box_m
        begin = math.hypot(max(left, -right, 0.0), max(low, -high, 0.0)) / self.pace.speed_m_s
        while True:
            end = _WIDENING * begin + _WIDER_S
            yield begin, end
            begin = end

    def least_s(self) -> float:
        """The least of all durations."""
        spans: list[tuple[float, float, float]] = []
        longer = self._durations()
        begin, end = next(longer)
        while True:
            # A longer way takes as long at least.
            if not spans or spans[0][0] > begin:
                heapq.heappush(spans, (self.lasts_s(begin, end), begin, end))
                begin, end = next(longer)
                continue
            least, first, last = heapq.heappop(spans)
            if last - first <= self.narrow_s:
                return least
            middle = 0.5 * (first + last)
            for span in ((first, middle), (middle, last)):
                heapq.heappush(spans, (max(self.lasts_s(*span), least), *span))


def _cubic_chord(first: float, last: float) -> tuple[float, float]:
    return first**2 + first * last + last**2, -first * last * (first + last)


@lru_cache(maxsize=4096)
def least_s(way: Way) -> float:
    """What a way takes at least."""
    return way.least_s()
