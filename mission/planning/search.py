"""Shortest accepting runs of the product: backward from the accepting states (paper, Sec. 5.2).

A run is a lasso whose loop begins at an accepting state f. Its cost is the number of its transitions,
d(f) + c(f): the distance of f from the initial states and the length of the shortest loop through f. *All* runs of the
least cost are found: counted exactly, listed lazily, and picked by number without listing the ones before.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import accumulate

import numpy as np

from mission.errors import NoPlanError
from mission.planning.chains import Chain, Layered, chain
from mission.planning.product import Codes, Product
from mission.planning.refusal import refusal
from mission.planning.run import Run


@dataclass(frozen=True)
class Head:
    """An accepting state on a loop: its number, its distance from the start, the length of its shortest loop."""

    state: int
    distance: int
    loop: int

    @property
    def cost(self) -> int:
        """Number of transitions of the shortest lasso whose loop begins here."""
        return self.distance + self.loop


@dataclass(frozen=True)
class _Group:
    """The runs whose prefix ends before one node: every prefix goes with every loop."""

    prefixes: Chain
    node: int
    loops: Chain
    closing: tuple[int, ...]  # nodes of the last layer of ``loops`` at which a loop is closed

    @property
    def prefix_count(self) -> int:
        return self.prefixes.counts[self.node]

    @property
    def size(self) -> int:
        return self.prefix_count * sum(self.loops.counts[node] for node in self.closing)

    def run(self, rank: int) -> Run:
        loop_rank, prefix_rank = divmod(rank, self.prefix_count)
        before, entering = self.prefixes.walk(self.node, prefix_rank)
        passed = accumulate(self.loops.counts[node] for node in self.closing)
        node, end = next((node, end) for node, end in zip(self.closing, passed, strict=True) if loop_rank < end)
        around, controls = self.loops.walk(node, loop_rank - end + self.loops.counts[node])
        return Run(tuple(before[:-1]), tuple(around[:-1]), tuple(entering + controls))


class ShortestRuns:
    """All runs of the least cost.

    They are ordered by the length of the prefix, then by the triangle in which the loop begins and the state (or set
    of states) of the automaton there, then by the loop and then by the prefix, each compared from its end backward by
    control and by triangle.

    Attributes:
        cost: Number of transitions of each of them.
        count: How many there are, exactly.
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
            rank, size = 0, group.size  # a count may be beyond what range() can hold
            while rank < size:
                yield group.run(rank)
                rank += 1


def search(product: Product) -> ShortestRuns:
    """Find all shortest accepting runs.

    Raises:
        NoPlanError: If there is none; the message says why, and how far the flight can get.
    """
    heads = _heads(product)
    if not heads:
        raise NoPlanError(refusal(product))
    groups: list[_Group] = []
    for distance in sorted({head.distance for head in heads}):
        groups.extend(_groups(product, [head for head in heads if head.distance == distance]))
    return ShortestRuns(heads[0].cost, tuple(groups))


def _heads(product: Product) -> list[Head]:
    """All heads of the least cost.

    A stay is a loop of one transition; no other loop is shorter than two. One sweep from all the heads that do not
    stay gives a lower bound of their loops, in the order of which they are tried, up to the best found so far.
    """
    accepting = product.accepting
    distances = product.distances[accepting]
    stays = product.stays(accepting)
    nearest = int(distances[stays].min(initial=2 * product.full_size))
    found = [Head(f, nearest, 1) for f in accepting[stays & (distances == nearest)].tolist()]
    best = nearest + 1
    moving = accepting[~stays & (distances + 2 <= best)]
    if len(moving):
        moving = moving[product.on_loops[moving]]
    if len(moving):
        bounds = product.distances[moving] + 1 + _loop_distances(product, moving)[moving]
        for i in np.argsort(bounds, kind="stable").tolist():
            if bounds[i] > best:
                break
            state = moving[i : i + 1]
            loop = int(_loop_distances(product, state)[state[0]]) + 1
            found.append(Head(int(state[0]), int(product.distances[state[0]]), loop))
            best = min(best, found[-1].cost)
    return [head for head in found if head.cost == best]


def _loop_distances(product: Product, heads: Codes) -> Codes:
    """Distances from the states after ``heads``: one less than the length of a way from a head, back to it too."""
    return product.distances_from(np.unique(product.out(heads).states))


def _groups(product: Product, heads: list[Head]) -> Iterator[_Group]:
    """The runs to heads that are equally far from the start."""
    states = np.array([head.state for head in heads], dtype=np.int32)
    ways = product.on_shortest_ways(product.distances, states)
    prefixes = chain(product, [Layered(ways, product.distances[ways].astype(np.int64))])
    triangles, automaton_states = (part.tolist() for part in product.parts(states))
    at_triangle: dict[int, list[tuple[int, Head]]] = {}
    for x, q, head in zip(triangles, automaton_states, heads, strict=True):
        at_triangle.setdefault(x, []).append((q, head))
    loops_of: dict[tuple[Head, ...], tuple[Chain, tuple[int, ...]]] = {}
    for node, bits in prefixes.ends:
        key = tuple(head for q, head in at_triangle[prefixes.triangles[node]] if bits >> q & 1)
        if key not in loops_of:
            loops = chain(product, [_loop_graph(product, head) for head in key])
            loops_of[key] = loops, tuple(end for end, _ in loops.ends)  # the last layer is the heads, each its own
        yield _Group(prefixes, node, *loops_of[key])


def _loop_graph(product: Product, head: Head) -> Layered:
    """The states on the shortest loops of a head, which is in the first layer and in the last."""
    state = np.array([head.state], dtype=np.int32)
    if head.loop == 1:
        return Layered(np.repeat(state, 2), np.arange(2))
    distances = _loop_distances(product, state)
    ways = product.on_shortest_ways(distances, state)
    return Layered(np.concatenate((state, ways)), np.concatenate(([0], distances[ways].astype(np.int64) + 1)))
