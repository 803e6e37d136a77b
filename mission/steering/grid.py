"""A curve, or a part of one, in cells, with what is known of its derivatives."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.steering.joined import Curve, JoinedCurve

_LEAST_M: Final = 1e-6
"""What stays in one place is taken to be this long."""

_WEAK: Final = 1e-9


class Limits(NamedTuple):
    """What a vehicle can do in level flight: its largest speed, acceleration and jerk."""

    speed_m_s: float
    acceleration_m_s2: float
    jerk_m_s3: float


@dataclass(frozen=True, eq=False)
class Grid:
    """A curve, or a part of one, in cells.

    Attributes:
        knots_s: Shape (n + 1,), from 0, ascending.
        slopes: Shape (n + 1, 2), r' at the knots.
        bends: Shape (n + 1, 2), r'' there.
        first: Shape (n,), a bound of |r'| on each cell, positive.
        second: Of |r''|.
        third: Of |r'''|.
        rates: Shape (n,), the largest sigma' on each cell.
    """

    knots_s: FloatArray
    slopes: FloatArray
    bends: FloatArray
    first: FloatArray
    second: FloatArray
    third: FloatArray
    rates: FloatArray

    def firm(self, limits: Limits) -> "Grid":
        """The same with |r'| next to each end nowhere less than its largest value there.

        A curve may begin with r' = 0. There sigma'' could be as large as it likes, which is of no use.
        """
        slopes, first = self.slopes.copy(), self.first.copy()
        passed = np.concatenate(([0.0], np.cumsum(self.first * np.diff(self.knots_s))))
        ramp_m = limits.acceleration_m_s2**3 / limits.jerk_m_s3**2
        for away in (passed, passed[-1] - passed):
            knots = away <= ramp_m
            cells = knots[:-1] | knots[1:]
            most = float(first[cells].max())
            sizes = np.hypot(slopes[:, 0], slopes[:, 1])
            slopes[knots & (sizes <= _WEAK * most)] = (most, 0.0)
            weak = knots & (sizes < most)
            slopes[weak] *= (most / np.hypot(slopes[weak, 0], slopes[weak, 1]))[:, None]
            first[cells] = most
        return replace(self, slopes=slopes, first=first)


class Slow(NamedTuple):
    """A part of a curve on which sigma', or the speed, is not to exceed a value."""

    begin_s: float
    end_s: float
    rate: float = math.inf
    speed_m_s: float = math.inf


def grid_of(curve: Curve, span_s: tuple[float, float], knots: FloatArray, limits: Limits, slow: Iterable[Slow]) -> Grid:
    """A curve in cells.

    Args:
        curve: The curve.
        span_s: Where the first cell begins and the last one ends.
        knots: Shape (n + 1,), counted from there.
        limits: Those of the vehicle.
        slow: Where it is to be slow. A cell that lies there in part is slow as a whole.
    """
    own_s = np.append(np.minimum(span_s[0] + knots[:-1], span_s[1]), span_s[1])
    _, slopes, bends = curve.jet(own_s)
    joints = curve.joints_s if isinstance(curve, JoinedCurve) else np.empty(0)
    whole = np.union1d(own_s, joints[(own_s[0] < joints) & (joints < own_s[-1])])
    # A cell in which pieces meet has the larger bound of both.
    own = np.searchsorted(whole, own_s[:-1])
    first, second, third = (np.maximum.reduceat(curve.norm_bounds(whole, order), own) for order in (1, 2, 3))
    first = np.maximum(first, _LEAST_M / knots[-1])
    rates = limits.speed_m_s / first
    for begin, end, rate, speed in slow:
        part = slice(max(0, int(np.searchsorted(own_s, begin, side="right")) - 1), int(np.searchsorted(own_s, end)))
        rates[part] = np.minimum(rates[part], np.minimum(rate, speed / first[part]))
    return Grid(knots, slopes, bends, first, second, third, rates)


def beside(values: FloatArray) -> FloatArray:
    """Of values on cells (n,), the larger one of those that meet at each knot, shape (n + 1,)."""
    return np.asarray(np.maximum(np.append(values, values[-1]), np.append(values[0], values)))
