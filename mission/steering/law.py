"""A monotone s = sigma(t) with a bounded third derivative: cubic between knots, joined with two derivatives."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike

from mission.geometry.arrays import FloatArray, IntArray, frozen_floats

_SAME_TIME_S: Final = 1e-12
_BISECTIONS: Final = 60
_ROUNDING: Final = 1e-6
"""What is rounding at the end of a law, as a part of the largest."""
_TINY: Final = 1e-100  # against 0 / 0
_CONSISTENT: Final = 1e-8
"""By how much, as a part of the largest, a knot may be off the piece that leads to it: rounding."""


@dataclass(frozen=True, eq=False)
class TimeLaw:
    """Where on a curve a vehicle is at each time: sigma'' is linear between knots.

    Attributes:
        knots_t_s: Shape (K + 1,), times, from 0, never decreasing.
        knots_s: Shape (K + 1,), the curve's parameter there, never decreasing.
        rates: Shape (K + 1,), sigma' there, at least 0.
        growths: Shape (K + 1,), sigma'' there.

    Raises:
        ValueError: One of these is not so, or the knots do not belong to one law.
    """

    knots_t_s: FloatArray
    knots_s: FloatArray
    rates: FloatArray
    growths: FloatArray

    def __post_init__(self) -> None:
        names = ("knots_t_s", "knots_s", "rates", "growths")
        for name in names:
            object.__setattr__(self, name, frozen_floats(getattr(self, name)))
        values = [getattr(self, name) for name in names]
        if values[0].ndim != 1 or len(values[0]) < 2 or any(each.shape != values[0].shape for each in values):  # noqa: PLR2004 - one piece
            raise ValueError("a time law needs two knots or more, with a time, a place, a rate and a growth each")
        if not all(np.isfinite(each).all() for each in values) or self.knots_t_s[0] != 0.0:
            raise ValueError("the numbers of a time law are finite, and it begins at time 0")
        steps = np.diff(self.knots_t_s)
        if (steps < 0).any() or (np.diff(self.knots_s) < 0).any() or (self.rates < 0).any():
            raise ValueError("a time law never runs backwards")
        places, rates = self._within(np.arange(len(steps)), steps)[:2]
        if (
            np.abs(places - self.knots_s[1:]).max() > _CONSISTENT * (1.0 + float(np.abs(self.knots_s).max()))
            or np.abs(rates - self.rates[1:]).max() > _CONSISTENT * (1.0 + float(self.rates.max()))
            or self._slowest() < -_CONSISTENT * (1.0 + float(self.rates.max()))
        ):
            raise ValueError("the knots of a time law do not belong together")

    @property
    def duration_s(self) -> float:
        """Time from the start of the flight of the curve to its end."""
        return float(self.knots_t_s[-1])

    @cached_property
    def jerks(self) -> FloatArray:
        """The third derivative of sigma on each piece, shape (K,)."""
        steps, gains = np.diff(self.knots_t_s), np.diff(self.growths)
        return frozen_floats(np.divide(gains, steps, out=np.zeros_like(gains), where=steps > 0))

    def _slowest(self) -> float:
        """The least rate inside of pieces where it has a minimum there; infinite where none has."""
        begin, end, steps = self.growths[:-1], self.growths[1:], np.diff(self.knots_t_s)
        dips = (begin < 0.0) & (end > 0.0)
        least = self.rates[:-1][dips] - 0.5 * begin[dips] ** 2 * steps[dips] / (end[dips] - begin[dips])
        return float(least.min(initial=math.inf))

    def _within(self, piece: IntArray, elapsed: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """sigma, sigma' and sigma'' so long after the beginning of a piece."""
        rate, growth, jerk = self.rates[piece], self.growths[piece], self.jerks[piece]
        place = self.knots_s[piece] + elapsed * (rate + elapsed * (growth / 2.0 + elapsed * jerk / 6.0))
        return place, rate + elapsed * (growth + elapsed * jerk / 2.0), growth + elapsed * jerk

    def piece_at(self, t_s: FloatArray) -> IntArray:
        """The piece of each time (P,); the later one where two meet."""
        return np.clip(np.searchsorted(self.knots_t_s, t_s, side="right") - 1, 0, len(self.knots_t_s) - 2)

    def jet(self, t_s: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
        """sigma, sigma' and sigma'' at the times ``t_s`` (P,), each (P,); as at its ends outside its span."""
        times = np.clip(np.atleast_1d(np.asarray(t_s, dtype=np.float64)), 0.0, self.duration_s)
        piece = self.piece_at(times)
        place, rate, growth = self._within(piece, times - self.knots_t_s[piece])
        return np.clip(place, self.knots_s[piece], self.knots_s[piece + 1]), np.maximum(rate, 0.0), growth

    def parameter(self, t_s: ArrayLike) -> FloatArray:
        """sigma(t) at the times ``t_s`` (P,), shape (P,)."""
        return self.jet(t_s)[0]

    def time_at(self, s: ArrayLike) -> FloatArray:
        """The first time at which sigma reaches each place (P,), shape (P,)."""
        asked = np.atleast_1d(np.asarray(s, dtype=np.float64))
        piece = np.clip(np.searchsorted(self.knots_s, asked, side="left") - 1, 0, len(self.knots_s) - 2)
        low, high = np.zeros(len(asked)), np.diff(self.knots_t_s)[piece]
        place, rate, growth, jerk = self.knots_s[piece], self.rates[piece], self.growths[piece], self.jerks[piece]
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            reached = place + middle * (rate + middle * (growth / 2.0 + middle * jerk / 6.0)) >= asked
            low, high = np.where(reached, low, middle), np.where(reached, middle, high)
            if (high - low).max(initial=0.0) <= _SAME_TIME_S:
                break
        return np.asarray(self.knots_t_s[piece] + np.where(asked > self.knots_s[0], high, 0.0))

    def left_at(self, s: ArrayLike) -> FloatArray:
        """The last time at which the vehicle is at each place (P,) or before it, shape (P,)."""
        asked = np.atleast_1d(np.asarray(s, dtype=np.float64))
        stood = np.searchsorted(self.knots_s, asked, side="right") - 1
        at_knot = self.knots_s[np.maximum(stood, 0)] == asked
        return np.where(at_knot, self.knots_t_s[np.maximum(stood, 0)], self.time_at(asked))

    def to_json(self) -> dict[str, Any]:
        """The law as JSON values; ``from_json`` gives it back bit by bit."""
        return {
            "knots_t_s": self.knots_t_s.tolist(),
            "knots_s": self.knots_s.tolist(),
            "rates": self.rates.tolist(),
            "growths": self.growths.tolist(),
        }

    @staticmethod
    def from_json(data: Mapping[str, Any]) -> "TimeLaw":
        """The law that ``to_json`` wrote; raises KeyError, TypeError or ValueError where it is not one."""
        return TimeLaw(data["knots_t_s"], data["knots_s"], data["rates"], data["growths"])


def law_from_growths(
    times: FloatArray, growths: FloatArray, rates: tuple[float, float], ends_s: tuple[float, float]
) -> TimeLaw:
    """The law with these sigma'' between these ends; what rounding leaves at the end is taken off all of them.

    Rounding of a sigma'' early in a long law moves its end by as much as there is time to go.
    """
    inner = np.ones(len(times))
    inner[[0, -1]] = 0.0
    shapes = inner, inner * (2.0 * times / max(float(times[-1]), _TINY) - 1.0)
    speeds, places = integrated(times, growths, rates[0])
    off = np.array([rates[1] - speeds[-1], ends_s[1] - ends_s[0] - places[-1]])
    largest = np.array([1.0 + float(np.abs(speeds).max()), 1.0 + ends_s[1] - ends_s[0]])
    if len(times) > len(rates) + len(ends_s) and (np.abs(off) <= _ROUNDING * largest).all():
        moved = np.array([[each[-1] for each in integrated(times, shape, 0.0)] for shape in shapes]).T
        growths = growths + np.linalg.lstsq(moved, off, rcond=None)[0] @ np.array(shapes)
        speeds, places = integrated(times, growths, rates[0])
    speeds = np.maximum(speeds, 0.0)
    speeds[-1] = rates[1]
    places = np.minimum(ends_s[0] + np.maximum.accumulate(places), ends_s[1])
    places[-1] = ends_s[1]
    return TimeLaw(times, places, speeds, growths)


def integrated(times: FloatArray, growths: FloatArray, rate: float) -> tuple[FloatArray, FloatArray]:
    """The rates and places, from 0, that growths lead to."""
    steps = np.diff(times)
    rates = rate + np.concatenate(([0.0], np.cumsum(steps * 0.5 * (growths[:-1] + growths[1:]))))
    moves = steps * (rates[:-1] + steps * (2.0 * growths[:-1] + growths[1:]) / 6.0)
    return rates, np.concatenate(([0.0], np.cumsum(moves)))
