"""Curves that are flown one after the other, as one curve: with a rest between two, or through where they go over."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from mission.geometry.arrays import FloatArray, IntArray, frozen_floats
from mission.steering.bezier import BezierCurve
from mission.steering.rounded import RoundedPolyline
from mission.steering.sampled import Sampled
from mission.steering.smoothing import FourierCurve

_APART = 1e-11
"""How far ends that are one point may lie apart, as a part of their coordinates: rounding."""

_SMOOTH = 1e-6
"""Likewise of derivatives."""

Piece = FourierCurve | RoundedPolyline | BezierCurve
"""A curve with a continuous second derivative."""


@dataclass(frozen=True, eq=False)
class JoinedCurve:
    """Smooth legs, each of which begins where the one before it ends; there the direction may jump.

    Attributes:
        legs: At least one; each on its own [0, T]. A leg may itself be joined of others.

    Raises:
        ValueError: Two legs do not join, or there is none.
    """

    legs: "tuple[Piece | JoinedCurve, ...]"

    def __post_init__(self) -> None:
        if not self.legs:
            raise ValueError("a curve has one leg at least")
        if not all(joins(before, after) for before, after in pairwise(self.legs)):
            raise ValueError("the legs of a curve do not join")

    @cached_property
    def starts_s(self) -> FloatArray:
        """Where each leg begins, and the end, shape (len(legs) + 1,)."""
        counts = [len(leg.pieces) if isinstance(leg, JoinedCurve) else 1 for leg in self.legs]
        return frozen_floats(self.joints_s[np.concatenate(([0], np.cumsum(counts)))])

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """The smooth curves of all legs."""
        return tuple(piece for leg in self.legs for piece in (leg.pieces if isinstance(leg, JoinedCurve) else (leg,)))

    @cached_property
    def joints_s(self) -> FloatArray:
        """Where each of the pieces begins, and the end, shape (len(pieces) + 1,)."""
        return frozen_floats(np.concatenate(([0.0], np.cumsum([piece.duration_s for piece in self.pieces]))))

    @property
    def duration_s(self) -> float:
        """T, the steering time of all legs."""
        return float(self.joints_s[-1])

    @cached_property
    def instants_s(self) -> FloatArray:
        """Where pieces meet, and where those of splines do: places at which it was made to be somewhere."""
        within = [
            start + piece.instants_s
            for start, piece in zip(self.joints_s, self.pieces, strict=False)
            if isinstance(piece, BezierCurve)
        ]
        return np.concatenate((self.joints_s[1:-1], *within))

    @cached_property
    def breaks_s(self) -> FloatArray:
        """Those places between pieces where velocity or acceleration would jump: there the vehicle rests."""
        pairs = zip(self.joints_s[1:-1].tolist(), pairwise(self.pieces), strict=True)
        return np.array([joint for joint, (before, after) in pairs if not joins_smoothly(before, after)])

    @property
    def length_m(self) -> float:
        """Arc length."""
        return sum(piece.length_m for piece in self.pieces)

    @property
    def frequencies(self) -> int:
        """Number of waves of the piece that has most."""
        return max(piece.frequencies for piece in self.pieces)

    def placed(self, s: FloatArray) -> Iterator[tuple[Piece, IntArray, FloatArray]]:
        """For each piece: itself, the indices of the ``s`` (P,) that lie on it, and its own parameter there.

        Where two pieces meet, the later one counts.
        """
        which = np.clip(np.searchsorted(self.joints_s, s, side="right") - 1, 0, len(self.pieces) - 1)
        for number, piece in enumerate(self.pieces):
            found = np.flatnonzero(which == number)
            yield piece, found, np.clip(s[found] - self.joints_s[number], 0.0, piece.duration_s)

    def derivative(self, s: ArrayLike, order: int) -> FloatArray:
        """The derivative d^order r / ds^order at the parameters ``s`` (P,), shape (P, 2); order 0 is the position."""
        asked = np.atleast_1d(np.asarray(s, dtype=np.float64))
        values = np.empty((len(asked), 2))
        for piece, found, own in self.placed(asked):
            values[found] = piece.derivative(own, order)
        return values

    def position(self, s: ArrayLike) -> FloatArray:
        """Points of the curve, shape (P, 2), at the parameters ``s`` (P,)."""
        return self.derivative(s, 0)

    def jet(self, s: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Position, first and second derivative there, each of shape (P, 2)."""
        asked = np.atleast_1d(np.asarray(s, dtype=np.float64))
        values = np.empty((3, len(asked), 2))
        for piece, found, own in self.placed(asked):
            values[:, found] = piece.jet(own)
        return values[0], values[1], values[2]

    def sampled(self, fewest: int) -> Sampled:
        """Each piece at ``fewest`` knots or more; where two meet, the longer of each derivative."""
        parts = [piece.sampled(fewest) for piece in self.pieces]
        knots, points, *derivatives = parts[0]
        for start, part in zip(self.joints_s[1:-1], parts[1:], strict=True):
            knots = np.concatenate((knots, start + part.knots_s[1:]))
            points = np.concatenate((points, part.points_m[1:]))
            for i, values in enumerate((part.slopes_m_s, part.bends_m_s2)):
                ends = derivatives[i][-1], values[0]
                longer = max(ends, key=lambda end: float(np.hypot(*end)))
                derivatives[i] = np.concatenate((derivatives[i][:-1], longer[None], values[1:]))
        return Sampled(knots, points, derivatives[0], derivatives[1])

    def norm_bounds(self, knots_s: FloatArray, order: int, values: FloatArray | None = None) -> FloatArray:
        """Proved upper bounds of |d^order r / ds^order| between knots, shape (K,), order 1, 2 or 3.

        Args:
            knots_s: Shape (K + 1,), ascending, those between its ends at which pieces meet among them.
            order: 1, 2 or 3.
            values: The derivative at the knots, shape (K + 1, 2), where the caller has it already; where two pieces
                meet, the longer of the two.
        """
        bounds = np.empty(len(knots_s) - 1)
        ends = np.minimum(np.searchsorted(knots_s, self.joints_s), len(bounds))
        for piece, start, (first, last) in zip(self.pieces, self.joints_s, pairwise(ends), strict=False):
            if first == last:  # no part is on it
                continue
            own = slice(first, last + 1)
            at_knots = None if values is None else values[own]
            bounds[first:last] = piece.norm_bounds(knots_s[own] - start, order, at_knots)
        return bounds

    def to_json(self) -> dict[str, Any]:
        """The curve as JSON values; ``curve_from_json`` gives it back bit by bit."""
        return {"kind": "joined", "legs": [leg.to_json() for leg in self.legs]}


