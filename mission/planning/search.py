"""Best accepting runs of the product (paper, Sec. 5.2, for any formula and any costs).

A run is a lasso over triangles: a way from the start to one of them, the head, and a loop from there back to it, so
that the word of the way with the loop repeated for ever is accepted. Whether the automaton, too, is back where it was
after one round does not matter. *All* runs of the least cost are found: counted exactly, listed lazily, and picked by
number without listing the ones before. How prefix and suffix are weighed against each other is the ``Objective``.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import accumulate

import numpy as np

from mission.errors import NoPlanError
from mission.geometry.arrays import IntArray
from mission.planning.chains import Chain, Ways, chain
from mission.planning.heads import Head, best_heads
from mission.planning.objective import SUFFIX_DECIDES, Objective
from mission.planning.product import Product
from mission.planning.refusal import refusal
from mission.planning.run import Run
from mission.planning.sweeps import Graph


@dataclass(frozen=True)
class _Group:
    """The runs whose prefix ends before one node: every prefix goes with every loop."""

    prefixes: Chain
    node: int
    loops: Chain
    closing: tuple[int, ...]  # nodes of ``loops`` at which a loop is closed

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

    They are ordered by the cost of the prefix, then by the triangle in which the loop begins and the state of the
    automaton there, then by the loop and then by the prefix, each compared from its end backward by
    control and by triangle.

    Attributes:
        cost: The weighed cost of each of them; the number of its transitions where each of them and a suffix count 1.
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


def search(product: Product, objective: Objective = SUFFIX_DECIDES, *, closing: bool = False) -> ShortestRuns:
    """Find all best accepting runs.

    Args:
        product: P.
        objective: What is best.
        closing: Whether only such loops count that bring A back to where it was after one round: runs of P.

    Raises:
        NoPlanError: If there is none; the message says why, and how far the flight can get.
        SearchSizeError: If the best loop is beyond an exact search.
    """
    heads = best_heads(product, objective, closing=closing)
    if not heads:
        raise NoPlanError(refusal(product))
    groups: list[_Group] = []
    for distance in sorted({head.distance for head in heads}):
        groups.extend(_groups(product, [head for head in heads if head.distance == distance]))
    return ShortestRuns(round(objective.cost(heads[0].distance, heads[0].loop)), tuple(groups))


def _groups(product: Product, heads: list[Head]) -> Iterator[_Group]:
    """The runs to heads that are equally far from the start."""
    ways, states = _prefix_ways(product, np.array([head.state for head in heads]))
    prefixes = chain(ways)
    head_of = {head.state: head for head in heads}
    for node, end in prefixes.ends:
        loops = chain(head_of[int(states[end])].ways())
        yield _Group(prefixes, node, loops, tuple(closing for closing, _ in loops.ends))


def _prefix_ways(product: Product, ends: IntArray) -> tuple[Ways, IntArray]:
    """The cheapest ways from the start to states that are equally far from it, and the product state of each state."""
    graph, distances = product.graph, product.distances
    before = np.where(distances < distances[ends[0]], distances, np.inf)
    ahead = np.repeat(before, np.diff(graph.begins)) + graph.weights == distances[graph.targets]
    kept = np.zeros(len(graph.targets) + 1, dtype=np.int32)
    np.cumsum(ahead, out=kept[1:])
    backward = Graph(graph.targets[ahead], kept[graph.begins], 1.0).reversed
    states = np.flatnonzero(np.isfinite(backward.distances(ends)))
    number = np.full(product.full_size, -1, dtype=np.int64)
    number[states] = np.arange(len(states))
    steps = product.out(states)
    onward = (number[steps.states] >= 0) & (distances[states[steps.rows]] + steps.weights == distances[steps.states])
    triangles, order = product.parts(states)
    ways = Ways(
        triangles=triangles,
        order=order,
        distances=distances[states],
        sources=steps.rows[onward],
        controls=steps.controls[onward],
        targets=number[steps.states[onward]],
        ends=number[ends],
    )
    return ways, states
