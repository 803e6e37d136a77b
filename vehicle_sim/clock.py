"""Clocks: the vehicle's own, which counts steps, and the wall's, for the program that paces it."""

import time
from typing import Protocol


class Clock(Protocol):
    """Anything that tells seconds which never run backwards."""

    def now_s(self) -> float:
        """Return the seconds since some fixed moment."""
        ...


class WallClock:
    """The machine's monotonic clock."""

    def now_s(self) -> float:
        """Return the seconds since an arbitrary moment, unaffected by changes of the date."""
        return time.monotonic()


class StepClock:
    """Vehicle time: an integer number of steps of fixed length, so that no rounding error accumulates."""

    __slots__ = ("_step_s", "steps")

    def __init__(self, step_s: float) -> None:
        """Start at zero; `step_s` is the length of one step in seconds."""
        self._step_s = step_s
        self.steps = 0

    def advance(self) -> float:
        """Count one step and return the time after it, in seconds."""
        self.steps += 1
        return self.steps * self._step_s

    def now_s(self) -> float:
        """Return the seconds of vehicle time since boot."""
        return self.steps * self._step_s
