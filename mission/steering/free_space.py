"""Free space as the search for shortest paths sees it: barriers that are hit, and corners to bend at.

Barriers are the rims, moved out of free space by a hair, so that a path may run along a rim and bend at its corners.
They come in pieces: a ring as a whole, or some edges of a long one, with the corners at which a path round that piece
may bend.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
import shapely

from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.geometry.rings import ring_area_m2

HAIR: Final = 1e-9
"""By what part of the extent of free space its rims are moved, and a place may lie outside."""

_LEAST_HAIR_M: Final = 1e-8
_LONGEST_MITRE: Final = 10.0
_WHOLE: Final = 24
"""Corners of a ring that is one piece."""
_PIECE: Final = 12
_PART: Final = 4.0
"""How long parts are of ways that are looked at, if edges of rims lie a length apart."""
"""Edges in a piece of any other ring."""


class FreeSpace:
    """Where a place may be, prepared for many questions.

    Args:
        area: Polygon or MultiPolygon, not empty.

    Attributes:
        hair_m: How far its rims are moved.
        corners_m: Shape (C, 2), where paths may bend; a corner of two pieces of rim is there twice.
        part_of_corner: Shape (C,), the connected part of the area on whose rim it is.
    """

    def __init__(self, area: shapely.Geometry) -> None:
        self._parts = shapely.get_parts(area)
        bounds = np.array(shapely.bounds(area))
        self.hair_m = max(_LEAST_HAIR_M, HAIR * float(np.abs(bounds).max()))
        edges: list[FloatArray] = []
        pieces: list[IntArray] = []
        corners: list[tuple[IntArray, IntArray, FloatArray, BoolArray]] = []
        count = 0
        for number, part in enumerate(self._parts):
            for place, ring in enumerate(shapely.get_rings(part)):
                found = _Ring.of(shapely.get_coordinates(ring)[:-1], hole=place > 0, hair_m=self.hair_m)
                edges.append(found.barrier)
                pieces.append(found.piece_of_edge + count)
                owner = found.piece_of_corner + count
                corners.append((np.full(len(owner), number), owner, found.corners, found.ends))
                count += found.pieces
        self._piece_of_edge = np.concatenate(pieces)
        barriers = np.concatenate(edges)
        self._tree = shapely.STRtree(shapely.linestrings(barriers))
        self._part_m = _PART * float(np.sqrt(shapely.box(*bounds).area / len(barriers)))
        self.part_of_corner, piece_of = (np.concatenate([each[k] for each in corners]) for k in (0, 1))
        self._begins = np.searchsorted(piece_of, np.arange(count + 1))  # the corners of each piece follow each other
        triples = np.concatenate([each[2] for each in corners])
        self.corners_m = triples[:, 1]
        self._before, self._after = triples[:, 0] - self.corners_m, triples[:, 2] - self.corners_m
        self._ends = np.concatenate([each[3] for each in corners])

    @cached_property
    def _part_tree(self) -> shapely.STRtree:
        return shapely.STRtree(self._parts)

    def part_of(self, places_m: FloatArray) -> IntArray:
        """The connected part that each place lies in, (N,); -1 outside."""
        found = np.full(len(places_m), -1, dtype=np.int64)
        index, part = self._part_tree.query(shapely.points(places_m), predicate="dwithin", distance=self.hair_m)
        found[index[::-1]] = part[::-1]
        return found

    def hits(self, begins_m: FloatArray, ends_m: FloatArray) -> tuple[IntArray, IntArray]:
        """Which straight ways, shapes (N, 2), meet barriers: pairs of the way's index and a piece that it meets."""
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
            index, edge = self._tree.query(shapely.linestrings(lines), predicate="intersects")
            found.append((way[index], self._piece_of_edge[edge]))
            done += max(2, done)
            open_ = np.setdiff1d(open_[count[open_] > done], way[index])
        return np.concatenate([way for way, _ in found]), np.concatenate([piece for _, piece in found])

    def corners_of(self, pieces: set[int]) -> IntArray:
        """The corners of some pieces, ascending."""
        wanted = np.zeros(len(self._begins) - 1, dtype=np.bool_)
        wanted[list(pieces)] = True
        return np.concatenate([np.arange(self._begins[k], self._begins[k + 1]) for k in np.flatnonzero(wanted)])

    def touched(self, points_m: FloatArray, corners: IntArray) -> BoolArray:
        """Whether a path from a point could bend at a corner, (P, C): the line leaves both edges there on one side."""
        return self._beside(points_m[:, None], corners[None])

    def touching(self, points_m: FloatArray, corners: IntArray) -> BoolArray:
        """The same of points (N, 2) and the corners beside them."""
        return self._beside(points_m, corners)

    def _beside(self, points_m: FloatArray, corners: IntArray) -> BoolArray:
        x, y = (self.corners_m[corners, axis] - points_m[..., axis] for axis in (0, 1))
        slack = self.hair_m * (np.abs(x) + np.abs(y) + self.hair_m)
        first = x * self._before[corners, 1] - y * self._before[corners, 0]
        second = x * self._after[corners, 1] - y * self._after[corners, 0]
        low, high = np.minimum(first, second), np.maximum(first, second)
        found: BoolArray = (low >= -slack) | (high <= slack) | self._ends[corners]
        return found


