"""Shortest paths over layers of places, each layer reached through a free space of its own, with lazy visibility.

A shortest path among polygons bends at their corners only and touches them there (Lozano-Perez and Wesley, "An
algorithm for planning collision-free paths among polyhedral obstacles", 1979). Which of very many obstacles matter is
found by trying: all straight ways are taken to be free until the best path asks for them; where one hits a piece of a
rim, that piece's corners join the graph. The length found never exceeds the true one meanwhile, so the first path whose
ways are all free is a shortest one (the argument of lazy search: Dellin and Srinivasa, "A unifying formalism for
shortest path problems with expensive edge evaluations", 2016).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from mission.errors import MissionError
from mission.geometry.arrays import FloatArray, IntArray
from mission.steering.free_space import FreeSpace

_NO_LENGTH: Final = 1e-9
"""Metres that a way between equal places counts: sparse arrays take zero for no way."""
_NEARLY: Final = 1e-3
"""Ways on paths that are longer than the best one by at most this part are looked at together with its own."""
_AT_ONCE: Final = 128
_UNKNOWN, _FREE, _SHUT = 0, 1, 2


class NoWayError(MissionError):
    """No path leads through the free spaces to the targets in their order.

    Attributes:
        stage: The first target that cannot be reached.
    """

    exit_code = 3

    def __init__(self, stage: int, message: str) -> None:
        self.stage = stage
        super().__init__(message)


@dataclass(frozen=True, eq=False)
class Chain:
    """A shortest path over layers.

    Attributes:
        places: For each layer the number of its place that is passed.
        lines: For each stage the way between the two, shape (n, 2), n >= 2; its ends may be equal.
        length_m: Of all lines.
    """

    places: tuple[int, ...]
    lines: tuple[FloatArray, ...]
    length_m: float


class LayeredPaths:
    """The graph of one search.

    Args:
        spaces: The free space of each stage.
        layers: Of one more layer than there are spaces, the places, shape (N, 2).
        pieces: For each stage the pieces of rims that are known to matter; those that are found are added.
        cyclic: Whether the last layer's places are those of the first, and one and the same is sought in both.
    """

    def __init__(
        self,
        spaces: Sequence[FreeSpace],
        layers: Sequence[FloatArray],
        pieces: Sequence[set[int]],
        *,
        cyclic: bool = False,
    ) -> None:
        self._spaces, self._layers, self._pieces, self._cyclic = spaces, layers, pieces, cyclic
        self._offsets = np.cumsum([0, *(len(layer) for layer in layers)])
        self._points = np.concatenate(layers)
        self._active: list[set[int]] = [set() for _ in spaces]
        self._corners = [np.empty(0, dtype=np.int64) for _ in spaces]  # of the space, and their nodes
        self._nodes = [np.empty(0, dtype=np.int64) for _ in spaces]
        empty = np.empty(0, dtype=np.int64)
        self._begins, self._ends, self._stage, self._both = empty, empty, empty, np.empty(0, dtype=np.bool_)
        self._status = np.empty(0, dtype=np.int8)
        self._parts = [(space.part_of(layers[k]), space.part_of(layers[k + 1])) for k, space in enumerate(self._spaces)]
        for stage, (entry, exit_) in enumerate(self._parts):
            same = (entry[:, None] == exit_[None]) & (entry >= 0)[:, None]
            if not same.any():
                raise NoWayError(stage, "no place from which the way could begin is connected with its target")
            first, second = np.nonzero(same)
            self._join(stage, self._offsets[stage] + first, self._offsets[stage + 1] + second, both=False)
            self._activate(stage, set(self._pieces[stage]))

    def shortest(self) -> Chain:
        """The shortest path.

        Raises:
            NoWayError: There is none.
        """
        while True:
            graph, lengths = self._graph()
            wanted, nodes = (self._rounds if self._cyclic else self._passages)(graph, lengths)
            if not len(wanted):
                return self._chain(nodes)
            hit, pieces = self._looked_at(wanted)
            for stage in np.unique(self._stage[hit]).tolist():
                self._activate(stage, set(pieces[self._stage[hit] == stage].tolist()) - self._active[stage])

    def _looked_at(self, ways: IntArray) -> tuple[IntArray, IntArray]:
        """Find out which ways are free; those that are not, with a piece of rim that each hits."""
        found: list[tuple[IntArray, IntArray]] = []
        self._status[ways] = _FREE
        for stage in np.unique(self._stage[ways]).tolist():
            these = ways[self._stage[ways] == stage]
            index, piece = self._spaces[stage].hits(self._points[self._begins[these]], self._points[self._ends[these]])
            self._status[these[index]] = _SHUT
            found.append((these[index], piece))
        return np.concatenate([way for way, _ in found]), np.concatenate([piece for _, piece in found])

    def _passages(
        self, graph: "csr_array[np.float64, tuple[int, int]]", lengths: FloatArray
    ) -> tuple[IntArray, list[int]]:
        """Ways to be looked at next, none where the best path is known to be free; and that path's nodes."""
        first, last = np.arange(self._offsets[1]), np.arange(self._offsets[-2], self._offsets[-1])
        there, before, _ = dijkstra(graph, indices=first, min_only=True, return_predecessors=True)
        end = int(last[np.argmin(there[last])])
        best = float(there[end])
        if not np.isfinite(best):
            raise NoWayError(self._stuck(there), "no way leads to the target")
        nodes = _followed(before.astype(np.int64), end)
        unknown = self._unknown(nodes)
        if not len(unknown):
            return unknown, nodes
        back = dijkstra(graph.T.tocsr(), indices=last, min_only=True)
        through = there[self._begins] + lengths + back[self._ends]
        other = there[self._ends] + lengths + back[self._begins]
        through = np.where(self._both, np.minimum(through, other), through)
        near = np.flatnonzero((self._status == _UNKNOWN) & (through <= best * (1.0 + _NEARLY)))
        near = near[np.argsort(through[near], kind="stable")[:_AT_ONCE]]
        return np.union1d(near, unknown), nodes

    def _rounds(
        self, graph: "csr_array[np.float64, tuple[int, int]]", lengths: FloatArray
    ) -> tuple[IntArray, list[int]]:
        """The same for rounds."""
        del lengths
        first, last = np.arange(self._offsets[1]), np.arange(self._offsets[-2], self._offsets[-1])
        there, before = dijkstra(graph, indices=first, return_predecessors=True)
        rounds = there[np.arange(len(first)), last]
        best = int(np.argmin(rounds))
        if not np.isfinite(rounds[best]):
            raise NoWayError(self._stuck(there.min(axis=0)), "no way leads round the targets")
        before = before.astype(np.int64)
        nodes = _followed(before[best], int(last[best]))
        unknown = self._unknown(nodes)
        if len(unknown):
            near = np.flatnonzero(rounds <= rounds[best] * (1.0 + _NEARLY))
            near = near[np.argsort(rounds[near], kind="stable")[: max(1, _AT_ONCE // 8)]]
            others = [self._unknown(_followed(before[place], int(last[place]))) for place in near.tolist()]
            unknown = np.unique(np.concatenate([unknown, *others]))
        return unknown, nodes

    def _stuck(self, there: FloatArray) -> int:
        """The first layer of which no place is reached, as the stage that leads to it."""
        reached = [bool(np.isfinite(there[a:b]).any()) for a, b in pairwise(self._offsets.tolist())]
        return max(0, reached.index(False) - 1) if False in reached else len(self._spaces) - 1

    def _unknown(self, nodes: list[int]) -> IntArray:
        """The ways of a path that were not looked at yet."""
        keys = self._keys(np.array(nodes[:-1]), np.array(nodes[1:]))
        own = self._keys(self._begins, self._ends)
        order = np.argsort(own)
        ways = order[np.searchsorted(own[order], keys)]
        unknown: IntArray = ways[self._status[ways] == _UNKNOWN]
        return unknown

    def _keys(self, begins: IntArray, ends: IntArray) -> IntArray:
        low, high = np.minimum(begins, ends), np.maximum(begins, ends)
        keys: IntArray = low * np.int64(len(self._points)) + high
        return keys

    def _graph(self) -> tuple["csr_array[np.float64, tuple[int, int]]", FloatArray]:
        steps = self._points[self._begins] - self._points[self._ends]
        lengths = np.maximum(np.hypot(*steps.T), _NO_LENGTH)
        kept = self._status != _SHUT
        back = kept & self._both
        rows = np.concatenate((self._begins[kept], self._ends[back])).astype(np.int32)
        columns = np.concatenate((self._ends[kept], self._begins[back])).astype(np.int32)
        size = len(self._points)
        graph = csr_array((np.concatenate((lengths[kept], lengths[back])), (rows, columns)), shape=(size, size))
        return graph, lengths

    def _join(self, stage: int, begins: IntArray, ends: IntArray, *, both: bool) -> None:
        count = len(begins)
        self._begins, self._ends = np.append(self._begins, begins), np.append(self._ends, ends)
        self._stage = np.append(self._stage, np.full(count, stage))
        self._both = np.append(self._both, np.full(count, both))
        self._status = np.append(self._status, np.full(count, _UNKNOWN, dtype=np.int8))

    def _activate(self, stage: int, pieces: set[int]) -> None:
        """Let paths of a stage bend at the corners of some pieces of rims."""
        if not pieces:
            return
        self._pieces[stage].update(pieces)
        self._active[stage].update(pieces)
        space = self._spaces[stage]
        new = np.flatnonzero(np.isin(space.piece_of, list(pieces)))
        nodes = len(self._points) + np.arange(len(new))
        self._points = np.concatenate((self._points, space.corners_m[new]))
        known, known_nodes = self._corners[stage], self._nodes[stage]
        corners, all_nodes = np.append(known, new), np.append(known_nodes, nodes)
        self._corners[stage], self._nodes[stage] = corners, all_nodes
        part = space.part_of_corner[new]
        for layer, of_place in zip((stage, stage + 1), self._parts[stage], strict=True):
            places = np.arange(self._offsets[layer], self._offsets[layer + 1])
            fits = space.touched(self._points[places], new) & (of_place[:, None] == part)
            place, corner = np.nonzero(fits)
            ends = (places[place], nodes[corner])
            self._join(stage, *(ends if layer == stage else ends[::-1]), both=False)
        fits = space.touched(space.corners_m[corners], new) & space.touched(space.corners_m[new], corners).T
        fits &= space.part_of_corner[corners][:, None] == part
        fits &= np.arange(len(corners))[:, None] < len(known) + np.arange(len(new))
        one, other = np.nonzero(fits)
        self._join(stage, all_nodes[one], nodes[other], both=True)

    def _chain(self, nodes: list[int]) -> Chain:
        """The path over some nodes, cut at the layers."""
        cuts = [i for i, node in enumerate(nodes) if node < self._offsets[-1]]
        places = tuple(int(nodes[i] - self._offsets[layer]) for layer, i in enumerate(cuts))
        lines = tuple(self._points[np.array(nodes[a : b + 1])] for a, b in pairwise(cuts))
        length = sum(float(np.hypot(*np.diff(line, axis=0).T).sum()) for line in lines)
        return Chain(places, lines, length)


def _followed(before: IntArray, end: int) -> list[int]:
    nodes = [end]
    while before[nodes[-1]] >= 0:
        nodes.append(int(before[nodes[-1]]))
    return nodes[::-1]
