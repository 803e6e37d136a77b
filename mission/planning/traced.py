"""From a way in the plane to a run of T: the triangles along it, letter by letter.

A way that bends at corners runs along edges, and touches triangles on both sides. So the run is not read off its
points: of the triangles that lie at the way where it reads one letter, a chain is looked for that leads from those at
its beginning to those at its end, and over to the next letter where the way changes it.
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np
import shapely
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.geometry.simplices import Partition

_WIDER: Final = 10.0


@dataclass(frozen=True, eq=False)
class Stretch:
    """A part of a way on which one letter is read.

    Attributes:
        letter: Its number.
        points_m: Shape (K, 2), K at least 1; it begins where the stretch before it ends.
    """

    letter: int
    points_m: FloatArray


def stretches(letters: IntArray, points_m: FloatArray) -> tuple[Stretch, ...]:
    """A way, its letters (K,) and points (K, 2), in stretches."""
    bounds = [0, *(np.flatnonzero(np.diff(letters)) + 1).tolist(), len(letters)]
    return tuple(Stretch(int(letters[first]), points_m[first:last]) for first, last in pairwise(bounds))


@dataclass(frozen=True, eq=False)
class Tracer:
    """Finds triangles along ways.

    Attributes:
        partition: The triangles.
        tree: Of the triangles, as polygons.
        letter_of: Shape (M,), their letters.
        open: Shape (M,), which of them may be entered.
        lengths: Shape (M, 3), what it costs to leave through a facet.
        near_m: How far off a way triangles are at it; more where there is no chain of such.
    """

    partition: Partition
    tree: shapely.STRtree
    letter_of: IntArray
    open: BoolArray
    lengths: FloatArray
    near_m: float

    def chain(self, way: tuple[Stretch, ...], first: int, ends: BoolArray | None = None) -> tuple[int, ...] | None:
        """The cheapest chain of neighbouring triangles along a way.

        Args:
            way: Its stretches.
            first: The triangle in which it begins.
            ends: Shape (M,), in which it may end; any at its end by default.

        Returns:
            Triangles, ``first`` included; None where no chain reads these letters.
        """
        near_m = self.near_m
        while True:
            found = self._chain(way, first, ends, near_m)
            if found is not None or near_m > self.partition.extent_m:
                return found
            near_m *= _WIDER

    def _chain(
        self, way: tuple[Stretch, ...], first: int, ends: BoolArray | None, near_m: float
    ) -> tuple[int, ...] | None:
        levels = [self._at(_line(stretch.points_m), near_m, stretch.letter) for stretch in way]
        begins = np.cumsum([0, *map(len, levels)])
        triangles, level = np.concatenate(levels), np.repeat(np.arange(len(way)), np.diff(begins))
        node = {key: number for number, key in enumerate(zip(level.tolist(), triangles.tolist(), strict=True))}
        source = node.get((0, first))
        if source is None:
            return None
        changes = [set(self._at(shapely.Point(stretch.points_m[0]), near_m).tolist()) for stretch in way[1:]]
        edges: list[tuple[int, int, float]] = []
        for (at, triangle), number in node.items():
            for facet, beyond in enumerate(self.partition.neighbours[triangle].tolist()):
                cost = float(self.lengths[triangle, facet])
                if (at, beyond) in node:
                    edges.append((number, node[at, beyond], cost))
                if (at + 1, beyond) in node and {triangle, beyond} <= changes[at]:
                    edges.append((number, node[at + 1, beyond], cost))
        at_end = self._at(shapely.Point(way[-1].points_m[-1]), near_m, way[-1].letter)
        lasts = at_end if ends is None else at_end[ends[at_end]]
        goals = [node[len(way) - 1, triangle] for triangle in lasts.tolist() if (len(way) - 1, triangle) in node]
        if not goals or (not edges and source not in goals):
            return None
        rows, columns, costs = np.array(edges, dtype=np.float64).reshape(-1, 3).T
        ends_of = (rows.astype(np.int32), columns.astype(np.int32))  # all that older versions of dijkstra take
        graph = csr_array((costs, ends_of), shape=(len(node), len(node)))
        (reached,), (before,) = dijkstra(graph, indices=np.array([source]), return_predecessors=True)
        goal = min(goals, key=lambda number: (reached[number], number))
        if not np.isfinite(reached[goal]):
            return None
        chain = [goal]
        while chain[-1] != source:
            chain.append(int(before[chain[-1]]))
        return tuple(int(triangles[number]) for number in reversed(chain))

    def _at(self, line: shapely.Geometry, near_m: float, letter: int | None = None) -> IntArray:
        """The open triangles, of a letter where one is given, at a line; ascending."""
        found = np.sort(self.tree.query(line, predicate="dwithin", distance=near_m))
        kept = self.open[found] if letter is None else self.open[found] & (self.letter_of[found] == letter)
        at: IntArray = found[kept].astype(np.int64)
        return at


def _line(points_m: FloatArray) -> shapely.Geometry:
    return shapely.LineString(points_m) if len(points_m) > 1 else shapely.Point(points_m[0])
