"""Polynomials by their control points, in Bernstein's form on 0 <= u <= 1: the one arithmetic for all bounds.

A polynomial lies in the convex hull of its control points, and comes as near to it as one likes where it is cut. What
is said of curves, of their time laws and of both together are polynomials, and control points bound them.
Arrays have the shape (K, n + 1, d): K polynomials of degree n with values in d dimensions.
"""

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from functools import cache
from itertools import pairwise
from math import comb
from typing import Final, Self, TypeVar

import numpy as np

from mission.geometry.arrays import BoolArray, FloatArray, IntArray

_ROUNDS: Final = 40
_MOST: Final = 1 << 10
"""Pieces that are looked into at a time."""


@cache
def _binomials(degree: int) -> FloatArray:
    return np.array([float(comb(degree, i)) for i in range(degree + 1)])[:, None]


def part(control: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    """Polynomials on their parts from ``low`` to ``high``, shape (K,), by de Casteljau's scheme."""
    onward = np.where(high < 1.0, (high - low) / np.maximum(1.0 - low, np.finfo(np.float64).tiny), 1.0)
    for share, last in ((low, True), (onward, False)):
        here, found = control, []
        for _ in range(control.shape[1]):
            found.append(here[:, -1 if last else 0])
            here = here[:, :-1] + (here[:, 1:] - here[:, :-1]) * share[:, None, None]
        control = np.stack(found[::-1] if last else found, axis=1)
    return control


def halved(control: FloatArray) -> FloatArray:
    """The halves of each, one after the other, shape (2 K, n + 1, d)."""
    nought, half = np.zeros(len(control)), np.full(len(control), 0.5)
    halves = part(control, nought, half), part(control, half, nought + 1.0)
    return np.stack(halves, axis=1).reshape(2 * len(control), *control.shape[1:])


def derivative(control: FloatArray, widths: FloatArray, order: int) -> FloatArray:
    """Derivatives of polynomials that go on for ``widths``, shape (K,)."""
    for _ in range(order):
        control = np.diff(control, axis=1) * (control.shape[1] - 1) / widths[:, None, None]
    return control


def times(one: FloatArray, other: FloatArray) -> FloatArray:
    """Products, component by component."""
    n, m = one.shape[1] - 1, other.shape[1] - 1
    one, other = one * _binomials(n), other * _binomials(m)
    total = np.zeros((len(one), n + m + 1, max(one.shape[2], other.shape[2])))
    for i in range(m + 1):
        total[:, i : i + n + 1] += one * other[:, i : i + 1]
    return total / _binomials(n + m)


def composed(control: FloatArray, inner: FloatArray) -> FloatArray:
    """Polynomials of polynomials (K, m + 1, 1) with values from 0 to 1: de Casteljau's scheme at such a place."""
    rows = [control[:, i : i + 1] for i in range(control.shape[1])]
    while len(rows) > 1:
        rows = [times(before, 1.0 - inner) + times(after, inner) for before, after in pairwise(rows)]
    return rows[0]


def raised(control: FloatArray, degree: int) -> FloatArray:
    """The same polynomials, of a higher degree."""
    return times(control, np.ones((len(control), degree + 2 - control.shape[1], 1)))


def of_powers(powers: FloatArray, degree: int) -> FloatArray:
    """Polynomials from their coefficients of 1, u, u^2, ..., shape (K, n, d)."""
    table = [[comb(j, i) / comb(degree, i) for i in range(powers.shape[1])] for j in range(degree + 1)]
    return np.asarray(np.einsum("ji,kix->kjx", np.array(table), powers))


@dataclass(frozen=True, eq=False)
class Pieces:
    """K polynomials that follow each other; what else is known of each is in further arrays of the same length.

    Attributes:
        begins_s: Shape (K,), ascending.
        ends_s: Shape (K,).
    """

    begins_s: FloatArray
    ends_s: FloatArray

    def __len__(self) -> int:
        return len(self.begins_s)

    def taken(self, which: BoolArray | IntArray) -> Self:
        """Some of them."""
        return replace(self, **{each.name: getattr(self, each.name)[which] for each in fields(self)})

    def halves(self) -> Self:
        """Each cut in the middle: control points, which have three dimensions, and what is between begin and end."""
        middles = 0.5 * (self.begins_s + self.ends_s)
        begins, ends = (np.stack(each, axis=1).ravel() for each in ((self.begins_s, middles), (middles, self.ends_s)))
        others = {each.name: getattr(self, each.name) for each in fields(self)[2:]}
        cut = {name: halved(of) if of.ndim == 3 else np.repeat(of, 2, axis=0) for name, of in others.items()}  # noqa: PLR2004
        return replace(self, begins_s=begins, ends_s=ends, **cut)


SomePieces = TypeVar("SomePieces", bound=Pieces)


def undecided(pieces: SomePieces, doubtful: Callable[[SomePieces], BoolArray], rounds: int = _ROUNDS) -> SomePieces:
    """What of some pieces is doubtful, and stays so however often it is cut in halves; none where all is proved.

    Args:
        pieces: The pieces.
        doubtful: Which of some pieces, (K,), are not proved by their control points.
        rounds: How often they are cut at most; not much more often than that there are too many.
    """
    most = max(_MOST, 2 * len(pieces))
    for _ in range(rounds):
        pieces = pieces.taken(doubtful(pieces))
        if not 0 < len(pieces) <= most:
            return pieces
        pieces = pieces.halves()
    return pieces.taken(doubtful(pieces))
