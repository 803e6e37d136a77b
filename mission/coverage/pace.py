"""How fast the vehicle is on a polyline with rounded corners: what chooses headings and orders of lanes counts by it.

A corner that turns by phi is rounded within the reach d by a blend of ``mission.steering.rounded``, which takes as long
as the way round the corner at the even rate that its sharpest place admits. There |r''| = 3/2 s / d and |r'''| =
3 s / d^2 for r' of the length 1 at its ends, with s = sin(phi / 2), so that at the speed v

    v^2 <= a d / (3/2 s)    and    v^3 <= j d^2 / (3 s).

Between corners the speed changes by D within D / a + a / j, evenly but for the jerk at both ends of that time.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from mission.geometry.arrays import FloatArray

_STILL: Final = 1e-9
_LONGER: Final = 1.0 + 1e-6  # rounding
_MIDDLE: Final = 0.5
"""How much the speed in the middle of a corner counts beside that at its ends."""
_AT_ONCE: Final = 1e9
"""Metres per second squared: what is faster than that takes no time."""


@dataclass(frozen=True)
class Pace:
    """How fast the vehicle is, so that turns cost time.

    Attributes:
        speed_m_s: Cruise speed, positive.
        acceleration_m_s2: a, positive; infinite for turns that cost nothing.
        jerk_m_s3: j, positive or infinite.
        reach_m: Within which corners are rounded at most, positive. Each has no more than half of the shorter piece
            beside it.
    """

    speed_m_s: float
    acceleration_m_s2: float
    jerk_m_s3: float
    reach_m: float

    def corner(self, cosines: FloatArray, reaches_m: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The speed where corners between directions with these cosines begin and end, and how long they take.

        All are of one shape; corners are rounded within these reaches.
        """
        sines = np.sqrt(np.clip((1.0 - cosines) / 2.0, 0.0, 1.0))
        with np.errstate(divide="ignore", invalid="ignore"):
            bent = np.sqrt(self._acceleration * reaches_m / (1.5 * sines))
            shaken = np.cbrt(self.jerk_m_s3 * reaches_m**2 / (3.0 * sines))
        ends = np.fmax(np.fmin(shaken, self.speed_m_s), _STILL)
        return ends, 2.0 * reaches_m / (_MIDDLE * np.fmin(bent, ends) + (1.0 - _MIDDLE) * ends + _STILL)

    def link_s(self, lengths_m: FloatArray, leaving: FloatArray, arriving: FloatArray) -> FloatArray:
        """Time that ways cost between lanes that are flown at cruise speed elsewhere, all arguments of one shape.

        Args:
            lengths_m: Of the ways; infinite where there is none. Those of no length have one corner.
            leaving: Cosine of the angle between a lane and the way after it; not finite where the way begins at rest.
            arriving: Likewise between the way and the lane after it, where it ends at rest.
        """
        times = np.zeros(np.shape(lengths_m))
        reaches, speeds = [], []
        for cosines in (leaving, arriving):
            moving = np.isfinite(cosines)
            halves = np.where(lengths_m > _STILL, lengths_m / 2.0, np.inf)
            reach = np.where(moving, np.minimum(halves, self.reach_m), 0.0)
            speed, lasts_s = self.corner(np.where(moving, cosines, 1.0), reach)
            lost = (self.speed_m_s - speed) / self.speed_m_s / 2.0 * self._gaining_s(self.speed_m_s - speed)
            times += np.where(moving, lost + lasts_s - reach / self.speed_m_s, 0.0)
            reaches.append(reach)
            speeds.append(np.where(moving, speed, 0.0))
        straight = np.maximum(lengths_m - reaches[0] - reaches[1], 0.0)
        found = np.where(np.isfinite(lengths_m), straight, 0.0)
        # A way of no length has no corner but the one of its two that bends.
        between = np.where(lengths_m > _STILL, self._straight_s(found, speeds[0], speeds[1]), 0.0)
        return np.where(np.isfinite(lengths_m), times + between, np.inf)

    def duration_s(self, line_m: FloatArray, reaches_m: FloatArray | None = None) -> float:
        """Time that a polyline of shape (k, 2) takes from rest to rest.

        Its corners are rounded as widely as they may be, or within given reaches, shape (k - 2,); then no two of its
        places that follow each other are the same.
        """
        steps = np.diff(line_m, axis=0)
        lengths = np.linalg.norm(steps, axis=1)
        steps, lengths = steps[lengths > 0.0], lengths[lengths > 0.0]
        if not len(lengths):
            return 0.0
        units = steps / lengths[:, None]
        reaches = np.minimum(np.minimum(lengths[:-1], lengths[1:]) / 2.0, self.reach_m)
        reaches = reaches if reaches_m is None else reaches_m
        corners, turning = self.corner((units[:-1] * units[1:]).sum(axis=1), reaches)
        speeds = np.concatenate(([0.0], corners, [0.0]))
        straight = lengths - np.append(reaches, 0.0) - np.insert(reaches, 0, 0.0)
        # One sweep forwards and one backwards: no corner is passed faster than one can get there, or slow down after.
        for i, length in enumerate(lengths.tolist()):
            speeds[i + 1] = min(speeds[i + 1], self._gained_m_s(float(speeds[i]), length))
        for i in range(len(lengths) - 1, -1, -1):
            speeds[i] = min(speeds[i], self._gained_m_s(float(speeds[i + 1]), float(lengths[i])))
        times = self._straight_s(straight, speeds[:-1], speeds[1:])
        # Where it is slower than the corner admits, it is so in all of it.
        turning *= np.maximum(corners / np.maximum(speeds[1:-1], _STILL), 1.0)
        return float(times.sum() + turning.sum())

    @property
    def _acceleration(self) -> float:
        return min(self.acceleration_m_s2, _AT_ONCE)

    @property
    def _rise_s(self) -> float:
        """The time in which the acceleration comes up."""
        return self._acceleration / self.jerk_m_s3 if self.acceleration_m_s2 < _AT_ONCE else 0.0

    def _gaining_s(self, change_m_s: FloatArray) -> FloatArray:
        """How long the speed changes by so much."""
        return np.where(change_m_s > _STILL, change_m_s / self._acceleration + self._rise_s, 0.0)

    def _gained_m_s(self, speed_m_s: float, length_m: float) -> float:
        """The speed after a length, from one at its begin."""
        lag = self._acceleration * self._rise_s
        square = lag**2 / 4.0 + speed_m_s**2 - lag * speed_m_s + 2.0 * self._acceleration * length_m
        return max(speed_m_s, float(np.sqrt(max(square, 0.0))) - lag / 2.0)

    def _straight_s(self, lengths_m: FloatArray, begins_m_s: FloatArray, ends_m_s: FloatArray) -> FloatArray:
        """The time on straight parts between two speeds."""
        lag = self._acceleration * self._rise_s
        square = (begins_m_s**2 + ends_m_s**2 - lag * (begins_m_s + ends_m_s)) / 2.0 + self._acceleration * lengths_m
        top = np.sqrt(np.maximum(lag**2 / 4.0 + square, 0.0)) - lag / 2.0
        top = np.maximum(np.minimum(top, self.speed_m_s), np.maximum(begins_m_s, ends_m_s))
        times, passed = np.zeros(np.shape(lengths_m)), np.zeros(np.shape(lengths_m))
        for speed in (begins_m_s, ends_m_s):
            gaining = self._gaining_s(top - speed)
            times = times + gaining
            passed = passed + gaining * (top + speed) / 2.0
        left = np.maximum(lengths_m - passed, 0.0) / np.maximum(top, _STILL)
        # On a part too short for that the speed changes in the corners as well.
        steady = 2.0 * lengths_m / np.maximum(begins_m_s + ends_m_s, _STILL)
        return np.where(passed > _LONGER * lengths_m, steady, times + left)
