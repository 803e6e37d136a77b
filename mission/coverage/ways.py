"""Shortest ways in an area with holes: straight where that is free, else over the corners that stand in the way.

A shortest path among polygons bends at their reflex corners only and touches them there (Lozano-Perez and Wesley,
1979). So the graph has these corners for nodes, and an edge where two see each other and both are touched; Dijkstra's
method gives exact shortest ways between all corners, once for an area. A pair of points then takes the corner that each
sees, of all such pairs, over which the way is shortest.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
import shapely
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.geometry.rings import ring_area_m2

_NO_LENGTH: Final = 1e-9
"""Metres that an edge between equal points counts: sparse arrays take zero for no edge."""
_STRAIGHT: Final = -1


class Sights(NamedTuple):
    """The corners that each of T points sees and touches, in rows as sparse arrays have them.

    Attributes:
        begins: Shape (T + 1,), where the row of each point begins.
        corners: Shape (S,), numbers of corners.
        lengths_m: Shape (S,).
    """

    begins: IntArray
    corners: IntArray
    lengths_m: FloatArray

    def of(self, points: IntArray) -> tuple[IntArray, IntArray]:
        """Of each of N points all that it sees: rows of this table, and whose they are, from 0 to N - 1."""
        counts = self.begins[points + 1] - self.begins[points]
        owner = np.arange(len(points)).repeat(counts)
        within = np.arange(len(owner)) - (np.cumsum(counts) - counts).repeat(counts)
        return self.begins[points].repeat(counts) + within, owner


@dataclass(frozen=True, eq=False)
class Ways:
    """The shortest ways of P pairs of points.

    Attributes:
        lengths_m: Shape (P,), infinite where there is no way.
        ends_m: Shape (P, 2, 2): begin and end.
        bends: Shape (P, 2), the first and the last corner on the way; negative where it is straight.
        corners_m: Shape (V, 2).
        before: Shape (V, V), on the way from a corner to another the corner before.
    """

    lengths_m: FloatArray
    ends_m: FloatArray
    bends: IntArray
    corners_m: FloatArray
    before: IntArray

    def line_m(self, pair: int) -> FloatArray:
        """The way of a pair, shape (k, 2), k >= 2; a length of infinity has none."""
        first, last = self.bends[pair].tolist()
        bends = [] if first == _STRAIGHT else [last]
        while bends and bends[-1] != first:
            bends.append(int(self.before[first, bends[-1]]))
        corners = self.corners_m[np.array(bends[::-1], dtype=np.int64)]
        line = np.concatenate((self.ends_m[pair, :1], corners, self.ends_m[pair, 1:]))
        apart = np.linalg.norm(np.diff(line, axis=0), axis=1) > _NO_LENGTH
        kept: FloatArray = line[np.concatenate(([True], apart))]
        return kept if len(kept) > 1 else line[[0, -1]]

    @cached_property
    def outwards(self) -> FloatArray:
        """Unit vectors in which ways leave their begin, and their end if flown back, (P, 2, 2); zero without length."""
        bent = (self.bends != _STRAIGHT)[..., None]
        steps = np.where(bent, self._bends_m, self.ends_m[:, ::-1]) - self.ends_m
        norms = np.linalg.norm(steps, axis=2, keepdims=True)
        units: FloatArray = np.divide(steps, norms, out=np.zeros_like(steps), where=norms > _NO_LENGTH)
        return units

    @property
    def _bends_m(self) -> FloatArray:
        return self.corners_m[self.bends] if len(self.corners_m) else np.zeros_like(self.ends_m)


class Network:
    """What sees what in an area."""

    def __init__(self, area: shapely.Geometry, tolerance_m: float) -> None:
        """Take the area's corners.

        Args:
            area: Polygon or MultiPolygon, metres.
            tolerance_m: Ways may leave the area by this much, so that they can run along its rim.
        """
        self._room, self._tolerance_m = shapely.buffer(area, tolerance_m, join_style="mitre"), tolerance_m
        shapely.prepare(self._room)
        before, corners, after = _corners(area)
        self._edges = np.stack((corners, after), axis=1)
        self._tree = shapely.STRtree(shapely.linestrings(self._edges))
        arriving, leaving = corners - before, after - corners
        reflex = arriving[:, 0] * leaving[:, 1] - arriving[:, 1] * leaving[:, 0] < 0.0
        self._corners, self._before, self._after = corners[reflex], before[reflex], after[reflex]

    def sees(self, begins_m: FloatArray, ends_m: FloatArray) -> BoolArray:
        """Whether the straight way between the points beside each other, shapes (N, 2), is free; shape (N,)."""
        lines = shapely.linestrings(np.stack((begins_m, ends_m), axis=1))
        seen: BoolArray = shapely.covers(self._room, lines)
        # What is thinner than the tolerance is open to it: nothing leads from one side of an edge to the other.
        line, edge = self._tree.query(lines, predicate="intersects")
        way, rim = np.stack((begins_m[line], ends_m[line]), axis=1), self._edges[edge]
        seen[line[_apart(way, rim, self._tolerance_m) & _apart(rim, way, self._tolerance_m)]] = False
        # Older versions of GEOS do not find a line of no length anywhere.
        seen |= (begins_m == ends_m).all(axis=1)
        return seen

    def ways(self, points_m: FloatArray, pairs: IntArray) -> Ways:
        """The shortest ways between points.

        Args:
            points_m: Shape (T, 2), in the area.
            pairs: Shape (P, 2), numbers of points: begin and end.
        """
        ends = points_m[pairs]
        straight = self.sees(ends[:, 0], ends[:, 1])
        lengths = np.where(straight, np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1), np.inf)
        bends = np.full((len(pairs), 2), _STRAIGHT)
        rest = np.flatnonzero(~straight)
        if len(rest) and len(self._corners):
            asked, place = np.unique(pairs[rest], return_inverse=True)
            lengths[rest], bends[rest] = self._over_corners(points_m[asked], place.reshape(-1, 2))
        return Ways(lengths, ends, bends, self._corners, self._between[1])

    def _over_corners(self, points_m: FloatArray, pairs: IntArray) -> tuple[FloatArray, IntArray]:
        """Of pairs of points that do not see each other the lengths, and first and last corners: (P,) and (P, 2)."""
        sights = self._sights(points_m)
        seeing = np.flatnonzero(np.diff(sights.begins))
        # From each point to each corner, over the best of those that it sees.
        reached = np.full((len(points_m), len(self._corners)), np.inf)
        over = sights.lengths_m[:, None] + self._between[0][sights.corners]
        if len(seeing):
            reached[seeing] = np.minimum.reduceat(over, sights.begins[seeing], axis=0)
        lengths, bends = np.full(len(pairs), np.inf), np.full((len(pairs), 2), _STRAIGHT)
        row, pair = sights.of(pairs[:, 1])
        lengths, best = _least(reached[pairs[pair, 0], sights.corners[row]] + sights.lengths_m[row], pair, lengths)
        found = np.flatnonzero(np.isfinite(lengths))
        bends[found, 1] = sights.corners[row[best[found]]]
        row, pair = sights.of(pairs[found, 0])
        _, best = _least(over[row, bends[found[pair], 1]], pair, lengths[found])
        bends[found, 0] = sights.corners[row[best]]
        return lengths, bends

    def _sights(self, points_m: FloatArray) -> Sights:
        point, corner = self._touched(points_m).nonzero()
        seen = self.sees(points_m[point], self._corners[corner])
        point, corner = point[seen], corner[seen]
        begins = np.searchsorted(point, np.arange(len(points_m) + 1))
        lengths = np.linalg.norm(points_m[point] - self._corners[corner], axis=1)
        return Sights(begins.astype(np.int64), corner.astype(np.int64), lengths)

    @cached_property
    def _between(self) -> tuple[FloatArray, IntArray]:
        """Shortest ways between all corners, and on the way to each the corner before; both (V, V)."""
        count = len(self._corners)
        if not count:
            return np.empty((0, 0)), np.empty((0, 0), dtype=np.int64)
        touched = self._touched(self._corners)
        pairs = np.argwhere(np.triu(touched & touched.T, 1))
        pairs = pairs[self.sees(self._corners[pairs[:, 0]], self._corners[pairs[:, 1]])]
        steps = self._corners[pairs[:, 0]] - self._corners[pairs[:, 1]]
        lengths = np.maximum(np.linalg.norm(steps, axis=1), _NO_LENGTH)
        rows, columns = pairs.T.astype(np.int32)  # all that dijkstra of older versions of scipy takes
        graph = csr_array((lengths, (rows, columns)), shape=(count, count))
        found, before = dijkstra(graph, directed=False, return_predecessors=True)
        return found, before.astype(np.int64)

    def _touched(self, points: FloatArray) -> BoolArray:
        """Whether the line from each point to each corner leaves both edges there on one side, shape (T, V)."""
        steps = self._corners - points[:, None]
        sides = [
            steps[..., 0] * (beside - self._corners)[:, 1] - steps[..., 1] * (beside - self._corners)[:, 0]
            for beside in (self._before, self._after)
        ]
        slack = _NO_LENGTH * (1.0 + np.abs(steps).sum(axis=2))
        touched: BoolArray = (np.minimum(*sides) >= -slack) | (np.maximum(*sides) <= slack)
        return touched


def _apart(lines: FloatArray, others: FloatArray, least_m: float) -> BoolArray:
    """Whether the ends of others lie on both sides of lines, and farther from them than that; shapes (N, 2, 2)."""
    along = lines[:, 1] - lines[:, 0]
    steps = others - lines[:, :1]
    sides = along[:, None, 0] * steps[..., 1] - along[:, None, 1] * steps[..., 0]
    beyond = np.abs(sides) > least_m * np.linalg.norm(along, axis=1)[:, None]
    apart: BoolArray = beyond.all(axis=1) & (np.sign(sides[:, 0]) != np.sign(sides[:, 1]))
    return apart


def _least(values: FloatArray, owner: IntArray, none: FloatArray) -> tuple[FloatArray, IntArray]:
    """The least value of each owner, ``none`` where it has none, and its place among the values; shapes of ``none``."""
    order = np.lexsort((values, owner))
    first = np.flatnonzero(np.diff(owner[order], prepend=-1))
    least, place = none.copy(), np.zeros(len(none), dtype=np.int64)
    least[owner[order[first]]], place[owner[order[first]]] = values[order[first]], order[first]
    return least, place


def _corners(area: shapely.Geometry) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Of each corner of all rings the one before, itself and the one after, the area on the left; shapes (C, 2)."""
    triples: list[list[FloatArray]] = [[], [], []]
    for part in shapely.get_parts(area):
        for number, ring in enumerate(shapely.get_rings(part)):
            corners = shapely.get_coordinates(ring)[:-1]
            if (ring_area_m2(corners) > 0.0) == (number > 0):
                corners = corners[::-1]
            for kept, shift in zip(triples, (1, 0, -1), strict=True):
                kept.append(np.roll(corners, shift, axis=0))
    before, here, after = (np.concatenate(kept) if kept else np.empty((0, 2)) for kept in triples)
    return before, here, after
