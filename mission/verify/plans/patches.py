"""A trajectory's curve as the checker sees it: polynomials in Bernstein form, each with the error that it may have.

Polylines with rounded corners are piecewise polynomials of degree 4 at most; splines are polynomials as they are; a
Fourier series is expanded about the middles of short intervals, by Taylor's formula with Lagrange's remainder. What is
said of all curves then follows from control points alone: where the tube is, how fast it is flown, how it bends.
A further kind of curve is one more function in ``_KINDS``.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import comb, factorial
from typing import Any, Final

import numpy as np

from mission.geometry.arrays import FloatArray, IntArray
from mission.geometry.bernstein import Pieces, derivative, of_powers, part, raised

DEGREE: Final = 7
ROUNDING: Final = 1e-11
"""Of the size of what is computed: what floating point may have lost."""

_TAYLOR: Final = 1e-12  # of the size of a series: largest remainder of a position
_STEP: Final = 1e-9  # of the size: what is no way
_MOST_CELLS: Final = 1 << 17
_CHUNK: Final = 1 << 21


@dataclass(frozen=True, eq=False)
class Patches(Pieces):
    """K polynomials that follow each other, on parameters of a curve.

    Attributes:
        control_m: Shape (K, 8, 2), control points.
        off: Shape (K, 4), how far the curve's position and first three derivatives may lie from the polynomial's.
    """

    control_m: FloatArray
    off: FloatArray

    def at_index(self, s: FloatArray) -> IntArray:
        """The patches in which some parameters (P,) lie, shape (P,)."""
        return np.clip(np.searchsorted(self.begins_s, s, side="right") - 1, 0, len(self.begins_s) - 1)

    def cut(self, breaks_s: FloatArray) -> "Patches":
        """The same curve, each patch cut wherever one of the places lies inside of it."""
        inside = (breaks_s > self.begins_s[0]) & (breaks_s < self.ends_s[-1])
        edges = np.unique(np.concatenate((self.begins_s, self.ends_s[-1:], breaks_s[inside])))
        of = self.taken(self.at_index(edges[:-1]))
        low, high = ((ends - of.begins_s) / (of.ends_s - of.begins_s) for ends in (edges[:-1], edges[1:]))
        return Patches(edges[:-1], edges[1:], part(of.control_m, low, np.minimum(high, 1.0)), of.off)

    def derivative(self, order: int) -> FloatArray:
        """Control points of a derivative, shape (K, 8 - order, 2)."""
        return derivative(self.control_m, self.ends_s - self.begins_s, order)

    def at(self, s: FloatArray) -> FloatArray:
        """Positions at some parameters (P,), shape (P, 2)."""
        of = self.taken(self.at_index(s))
        share = np.clip((s - of.begins_s) / (of.ends_s - of.begins_s), 0.0, 1.0)
        return part(of.control_m, share, np.ones(len(s)))[:, 0]

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
    return in_a_row([_KINDS[piece["kind"]](piece) for piece in pieces_of(curve)])


def pieces_of(curve: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """The curves of which a curve of a plan file is joined."""
    return [piece for leg in curve["legs"] for piece in pieces_of(leg)] if curve["kind"] == "joined" else [curve]


def in_a_row(parts: list[Patches]) -> Patches:
    """One curve of several: each begins where the one before it ends."""
    starts = np.cumsum([0.0, *(each.ends_s[-1] for each in parts)])
    begins = np.concatenate([each.begins_s + start for each, start in zip(parts, starts, strict=False)])
    # Where one ends and the next one begins is one place, and not two that differ by rounding.
    control, off = (np.concatenate([getattr(each, name) for each in parts]) for name in ("control_m", "off"))
    return Patches(begins, np.append(begins[1:], starts[-1]), control, off)


def _fourier(curve: Mapping[str, Any]) -> Patches:
    """A wave a sin(w t + p) is the imaginary part of a exp(i (w t + p)), whose k-th derivative is (i w)^k times it."""
    amplitudes = np.array(curve["coefficients_m"], dtype=np.float64).reshape(-1, 2)
    duration, base, slope = float(curve["duration_s"]), np.array(curve["base_m"]), np.array(curve["slope_m_s"])
    rates, order = np.arange(1, len(amplitudes) + 1) * (np.pi / duration), DEGREE + 1
    norms = np.hypot(*amplitudes.T)
    size = float(np.abs(base).max() + np.abs(slope).max() * duration + norms.sum()) + 1e-3
    # Half a cell so wide that the remainder of the position is as small as asked, and no wave turns by more than 1 rad.
    steepest = float((norms * rates**order).sum())
    half = min((_TAYLOR * size * factorial(order) / max(steepest, 1e-300)) ** (1.0 / order), 1.0 / rates[-1])
    cells = int(np.ceil(duration / (2.0 * half)))
    if not 0 < cells <= _MOST_CELLS:
        raise ValueError("the waves of a curve are too fast")
    edges, half = np.linspace(0.0, duration, cells + 1), duration / (2.0 * cells)
    middles, phase = edges[:-1] + half, {"even": 0.5 * np.pi, "odd": 0.0}[curve["extension"]]
    terms = np.stack([(1j * rates * half) ** k / factorial(k) for k in range(order)], axis=1)[..., None]
    terms = (terms * amplitudes[:, None]).reshape(len(rates), 2 * order)
    rows = np.array_split(middles, -(-cells * len(rates) // _CHUNK))
    waves = [(np.exp(1j * (np.multiply.outer(some, rates) + phase)) @ terms).imag for some in rows]
    jets = np.concatenate(waves).reshape(cells, order, 2)
    jets[:, 0] += base + np.multiply.outer(middles, slope)
    jets[:, 1] += slope * half
    # t = 2 u - 1 on each cell; comb is 0 where i > k.
    turned = [[comb(k, i) * 2.0**i * (-1.0) ** (k - i) for k in range(order)] for i in range(order)]
    control = of_powers(np.einsum("ik,ckx->cix", np.array(turned), jets), DEGREE)
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
    return _exact(np.concatenate(([0.0], np.cumsum(lasts))), of_powers(powers, DEGREE))


def _bezier(curve: Mapping[str, Any]) -> Patches:
    """Control points as they are, their degree raised."""
    control = np.array(curve["controls_m"], dtype=np.float64)
    if not 2 <= control.shape[1] <= DEGREE + 1:  # noqa: PLR2004 - a point is no polynomial
        raise ValueError("the pieces of a curve have degree 1 to 7")
    return _exact(np.array(curve["knots_s"], dtype=np.float64), raised(control, DEGREE))


def _exact(knots_s: FloatArray, control: FloatArray) -> Patches:
    """Patches without a remainder; those that last no time, but for rounding, are points, and are left out."""
    if len(knots_s) != len(control) + 1 or not np.isfinite(control).all() or (np.diff(knots_s) < 0.0).any():
        raise ValueError("the knots of a curve ascend, and its points are finite")
    lasts, size = np.diff(knots_s) > ROUNDING * knots_s[-1], float(np.abs(control).max(initial=1.0))
    if knots_s[0] != 0.0 or np.ptp(control[~lasts], axis=1).max(initial=0.0) > _STEP * size:
        raise ValueError("a curve begins at 0, and goes nowhere in no time")
    kept = np.flatnonzero(lasts)
    off = np.stack([ROUNDING * size / np.diff(knots_s)[kept] ** order for order in range(4)], axis=1)
    return Patches(knots_s[kept], knots_s[kept + 1], control[kept], np.minimum(off, 1e-6 * size))


_KINDS: Final[Mapping[str, Callable[[Mapping[str, Any]], Patches]]] = {
    "fourier": _fourier,
    "rounded polyline": _rounded,
    "bezier": _bezier,
}
