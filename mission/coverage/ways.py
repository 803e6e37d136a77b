"""Shortest ways in an area with holes: straight where that is free, else over the corners that stand in the way.

A shortest path among polygons bends at their reflex corners only and touches them there (Lozano-Perez and Wesley,
1979). So the graph has these corners for nodes, and an edge where two see each other and both are touched; Dijkstra's
method then gives exact shortest ways from each of the points asked for.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
import shapely
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.geometry.rings import ring_area_m2

_NO_LENGTH: Final = 1e-9
"""Metres that an edge between equal points counts: sparse arrays take zero for no edge."""


@dataclass(frozen=True, eq=False)
class Ways:
    """The shortest ways between T points.

    Attributes:
        lengths_m: Shape (T, T), infinite where there is no way.
        nodes_m: Shape (V + T, 2): the corners of the area, then the points.
        before: Shape (T, V + T), on the way from a point to a node the node before; negative where there is none.
    """

    lengths_m: FloatArray
    nodes_m: FloatArray
    before: IntArray

    def line_m(self, begin: int, end: int) -> FloatArray:
        """The way from a point to another, shape (k, 2), k >= 2; a length of infinity has none."""
        offset = len(self.nodes_m) - len(self.before)
        chain = [offset + end]
        while chain[-1] != offset + begin:
            chain.append(int(self.before[begin, chain[-1]]))
        line: FloatArray = self.nodes_m[chain[::-1]]
        apart = np.linalg.norm(np.diff(line, axis=0), axis=1) > _NO_LENGTH
        kept: FloatArray = line[np.concatenate(([True], apart))]
        return kept if len(kept) > 1 else line[[0, -1]]

    @property
    def leaving(self) -> FloatArray:
        """Unit vector in which the way from point i to point j leaves i, shape (T, T, 2); zero where it has none."""
        points = self.nodes_m[len(self.nodes_m) - len(self.before) :]
        towards = self.nodes_m[np.maximum(self.before[:, len(self.nodes_m) - len(self.before) :].T, 0)]
        steps = towards - points[:, None]
        norms = np.linalg.norm(steps, axis=2, keepdims=True)
        units: FloatArray = np.divide(steps, norms, out=np.zeros_like(steps), where=norms > _NO_LENGTH)
        return units


class Network:
    """What sees what in an area."""

    def __init__(self, area: shapely.Geometry, tolerance_m: float) -> None:
        """Take the area's corners.

        Args:
            area: Polygon or MultiPolygon, metres.
            tolerance_m: Ways may leave the area by this much, so that they can run along its rim.
        """
        self._room = shapely.buffer(area, tolerance_m, join_style="mitre")
        shapely.prepare(self._room)
        before, corners, after = _corners(area)
        arriving, leaving = corners - before, after - corners
        reflex = arriving[:, 0] * leaving[:, 1] - arriving[:, 1] * leaving[:, 0] < 0.0
        self._corners, self._before, self._after = corners[reflex], before[reflex], after[reflex]

    def sees(self, begins_m: FloatArray, ends_m: FloatArray) -> BoolArray:
        """Whether the straight way between the points beside each other, shapes (N, 2), is free; shape (N,)."""
        seen: BoolArray = shapely.covers(self._room, shapely.linestrings(np.stack((begins_m, ends_m), axis=1)))
        # Older versions of GEOS do not find a line of no length anywhere.
        seen |= (begins_m == ends_m).all(axis=1)
        return seen

    def ways(self, points_m: FloatArray, wanted: BoolArray) -> Ways:
        """The shortest ways between points.

        Args:
            points_m: Shape (T, 2), in the area.
            wanted: Shape (T, T), symmetric: the pairs that count; others may come out longer than they are.
        """
        offset, count = len(self._corners), len(self._corners) + len(points_m)
        pairs = np.argwhere(np.triu(wanted, 1))
        pairs = pairs[self.sees(points_m[pairs[:, 0]], points_m[pairs[:, 1]])]
        touched = self._touched(points_m).nonzero()
        seen = self.sees(points_m[touched[0]], self._corners[touched[1]])
        ends = np.concatenate(
            (self._edges, pairs + offset, np.stack((touched[1][seen], touched[0][seen] + offset), axis=1))
        )
        nodes = np.concatenate((self._corners, points_m))
        lengths = np.maximum(np.linalg.norm(nodes[ends[:, 0]] - nodes[ends[:, 1]], axis=1), _NO_LENGTH)
        rows, columns = ends.T.astype(np.int32)  # all that dijkstra of older versions of scipy takes
        graph = csr_array((lengths, (rows, columns)), shape=(count, count))
        found, before = dijkstra(graph, directed=False, indices=np.arange(offset, count), return_predecessors=True)
        return Ways(found[:, offset:], nodes, before.astype(np.int64))

    @cached_property
    def _edges(self) -> IntArray:
        """Pairs of corners that see each other and are both touched, shape (E, 2)."""
        touched = self._touched(self._corners)
        pairs = np.argwhere(np.triu(touched & touched.T, 1))
        seen = self.sees(self._corners[pairs[:, 0]], self._corners[pairs[:, 1]])
        return pairs[seen].astype(np.int64)

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
