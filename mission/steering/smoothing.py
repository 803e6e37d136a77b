"""Fourier smoothing of a planned path (paper, Sec. 4.3), with both extensions and rigorous bounds.

The planned path r*(s) lives on the steering time s in [0, T]. With w = pi / T:

- even extension (the paper's): the path is followed by its own reverse, which is a cosine series
  r(s) = a_0 + sum a_n cos(n w s). Its velocity vanishes at both ends; its end points are moved a little.
- odd extension: the straight line from start to end is taken off, the rest is continued as an odd function, which is a
  sine series r(s) = r*(0) + (r*(T) - r*(0)) s / T + sum b_n sin(n w s). Both end points are exact.

The coefficients are integrals of entire functions on each segment of the path (the flow of an affine field times a
sine), so panels of Gauss-Legendre nodes, short against both the fastest wave and the rate of the field, give them to
rounding error: with 24 nodes and a phase of 10 rad on each side of the middle the error of one panel is below 1e-15 of
the integrand.

Every derivative of the series is a vector of trigonometric polynomials of degree N. By M. Riesz's lemma such a
polynomial, around a point where it attains its largest modulus m, stays above m cos(N d) at the angular distance
d <= pi / N; so m is at most the largest sampled modulus over cos(N h / 2) on a grid of step h. That bounds derivatives
between samples within 2 %, where the sum of the coefficients' moduli would be off by the number of corners.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import simpson

from mission.geometry.arrays import FloatArray, frozen_floats
from mission.spec.model import Extension
from mission.steering.path import SteeringPath
from mission.steering.sampled import Sampled

_NODES = 24
_PHASE = 10.0  # rad on either side of a panel's middle
_GRID = 8  # samples a half period of the fastest wave
_ROUNDING = 1.0 + 1e-9  # what a bound computed in floating point is raised by
_CHUNK = 1 << 20  # most entries of one table of sines
_LARGEST = 1e12  # of larger amplitudes, what a transform or a derivative makes is no number any more


@dataclass(frozen=True, eq=False)
class FourierCurve:
    """An analytic curve r(s), 0 <= s <= T: a constant, a uniform motion and a series of cosines or of sines.

    Attributes:
        extension: Even (cosines) or odd (sines).
        duration_s: T, the steering time of the path that it smooths.
        base_m: Shape (2,), the constant term.
        slope_m_s: Shape (2,), the uniform motion (zero for the even extension).
        coefficients_m: Shape (N, 2), the amplitude of the n-th wave in row n - 1; N >= 1.
    """

    extension: Extension
    duration_s: float
    base_m: FloatArray
    slope_m_s: FloatArray
    coefficients_m: FloatArray

    def __post_init__(self) -> None:
        for name in ("base_m", "slope_m_s", "coefficients_m"):
            object.__setattr__(self, name, frozen_floats(getattr(self, name)))
        if self.base_m.shape != (2,) or self.slope_m_s.shape != (2,):
            raise ValueError("the constant and the slope of a plane curve are two numbers each")
        if self.coefficients_m.ndim != 2 or self.coefficients_m.shape[1] != 2 or not len(self.coefficients_m):  # noqa: PLR2004 - plane
            raise ValueError("a series needs at least one row of two amplitudes")
        if not (math.isfinite(self.duration_s) and self.duration_s > 0):
            raise ValueError("the duration of a curve must be positive and finite")
        if not all(
            (np.abs(getattr(self, name)) < _LARGEST).all() for name in ("base_m", "slope_m_s", "coefficients_m")
        ):
            raise ValueError(f"the numbers of a curve must be finite, and less than {_LARGEST:g}")

    @property
    def frequencies(self) -> int:
        """Number of waves, N."""
        return len(self.coefficients_m)

    @cached_property
    def _rates(self) -> FloatArray:
        """Angular rates n w of the waves, rad/s, shape (N,)."""
        return frozen_floats(np.arange(1, self.frequencies + 1) * (math.pi / self.duration_s))

    def truncated(self, frequencies: int) -> "FourierCurve":
        """The curve of the first ``frequencies`` waves; they do not depend on how many more were fitted."""
        if not 1 <= frequencies <= self.frequencies:
            raise ValueError(f"a series of {self.frequencies} waves cannot be cut to {frequencies}")
        cut = self.coefficients_m[:frequencies]
        return FourierCurve(self.extension, self.duration_s, self.base_m, self.slope_m_s, cut)

    def position(self, s: ArrayLike) -> FloatArray:
        """Points of the curve, shape (P, 2), at the steering times ``s`` of shape (P,)."""
        return self.derivative(s, 0)

    def derivative(self, s: ArrayLike, order: int) -> FloatArray:
        """The derivative d^order r / ds^order, shape (P, 2), in m/s^order; order 0 is the position."""
        times = np.atleast_1d(np.asarray(s, dtype=np.float64))
        values = np.empty((len(times), 2))
        rows = max(1, _CHUNK // self.frequencies)
        # Each derivative of a wave is a wave a quarter period ahead; sign and kind are chosen exactly.
        quarter = (order + (3 if self.extension is Extension.ODD else 0)) % 4
        wave = np.cos if quarter % 2 == 0 else np.sin
        weights = self.coefficients_m * (self._rates**order)[:, None]
        if quarter in {1, 2}:
            weights = -weights
        for start in range(0, len(times), rows):
            part = slice(start, start + rows)
            values[part] = wave(np.multiply.outer(times[part], self._rates)) @ weights
        return values + self._polynomial(times, order)

    def jet(self, s: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Position, first and second derivative, each of shape (P, 2), from one table of sines and cosines."""
        times = np.atleast_1d(np.asarray(s, dtype=np.float64))
        phases = np.multiply.outer(times, self._rates)
        first, second = np.cos(phases), np.sin(phases)
        rated = self.coefficients_m * self._rates[:, None]
        if self.extension is Extension.EVEN:
            wave, slope = first @ self.coefficients_m, -second @ rated
            bend = -first @ (rated * self._rates[:, None])
        else:
            wave, slope = second @ self.coefficients_m, first @ rated
            bend = -second @ (rated * self._rates[:, None])
        return wave + self._polynomial(times, 0), slope + self._polynomial(times, 1), bend

    def on_grid(self, cells: int, order: int) -> FloatArray:
        """The derivative of that order at s = j T / cells, j = 0..cells, shape (cells + 1, 2), by one FFT.

        ``cells`` must exceed the number of frequencies.
        """
        if cells <= self.frequencies:
            raise ValueError(f"a grid of {cells} cells is too coarse for {self.frequencies} waves")
        kind = 1.0 if self.extension is Extension.EVEN else -1j
        factors = kind * 1j ** (order % 4) * self._rates**order
        spectrum = np.zeros((cells + 1, 2), dtype=np.complex128)
        spectrum[1 : self.frequencies + 1] = cells * self.coefficients_m * factors[:, None]
        waves = np.fft.irfft(spectrum, n=2 * cells, axis=0)[: cells + 1]
        times = np.linspace(0.0, self.duration_s, cells + 1)
        return np.asarray(waves + self._polynomial(times, order), dtype=np.float64)

    def sampled(self, fewest: int) -> Sampled:
        """The curve at evenly spaced knots: ``fewest`` pieces, or as many more as its waves need."""
        cells = max(fewest, self.frequencies + 1)
        knots = np.linspace(0.0, self.duration_s, cells + 1)
        return Sampled(knots, *(self.on_grid(cells, order) for order in range(3)))

    @cached_property
    def length_m(self) -> float:
        """Arc length, by Simpson's rule on sixteen cells a half period of the fastest wave."""
        cells = 16 * self.frequencies
        slopes = self.on_grid(cells, 1)
        return float(simpson(np.hypot(slopes[:, 0], slopes[:, 1]), dx=self.duration_s / cells))

    @cached_property
    def suprema(self) -> tuple[float, ...]:
        """Proved upper bounds of the norms of the first to the fifth derivative on the whole curve, in this order."""
        cells = _GRID * self.frequencies
        spread = _ROUNDING / math.cos(math.pi / (2 * _GRID))
        return tuple(spread * float(np.linalg.norm(self.on_grid(cells, order), axis=1).max()) for order in range(1, 6))

    def norm_bounds(self, knots_s: FloatArray, order: int, values: FloatArray | None = None) -> FloatArray:
        """Proved upper bounds of |d^order r / ds^order| between consecutive knots, shape (K,), order 1, 2 or 3.

        On an interval of length h the derivative lies within sup |r^(order + 2)| h^2 / 8 of the chord of its end
        values, and a chord is nowhere longer than its longer end.

        Args:
            knots_s: Shape (K + 1,), ascending.
            order: 1, 2 or 3.
            values: The derivative at the knots, shape (K + 1, 2), where the caller has it already.
        """
        ends = np.linalg.norm(self.derivative(knots_s, order) if values is None else values, axis=1)
        bend = self.suprema[order + 1] * np.diff(knots_s) ** 2 / 8.0
        return np.asarray((np.maximum(ends[:-1], ends[1:]) + bend) * _ROUNDING, dtype=np.float64)

    def to_json(self) -> dict[str, Any]:
        """The curve as JSON values; ``from_json`` gives it back bit by bit."""
        return {
            "kind": "fourier",
            "extension": self.extension.value,
            "duration_s": self.duration_s,
            "base_m": self.base_m.tolist(),
            "slope_m_s": self.slope_m_s.tolist(),
            "coefficients_m": self.coefficients_m.tolist(),
        }

    @staticmethod
    def from_json(data: Mapping[str, Any]) -> "FourierCurve":
        """The curve that ``to_json`` wrote; raises KeyError, TypeError or ValueError where it is not one."""
        return FourierCurve(
            extension=Extension(data["extension"]),
            duration_s=float(data["duration_s"]),
            base_m=data["base_m"],
            slope_m_s=data["slope_m_s"],
            coefficients_m=data["coefficients_m"],
        )

    def _polynomial(self, times: FloatArray, order: int) -> FloatArray:
        """The part of the derivative that is no wave, broadcastable to (P, 2)."""
        if order == 0:
            return np.asarray(self.base_m + np.multiply.outer(times, self.slope_m_s))
        return self.slope_m_s if order == 1 else np.zeros(2)


