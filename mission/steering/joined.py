"""Curves that are flown from rest to rest, one after the other, as one curve."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from mission.geometry.arrays import FloatArray, IntArray, frozen_floats
from mission.steering.smoothing import FourierCurve

_APART = 1e-11
"""How far ends that are one point may lie apart, as a part of their coordinates: rounding."""


@dataclass(frozen=True, eq=False)
class JoinedCurve:
    """Smooth legs, each of which begins where the one before it ends; there the direction may jump.

    Attributes:
        legs: At least one; each on its own [0, T].

    Raises:
        ValueError: Two legs do not join, or there is none.
    """

    legs: tuple[FourierCurve, ...]

    def __post_init__(self) -> None:
        if not self.legs:
            raise ValueError("a curve has one leg at least")
        if not all(joins(before, after) for before, after in pairwise(self.legs)):
            raise ValueError("the legs of a curve do not join")

    @cached_property
    def starts_s(self) -> FloatArray:
        """Where each leg begins, and the end, shape (len(legs) + 1,)."""
        return frozen_floats(np.concatenate(([0.0], np.cumsum([leg.duration_s for leg in self.legs]))))

    @property
    def duration_s(self) -> float:
        """T, the steering time of all legs."""
        return float(self.starts_s[-1])

    @property
    def frequencies(self) -> int:
        """Number of waves of the leg that has most."""
        return max(leg.frequencies for leg in self.legs)

    def placed(self, s: FloatArray) -> Iterator[tuple[FourierCurve, IntArray, FloatArray]]:
        """For each leg: itself, the indices of the ``s`` (P,) that lie on it, and its own parameter there.

        Where two legs meet, the later one counts.
        """
        which = np.clip(np.searchsorted(self.starts_s, s, side="right") - 1, 0, len(self.legs) - 1)
        for number, leg in enumerate(self.legs):
            found = np.flatnonzero(which == number)
            yield leg, found, np.clip(s[found] - self.starts_s[number], 0.0, leg.duration_s)

    def derivative(self, s: ArrayLike, order: int) -> FloatArray:
        """The derivative d^order r / ds^order at the parameters ``s`` (P,), shape (P, 2); order 0 is the position."""
        asked = np.atleast_1d(np.asarray(s, dtype=np.float64))
        values = np.empty((len(asked), 2))
        for leg, found, own in self.placed(asked):
            values[found] = leg.derivative(own, order)
        return values

    def position(self, s: ArrayLike) -> FloatArray:
        """Points of the curve, shape (P, 2), at the parameters ``s`` (P,)."""
        return self.derivative(s, 0)


def joins(before: FourierCurve, after: FourierCurve) -> bool:
    """Whether one curve ends where the other begins."""
    end, begin = before.position([before.duration_s])[0], after.position([0.0])[0]
    return float(np.abs(end - begin).max()) <= _APART * (1.0 + float(np.abs(end).max()))
