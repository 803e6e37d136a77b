"""What covers a region: lanes in the order flown and the ways between them, with what they cost."""

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from mission.geometry.arrays import BoolArray, FloatArray, IntArray

_STRAIGHT: Final = 1e-12
_STILL: Final = 1e-9
_AT_ONCE: Final = 1e9
"""Metres per second squared: what is faster than that takes no time."""


@dataclass(frozen=True)
class Pace:
    """How fast the vehicle is, so that turns cost time.

    A corner that turns by an angle phi is flown at the speed v (1 - sin(phi / 2)), so that turning back means to stop.

    Attributes:
        speed_m_s: Cruise speed v, positive.
        acceleration_m_s2: Along the path, positive.
    """

    speed_m_s: float
    acceleration_m_s2: float

    def corner_s(self, arriving: FloatArray, leaving: FloatArray) -> FloatArray:
        """Time that corners cost over flying on, of unit vectors of shape (..., 2): the speed is lost and regained."""
        share = (1.0 - (arriving * leaving).sum(axis=-1)) / 2.0  # sin(phi / 2) squared
        time_s: FloatArray = np.clip(share, 0.0, 1.0) * self.speed_m_s / self.acceleration_m_s2
        return time_s

    def duration_s(self, line_m: FloatArray, widest_m: float) -> float:
        """Time that a polyline of shape (k, 2) takes from rest to rest, its corners rounded by arcs.

        An arc reaches as far as half of the shorter piece beside it, and no farther than is given; where more than a
        right angle is turned, less: turning back it would cut off all that lies before it.
        """
        acceleration = min(self.acceleration_m_s2, _AT_ONCE)
        steps = np.diff(line_m, axis=0)
        lengths = np.linalg.norm(steps, axis=1)
        steps, lengths = steps[lengths > 0.0], lengths[lengths > 0.0]
        if not len(lengths):
            return 0.0
        units = steps / lengths[:, None]
        cosines = np.clip((units[:-1] * units[1:]).sum(axis=1), -1.0, 1.0)
        reaches = np.minimum(np.minimum(lengths[:-1], lengths[1:]) / 2.0, widest_m) * np.minimum(1.0, 1.0 + cosines)
        radii = reaches * np.sqrt((1.0 + cosines) / np.maximum(1.0 - cosines, _STRAIGHT))
        squares = np.concatenate(([0.0], np.minimum(acceleration * radii, self.speed_m_s**2), [0.0]))
        lengths = lengths - np.append(reaches, 0.0) - np.insert(reaches, 0, 0.0)
        gain = 2.0 * acceleration * lengths
        # One sweep forwards and one backwards: no corner is passed faster than one can get there, or slow down after.
        for i in range(len(gain)):
            squares[i + 1] = min(squares[i + 1], squares[i] + gain[i])
        for i in range(len(gain) - 1, -1, -1):
            squares[i] = min(squares[i], squares[i + 1] + gain[i])
        top = np.minimum(self.speed_m_s, np.sqrt((squares[:-1] + squares[1:] + gain) / 2.0))
        speeds = np.sqrt(squares)
        changing = (2.0 * top**2 - squares[:-1] - squares[1:]) / (2.0 * acceleration)
        times = (2.0 * top - speeds[:-1] - speeds[1:]) / acceleration
        times += np.maximum(lengths - changing, 0.0) / np.maximum(top, _STILL)
        return float(times.sum() + (2.0 * reaches / np.maximum(speeds[1:-1], _STILL)).sum())


@dataclass(frozen=True, eq=False)
class Coverage:
    """Lanes that cover a region, in the order flown.

    All coordinates are those of the shapes given, metres; n >= 1 lanes.

    Attributes:
        heading_deg: Of the lanes that sweep, clockwise from north (the y axis), 0 <= heading < 180; where none was
            asked for, corridors across it have lanes along them.
        spacing_m: Between them, at most.
        lanes_m: Shape (n, 2, 2): lane, begin and end, xy.
        cell_of: Shape (n,), the cell that each lane belongs to; -1 for a lane of its own along a rim.
        ways_m: n - 1 polylines of shape (k, 2), k >= 2: from the end of a lane to the begin of the next.
        approach_m: Shape (k, 2), from the entry place to the first lane.
        leaving_m: Shape (k, 2), from the last lane to the exit; shape (0, 2) where none is wanted.
        exact: Whether no other order of the cells, corner to begin at in each and direction takes less time, with ways
            between lanes counted a little more than those there and back; otherwise it is the best that was found.
        duration_s: Estimated time, from rest at the entry place to rest at the exit or the last lane's end.
        complete: Whether nothing is left out that can be reached, beside what is always spared.
    """

    heading_deg: float
    spacing_m: float
    lanes_m: FloatArray
    cell_of: IntArray
    ways_m: tuple[FloatArray, ...]
    approach_m: FloatArray
    leaving_m: FloatArray
    exact: bool
    duration_s: float
    complete: bool

    @cached_property
    def _pieces(self) -> tuple[FloatArray, BoolArray]:
        points, on_lane = [self.lanes_m[0]], [[True]]
        for way, lane in zip(self.ways_m, self.lanes_m[1:], strict=True):
            points.append(way[1:])
            on_lane.append([False] * (len(way) - 1))
            points.append(lane[1:])
            on_lane.append([True])
        return np.concatenate(points), np.concatenate(on_lane).astype(np.bool_)

    @property
    def line_m(self) -> FloatArray:
        """All lanes and the ways between them, shape (p, 2): from the first lane's begin to the last lane's end."""
        return self._pieces[0]

    @property
    def on_lane(self) -> BoolArray:
        """Of each piece of the line whether it is a lane, shape (p - 1,)."""
        return self._pieces[1]

    @property
    def lanes_length_m(self) -> float:
        """All lanes."""
        return float(np.linalg.norm(self.lanes_m[:, 1] - self.lanes_m[:, 0], axis=1).sum())

    @property
    def ways_length_m(self) -> float:
        """All ways between lanes; neither the way there nor the way from there."""
        return float(sum(np.linalg.norm(np.diff(way, axis=0), axis=1).sum() for way in self.ways_m))
