"""Distances in a directed graph with whole weights: each sweep over the graph is one compiled search.

Distances are floats, exact up to 2^53 and infinite where no way leads.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import breadth_first_order, connected_components, dijkstra

from mission.geometry.arrays import FloatArray, IntArray

Codes = NDArray[np.int32]
"""Numbers of vertices; half the memory of ``IntArray``."""


@dataclass(frozen=True, eq=False)
class Graph:
    """A graph as the rows of a sparse matrix.

    Attributes:
        targets: (E,) the vertex that each edge enters, edges ordered by the vertex that they leave.
        begins: (V + 1,) where the edges of each vertex begin.
        weights: (E,) what each edge costs, not negative; or one number that all of them cost.
    """

    targets: Codes
    begins: Codes
    weights: FloatArray | float

    @staticmethod
    def from_edges(size: int, sources: IntArray | Codes, targets: IntArray | Codes, weights: FloatArray) -> "Graph":
        """The graph of any list of edges: (E,) sources, targets, and weights."""
        order = np.argsort(sources, kind="stable")
        begins = np.zeros(size + 1, dtype=np.int32)
        np.cumsum(np.bincount(sources, minlength=size), out=begins[1:])
        alike = len(weights) > 0 and weights[0] > 0.0 and bool((weights == weights[0]).all())
        return Graph(targets[order].astype(np.int32), begins, float(weights[0]) if alike else weights[order])

    @property
    def size(self) -> int:
        """Number of vertices, V."""
        return len(self.begins) - 1

    @cached_property
    def sources(self) -> IntArray:
        """(E,) the vertex that each edge leaves."""
        return np.repeat(np.arange(self.size), np.diff(self.begins))

    @cached_property
    def reversed(self) -> "Graph":
        """The graph with every edge turned round."""
        weights = np.broadcast_to(np.asarray(self.weights, dtype=np.float64), len(self.targets))
        return Graph.from_edges(self.size, self.targets, self.sources, weights)

    @cached_property
    def components(self) -> IntArray:
        """(V,) the number of each vertex's strongly connected component."""
        matrix = _matrix(self.targets.copy(), self.begins.copy(), np.ones(len(self.targets)))
        matrix.sum_duplicates()  # scipy's search for components does not end where an edge is given twice
        _, components = connected_components(matrix, directed=True, connection="strong")
        return np.asarray(components, dtype=np.int64)

    def with_root(self, vertices: IntArray | Codes, weights: FloatArray) -> "Graph":
        """The graph with one more vertex, the last, from which edges of the given weights lead to ``vertices``."""
        begins = np.append(self.begins, np.int32(self.begins[-1] + len(vertices)))
        targets = np.append(self.targets, vertices.astype(np.int32))
        if np.ndim(self.weights) == 0 and (weights == self.weights).all():
            return Graph(targets, begins, self.weights)
        own = np.broadcast_to(np.asarray(self.weights, dtype=np.float64), len(self.targets))
        return Graph(targets, begins, np.append(own, weights))

    def distances(self, sources: IntArray | Codes, *, limit: float = np.inf) -> FloatArray:
        """Distance of each vertex from the nearest of ``sources``, (V,); infinite beyond ``limit`` too."""
        if not len(sources):
            return np.full(self.size, np.inf)
        if np.ndim(self.weights) == 0:
            return self._levels(sources) * float(self.weights)
        matrix = _matrix(self.targets, self.begins, np.asarray(self.weights))
        found = dijkstra(matrix, directed=True, indices=np.asarray(sources), min_only=True, limit=limit)
        return np.asarray(found, dtype=np.float64)

    def _levels(self, sources: IntArray | Codes) -> FloatArray:
        """Numbers of edges from the nearest of ``sources``."""
        rooted = Graph(self.targets, self.begins, 1.0).with_root(sources, np.ones(len(sources)))
        matrix = _matrix(rooted.targets, rooted.begins, np.broadcast_to(np.float64(1.0), len(rooted.targets)))
        order, parents = breadth_first_order(matrix, self.size)
        place = np.empty(rooted.size, dtype=np.int32)
        place[order] = np.arange(len(order), dtype=np.int32)
        # Found in order, children of early vertices come early: a level ends where the last one's children end.
        family_ends = np.cumsum(np.bincount(place[parents[order[1:]]], minlength=len(order))) + 1
        ends = [0, 1]
        while ends[-1] > ends[-2]:
            ends.append(int(family_ends[ends[-1] - 1]))
        distances = np.full(rooted.size, np.inf)
        distances[order] = np.repeat(np.arange(-1.0, len(ends) - 2), np.diff(ends))
        return distances[:-1]


def _matrix(targets: Codes, begins: Codes, weights: FloatArray) -> "csr_array[np.float64, tuple[int, int]]":
    size = len(begins) - 1
    return csr_array((weights, targets, begins), shape=(size, size))
