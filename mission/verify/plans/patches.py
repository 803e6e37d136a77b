"""A trajectory's curve as the checker sees it: polynomials in Bernstein form, each with the error that it may have.

A polynomial lies in the convex hull of its control points, and so do its derivatives in the hulls of theirs. Polylines
with rounded corners are piecewise polynomials of degree 4 at most; control points are polynomials as they are; a
Fourier series is expanded about the middles of short intervals, by Taylor's formula with Lagrange's remainder. What is
said of all curves then follows from control points alone: where the tube is, how fast it is flown, how it bends.
A further kind of curve is one more function in ``_KINDS``.
"""

from collections.abc import Callable, Mapping
from itertools import accumulate
from math import comb, factorial
from typing import Any, Final, NamedTuple

import numpy as np

from mission.geometry.arrays import BoolArray, FloatArray, IntArray

DEGREE: Final = 7
ROUNDING: Final = 1e-11
"""Of the size of what is computed: what floating point may have lost."""

_TAYLOR: Final = 1e-12  # of the size of a series: largest remainder of a position
_MOST_CELLS: Final = 1 << 17
_CHUNK: Final = 1 << 21


class Patches(NamedTuple):
    """K polynomials that follow each other.

    Attributes:
        begins_s: Shape (K,), ascending curve parameters.
        ends_s: Shape (K,).
        control_m: Shape (K, 8, 2), control points.
        off: Shape (K, 4), how far the curve's position and first three derivatives may lie from the polynomial's.
    """

    begins_s: FloatArray
    ends_s: FloatArray
    control_m: FloatArray
    off: FloatArray

    def taken(self, which: BoolArray | IntArray) -> "Patches":
        """Some of them."""
        return Patches(*(part[which] for part in self))

    def cut(self, breaks_s: FloatArray) -> "Patches":
        """The same curve, each patch cut wherever one of the places lies inside of it."""
        edges, parent, low, high = self._pieces(breaks_s)
        return Patches(edges[:-1], edges[1:], _between(self.control_m[parent], low, high), self.off[parent])

    def derivatives(self, breaks_s: FloatArray) -> tuple[FloatArray, ...]:
        """The ends of the pieces that ``cut`` gives, of each the control points of three derivatives, and ``off``."""
        edges, parent, low, high = self._pieces(breaks_s)
        return edges, *(_between(self.derivative(order)[parent], low, high) for order in (1, 2, 3)), self.off[parent]

    def _pieces(self, breaks_s: FloatArray) -> tuple[FloatArray, IntArray, FloatArray, FloatArray]:
        inside = (breaks_s > self.begins_s[0]) & (breaks_s < self.ends_s[-1])
        edges = np.unique(np.concatenate((self.begins_s, self.ends_s[-1:], breaks_s[inside])))
        parent = np.searchsorted(self.begins_s, edges[:-1], side="right") - 1
        begins, widths = self.begins_s[parent], (self.ends_s - self.begins_s)[parent]
        return edges, parent, (edges[:-1] - begins) / widths, np.minimum((edges[1:] - begins) / widths, 1.0)

    def halves(self) -> "Patches":
        """Each cut in the middle."""
        middles = 0.5 * (self.begins_s + self.ends_s)
        nought, half = np.zeros(len(middles)), np.full(len(middles), 0.5)
        parts = _between(self.control_m, nought, half), _between(self.control_m, half, nought + 1.0)
        return Patches(
            np.stack((self.begins_s, middles), axis=1).ravel(),
            np.stack((middles, self.ends_s), axis=1).ravel(),
            np.stack(parts, axis=1).reshape(-1, DEGREE + 1, 2),
            np.repeat(self.off, 2, axis=0),
        )

    def derivative(self, order: int) -> FloatArray:
        """Control points of a derivative, shape (K, 8 - order, 2)."""
        control, widths = self.control_m, (self.ends_s - self.begins_s)[:, None, None]
        for step in range(order):
            control = np.diff(control, axis=1) * (DEGREE - step) / widths
        return control

    def at(self, s: FloatArray) -> FloatArray:
        """Positions at some parameters (P,), shape (P, 2)."""
        which = np.clip(np.searchsorted(self.begins_s, s, side="right") - 1, 0, len(self.begins_s) - 1)
        of = self.taken(which)
        share = np.clip((s - of.begins_s) / (of.ends_s - of.begins_s), 0.0, 1.0)
        return _between(of.control_m, share, np.ones(len(s)))[:, 0]

    @property
    def jumps_s(self) -> FloatArray:
        """Where the first or the second derivative jumps, so that the vehicle must rest there; position must not.

        Raises:
            ValueError: The curve is broken.
        """
        jump = np.zeros(len(self.begins_s) - 1, dtype=np.bool_)
        for order in range(3):
            control, allowed = self.derivative(order), self.off[:-1, order] + self.off[1:, order]
            gaps = np.abs(control[1:, 0] - control[:-1, -1]).max(axis=1, initial=0.0)
            broken = gaps > 2.0 * allowed + 1e-6 * (order > 0) * (1.0 + np.abs(control).max()) + ROUNDING * self.size_m
            if order == 0 and broken.any():
                raise ValueError(f"the curve is broken at {self.ends_s[np.argmax(gaps)]:.3f} s")
            jump |= broken
        return self.ends_s[:-1][jump]

    @property
    def size_m(self) -> float:
        """The largest coordinate."""
        return max(1.0, float(np.abs(self.control_m).max()))


