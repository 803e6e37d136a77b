"""What covers a region: lanes in the order flown and the ways between them, with what they cost."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mission.geometry.arrays import BoolArray, FloatArray, IntArray


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
