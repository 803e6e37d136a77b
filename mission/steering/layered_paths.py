"""Shortest paths over layers of places, each layer reached through a free space of its own, with lazy visibility.

A shortest path among polygons bends at their corners only and touches them there (Lozano-Perez and Wesley, "An
algorithm for planning collision-free paths among polyhedral obstacles", 1979). A corner joins the graph once a path
over it could be as short as the best one, with ways to what may be seen from it; these are taken to be free until the
best path asks for them. The length found never
exceeds the true one meanwhile, so the first path whose ways are all free is a shortest one (the argument of lazy
search: Dellin and Srinivasa, "A unifying formalism for shortest path problems with expensive edge evaluations", 2016).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from operator import is_
from typing import Final, TypeAlias

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra
from scipy.spatial.distance import cdist

from mission.errors import MissionError
from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.steering.free_space import FreeSpace

_NO_LENGTH: Final = 1e-9
"""Metres that a way between equal places counts: sparse arrays take zero for no way."""
_NEARLY: Final = 2e-3
"""Ways on paths that are longer than the best one by at most this part are looked at together with its own."""
_WIDER: Final = 0.5
"""How much more than the shortest length that is possible is looked for at once, by what it exceeds the first one."""
_AT_ONCE: Final = 1500
_NONE: Final = -1
_ROUNDING: Final = 1e-9
"""By what part of its length sums along a path differ that begin at its one end or at the other."""

Graph: TypeAlias = "csr_array[np.float64, tuple[int, int]]"


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
    """Searches over the same free spaces, which remember what they have seen.

    Args:
        spaces: The free space of each stage.
        cyclic: Whether paths are rounds: the last layer's places are those of the first, and one and the same place is
            passed in both.
    """

    def __init__(self, spaces: Sequence[FreeSpace], *, cyclic: bool = False) -> None:
        self._spaces, self._cyclic = spaces, cyclic
        none = np.empty(0, dtype=np.int64)
        self._layers: list[FloatArray] = []
        self._offsets = none
        # Nodes: the places, layer by layer, then corners: of each its stage, and its number in the free space there.
        self._points = np.empty((0, 2))
        self._corner_stage, self._corner = none, none
        # Of each stage, for all corners: its node, counted from the first corner's; and how long a path is at least
        # that bends there, and whether that is exact: infinitely long over those that are left out for good.
        self._node = [np.full(len(space.corners_m), _NONE) for space in spaces]
        self._least = [np.zeros(len(space.corners_m)) for space in spaces]
        self._left_out = [np.zeros(len(space.corners_m), dtype=np.bool_) for space in spaces]
        self._exact = [np.zeros(len(space.corners_m), dtype=np.bool_) for space in spaces]
        # Ways between two nodes that may be free: of some stage, perhaps both ways, perhaps seen to be free, and
        # perhaps on a path that is nearly as short as the best one.
        self._begins, self._ends, self._stage = none, none, none
        self._both, self._seen, self._near = (np.empty(0, dtype=np.bool_) for _ in range(3))
        self._lengths = np.empty(0)
        self._joined: list[tuple[IntArray, IntArray, IntArray, BoolArray, FloatArray]] = []
        self._seen_from: list[tuple[tuple[IntArray, IntArray], tuple[IntArray, IntArray]]] = []

    @property
    def _count(self) -> int:
        """Number of places."""
        return int(self._offsets[-1]) if len(self._offsets) else 0

    def shortest(self, layers: Sequence[FloatArray]) -> Chain:
        """The shortest path.

        Args:
            layers: Of one more layer than there are spaces, the places, shape (N, 2).

        Raises:
            NoWayError: There is none.
        """
        self._begin(layers)
        first, last = np.arange(self._offsets[1]), np.arange(self._offsets[-2], self._offsets[-1])
        ends = list(zip(first[:, None], last[:, None], strict=True)) if self._cyclic else [(first, last)]
        least = self._straight_rounds() if self._cyclic else np.zeros(1)
        limit, straight = np.inf, float(self._unlinked_m)
        while True:
            choice = int(np.argmin(least))
            graph = self._graph()
            there, before, _ = dijkstra(graph, indices=ends[choice][0], min_only=True, return_predecessors=True)
            end = int(ends[choice][1][np.argmin(there[ends[choice][1]])])
            # Any other path bends at a corner that is not linked yet.
            least[choice] = min(there[end], self._unlinked_m)
            best = float(least.min())
            if best > limit:
                self._near, limit = np.isfinite(self._lengths), np.inf
                continue
            if not np.isfinite(best):
                raise NoWayError(self._stuck(there), "no way leads to the target")
            # What is left out below is on no path up to the limit, if all corners of such paths are linked.
            reach = limit
            if not np.isfinite(limit):
                reach = min(float(there[end]), best + _WIDER * max(best - straight, 0.0)) * (1.0 + _NEARLY)
            if self._link(reach) or there[end] > best:
                continue
            nodes = _followed(before.astype(np.int64), end)
            wanted = self._unknown(nodes)
            if not len(wanted):
                return self._chain(nodes)
            if not self._cyclic:
                limit = reach
            back = dijkstra(graph.T.tocsr(), indices=ends[choice][1], min_only=True)
            self._look(np.union1d(wanted, self._nearest(there, back, reach, limit)))

    def forget_beyond(self, length_m: float, layers: Sequence[FloatArray]) -> None:
        """Leave out the corners over which no path through the layers is as short as a length."""
        self._begin(layers)
        there, back = self._distances(self._graph())
        kept = np.append(np.ones(self._count, dtype=np.bool_), np.zeros(len(self._corner), dtype=np.bool_))
        kept |= there + back <= length_m * (1.0 + _ROUNDING)
        number = np.cumsum(kept) - 1
        self._keep(kept[self._begins] & kept[self._ends])
        self._begins, self._ends = number[self._begins], number[self._ends]
        corners = kept[self._count :]
        for stage, left_out in enumerate(self._left_out):
            left_out[self._corner[~corners & (self._corner_stage == stage)]] = True
        self._points = self._points[kept]
        self._corner_stage, self._corner = self._corner_stage[corners], self._corner[corners]
        for stage, node in enumerate(self._node):
            node[:] = _NONE
            here = np.flatnonzero(self._corner_stage == stage)
            node[self._corner[here]] = here

    # -- what is asked of the graph --------------------------------------------------------------------------------

    def _nearest(self, there: FloatArray, back: FloatArray, length_m: float, limit_m: float) -> IntArray:
        """Ways on paths no longer than a length, to be looked at, and of many the shortest.

        All that are on longer ones than a limit are left out from now on.
        """
        ways = np.flatnonzero(self._near)
        begins, ends = self._begins[ways], self._ends[ways]
        other = np.where(self._both[ways], there[ends] + back[begins], np.inf)
        through = np.minimum(there[begins] + back[ends], other) + self._lengths[ways]
        self._near[ways[through > limit_m]] = False
        chosen = np.flatnonzero(~self._seen[ways] & (through <= length_m))
        if len(chosen) > _AT_ONCE:
            chosen = chosen[np.argpartition(through[chosen], _AT_ONCE)[:_AT_ONCE]]
        found: IntArray = ways[chosen]
        return found

    def _look(self, ways: IntArray) -> None:
        """Find out which ways are free."""
        self._seen[ways] = True
        for stage in np.unique(self._stage[ways]).tolist():
            these = ways[self._stage[ways] == stage]
            hit = these[self._spaces[stage].hits(self._points[self._begins[these]], self._points[self._ends[these]])]
            self._near[hit], self._lengths[hit] = False, np.inf

    def _keep(self, ways: BoolArray) -> None:
        """Forget all other ways, and those that are not free."""
        ways &= np.isfinite(self._lengths)
        self._begins, self._ends, self._stage = self._begins[ways], self._ends[ways], self._stage[ways]
        self._both, self._seen, self._near = self._both[ways], self._seen[ways], self._near[ways]
        self._lengths = self._lengths[ways]

    def _stuck(self, there: FloatArray) -> int:
        """The first layer of which no place is reached, as the stage that leads to it."""
        reached = [bool(np.isfinite(there[a:b]).any()) for a, b in pairwise(self._offsets.tolist())]
        return max(0, reached.index(False) - 1) if False in reached else len(self._spaces) - 1

    def _unknown(self, nodes: list[int]) -> IntArray:
        """The ways of a path that were not looked at yet."""
        keys = self._keys(np.array(nodes[:-1]), np.array(nodes[1:]))
        ways = np.flatnonzero(self._near & ~self._seen)
        found: IntArray = ways[np.isin(self._keys(self._begins[ways], self._ends[ways]), keys)]
        return found

    def _keys(self, begins: IntArray, ends: IntArray) -> IntArray:
        keys: IntArray = np.minimum(begins, ends) * np.int64(len(self._points)) + np.maximum(begins, ends)
        return keys

    def _graph(self) -> Graph:
        """The graph of all ways that may be free and near the best path."""
        self._settle()
        kept = np.flatnonzero(self._near)
        back = kept[self._both[kept]]
        rows = np.concatenate((self._begins[kept], self._ends[back])).astype(np.int32)
        columns = np.concatenate((self._ends[kept], self._begins[back])).astype(np.int32)
        lengths, size = np.concatenate((self._lengths[kept], self._lengths[back])), len(self._points)
        return csr_array((lengths, (rows, columns)), shape=(size, size))

    def _chain(self, nodes: list[int]) -> Chain:
        """The path over some nodes, cut at the layers."""
        cuts = [i for i, node in enumerate(nodes) if node < self._count]
        places = tuple(int(nodes[i] - self._offsets[layer]) for layer, i in enumerate(cuts))
        lines = tuple(self._points[np.array(nodes[a : b + 1])] for a, b in pairwise(cuts))
        length = sum(float(np.hypot(*np.diff(line, axis=0).T).sum()) for line in lines)
        return Chain(places, lines, length)

    # -- what the graph is made of ---------------------------------------------------------------------------------

    def _begin(self, layers: Sequence[FloatArray]) -> None:
        """Put other places into the graph."""
        before = self._count
        same_places = len(layers) == len(self._layers) and all(map(is_, layers, self._layers))
        self._keep((self._begins >= before) & (self._ends >= before))
        self._near[:] = True  # but for those that are not free, which are gone
        corners = self._points[before:]
        self._layers = list(layers)
        self._offsets = np.cumsum([0, *(len(layer) for layer in layers)])
        shift = self._count - before
        self._begins, self._ends = self._begins + shift, self._ends + shift
        self._points = np.concatenate((*layers, corners))
        self._straight = _straight_lengths(self._layers)
        if not same_places:
            self._seen_from = self._seen_from_layers()
        for stage, space in enumerate(self._spaces):
            layers_here = self._layers[stage], self._layers[stage + 1]
            entry, exit_ = (space.part_of(places) for places in layers_here)
            same = (entry[:, None] == exit_[None]) & (entry >= 0)[:, None]
            if stage == 0 and (entry < 0).all():
                raise NoWayError(stage, "the way would begin where it must not be")
            if not same.any():
                raise NoWayError(stage, "no place from which the way could begin is connected with its target")
            first, second = np.nonzero(same)
            solid = space.solid(layers_here[0][first], layers_here[1][second])
            first, second = np.delete(first, solid), np.delete(second, solid)
            self._join(stage, self._offsets[stage] + first, self._offsets[stage + 1] + second, both=False)
            self._join_places(stage, self._node[stage] >= 0)
            self._least[stage] = self._roughly_least(stage)
            self._exact[stage][:] = False

    def _seen_from_layers(self) -> list[tuple[tuple[IntArray, IntArray], tuple[IntArray, IntArray]]]:
        """What is seen in the free space of each stage from the layers of places before and after it."""
        layers: dict[FreeSpace, dict[int, FloatArray]] = {}
        for stage, space in enumerate(self._spaces):
            layers.setdefault(space, {}).update({layer: self._layers[layer] for layer in (stage, stage + 1)})
        found = {
            (space, layer): seen
            for space, here in layers.items()
            for layer, seen in zip(here, space.seen_from_places(list(here.values())), strict=True)
        }
        return [(found[space, stage], found[space, stage + 1]) for stage, space in enumerate(self._spaces)]

    def _straight_rounds(self) -> FloatArray:
        """How long rounds from each place of the first layer are at least."""
        found = np.zeros((len(self._layers[0]), 1)) + np.where(np.eye(len(self._layers[0])) > 0.0, 0.0, np.inf)
        for one, other in pairwise(self._layers):
            found = (found[:, :, None] + _distances(one, other)[None]).min(axis=1)
        least: FloatArray = np.diagonal(found).copy()
        return least

    def _roughly_least(self, stage: int) -> FloatArray:
        """How long a path is at least that bends at each corner of a stage, from discs round the places."""
        total = np.zeros(len(self._least[stage]))
        for places, more in zip(self._layers[stage : stage + 2], self._onward(stage), strict=True):
            middle = places.mean(axis=0)
            far = float(np.hypot(*(places - middle).T).max())
            total += more.min() + np.maximum(np.hypot(*(self._spaces[stage].corners_m - middle).T) - far, 0.0)
        total[self._left_out[stage]] = np.inf
        return total

    def _onward(self, stage: int) -> tuple[FloatArray, FloatArray]:
        """How far the places before a stage are at least from the first layer, and those after it from the last."""
        return self._straight[0][stage], self._straight[1][stage + 1]

    @property
    def _unlinked_m(self) -> float:
        """How long a path is at least that bends at a corner which is not linked."""
        return min(
            float(least[node == _NONE].min(initial=np.inf)) for least, node in zip(self._least, self._node, strict=True)
        )

    def _link(self, length_m: float) -> bool:
        """Link the corners over which a path may be as short as a length; whether there are any."""
        linked = [self._to_link(stage, length_m) for stage in range(len(self._spaces))]
        for space in set(self._spaces):
            space.look_from(
                np.concatenate([new for new, own in zip(linked, self._spaces, strict=True) if own is space])
            )
        for stage, (new, space) in enumerate(zip(linked, self._spaces, strict=True)):
            if not len(new):
                continue
            node = self._node[stage]
            first = len(self._corner)
            node[new] = first + np.arange(len(new))
            self._points = np.concatenate((self._points, space.corners_m[new]))
            self._corner_stage = np.append(self._corner_stage, np.full(len(new), stage))
            self._corner = np.append(self._corner, new)
            corners = np.zeros(len(node), dtype=np.bool_)
            corners[new] = True
            self._join_places(stage, corners)
            index, seen = space.seen_from_corners(new)
            one, other = node[new][index], node[seen]
            kept = (other >= 0) & (other < one)  # each once
            self._join(stage, self._count + other[kept], self._count + one[kept], both=True)
        return any(map(len, linked))

    def _to_link(self, stage: int, length_m: float) -> IntArray:
        """The corners of a stage that are not linked yet, and over which a path may be as short as a length."""
        least, exact, open_ = self._least[stage], self._exact[stage], self._node[stage] == _NONE
        rough = np.flatnonzero((least <= length_m) & ~exact & open_)
        if len(rough):
            corners_m = self._spaces[stage].corners_m[rough]
            least[rough] = sum(
                (more + _distances(corners_m, places)).min(axis=1)
                for places, more in zip(self._layers[stage : stage + 2], self._onward(stage), strict=True)
            )
            exact[rough] = True
        return np.flatnonzero((least <= length_m) & open_)

    def _distances(self, graph: Graph) -> tuple[FloatArray, FloatArray]:
        """How far each node is from the nearest place of the first layer, and from the nearest of the last."""
        there = dijkstra(graph, indices=np.arange(self._offsets[1]), min_only=True)
        last = np.arange(self._offsets[-2], self._offsets[-1])
        return there, dijkstra(graph.T.tocsr(), indices=last, min_only=True)

    def _join_places(self, stage: int, corners: BoolArray) -> None:
        """Link corners of a stage with the places of its layers."""
        for layer, (place, seen) in zip((stage, stage + 1), self._seen_from[stage], strict=True):
            kept = corners[seen]
            ends = (self._offsets[layer] + place[kept], self._count + self._node[stage][seen[kept]])
            self._join(stage, *(ends if layer == stage else ends[::-1]), both=False)

    def _join(self, stage: int, begins: IntArray, ends: IntArray, *, both: bool) -> None:
        lengths = np.maximum(np.hypot(*(self._points[begins] - self._points[ends]).T), _NO_LENGTH)
        self._joined.append((begins, ends, np.full(len(begins), stage), np.full(len(begins), both), lengths))

    def _settle(self) -> None:
        """Take what was joined to the other ways."""
        if not self._joined:
            return
        begins, ends, stage, both, lengths = (np.concatenate(each) for each in zip(*self._joined, strict=True))
        self._joined.clear()
        self._begins, self._ends = np.append(self._begins, begins), np.append(self._ends, ends)
        self._stage, self._both = np.append(self._stage, stage), np.append(self._both, both)
        self._lengths = np.append(self._lengths, lengths)
        self._seen = np.append(self._seen, np.zeros(len(begins), dtype=np.bool_))
        self._near = np.append(self._near, np.ones(len(begins), dtype=np.bool_))


def _followed(before: IntArray, end: int) -> list[int]:
    nodes = [end]
    while before[nodes[-1]] >= 0:
        nodes.append(int(before[nodes[-1]]))
    return nodes[::-1]


def _distances(points: FloatArray, others: FloatArray) -> FloatArray:
    """(P, O) how far points are from others."""
    distances: FloatArray = cdist(points, others)
    return distances


def _straight_lengths(layers: list[FloatArray]) -> tuple[list[FloatArray], list[FloatArray]]:
    """For each place of each layer how far it is at least from the first layer, and from the last."""
    there, back = [np.zeros(len(layers[0]))], [np.zeros(len(layers[-1]))]
    for one, other in pairwise(layers):
        there.append((there[-1] + _distances(other, one)).min(axis=1))
    for one, other in pairwise(layers[::-1]):
        back.append((back[-1] + _distances(other, one)).min(axis=1))
    return there, back[::-1]