def patches_of(curve: Mapping[str, Any]) -> Patches:
    """The patches of a curve of a plan file; raises KeyError, TypeError or ValueError where it is none."""
    if curve["kind"] == "joined":
        return in_a_row([patches_of(leg) for leg in curve["legs"]])
    return _KINDS[curve["kind"]](curve)


def in_a_row(parts: list[Patches]) -> Patches:
    """One curve of several: each begins where the one before it ends."""
    starts = accumulate((float(part.ends_s[-1]) for part in parts), initial=0.0)
    moved = [(part.begins_s + s, part.ends_s + s, *part[2:]) for part, s in zip(parts, starts, strict=False)]
    joined = Patches(*(np.concatenate(column) for column in zip(*moved, strict=True)))
    # One place, and not two that differ by rounding.
    return joined._replace(ends_s=np.append(joined.begins_s[1:], joined.ends_s[-1]))


def _between(control: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    """Control points of the parts from ``low`` to ``high`` (K,) of polynomials, by de Casteljau's scheme."""
    for share, last in ((low, True), (np.where(high < 1.0, (high - low) / np.maximum(1.0 - low, 1e-300), 1.0), False)):
        here, found = control, []
        for _ in range(control.shape[1]):
            found.append(here[:, -1 if last else 0])
            here = here[:, :-1] + (here[:, 1:] - here[:, :-1]) * share[:, None, None]
        control = np.stack(found[::-1] if last else found, axis=1)
    return control


def _of_powers(powers: FloatArray) -> FloatArray:
    """Control points from the coefficients of 1, u, u^2, ... on 0 <= u <= 1, shape (K, n, 2)."""
    table = np.array([[comb(j, i) / comb(DEGREE, i) for i in range(powers.shape[1])] for j in range(DEGREE + 1)])
    return np.asarray(np.einsum("ji,kix->kjx", table, powers))


def _fourier(curve: Mapping[str, Any]) -> Patches:
    amplitudes = np.array(curve["coefficients_m"], dtype=np.float64).reshape(-1, 2)
    duration, base, slope = float(curve["duration_s"]), np.array(curve["base_m"]), np.array(curve["slope_m_s"])
    rates = np.arange(1, len(amplitudes) + 1) * (np.pi / duration)
    norms = np.hypot(*amplitudes.T)
    size = float(np.abs(base).max() + np.abs(slope).max() * duration + norms.sum()) + 1e-3
    order = DEGREE + 1
    # Half a cell so wide that the remainder of the position is as small as asked, and no wave turns by more than 1 rad.
    steepest = float((norms * rates**order).sum())
    half = min((_TAYLOR * size * factorial(order) / max(steepest, 1e-300)) ** (1.0 / order), 1.0 / rates[-1])
    cells = int(np.ceil(duration / (2.0 * half)))
    if not 0 < cells <= _MOST_CELLS:
        raise ValueError("the waves of a curve are too fast")
    edges = np.linspace(0.0, duration, cells + 1)
    half = duration / (2.0 * cells)
    phase = {"even": 0.5 * np.pi, "odd": 0.0}[curve["extension"]]
    jets = np.empty((cells, order, 2))
    for first in range(0, cells, rows := max(1, _CHUNK // len(rates))):
        part = slice(first, first + rows)
        turns = np.multiply.outer(edges[:-1][part] + half, rates) + phase
        waves = np.sin(turns), np.cos(turns)
        for k in range(order):
            weights = amplitudes * ((-1.0) ** (k // 2) * (rates * half) ** k / factorial(k))[:, None]
            jets[part, k] = waves[k % 2] @ weights
    jets[:, 0] += base + np.multiply.outer(edges[:-1] + half, slope)
    jets[:, 1] += slope * half
    # t = 2 u - 1 on each cell.
    turned = np.array(
        [[comb(k, i) * 2.0**i * (-1.0) ** (k - i) for k in range(order)] for i in range(order)]
    )  # comb is 0 where i > k
    control = _of_powers(np.einsum("ik,ckx->cix", turned, jets))
    off = [steepest * half ** (order - q) / factorial(order - q) + ROUNDING * size / half**q for q in range(4)]
    return Patches(edges[:-1], edges[1:], control, np.tile(off, (cells, 1)))


def _rounded(curve: Mapping[str, Any]) -> Patches:
    """Straight parts at one speed c, and blends of length T = 2 d / c in which the velocity goes as 3 u^2 - 2 u^3."""
    corners, speed = np.array(curve["corners_m"], dtype=np.float64).reshape(-1, 2), float(curve["speed_m_s"])
    reaches = np.concatenate(([0.0], np.array(curve["reaches_m"], dtype=np.float64), [0.0]))
    lengths = np.hypot(*np.diff(corners, axis=0).T)
    straight = lengths - reaches[:-1] - reaches[1:]
    if not (speed > 0.0 and len(reaches) == len(corners) and (straight >= -1e-9 * lengths).all()):
        raise ValueError("the blends of a polyline overlap, or it has no speed")
    ways = np.diff(corners, axis=0) / lengths[:, None]
    powers = np.zeros((2 * len(corners) - 3, 5, 2))
    powers[::2, 0] = corners[:-1] + ways * reaches[:-1, None]
    powers[::2, 1] = ways * np.maximum(straight, 0.0)[:, None]
    doubled, turns = 2.0 * reaches[1:-1, None], np.diff(ways, axis=0)
    powers[1::2, 0] = corners[1:-1] - ways[:-1] * reaches[1:-1, None]
    powers[1::2, 1] = doubled * ways[:-1]
    powers[1::2, 3], powers[1::2, 4] = doubled * turns, -0.5 * doubled * turns
    lasts = np.empty(len(powers))
    lasts[::2], lasts[1::2] = np.maximum(straight, 0.0) / speed, 2.0 * reaches[1:-1] / speed
    return _exact(np.concatenate(([0.0], np.cumsum(lasts))), _of_powers(powers))


def _bezier(curve: Mapping[str, Any]) -> Patches:
    """Control points as they are, their degree raised."""
    control = np.array(curve["controls_m"], dtype=np.float64)
    if not 2 <= control.shape[1] <= DEGREE + 1:  # noqa: PLR2004 - a point is no polynomial
        raise ValueError("the pieces of a curve have degree 1 to 7")
    for degree in range(control.shape[1], DEGREE + 1):
        share = (np.arange(1, degree) / degree)[:, None]
        inner = control[:, :-1] * share + control[:, 1:] * (1.0 - share)
        control = np.concatenate((control[:, :1], inner, control[:, -1:]), axis=1)
    return _exact(np.array(curve["knots_s"], dtype=np.float64), control)


def _exact(knots_s: FloatArray, control: FloatArray) -> Patches:
    """Patches without a remainder; those that last no time, but for rounding, are left out."""
    if len(knots_s) != len(control) + 1 or not np.isfinite(control).all() or (np.diff(knots_s) < 0.0).any():
        raise ValueError("the knots of a curve ascend, and its points are finite")
    kept = np.flatnonzero(np.diff(knots_s) > ROUNDING * knots_s[-1])
    size = float(np.abs(control).max(initial=1.0))
    widths = np.diff(knots_s)[kept]
    off = np.stack([ROUNDING * size / widths**order for order in range(4)], axis=1)
    return Patches(knots_s[kept], knots_s[kept + 1], control[kept], np.minimum(off, 1e-6 * size))


_KINDS: Final[Mapping[str, Callable[[Mapping[str, Any]], Patches]]] = {
    "fourier": _fourier,
    "rounded polyline": _rounded,
    "bezier": _bezier,
}