Curve = Piece | JoinedCurve


def joins(before: Curve, after: Curve) -> bool:
    """Whether one curve ends where the other begins."""
    end, begin = before.position([before.duration_s])[0], after.position([0.0])[0]
    return float(np.abs(end - begin).max()) <= _APART * (1.0 + float(np.abs(end).max()))


def joins_smoothly(before: Curve, after: Curve) -> bool:
    """Whether one curve ends where the other begins, with the same first and second derivative."""
    ends, begins = before.jet([before.duration_s]), after.jet([0.0])
    return joins(before, after) and all(
        float(np.abs(end - begin).max()) <= _SMOOTH * (1.0 + float(np.abs(end).max()))
        for end, begin in zip(ends[1:], begins[1:], strict=True)
    )


def curve_from_json(data: Any) -> Curve:  # noqa: ANN401 - any JSON value
    """The curve that its ``to_json`` wrote; raises KeyError, TypeError or ValueError where it is none."""
    if data["kind"] == "joined":
        return JoinedCurve(tuple(curve_from_json(leg) for leg in data["legs"]))
    readers: dict[str, Callable[[Any], Piece]] = {
        "fourier": FourierCurve.from_json,
        "rounded polyline": RoundedPolyline.from_json,
        "bezier": BezierCurve.from_json,
    }
    return readers[data["kind"]](data)
