"""Seeded noise: every source of randomness has a generator of its own, so none depends on who asks when."""

from collections.abc import Callable, Iterator
from math import exp, sqrt
from typing import Final

import numpy as np

_BLOCK: Final = 512


def _stream(generator: np.random.Generator) -> Iterator[float]:
    while True:
        yield from generator.standard_normal(_BLOCK).tolist()


class Normals:
    """A stream of standard normal numbers, drawn in blocks because that is fifty times faster than one by one.

    `draw()` returns the next number.
    """

    __slots__ = ("draw",)

    def __init__(self, seed: int, source: int) -> None:
        """Begin the stream of `source`, an arbitrary number that no other source of the vehicle has."""
        generator = np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=(source,))))
        self.draw: Callable[[], float] = _stream(generator).__next__


class GaussMarkov:
    """A first-order Gauss-Markov process, exactly discretised: exponentially correlated, stationary from the start."""

    __slots__ = ("_decay", "_kick", "_normals", "std", "value")

    def __init__(self, normals: Normals, *, std: float, time_s: float, step_s: float) -> None:
        """Correlate over `time_s` with standard deviation `std`, sampled every `step_s`."""
        self._normals = normals
        self._decay = exp(-step_s / time_s)
        self._kick = sqrt(1.0 - self._decay * self._decay)
        self.std = std
        self.value = std * normals.draw()

    def step(self) -> float:
        """Go on by one step and return the new value."""
        self.value = self._decay * self.value + self._kick * self.std * self._normals.draw()
        return self.value
