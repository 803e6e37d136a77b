"""A polyline with rounded corners, with continuous acceleration and exact bounds: what lanes and the ways between are.

On the straight parts r' = c t with the unit direction t. At a corner from the direction t1 to t2 the velocity goes
along the straight line between both, r' = c (t1 + (t2 - t1) S(u)) with S(u) = 3 u^2 - 2 u^3, for the time T = 2 d / c:
the blend begins the reach d before the corner and ends d after it, stays in the triangle of these three points, and
passes the corner at the distance 3/16 d |t2 - t1|. As S' vanishes at both ends, r'' is continuous, and as a velocity
between two is nowhere longer than the longer one, |r'| <= c. Where the direction is reversed, r' vanishes halfway.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from mission.geometry.arrays import FloatArray, IntArray, frozen_floats
from mission.steering.sampled import Sampled

_BLEND_CELLS = 8  # into which a blend is cut
_STRAIGHT_S = 0.5  # of what length at most the parts are into which a straight part is cut
_PEAK = 1.5  # largest value of S'
_STEEPEST = 6.0  # largest value of S''
_OFF_CORNER = 3.0 / 16.0
_SLACK = 1e-9  # of a length, for rounding


class _Pieces(NamedTuple):
    """Straight parts and blends in turn, P = 2 (n - 2) + 1 of them: where each begins, its directions and its time."""

    begins_m: FloatArray
    before: FloatArray
    after: FloatArray
    lasts_s: FloatArray
    blends: np.ndarray


@dataclass(frozen=True, eq=False)
class RoundedPolyline:
    """A curve r(s), 0 <= s <= T, along a polyline, at the speed c but for the corners.

    Attributes:
        corners_m: Shape (n, 2), n >= 2, neighbours apart from each other.
        reaches_m: Shape (n - 2,), how far from each inner corner its blend begins and ends; positive, and no two
            of them overlap.
        speed_m_s: c, positive.

    Raises:
        ValueError: One of these is not so.
    """

    corners_m: FloatArray
    reaches_m: FloatArray
    speed_m_s: float

    def __post_init__(self) -> None:
        for name in ("corners_m", "reaches_m"):
            object.__setattr__(self, name, frozen_floats(getattr(self, name)))
        corners, reaches = self.corners_m, self.reaches_m
        if corners.ndim != 2 or corners.shape[1] != 2 or len(corners) < 2:  # noqa: PLR2004 - plane, one piece
            raise ValueError("a polyline has two corners or more, of two numbers each")
        if reaches.shape != (len(corners) - 2,) or not (np.isfinite(reaches).all() and (reaches > 0.0).all()):
            raise ValueError("each inner corner is rounded within a positive reach")
        if not (math.isfinite(self.speed_m_s) and self.speed_m_s > 0.0 and np.isfinite(corners).all()):
            raise ValueError("corners are finite, and the speed is positive")
        lengths = self.lengths_m
        ends = np.concatenate(([0.0], reaches, [0.0]))
        if not ((lengths > 0.0).all() and (ends[:-1] + ends[1:] <= lengths * (1.0 + _SLACK)).all()):
            raise ValueError("corners lie apart, and their blends do not overlap")

    @property
    def lengths_m(self) -> FloatArray:
        """Distances between consecutive corners, shape (n - 1,)."""
        steps = np.diff(self.corners_m, axis=0)
        return np.asarray(np.hypot(steps[:, 0], steps[:, 1]))

    @property
    def frequencies(self) -> int:
        """No waves."""
        return 0

    @cached_property
    def _pieces(self) -> _Pieces:
        lengths, count = self.lengths_m, len(self.corners_m)
        directions = np.diff(self.corners_m, axis=0) / lengths[:, None]
        ends = np.concatenate(([0.0], self.reaches_m, [0.0]))
        begins, before = np.empty((2 * count - 3, 2)), np.empty((2 * count - 3, 2))
        after, lasts = np.empty((2 * count - 3, 2)), np.empty(2 * count - 3)
        begins[::2] = self.corners_m[:-1] + directions * ends[:-1, None]
        begins[1::2] = self.corners_m[1:-1] - directions[:-1] * self.reaches_m[:, None]
        before[::2] = after[::2] = directions
        before[1::2], after[1::2] = directions[:-1], directions[1:]
        lasts[::2] = np.maximum(0.0, lengths - ends[:-1] - ends[1:]) / self.speed_m_s
        lasts[1::2] = 2.0 * self.reaches_m / self.speed_m_s
        return _Pieces(begins, before, after, lasts, np.arange(2 * count - 3) % 2 == 1)

    @cached_property
    def knots_s(self) -> FloatArray:
        """Where straight parts and blends begin, in turn, and the end: shape (2 n - 2,)."""
        return frozen_floats(np.concatenate(([0.0], np.cumsum(self._pieces.lasts_s))))

    @property
    def duration_s(self) -> float:
        """T."""
        return float(self.knots_s[-1])

    @property
    def corners_s(self) -> FloatArray:
        """Where the curve passes its corners, at the ends or nearest to them, shape (n,).

        Blends last as long as the way round their corners at the speed c: the parameter is the length of the polyline
        over c.
        """
        return np.concatenate(([0.0], np.cumsum(self.lengths_m))) / self.speed_m_s

    @property
    def off_corners_m(self) -> FloatArray:
        """How far from each inner corner the curve passes, shape (n - 2,)."""
        turns = (self._pieces.after - self._pieces.before)[1::2]
        return np.asarray(_OFF_CORNER * self.reaches_m * np.hypot(turns[:, 0], turns[:, 1]))

    @cached_property
    def length_m(self) -> float:
        """Arc length."""
        nodes, weights = np.polynomial.legendre.leggauss(24)
        shares = _eased(0.25 * (nodes + 1.0))  # up to halfway, where reversals have a kink; the other half is the same
        turns = self._pieces.after - self._pieces.before
        speeds = np.linalg.norm(self._pieces.before[:, None] + turns[:, None] * shares[:, None], axis=2)
        return float(self.speed_m_s * (speeds @ weights * 0.5 * self._pieces.lasts_s).sum())

    def jet(self, s: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Position, first and second derivative, each of shape (P, 2), at the parameters ``s`` (P,)."""
        times = np.clip(np.atleast_1d(np.asarray(s, dtype=np.float64)), 0.0, self.duration_s)
        piece = self._piece_at(times)
        begins, before, after, lasts, blends = (part[piece] for part in self._pieces)
        u = self._share(times, piece)
        turns, lasts = (after - before) * blends[:, None], lasts[:, None]
        passed = (u**3 - 0.5 * u**4)[:, None]  # the integral of S
        position = begins + self.speed_m_s * lasts * (u[:, None] * before + passed * turns)
        slope = self.speed_m_s * (before + _eased(u)[:, None] * turns)
        growth = np.divide(_rise(u)[:, None], lasts, out=np.zeros_like(lasts), where=lasts > 0.0)
        return position, slope, self.speed_m_s * turns * growth

    def derivative(self, s: ArrayLike, order: int) -> FloatArray:
        """The derivative d^order r / ds^order, shape (P, 2), of order 0 to 3; the third jumps at ends of blends."""
        if order < 3:  # noqa: PLR2004 - those of the jet
            return self.jet(s)[order]
        times = np.clip(np.atleast_1d(np.asarray(s, dtype=np.float64)), 0.0, self.duration_s)
        piece = self._piece_at(times)
        lasts, blends = self._pieces.lasts_s[piece], self._pieces.blends[piece]
        turns = (self._pieces.after - self._pieces.before)[piece]
        growth = np.divide(_bend(self._share(times, piece)), lasts**2, out=np.zeros_like(lasts), where=blends)
        return np.asarray(self.speed_m_s * turns * growth[:, None])

    def position(self, s: ArrayLike) -> FloatArray:
        """Points of the curve, shape (P, 2), at the parameters ``s`` (P,)."""
        return self.jet(s)[0]

    def norm_bounds(self, knots_s: FloatArray, order: int, values: FloatArray | None = None) -> FloatArray:
        """Least upper bounds of |d^order r / ds^order| between consecutive knots, shape (K,), order 1, 2 or 3.

        ``values`` is not needed; it is there for curves that are not made of such simple pieces.
        """
        del values
        begin, end = knots_s[:-1], knots_s[1:]
        first = self._piece_at(begin)
        last = np.clip(np.searchsorted(self.knots_s, end, side="left") - 1, first, len(self.knots_s) - 2)
        if order == 1:
            slopes = np.linalg.norm(self.jet(knots_s)[1], axis=1)
            # Along one blend the velocity goes along a straight line: it is longest at one of the ends.
            return np.where(first == last, np.maximum(slopes[:-1], slopes[1:]), self.speed_m_s) * (1.0 + _SLACK)
        lasts = self._pieces.lasts_s
        turns = np.linalg.norm(self._pieces.after - self._pieces.before, axis=1)
        scale = lasts ** (order - 1)
        rates = np.divide(turns * self.speed_m_s, scale, out=np.zeros_like(lasts), where=lasts > 0.0)
        low, high = self._share(begin, first), self._share(end, last)
        one = first == last
        peak, most = (_peak, _PEAK) if order == 2 else (_steepest, _STEEPEST)  # noqa: PLR2004 - the second derivative
        ends = np.maximum(
            rates[first] * peak(low, np.where(one, high, 1.0)), rates[last] * peak(np.where(one, low, 0.0), high)
        )
        between = np.maximum.reduceat(np.append(rates, [0.0, 0.0]), np.stack((first + 1, last), axis=1).ravel())[::2]
        bounds = np.where(last > first + 1, np.maximum(ends, most * between), ends)
        return np.asarray(bounds * (1.0 + _SLACK))

    def sampled(self, fewest: int) -> Sampled:
        """The curve at knots that resolve it: ``fewest`` or more, those of its pieces among them."""
        cells = np.where(self._pieces.blends, _BLEND_CELLS, np.ceil(self._pieces.lasts_s / _STRAIGHT_S)).astype(
            np.int64
        )
        cells = np.maximum(cells, math.ceil(fewest / len(cells))) * (self._pieces.lasts_s > 0.0)
        piece = np.repeat(np.arange(len(cells)), cells)
        place = np.arange(len(piece)) - np.repeat(np.cumsum(cells) - cells, cells)
        knots = self.knots_s[piece] + place * (self._pieces.lasts_s / np.maximum(cells, 1))[piece]
        knots = np.append(knots, self.duration_s)
        return Sampled(knots, *self.jet(knots))

    def rest(self, s: float) -> "RoundedPolyline":
        """What is left of the curve from a place of its polyline on; its parameter counts from there.

        The blend of a corner that is nearer than it was begins there.

        Raises:
            ValueError: Nothing is left.
        """
        corners_s = self.corners_s
        if not s < corners_s[-1]:
            raise ValueError("nothing is left of a curve at its end")
        after = int(np.searchsorted(corners_s, s, side="right"))
        way = (s - corners_s[after - 1]) / (corners_s[after] - corners_s[after - 1])
        begin = self.corners_m[after - 1] + way * (self.corners_m[after] - self.corners_m[after - 1])
        corners = np.concatenate((begin[None], self.corners_m[after:]))
        reaches = self.reaches_m[after - 1 :].copy()
        if len(reaches):
            reaches[0] = min(reaches[0], float(np.hypot(*(corners[1] - begin))))
        return RoundedPolyline(corners, reaches, self.speed_m_s)

    def to_json(self) -> dict[str, Any]:
        """The curve as JSON values; ``from_json`` gives it back bit by bit."""
        return {
            "kind": "rounded polyline",
            "corners_m": self.corners_m.tolist(),
            "reaches_m": self.reaches_m.tolist(),
            "speed_m_s": self.speed_m_s,
        }

    @staticmethod
    def from_json(data: Mapping[str, Any]) -> "RoundedPolyline":
        """The curve that ``to_json`` wrote; raises KeyError, TypeError or ValueError where it is not one."""
        return RoundedPolyline(data["corners_m"], data["reaches_m"], float(data["speed_m_s"]))

    def _share(self, s: FloatArray, piece: IntArray) -> FloatArray:
        """Which share of a piece has passed at ``s``."""
        elapsed, lasts = s - self.knots_s[piece], self._pieces.lasts_s[piece]
        return np.clip(np.divide(elapsed, lasts, out=np.zeros_like(elapsed), where=lasts > 0.0), 0.0, 1.0)

    def _piece_at(self, s: FloatArray) -> IntArray:
        piece = np.searchsorted(self.knots_s, s, side="right") - 1
        return np.clip(piece, 0, len(self.knots_s) - 2)


def _peak(low: FloatArray, high: FloatArray) -> FloatArray:
    """The largest value of S' between two shares."""
    halfway = (low <= 0.5) & (high >= 0.5)  # noqa: PLR2004 - where it is largest
    return np.where(halfway, _PEAK, np.maximum(_rise(low), _rise(high)))


def _steepest(low: FloatArray, high: FloatArray) -> FloatArray:
    """The largest modulus of S'' between two shares."""
    return np.maximum(np.abs(_bend(low)), np.abs(_bend(high)))


def _eased(u: FloatArray) -> FloatArray:
    """S(u)."""
    return np.asarray(u * u * (3.0 - 2.0 * u))


def _rise(u: FloatArray) -> FloatArray:
    """S'(u)."""
    return np.asarray(6.0 * u * (1.0 - u))


def _bend(u: FloatArray) -> FloatArray:
    """S''(u)."""
    return np.asarray(6.0 - 12.0 * u)