@cache
def _rule() -> tuple[FloatArray, FloatArray]:
    """Gauss-Legendre nodes and weights on [-1, 1]."""
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    return frozen_floats(nodes), frozen_floats(weights)


def _quadrature(path: SteeringPath, fastest: float) -> tuple[FloatArray, FloatArray]:
    """Nodes and weights (both (P,)) that integrate the path times any wave up to ``fastest`` rad/s over [0, T]."""
    starts = np.array([segment.start_s for segment in path.segments])
    durations = np.array([segment.duration_s for segment in path.segments])
    rates = np.array([np.linalg.norm(segment.F) for segment in path.segments])
    counts = np.maximum(1, np.ceil((rates + fastest) * durations / (2.0 * _PHASE))).astype(np.int64)
    widths = np.repeat(durations / counts, counts)
    index = np.arange(len(widths)) - np.repeat(np.cumsum(counts) - counts, counts)
    middles = np.repeat(starts, counts) + (index + 0.5) * widths
    nodes, weights = _rule()
    return (
        (middles[:, None] + 0.5 * widths[:, None] * nodes).ravel(),
        (0.5 * widths[:, None] * weights).ravel(),
    )


def fit_fourier(path: SteeringPath, frequencies: int, extension: Extension) -> FourierCurve:
    """Fit the Fourier series of the paper's Sec. 4.3 to a planned path.

    Args:
        path: The planned path, continuous, of positive duration.
        frequencies: Number of waves N, at least 1.
        extension: How the path is continued beyond [0, T].

    Raises:
        ValueError: ``frequencies`` is below 1.
    """
    if frequencies < 1:
        raise ValueError("a Fourier series needs at least one frequency")
    duration = float(path.duration_s)
    rates = np.arange(1, frequencies + 1) * (math.pi / duration)
    nodes, weights = _quadrature(path, float(rates[-1]))
    values = path.position(nodes)
    if extension is Extension.EVEN:
        base, slope = weights @ values / duration, np.zeros(2)
    else:
        base, end = path.position(np.array([0.0, duration]))
        slope = (end - base) / duration
    weighted = weights[:, None] * (values - base - np.multiply.outer(nodes, slope)) * (2.0 / duration)
    wave = np.cos if extension is Extension.EVEN else np.sin
    rows = max(1, _CHUNK // len(nodes))
    coefficients = [
        wave(np.multiply.outer(rates[first : first + rows], nodes)) @ weighted for first in range(0, frequencies, rows)
    ]
    return FourierCurve(extension, duration, base, slope, np.concatenate(coefficients))
