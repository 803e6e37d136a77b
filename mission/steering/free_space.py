"""Free space as the search for shortest paths sees it: barriers that are hit, and corners to bend at.

Barriers are the rims, moved out of free space by a hair, so that a path may run along a rim and bend at its corners.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Final

import numpy as np
import shapely

from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.steering.sights import Sights, ranges
from mission.steering.solid_cells import SolidCells

HAIR: Final = 1e-9
"""By what part of the extent of free space its rims are moved, and a place may lie outside."""

_LEAST_HAIR_M: Final = 1e-8
_LONGEST_MITRE: Final = 10.0
_PART: Final = 4.0
"""How long parts are of ways that are looked at, if edges of rims lie a length apart."""


_FEW: Final = 1000
"""Edges below which ways are looked at as quickly without cells."""


class FreeSpace:
    """Where a place may be, prepared for many questions.

    Args:
        area: Polygon or MultiPolygon, not empty.

    Attributes:
        hair_m: How far its rims are moved.
        corners_m: Shape (C, 2), where paths may bend.
        part_of_corner: Shape (C,), the connected part of the area on whose rim it is.
    """

    def __init__(self, area: shapely.Geometry) -> None:
        self._parts = shapely.get_parts(area)
        bounds = np.array(shapely.bounds(area))
        self.hair_m = max(_LEAST_HAIR_M, HAIR * float(np.abs(bounds).max()))
        rims = _Rims.of(self._parts)
        reflex = rims.arriving[:, 0] * rims.leaving[:, 1] - rims.arriving[:, 1] * rims.leaving[:, 0] < 0.0
        nodes = np.flatnonzero(reflex)
        self._rims = rims
        self._nodes = nodes
        self.corners_m, self.part_of_corner = rims.corners_m[nodes], rims.part[nodes]
        self._before, self._after = -rims.arriving[nodes], rims.leaving[nodes]
        # What was seen from each corner, one after the other; -1 where none was looked from.
        self._first_seen, self._after_seen = np.full((2, len(nodes)), -1)
        self._seen = np.empty(0, dtype=np.int64)
        moved = rims.corners_m + self.hair_m * _outwards(rims.arriving, rims.leaving)
        self._tree = shapely.STRtree(shapely.linestrings(np.stack((moved, moved[rims.following]), axis=1)))
        self._part_m = _PART * float(np.sqrt(shapely.box(*bounds).area / len(moved)))

    @cached_property
    def _part_tree(self) -> shapely.STRtree:
        return shapely.STRtree(self._parts)

    def part_of(self, places_m: FloatArray) -> IntArray:
        """The connected part that each place lies in, (N,); -1 outside."""
        found = np.full(len(places_m), -1, dtype=np.int64)
        index, part = self._part_tree.query(shapely.points(places_m), predicate="dwithin", distance=self.hair_m)
        found[index[::-1]] = part[::-1]
        return found

    def hits(self, begins_m: FloatArray, ends_m: FloatArray) -> IntArray:
        """Which straight ways, shapes (N, 2), meet barriers."""
        # In short parts: the box round a long slanting way holds far more of the rims than are near it. Those at its
        # ends first: most ways that are not free are not even free there.
        count = np.maximum(np.ceil(np.hypot(*(ends_m - begins_m).T) / self._part_m), 1.0).astype(np.int64)
        open_, done, found = np.arange(len(count)), 0, []
        while len(open_):
            wanted = np.minimum(count[open_] - done, max(2, done))
            way = np.repeat(open_, wanted)
            place = done + np.arange(len(way)) - np.repeat(np.cumsum(wanted) - wanted, wanted)
            part = np.where(place % 2 == 0, place // 2, count[way] - 1 - place // 2)
            begins, step = begins_m[way], (ends_m - begins_m)[way] / count[way, None]
            lines = np.stack((begins + part[:, None] * step, begins + (part + 1)[:, None] * step), axis=1)
            index, _ = self._tree.query(shapely.linestrings(lines), predicate="intersects")
            found.append(way[index])
            done += max(2, done)
            open_ = np.setdiff1d(open_[count[open_] > done], way[index])
        return np.unique(np.concatenate(found)) if found else open_

    def solid(self, begins_m: FloatArray, ends_m: FloatArray) -> IntArray:
        """Those of straight ways, shapes (N, 2), that are quickly seen to meet a barrier."""
        return np.empty(0, dtype=np.int64) if self._cells is None else self._cells.met(begins_m, ends_m)[0]

    @cached_property
    def _cells(self) -> SolidCells | None:
        rims = self._rims
        if len(rims.corners_m) < _FEW:
            return None
        return SolidCells(rims.corners_m, rims.corners_m[rims.following], rims.ring, rims.is_hole)

    @cached_property
    def _sights(self) -> Sights:
        return Sights(self._rims.corners_m, self._rims.following, 2.0 * _LONGEST_MITRE * self.hair_m)

    @cached_property
    def _number(self) -> IntArray:
        """Of each corner of the rims among ``corners_m``; -1 where none may bend."""
        number = np.full(len(self._rims.corners_m), -1, dtype=np.int64)
        number[self._nodes] = np.arange(len(self._nodes))
        return number

    def look_from(self, corners: IntArray) -> None:
        """Find out what is seen from some corners, and remember it: from many together it takes less time."""
        new = np.unique(corners[self._first_seen[corners] < 0])
        if not len(new):
            return
        index, seen = self._sights.from_corners(self._nodes[new])
        index, seen = self._bending(index, self._number[seen], self.corners_m[new])
        both = self._beside(self.corners_m[seen], new[index])
        both &= self.part_of_corner[seen] == self.part_of_corner[new[index]]
        places = len(self._seen) + np.searchsorted(index[both], np.arange(len(new) + 1))
        self._first_seen[new], self._after_seen[new] = places[:-1], places[1:]
        self._seen = np.append(self._seen, seen[both])

    def seen_from_corners(self, corners: IntArray) -> tuple[IntArray, IntArray]:
        """Ways between corners at both of which a path may bend: pairs of an index into some, and a corner.

        All that are free are among them, and few others.
        """
        self.look_from(corners)
        index, place = ranges(self._first_seen[corners], self._after_seen[corners])
        return index, self._seen[place]

    def seen_from_places(self, layers_m: Sequence[FloatArray]) -> list[tuple[IntArray, IntArray]]:
        """The same of ways from places, of each layer shape (N, 2), to corners: a path need bend at these only."""
        places_m = np.concatenate(layers_m)
        part = self.part_of(places_m)
        inside = np.flatnonzero(part >= 0)
        index, seen = self._sights.from_places(places_m[inside])
        index, seen = self._bending(inside[index], self._number[seen], places_m)
        same = part[index] == self.part_of_corner[seen]
        index, seen = index[same], seen[same]
        firsts = np.cumsum([0, *map(len, layers_m)])
        cuts = np.searchsorted(index, firsts).tolist()
        return [(index[a:b] - first, seen[a:b]) for (a, b), first in zip(pairwise(cuts), firsts.tolist(), strict=False)]

    def _bending(self, index: IntArray, corners: IntArray, points_m: FloatArray) -> tuple[IntArray, IntArray]:
        index, corners = index[corners >= 0], corners[corners >= 0]
        bends = self._beside(points_m[index], corners)
        pairs = np.unique(index[bends] * len(self.corners_m) + corners[bends])
        return pairs // len(self.corners_m), pairs % len(self.corners_m)

    def _beside(self, points_m: FloatArray, corners: IntArray) -> BoolArray:
        """Whether a path from points, (N, 2), could bend at corners, (N,): both edges there lie on one side of it."""
        x, y = (self.corners_m[corners, axis] - points_m[..., axis] for axis in (0, 1))
        slack = self.hair_m * (np.abs(x) + np.abs(y) + self.hair_m)
        first = x * self._before[corners, 1] - y * self._before[corners, 0]
        second = x * self._after[corners, 1] - y * self._after[corners, 0]
        low, high = np.minimum(first, second), np.maximum(first, second)
        found: BoolArray = (low >= -slack) | (high <= slack)
        return found


@dataclass(frozen=True, eq=False)
class _Rims:
    """The corners of all rings, one after the other; edge ``i`` begins at corner ``i``.

    Attributes:
        corners_m: Shape (K, 2).
        arriving: Shape (K, 2), from the corner before, with free space on the left.
        leaving: Shape (K, 2), to the corner after.
        following: Shape (K,), the corner at which each edge ends.
        ring: Shape (K,), the ring of each corner.
        part: Shape (K,), the part of free space that the ring belongs to.
        is_hole: For each ring whether it is that of a hole.
    """

    corners_m: FloatArray
    arriving: FloatArray
    leaving: FloatArray
    following: IntArray
    ring: IntArray
    part: IntArray
    is_hole: BoolArray

    @staticmethod
    def of(parts: Sequence[shapely.Polygon]) -> "_Rims":
        """Those of some polygons."""
        rings, part = shapely.get_rings(parts, return_index=True)
        corners, ring = shapely.get_coordinates(rings, return_index=True)
        kept = np.append(ring[1:] == ring[:-1], False)  # the last corner of a ring is its first
        corners, ring = corners[kept], ring[kept]
        number = np.arange(len(ring))
        first = np.searchsorted(ring, np.arange(len(rings)))
        last = np.append(first[1:], len(ring)) - 1
        following, before = number + 1, number - 1
        following[last], before[first] = first, last
        arriving, leaving = corners - corners[before], corners[following] - corners
        hole = np.append(False, part[1:] == part[:-1])  # a part's first ring is its outside
        turned = (shapely.is_ccw(rings) == hole)[ring][:, None]
        arriving, leaving = np.where(turned, -leaving, arriving), np.where(turned, -arriving, leaving)
        return _Rims(corners, arriving, leaving, following, ring, part[ring], hole)


def _outwards(arriving: FloatArray, leaving: FloatArray) -> FloatArray:
    """How far each corner moves, (K, 2), so that both its edges move to the right by one."""
    units = [each / np.hypot(*each.T)[:, None] for each in (arriving, leaving)]
    first, second = (np.stack((unit[:, 1], -unit[:, 0]), axis=1) for unit in units)
    sharp = 1.0 + (first * second).sum(axis=1, keepdims=True)
    mitre: FloatArray = (first + second) / np.maximum(sharp, 2.0 / _LONGEST_MITRE**2)
    return mitre
