"""A spline of Bézier pieces of degree 5 with a continuous second derivative: what flies through a corridor.

On a piece [s_k, s_{k+1}], with u = (s - s_k) / (s_{k+1} - s_k), r(s) = sum_i B_i(u) c_i with the Bernstein polynomials
B_i of degree 5. As these are at least 0 and sum to 1, a piece lies in every convex set that holds its control points
c_0 to c_5: that is what keeps it in its part of the corridor.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import comb, factorial
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from mission.geometry.arrays import FloatArray, IntArray, frozen_floats
from mission.steering.sampled import Sampled

DEGREE: Final = 5
_SLACK: Final = 1e-9  # of a bound, for rounding
_JOINED: Final = 1e-6  # how far derivatives may jump where pieces meet, as a part of the largest: rounding
_PANELS: Final = 8  # of a piece, for its length
_FEWEST_CELLS: Final = 4  # into which a piece is cut
_NODES: Final = 12  # Gauss-Legendre nodes a panel

_POWERS: Final = np.array(
    [
        [comb(DEGREE, i) * comb(DEGREE - i, j - i) * (-1.0) ** (j - i) if j >= i else 0.0 for i in range(DEGREE + 1)]
        for j in range(DEGREE + 1)
    ]
)
"""From control points to the coefficients of 1, u, ..., u^5."""


def derivative_points(controls_m: FloatArray, lasts_s: FloatArray, order: int) -> FloatArray:
    """The control points of a derivative, shape (K, 6 - order, 2), of pieces (K, 6, 2) that last ``lasts_s`` (K,)."""
    points = controls_m
    for degree in range(DEGREE, DEGREE - order, -1):
        points = degree * np.diff(points, axis=1) / lasts_s[:, None, None]
    return points


def gram(order: int) -> FloatArray:
    """G with c^T G c the integral over [0, 1] of the square of the derivative of sum_i B_i(u) c_i, shape (6, 6)."""
    degree = DEGREE - order
    bernstein = np.array(
        [
            [comb(degree, i) * comb(degree, j) / comb(2 * degree, i + j) / (2 * degree + 1) for j in range(degree + 1)]
            for i in range(degree + 1)
        ]
    )
    differences = derivative_points(np.eye(DEGREE + 1)[None], np.ones(1), order)[0]
    return np.asarray(differences.T @ bernstein @ differences)


class _Expanded(NamedTuple):
    """Taylor expansions about the middles of the parts between knots, which are cut where pieces meet.

    Attributes:
        begins: Shape (K,), the first part between each knot and the next.
        powers: Of each part's half width, 0 to 4.
        sizes: Of the derivatives of order 1 to 5 there.
    """

    begins: IntArray
    powers: list[FloatArray]
    sizes: list[FloatArray]


@dataclass(frozen=True, eq=False)
class BezierCurve:
    """A curve r(s), 0 <= s <= T.

    Attributes:
        knots_s: Shape (K + 1,), where its pieces begin, and the end; from 0, ascending.
        controls_m: Shape (K, 6, 2), the control points of each piece; the last of one is the first of the next.

    Raises:
        ValueError: One of these is not so, or the first or second derivative jumps.
    """

    knots_s: FloatArray
    controls_m: FloatArray

    def __post_init__(self) -> None:
        for name in ("knots_s", "controls_m"):
            object.__setattr__(self, name, frozen_floats(getattr(self, name)))
        knots, controls = self.knots_s, self.controls_m
        if controls.ndim != 3 or not len(controls) or controls.shape[1:] != (DEGREE + 1, 2):  # noqa: PLR2004 - pieces
            raise ValueError("there is a piece at least, and each has six control points of two numbers")
        if knots.shape != (len(controls) + 1,) or not (np.isfinite(knots).all() and np.isfinite(controls).all()):
            raise ValueError("there is one knot more than there are pieces, and all numbers are finite")
        if knots[0] != 0.0 or not (np.diff(knots) > 0.0).all():
            raise ValueError("knots begin at 0 and ascend")
        if not np.array_equal(controls[:-1, -1], controls[1:, 0]):
            raise ValueError("each piece begins where the one before it ends")
        for order in (1, 2):
            points = derivative_points(controls, np.diff(knots), order)
            jump = np.abs(points[1:, 0] - points[:-1, -1]).max(initial=0.0)
            if jump > _JOINED * (1.0 + np.abs(points).max()):
                raise ValueError(f"the derivative of order {order} jumps between two pieces")

    @property
    def duration_s(self) -> float:
        """T."""
        return float(self.knots_s[-1])

    @property
    def frequencies(self) -> int:
        """No waves."""
        return 0

    @property
    def instants_s(self) -> FloatArray:
        """Where its pieces meet: places at which it was made to be somewhere."""
        return self.knots_s[1:-1]

    @cached_property
    def _coefficients(self) -> tuple[FloatArray, ...]:
        """Of each derivative, order 0 to 5: those of 1, u, u^2, ... of each piece, shape (K, 6 - order, 2)."""
        lasts = np.diff(self.knots_s)[:, None, None]
        found = [np.einsum("ji,kid->kjd", _POWERS, self.controls_m)]
        for order in range(DEGREE):
            powers = np.arange(1, DEGREE + 1 - order)[None, :, None]
            found.append(found[-1][:, 1:] * powers / lasts)
        return tuple(found)

    def _piece_at(self, s: FloatArray) -> IntArray:
        piece = np.searchsorted(self.knots_s, s, side="right") - 1
        return np.clip(piece, 0, len(self.controls_m) - 1)

    def _value(self, piece: IntArray, u: FloatArray, order: int) -> FloatArray:
        coefficients = self._coefficients[order][piece]
        value = coefficients[:, -1]
        for power in range(coefficients.shape[1] - 2, -1, -1):
            value = value * u[:, None] + coefficients[:, power]
        return np.asarray(value)

    def _placed(self, s: ArrayLike) -> tuple[IntArray, FloatArray]:
        """The piece of each parameter (P,), and u there."""
        asked = np.clip(np.atleast_1d(np.asarray(s, dtype=np.float64)), 0.0, self.duration_s)
        piece = self._piece_at(asked)
        return piece, (asked - self.knots_s[piece]) / np.diff(self.knots_s)[piece]

    def derivative(self, s: ArrayLike, order: int) -> FloatArray:
        """The derivative d^order r / ds^order at the parameters ``s`` (P,), shape (P, 2); order 0 to 5.

        Where two pieces meet, orders above 2 are those of the later one.
        """
        return self._value(*self._placed(s), order)

    def position(self, s: ArrayLike) -> FloatArray:
        """Points of the curve, shape (P, 2), at the parameters ``s`` (P,)."""
        return self.derivative(s, 0)

    def jet(self, s: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Position, first and second derivative there, each of shape (P, 2)."""
        piece, u = self._placed(s)
        return self._value(piece, u, 0), self._value(piece, u, 1), self._value(piece, u, 2)

    @cached_property
    def length_m(self) -> float:
        """Arc length."""
        nodes, weights = np.polynomial.legendre.leggauss(_NODES)
        shares = ((np.arange(_PANELS)[:, None] + 0.5 * (nodes + 1.0)) / _PANELS).ravel()
        pieces = np.repeat(np.arange(len(self.controls_m)), len(shares))
        slopes = self._value(pieces, np.tile(shares, len(self.controls_m)), 1)
        speeds = np.hypot(slopes[:, 0], slopes[:, 1]).reshape(len(self.controls_m), _PANELS, _NODES)
        return float((speeds @ weights).sum(axis=1) @ np.diff(self.knots_s) * 0.5 / _PANELS)

    def norm_bounds(self, knots_s: FloatArray, order: int, values: FloatArray | None = None) -> FloatArray:
        """Proved upper bounds of |d^order r / ds^order| between consecutive knots, shape (K,), order 1 to 5.

        The finite Taylor expansion about the middle of each part, which is exact for polynomials: with the half width
        h, |p| <= sum_i |p^(i)| h^i / i!. ``values`` is not needed; it is there for curves that are of other kinds.
        """
        del values
        begins, powers, sizes = self._expanded(knots_s)
        bounds = np.zeros(len(powers[0]))
        for further in range(DEGREE + 1 - order):
            bounds += sizes[order + further - 1] * powers[further] / factorial(further)
        if len(bounds) >= len(knots_s):
            bounds = np.maximum.reduceat(bounds, begins)
        return np.asarray(bounds * (1.0 + _SLACK))

    def _expanded(self, knots_s: FloatArray) -> _Expanded:
        """The expansions between knots; the last ones are remembered, as bounds are asked for order by order."""
        key = knots_s.tobytes()
        if key not in self._expansions:
            inner = np.setdiff1d(self.knots_s[(self.knots_s > knots_s[0]) & (self.knots_s < knots_s[-1])], knots_s)
            begins = (np.arange(len(knots_s)) + np.searchsorted(inner, knots_s))[:-1]
            cuts = np.insert(knots_s, np.searchsorted(knots_s, inner), inner)
            half = 0.5 * np.diff(cuts)
            piece, u = self._placed(0.5 * (cuts[:-1] + cuts[1:]))
            values = (self._value(piece, u, order) for order in range(1, DEGREE + 1))
            sizes = [np.hypot(value[:, 0], value[:, 1]) for value in values]
            self._expansions.clear()
            self._expansions[key] = _Expanded(begins, [half**power for power in range(DEGREE)], sizes)
        return self._expansions[key]

    @cached_property
    def _expansions(self) -> dict[bytes, _Expanded]:
        return {}

    def sampled(self, fewest: int) -> Sampled:
        """The curve at knots that resolve it: ``fewest`` or more, those of its pieces among them."""
        cells = max(_FEWEST_CELLS, -(-fewest // len(self.controls_m)))
        shares = np.arange(cells) / cells
        knots = (self.knots_s[:-1, None] + np.diff(self.knots_s)[:, None] * shares).ravel()
        knots = np.append(knots, self.duration_s)
        return Sampled(knots, *self.jet(knots))

    def to_json(self) -> dict[str, Any]:
        """The curve as JSON values; ``from_json`` gives it back bit by bit."""
        return {"kind": "bezier", "knots_s": self.knots_s.tolist(), "controls_m": self.controls_m.tolist()}

    @staticmethod
    def from_json(data: Mapping[str, Any]) -> "BezierCurve":
        """The curve that ``to_json`` wrote; raises KeyError, TypeError or ValueError where it is not one."""
        return BezierCurve(data["knots_s"], data["controls_m"])
