"""Shortest accepting runs of the product: backward from the accepting states (paper, Sec. 5.2).

A run is a lasso whose loop begins at an accepting state f. Its cost is the number of its transitions,
d(f) + c(f): the distance of f from the initial states and the length of the shortest loop through f. *All* runs of the
least cost are found: counted exactly, listed lazily, and picked by number without listing the ones before.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import accumulate

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from mission.errors import NoPlanError
from mission.geometry.arrays import IntArray
from mission.planning.chains import Chain
from mission.planning.product import UNREACHED, Product
from mission.planning.run import Run


@dataclass(frozen=True)
class _Group:
    """The runs whose prefix ends before one node: every prefix goes with every loop."""

    prefixes: Chain
    node: int
    loops: Chain
    heads: tuple[tuple[int, int], ...]  # nodes of the last layer of ``loops`` that close it, with their counts

    @property
    def prefix_count(self) -> int:
        return int(self.prefixes.layers[-1].counts[self.node])

    @property
    def size(self) -> int:
        return self.prefix_count * sum(count for _, count in self.heads)

    def run(self, rank: int) -> Run:
        loop_rank, prefix_rank = divmod(rank, self.prefix_count)
        before, entering = self.prefixes.walk(self.node, prefix_rank)
        ends = accumulate(count for _, count in self.heads)
        head, end = next((i, end) for i, end in enumerate(ends) if loop_rank < end)
        node, count = self.heads[head]
        around, controls = self.loops.walk(node, loop_rank - end + count)
        return Run(tuple(before[:-1]), tuple(around[:-1]), tuple(entering + controls))


class ShortestRuns:
    """All runs of the least cost.

    They are ordered by the length of the prefix, then by the triangle in which the loop begins, and then, compared
    from the end of the run backward, by control and by triangle.

    Attributes:
        cost: Number of transitions of each of them.
        count: How many there are.
    """

    def __init__(self, cost: int, groups: tuple[_Group, ...]) -> None:
        self.cost = cost
        self._groups = groups
        self.count = sum(group.size for group in groups)

    def __getitem__(self, index: int) -> Run:
        """The run of a number; IndexError beyond the last."""
        if index < 0:
            raise IndexError("runs are numbered from 0")
        for group in self._groups:
            if index < group.size:
                return group.run(index)
            index -= group.size
        raise IndexError(f"there are {self.count} shortest runs")

    def __iter__(self) -> Iterator[Run]:
        """The runs one after the other, made as they are asked for."""
        for group in self._groups:
            for rank in range(group.size):
                yield group.run(rank)


def search(product: Product) -> ShortestRuns:
    """Find all shortest accepting runs.

    Raises:
        NoPlanError: If there is none; the message says how far the vehicle can get.
    """
    if not len(product.initial):
        label = ", ".join(sorted(product.system.letters[product.system.letter_of[product.start]])) or "no region"
        raise NoPlanError(f"the formula is violated where the flight starts, in triangle {product.start} ({label})")
    distances = product.distances
    accepting = np.flatnonzero((distances != UNREACHED) & np.tile(product.automaton.accepting, product.system.size))
    if not len(accepting):
        raise NoPlanError(f"no run satisfies the formula: {_how_far(product)}")
    heads = _heads(product, accepting)
    if not heads:
        raise NoPlanError(
            f"the formula asks for something again and again that can happen only finitely often: {_how_far(product)}"
        )
    best = min(distance + loop for _, distance, loop in heads)
    heads = [head for head in heads if head[1] + head[2] == best]
    groups: list[_Group] = []
    for distance in sorted({d for _, d, _ in heads}):
        anchors = np.array([f for f, d, _ in heads if d == distance], dtype=np.int64)
        groups.extend(_groups(product, anchors, distance, best - distance))
    return ShortestRuns(best, tuple(groups))


def _heads(product: Product, accepting: IntArray) -> list[tuple[int, int, int]]:
    """Accepting states (f, d(f), c(f)) among which are all with the least d(f) + c(f)."""
    distances = product.distances[accepting]
    stays = product.stays(accepting)
    found = [(int(f), int(d), 1) for f, d in zip(accepting[stays], distances[stays], strict=True)]
    best = min((d + 1 for _, d, _ in found), default=2 * product.full_size)
    candidates = np.flatnonzero(~stays & (distances + 2 <= best))
    if not len(candidates):
        return found
    component = _components(product)
    for i in candidates[np.argsort(distances[candidates], kind="stable")].tolist():
        f, d = int(accepting[i]), int(distances[i])
        if component[f] == UNREACHED or d + 2 > best:
            continue
        loop = _loop_length(product, f, best - d)
        if loop is not None:
            found.append((f, d, loop))
            best = min(best, d + loop)
    return found


def _components(product: Product) -> IntArray:
    """The strongly connected component of each reachable state, ``UNREACHED`` for one on no loop; (M * Q,)."""
    reachable = np.flatnonzero(product.distances != UNREACHED)
    steps = product.out(reachable)
    place = np.full(product.full_size, UNREACHED, dtype=np.int64)
    place[reachable] = np.arange(len(reachable))
    moved = place[steps.states] != steps.rows
    ends = (steps.rows[moved], place[steps.states[moved]])
    graph = coo_array((np.ones(len(ends[0]), dtype=np.int8), ends), shape=(len(reachable), len(reachable)))
    _, labels = connected_components(graph.tocsr(), directed=True, connection="strong")
    sizes = np.bincount(labels)
    component = np.full(product.full_size, UNREACHED, dtype=np.int64)
    component[reachable] = np.where(sizes[labels] > 1, labels, UNREACHED)
    return component


def _loop_length(product: Product, head: int, most: int) -> int | None:
    """Length of the shortest loop through a state that does not stay, None if it is longer than ``most``."""
    distances = product.distances_from(np.array([head]), most - 1)
    sources = np.unique(product.into(np.array([head])).states)
    lengths = distances[sources][distances[sources] != UNREACHED]
    return int(lengths.min()) + 1 if len(lengths) else None


def _groups(product: Product, anchors: IntArray, distance: int, loop: int) -> Iterator[_Group]:
    """The runs that reach one of the ``anchors`` after ``distance`` transitions and return after ``loop`` more."""
    states = product.automaton.states
    prefixes = Chain(product, [((codes, 0),) for codes in _layers(product, product.distances, anchors, distance)])
    last = prefixes.layers[-1]
    for node in range(len(last.triangles)):
        triangle, bits = int(last.triangles[node]), prefixes.bits(int(last.sets[node]))
        here = [f for f in anchors.tolist() if f // states == triangle and bits >> (f % states) & 1]
        loops = Chain(product, _loops(product, here, loop))
        closed = sum(1 << (i * states + f % states) for i, f in enumerate(here))
        ends = loops.layers[-1]
        heads = tuple(
            (i, int(ends.counts[i])) for i in range(len(ends.triangles)) if loops.bits(int(ends.sets[i])) & closed
        )
        yield _Group(prefixes, node, loops, heads)


def _loops(product: Product, heads: list[int], length: int) -> list[list[tuple[IntArray, int]]]:
    """The product states on loops of the given length, for each layer and each head."""
    marked: list[list[tuple[IntArray, int]]] = [[] for _ in range(length + 1)]
    for anchor, head in enumerate(heads):
        around = np.array([head])
        distances = product.distances_from(around, length - 1)
        for pairs, codes in zip(marked, _layers(product, distances, around, length), strict=True):
            pairs.append((codes, anchor))
    return marked


def _layers(product: Product, distances: IntArray, ends: IntArray, length: int) -> list[IntArray]:
    """The states, layer by layer, on ways of the given length from distance 0 to ``ends``, each layer one step on."""
    layers = [np.unique(ends)]
    for level in range(length - 1, -1, -1):
        before = product.into(layers[-1]).states
        layers.append(np.unique(before[distances[before] == level]))
    return layers[::-1]


def _how_far(product: Product) -> str:
    """Which regions can be reached, and which cannot, before the formula is violated."""
    x, _ = product.parts(np.flatnonzero(product.distances != UNREACHED))
    reached = set().union(*(product.system.letters[i] for i in np.unique(product.system.letter_of[x]).tolist()))
    missed = sorted(set().union(*product.system.letters) - reached)
    text = f"from triangle {product.start} the flight can reach {', '.join(sorted(reached)) or 'no region'}"
    return f"{text}, but not {', '.join(missed)}" if missed else text
