"""The time law s = sigma(t) that flies a curve r(s) within a vehicle's limits, from rest to rest.

The curve's parameter s is the steering time, so sigma' = 1 is the planned speed. The law is found in two steps.

1. The fastest law with sigma' <= 1 whose sigma'^2 =: b is piecewise linear in s. With proved bounds R1 >= |r'| and
   R2 >= |r''| on each cell of a grid, speed and acceleration

       |r'| sigma'                       <= R1 sqrt(b)               <= v_max
       |r'' sigma'^2 + r' sigma''|       <= R2 b + R1 |db/ds| / 2    <= a_max

   are linear in b, so one sweep forwards and one backwards give the largest b (the numerical integration of
   time-optimal path parametrisation, after Bobrow, Dubowsky and Gibson, 1985). It vanishes at both ends and
   wherever the vehicle is to stand still. On each cell sigma'' = (db/ds) / 2 is constant: all is exact.
2. The moving average of that law over a window of h seconds. It makes sigma twice continuously differentiable, with
   |sigma'''| <= 2 max |sigma''| / h, and takes h seconds more. At each instant its sigma' and sigma'' are averages
   over the window, and both inequalities are convex in them; R1 and R2 are taken as the largest over every cell
   within h of steering time, which is farther than the vehicle gets in the window. So the averages keep the limits.

Nothing is sampled, and nothing needs checking afterwards.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from mission.geometry.arrays import FloatArray, IntArray, frozen_floats
from mission.steering.joined import Curve, JoinedCurve

GRAVITY_M_S2 = 9.80665
_CELLS_PER_WAVE = 8
_FEWEST_CELLS = 256
_BISECTIONS = 60
_SAME_PLACE = 1e-9


@dataclass(frozen=True, eq=False)
class TimeLaw:
    """A monotone, twice continuously differentiable s = sigma(t), at rest at both ends and at every hold.

    It is the moving average, over ``window_s``, of a law whose rate is linear in time between knots.

    Attributes:
        knots_t_s: Shape (K + 1,), times of the law before averaging, from 0, never decreasing.
        knots_s: Shape (K + 1,), its steering time there, from 0, never decreasing.
        rates: Shape (K + 1,), its rate there, 0 at both ends.
        window_s: Length h of the averaging window.
    """

    knots_t_s: FloatArray
    knots_s: FloatArray
    rates: FloatArray
    window_s: float

    def __post_init__(self) -> None:
        for name in ("knots_t_s", "knots_s", "rates"):
            object.__setattr__(self, name, frozen_floats(getattr(self, name)))
        if not (len(self.knots_t_s) == len(self.knots_s) == len(self.rates) >= 2):  # noqa: PLR2004 - one piece
            raise ValueError("a time law needs two knots or more, with a time, a place and a rate each")
        if (np.diff(self.knots_t_s) < 0).any() or (np.diff(self.knots_s) < 0).any() or (self.rates < 0).any():
            raise ValueError("a time law never runs backwards")
        if not (math.isfinite(self.window_s) and self.window_s > 0):
            raise ValueError("the averaging window must be positive")

    @property
    def duration_s(self) -> float:
        """Time from the start of the flight of the curve to its end."""
        return float(self.knots_t_s[-1]) + self.window_s

    @cached_property
    def _integral(self) -> FloatArray:
        """Integral of the law from 0 to each knot, shape (K + 1,)."""
        steps = np.diff(self.knots_t_s)
        rises = (self.rates[1:] - self.rates[:-1]) / 6.0
        pieces = steps * (self.knots_s[:-1] + steps * (self.rates[:-1] / 2.0 + rises))
        return np.concatenate(([0.0], np.cumsum(pieces)))

    def _before_averaging(self, t_s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Integral, value and rate of the law before averaging, at any times (constant outside its span)."""
        piece = np.clip(np.searchsorted(self.knots_t_s, t_s, side="right") - 1, 0, len(self.knots_t_s) - 2)
        steps = np.diff(self.knots_t_s)[piece]
        elapsed = np.clip(t_s - self.knots_t_s[piece], 0.0, steps)
        rate, gain = self.rates[piece], np.diff(self.rates)[piece]
        growth = np.divide(gain, steps, out=np.zeros_like(gain), where=steps > 0)
        value = self.knots_s[piece] + elapsed * (rate + elapsed * growth / 2.0)
        integral = self._integral[piece] + elapsed * (
            self.knots_s[piece] + elapsed * (rate / 2.0 + elapsed * growth / 6.0)
        )
        integral += self.knots_s[-1] * np.maximum(0.0, t_s - self.knots_t_s[-1])
        inside = (t_s > 0.0) & (t_s < self.knots_t_s[-1])
        return integral, value, np.where(inside, rate + elapsed * growth, 0.0)

    def jet(self, t_s: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
        """sigma, sigma' and sigma'' at the times ``t_s`` (P,), each (P,); at rest outside its span."""
        times = np.clip(np.atleast_1d(np.asarray(t_s, dtype=np.float64)), 0.0, self.duration_s)
        late, early = self._before_averaging(times), self._before_averaging(times - self.window_s)
        place, rate, bend = ((a - b) / self.window_s for a, b in zip(late, early, strict=True))
        return np.clip(place, 0.0, self.knots_s[-1]), np.maximum(rate, 0.0), bend

    def parameter(self, t_s: ArrayLike) -> FloatArray:
        """sigma(t), the steering time at the times ``t_s`` (P,), shape (P,)."""
        return self.jet(t_s)[0]

    def time_at(self, s: ArrayLike) -> FloatArray:
        """The first time at which sigma reaches each steering time (P,), to 1e-9 s or better, shape (P,)."""
        asked = np.atleast_1d(np.asarray(s, dtype=np.float64))
        low, high = np.zeros(len(asked)), np.full(len(asked), self.duration_s)
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            reached = self.parameter(middle) >= asked
            low, high = np.where(reached, low, middle), np.where(reached, middle, high)
        return high

    def to_json(self) -> dict[str, Any]:
        """The law as JSON values; ``from_json`` gives it back bit by bit."""
        return {
            "knots_t_s": self.knots_t_s.tolist(),
            "knots_s": self.knots_s.tolist(),
            "rates": self.rates.tolist(),
            "window_s": self.window_s,
        }

    @staticmethod
    def from_json(data: Mapping[str, Any]) -> "TimeLaw":
        """The law that ``to_json`` wrote; raises KeyError, TypeError or ValueError where it is not one."""
        return TimeLaw(data["knots_t_s"], data["knots_s"], data["rates"], float(data["window_s"]))


def level_acceleration(acceleration_m_s2: float, tilt_rad: float) -> float:
    """The largest horizontal acceleration within both limits: tilted by an angle, level flight has g tan of it."""
    return min(acceleration_m_s2, GRAVITY_M_S2 * math.tan(tilt_rad))


def time_law(
    curve: Curve,
    *,
    speed_m_s: float,
    acceleration_m_s2: float,
    tilt_rad: float,
    holds: tuple[tuple[float, float], ...] = (),
    slow: tuple[tuple[float, float, float], ...] = (),
    window_s: float = 0.5,
) -> TimeLaw:
    """The fastest law of the module's kind that keeps the limits and is nowhere faster than planned.

    Args:
        curve: The smoothed path; where the pieces of one that is joined meet, the vehicle rests for a moment.
        speed_m_s: Largest horizontal speed.
        acceleration_m_s2: Largest horizontal acceleration.
        tilt_rad: Largest tilt; it bounds the acceleration by g tan(tilt) in level flight.
        holds: Pairs of a steering time in [0, T] and the seconds to stand still there; at one place the longest counts.
        slow: Triples of two steering times and the largest rate sigma' between them, positive.
        window_s: Averaging window, which bounds the jerk.

    Raises:
        ValueError: A limit that is not positive, or a hold outside the curve or of negative or infinite length.
    """
    limit = level_acceleration(acceleration_m_s2, tilt_rad)
    if not (speed_m_s > 0 and limit > 0 and 0 < tilt_rad < math.pi / 2):
        raise ValueError("limits of speed, acceleration and tilt must be positive")
    joints = curve.joints_s[1:-1].tolist() if isinstance(curve, JoinedCurve) else []
    stops = dict.fromkeys((0.0, *joints, curve.duration_s), 0.0)
    for place, seconds in holds:
        if not (0.0 <= place <= curve.duration_s and 0.0 <= seconds < math.inf):
            raise ValueError("a hold lies on the curve and lasts a finite time")
        # What lies closer together than the law can be resolved is one place.
        near = min(stops, key=lambda stop: abs(stop - place))
        stop = near if abs(near - place) <= _SAME_PLACE * curve.duration_s else place
        stops[stop] = max(stops.get(stop, 0.0), seconds)
    if not all(begin <= end and rate > 0.0 for begin, end, rate in slow):
        raise ValueError("where the vehicle is slow it goes on nevertheless")
    cells = _cells(curve, np.array(sorted(stops)), np.array(slow, dtype=np.float64).reshape(-1, 3), limit, window_s)
    squares = _largest_squares(cells, (speed_m_s, limit), np.array(sorted(stops)))
    holds_s = {s: seconds for s, seconds in stops.items() if seconds > 0 or s in joints}
    return _law(cells.grid, np.sqrt(squares), holds_s, window_s)


class _Cells(NamedTuple):
    """Cells of a curve: knots (K + 1,), bounds of |r'| and |r''|, and what sigma' is to be at most, (K,) each."""

    grid: FloatArray
    first: FloatArray
    second: FloatArray
    rates: FloatArray


def _cells(curve: Curve, stops: FloatArray, slow: FloatArray, limit: float, window_s: float) -> _Cells:
    """Cells that are fine where the vehicle starts and stops, and begin and end where it is to be slow.

    Each bound covers every place within ``window_s`` of steering time of its cell.
    """
    knots, _, slopes, bends = curve.sampled(max(_FEWEST_CELLS, _CELLS_PER_WAVE * curve.frequencies))
    # The cells that lie within the window of each, if only in part.
    low = np.searchsorted(knots, knots[:-1] - window_s, side="right") - 1
    high = np.searchsorted(knots, knots[1:] + window_s, side="left")
    near = np.stack((np.maximum(low, 0), np.minimum(high, len(knots) - 1)), axis=1).ravel()
    first, second = (
        np.maximum.reduceat(np.append(curve.norm_bounds(knots, order, values), 0.0), near)[::2]
        for order, values in ((1, slopes), (2, bends))
    )
    width = float(np.diff(knots).max())
    # Doubling distances from a stop, from an eighth of the shortest ramp to full speed up to the even grid's width.
    # A path that stays in one place has no ramp.
    ramp = max(float(first.max()) / (2.0 * limit), _SAME_PLACE * curve.duration_s)
    doublings = max(1, math.ceil(math.log2(max(2.0, 8.0 * width / ramp)))) + 1
    steps = ramp / 8.0 * 2.0 ** np.arange(doublings)
    near = (stops[:, None] + np.concatenate((-steps, [0.0], steps))).ravel()
    near = near[(near >= 0.0) & (near <= curve.duration_s)]
    ends = np.clip(slow[:, :2].ravel(), 0.0, curve.duration_s)
    # Between two stops there is a knot at which the vehicle moves.
    grid = np.union1d(np.union1d(knots, near), np.concatenate((0.5 * (stops[:-1] + stops[1:]), ends)))
    middles = 0.5 * (grid[:-1] + grid[1:])
    cell = np.clip(np.searchsorted(knots, middles, side="right") - 1, 0, len(first) - 1)
    rates = np.ones(len(middles))
    for (begin, end), rate in zip(np.searchsorted(middles, slow[:, :2]).tolist(), slow[:, 2].tolist(), strict=True):
        rates[begin:end] = np.minimum(rates[begin:end], rate)
    return _Cells(grid, first[cell], second[cell], rates)


def _largest_squares(cells: _Cells, limits: tuple[float, float], stops: FloatArray) -> FloatArray:
    """The largest b = sigma'^2 at the knots of the grid that keeps the limits on every cell, shape (K + 1,).

    Args:
        cells: The grid and the bounds.
        limits: Largest speed and acceleration.
        stops: Knots at which the vehicle stands still.
    """
    (grid, first, second, rates), (speed, limit) = cells, limits
    tiny = 1e-100  # against 0 / 0, and small enough that its square is no infinity
    of_cell = np.minimum(rates**2, np.minimum((speed / np.maximum(first, tiny)) ** 2, limit / np.maximum(second, tiny)))
    squares: FloatArray = np.minimum(np.append(of_cell, 1.0), np.append(1.0, of_cell))
    squares[np.searchsorted(grid, stops)] = 0.0
    slopes = first / (2.0 * np.diff(grid))
    # A cell may rise from b to at most (a_max + R1 b / (2 ds)) / (R2 + R1 / (2 ds)); falling is rising backwards.
    weights = slopes / np.maximum(second + slopes, tiny)
    gains = limit / np.maximum(second + slopes, tiny)
    for order in (1, -1):
        values, shares, rises = squares[::order].tolist(), weights[::order].tolist(), gains[::order].tolist()
        for i, (share, rise) in enumerate(zip(shares, rises, strict=True)):
            values[i + 1] = min(values[i + 1], share * values[i] + rise)
        squares = np.array(values, dtype=np.float64)[::order]
    return squares


def _law(grid: FloatArray, rates: FloatArray, holds: dict[float, float], window_s: float) -> TimeLaw:
    """The law with these rates at the knots of the grid, standing still where and as long as asked."""
    kept = _corners(rates, np.searchsorted(grid, sorted(holds)))
    grid, rates = grid[kept], rates[kept]
    times = np.concatenate(([0.0], np.cumsum(2.0 * np.diff(grid) / (rates[:-1] + rates[1:]))))
    for place, seconds in sorted(holds.items(), reverse=True):
        knot = int(np.searchsorted(grid, place))
        # The window sees both ends of a stop; it is lengthened so that the average, too, rests for the time asked.
        times = np.insert(times, knot + 1, times[knot])
        times[knot + 1 :] += seconds + window_s
        grid, rates = np.insert(grid, knot + 1, place), np.insert(rates, knot + 1, 0.0)
    return TimeLaw(times, grid, rates, window_s)


def _corners(rates: FloatArray, holds: IntArray) -> IntArray:
    """Indices of the knots that are needed: all but those in the middle of a stretch of constant rate."""
    same = np.diff(rates) == 0.0
    needed = np.concatenate(([True], ~(same[:-1] & same[1:]), [True]))
    needed[holds] = True
    return np.flatnonzero(needed)
