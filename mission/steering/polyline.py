"""A polyline at one speed: what is planned before it is smoothed, where no fields steer."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from mission.geometry.arrays import FloatArray, frozen_floats


@dataclass(frozen=True, eq=False)
class Polyline:
    """A polyline that is passed at one speed.

    Attributes:
        points_m: Shape (n, 2), n >= 1, its corners.
        speed_m_s: The speed, positive.
        lap: Of a flight of laps, the indices of the corners at which the lap begins and ends.

    Raises:
        ValueError: One of these is not so.
    """

    points_m: FloatArray
    speed_m_s: float
    lap: tuple[int, int] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "points_m", frozen_floats(self.points_m))
        points = self.points_m
        if points.ndim != 2 or points.shape[1] != 2 or not len(points) or not np.isfinite(points).all():  # noqa: PLR2004 - plane
            raise ValueError("a polyline has a corner or more, of two finite numbers each")
        if not (np.isfinite(self.speed_m_s) and self.speed_m_s > 0.0):
            raise ValueError("the speed is positive")
        if self.lap is not None and not 0 <= self.lap[0] <= self.lap[1] < len(points):
            raise ValueError("the lap begins and ends at corners")

    def then(self, onward: "Polyline") -> "Polyline":
        """This one with another after it, which begins where this one ends."""
        return Polyline(np.concatenate((self.points_m, onward.points_m[1:])), self.speed_m_s, self.lap)

    @cached_property
    def knots_s(self) -> FloatArray:
        """When each corner is passed, shape (n,)."""
        steps = np.diff(self.points_m, axis=0)
        return frozen_floats(np.append(0.0, np.cumsum(np.hypot(steps[:, 0], steps[:, 1]))) / self.speed_m_s)

    @property
    def duration_s(self) -> float:
        """How long it takes."""
        return float(self.knots_s[-1])

    @property
    def length_m(self) -> float:
        """Arc length."""
        return self.duration_s * self.speed_m_s

    @property
    def lap_s(self) -> tuple[float, float] | None:
        """When the lap begins and ends."""
        return None if self.lap is None else (float(self.knots_s[self.lap[0]]), float(self.knots_s[self.lap[1]]))

    def position(self, t_s: ArrayLike) -> FloatArray:
        """Position at the times ``t_s`` (T,), shape (T, 2), metres."""
        times = np.atleast_1d(np.asarray(t_s, dtype=np.float64))
        return np.stack([np.interp(times, self.knots_s, self.points_m[:, axis]) for axis in (0, 1)], axis=1)

    def velocity(self, t_s: ArrayLike) -> FloatArray:
        """Velocity at the times ``t_s`` (T,), shape (T, 2), m/s; at a corner, of the part after it."""
        if self.duration_s == 0.0:
            return np.zeros((len(np.atleast_1d(t_s)), 2))
        moving = np.append(np.diff(self.knots_s) > 0.0, True)
        knots, points = self.knots_s[moving], self.points_m[moving]
        slopes = np.diff(points, axis=0) / np.diff(knots)[:, None]
        times = np.atleast_1d(np.asarray(t_s, dtype=np.float64))
        return np.asarray(slopes[np.clip(np.searchsorted(knots, times, side="right") - 1, 0, len(slopes) - 1)])

    def to_json(self) -> dict[str, Any]:
        """The polyline as JSON values; ``from_json`` gives it back bit by bit."""
        return {"points_m": self.points_m.tolist(), "speed_m_s": self.speed_m_s, "lap": self.lap}

    @staticmethod
    def from_json(data: Mapping[str, Any]) -> "Polyline":
        """The polyline that ``to_json`` wrote; raises KeyError, TypeError or ValueError where it is not one."""
        lap = data["lap"]
        return Polyline(data["points_m"], float(data["speed_m_s"]), None if lap is None else (int(lap[0]), int(lap[1])))
