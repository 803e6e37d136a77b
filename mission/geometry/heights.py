"""How high triangles are while their corners move straight on: the least and the largest, exactly.

A height is twice the area over the opposite side. While the corners move straight, twice the area is a quadratic a in
time and the square of the side a quadratic q, so the height turns where the cubic 2 a' q - a q' vanishes, and that has
one root at most between places at which it turns itself.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Final

import numpy as np

from mission.geometry.arrays import FloatArray

_HALVINGS: Final = 60


def height_bounds(before_m: FloatArray, after_m: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The least and the largest heights of triangles on the way from one place to another.

    Args:
        before_m: Shape (..., 3, 2), the corners at first, counter-clockwise.
        after_m: The same at last; no triangle folds in between.

    Returns:
        Both of shape (..., 3), metres: over each facet, of the corner opposite.
    """
    edges = np.roll(before_m, -2, axis=-2) - np.roll(before_m, -1, axis=-2)
    change = np.roll(after_m, -2, axis=-2) - np.roll(after_m, -1, axis=-2) - edges
    (e, d), (f, c) = ((edges[..., j, :], change[..., j, :]) for j in (1, 2))
    area = [x[..., None] for x in (_cross(e, f), _cross(e, c) + _cross(d, f), _cross(d, c))]
    square = [(edges**2).sum(axis=-1), 2.0 * (edges * change).sum(axis=-1), (change**2).sum(axis=-1)]
    turns = _roots(
        2.0 * area[1] * square[0] - area[0] * square[1],
        area[1] * square[1] + 4.0 * area[2] * square[0] - 2.0 * area[0] * square[2],
        3.0 * area[2] * square[1],
        2.0 * area[2] * square[2],
    )
    heights = np.stack([_at(u, *area) / np.sqrt(_at(u, *square)) for u in (np.zeros(()), *turns, np.ones(()))])
    return heights.min(axis=0), heights.max(axis=0)


def _at(u: FloatArray, *coefficients: FloatArray) -> FloatArray:
    """A polynomial, by its coefficients from the constant on."""
    value = np.zeros_like(coefficients[0])
    for coefficient in reversed(coefficients):
        value = value * u + coefficient
    return np.asarray(value)


def _roots(*cubic: FloatArray) -> Sequence[FloatArray]:
    """Three places from 0 to 1 among which are all roots there of a cubic, by its coefficients of one shape."""
    _, c1, c2, c3 = cubic
    # The derivative c1 + 2 c2 u + 3 c3 u^2 vanishes at q / (3 c3) and c1 / q, neither of which loses digits.
    q = -(c2 + np.copysign(np.sqrt(np.maximum(c2 * c2 - 3.0 * c1 * c3, 0.0)), c2))
    turns = [np.divide(a, b, out=np.zeros_like(q), where=b != 0.0).clip(0.0, 1.0) for a, b in ((q, 3.0 * c3), (c1, q))]
    ends = [np.zeros_like(q), *np.sort(turns, axis=0), np.ones_like(q)]
    found = []
    for low, high in pairwise(ends):
        here, there, sign = low, high, np.signbit(_at(low, *cubic))
        for _ in range(_HALVINGS):
            middle = 0.5 * (here + there)
            stays = np.signbit(_at(middle, *cubic)) == sign
            here, there = np.where(stays, middle, here), np.where(stays, there, middle)
        found.append(there)
    return found


def _cross(one: FloatArray, other: FloatArray) -> FloatArray:
    return np.asarray(one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0])