@dataclass(frozen=True, eq=False)
class _Ring:
    """A ring of a rim in pieces.

    Attributes:
        barrier: Shape (E, 2, 2), its edges, moved.
        piece_of_edge: Shape (E,).
        corners: Shape (C, 3, 2): the corner before, the corner, and the one after.
        piece_of_corner: Shape (C,).
        ends: Shape (C,), whether the piece ends there, so that a path may bend whichever way.
    """

    barrier: FloatArray
    piece_of_edge: IntArray
    corners: FloatArray
    piece_of_corner: IntArray
    ends: BoolArray

    @property
    def pieces(self) -> int:
        """How many there are."""
        return int(self.piece_of_edge[-1]) + 1

    @staticmethod
    def of(ring: FloatArray, *, hole: bool, hair_m: float) -> "_Ring":
        """Cut a ring: that of a hole in free space, or of its outside."""
        if (ring_area_m2(ring) > 0.0) == hole:
            ring = ring[::-1]  # free space on the left
        before, after = np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0)
        arriving, leaving = ring - before, after - ring
        reflex = np.flatnonzero(arriving[:, 0] * leaving[:, 1] - arriving[:, 1] * leaving[:, 0] < 0.0)
        moved = ring + _outwards(arriving, leaving) * hair_m
        barrier = np.stack((moved, np.roll(moved, -1, axis=0)), axis=1)
        triples, size = np.stack((before, ring, after), axis=1), len(ring)
        if len(reflex) <= _WHOLE:
            none = np.zeros(len(reflex), dtype=np.int64)
            return _Ring(barrier, np.zeros(size, dtype=np.int64), triples[reflex], none, none.astype(np.bool_))
        # Round a piece that stands alone a path may bend at any of its corners, on either side.
        begins = np.arange(0, size, _PIECE)
        lengths = np.diff(np.append(begins, size)) + 1
        owner = np.repeat(np.arange(len(begins)), lengths)
        within = np.arange(len(owner)) - np.repeat(np.cumsum(lengths) - lengths, lengths)
        ends = (within == 0) | (within == lengths[owner] - 1)
        return _Ring(barrier, np.arange(size) // _PIECE, triples[(begins[owner] + within) % size], owner, ends)


def _outwards(arriving: FloatArray, leaving: FloatArray) -> FloatArray:
    """How far each corner moves, (K, 2), so that both its edges move to the right by one."""
    units = [each / np.hypot(*each.T)[:, None] for each in (arriving, leaving)]
    first, second = (np.stack((unit[:, 1], -unit[:, 0]), axis=1) for unit in units)
    sharp = 1.0 + (first * second).sum(axis=1, keepdims=True)
    mitre: FloatArray = (first + second) / np.maximum(sharp, 2.0 / _LONGEST_MITRE**2)
    return mitre
