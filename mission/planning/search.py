"""Best accepting runs of the product (paper, Sec. 5.2, for any formula and any costs).

A run is a lasso: a way from the start to a state, its head, and a loop from there back to it, round which every
acceptance set is met. *All* runs of the least cost are found: counted exactly, listed lazily, and picked by number
without listing the ones before. How prefix and suffix are weighed against each other is the ``Objective``.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import accumulate

import numpy as np

from mission.errors import NoPlanError
from mission.geometry.arrays import FloatArray, IntArray
from mission.planning.chains import Chain, Ways, chain
from mission.planning.objective import SUFFIX_DECIDES, Objective, Rank
from mission.planning.product import Product
from mission.planning.recurrence import accepting_components, recurrent_candidates
from mission.planning.refusal import refusal
from mission.planning.run import Run
from mission.planning.sweeps import Graph
from mission.planning.tours import Tours, loop_ways, tours


@dataclass(frozen=True)
class Head:
    """A product state at which a best lasso enters its loop.

    Attributes:
        state: The product state.
        distance: Cost of the cheapest way to it.
        loop: Cost of the loop.
        place: The tours that the loop is among, and the index of the state there; None for a stay.
    """

    state: int
    distance: float
    loop: float
    place: tuple[Tours, int] | None = None


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

    They are ordered by the cost of the prefix, then by the triangle in which the loop begins and the state (or set
    of states) of the automaton there, then by the loop and then by the prefix, each compared from its end backward by
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


def search(product: Product, objective: Objective = SUFFIX_DECIDES) -> ShortestRuns:
    """Find all best accepting runs.

    Raises:
        NoPlanError: If there is none; the message says why, and how far the flight can get.
        SearchSizeError: If the best loop is beyond an exact search.
    """
    heads = _heads(product, objective)
    if not heads:
        raise NoPlanError(refusal(product))
    groups: list[_Group] = []
    for distance in sorted({head.distance for head in heads}):
        groups.extend(_groups(product, [head for head in heads if head.distance == distance]))
    return ShortestRuns(round(objective.cost(heads[0].distance, heads[0].loop)), tuple(groups))


def _heads(product: Product, objective: Objective) -> list[Head]:
    """All heads of the least rank, by state.

    A stay is a loop of one transition; every other loop takes two transitions at least, so it is looked for only where
    it could be as good.
    """
    weights = product.system.weights
    candidates = recurrent_candidates(product)
    distances = product.distances[candidates]
    stays = np.flatnonzero(product.accepting_stays(candidates))
    loops = weights[product.parts(candidates[stays])[0], 0].astype(np.float64)
    rank, chosen = _least(objective, distances[stays], loops)
    found: dict[Rank, list[Head]] = {
        rank: [Head(int(candidates[stays[i]]), float(distances[stays[i]]), float(loops[i])) for i in chosen.tolist()]
    }
    first, second = objective.ranks(distances, np.full(len(distances), 2.0 * float(weights.min())))
    hopeful = (first < rank[0]) | ((first == rank[0]) & (second <= rank[1]))
    for component in accepting_components(product, candidates) if hopeful.any() else ():
        among, reached = tours(product, component, objective, rank)
        best, chosen = _least(objective, product.distances[component.states], among.lengths)
        if best > rank or not len(chosen):
            continue
        rank = reached
        found.setdefault(rank, []).extend(
            Head(
                int(component.states[i]),
                float(product.distances[component.states[i]]),
                float(among.lengths[i]),
                (among, i),
            )
            for i in chosen.tolist()
        )
    # A stay that accepts is among the tours, too, where these were looked for: one head for each state.
    heads = {head.state: head for head in found[rank]}
    return [heads[state] for state in sorted(heads)]


def _least(objective: Objective, prefixes: FloatArray, suffixes: FloatArray) -> tuple[Rank, IntArray]:
    """The least rank of lassos, and which of them have it; none where all suffixes are infinite."""
    first, second = objective.ranks(prefixes, suffixes)
    if not np.isfinite(first).any():
        return (np.inf, np.inf), np.zeros(0, dtype=np.int64)
    least = first.min()
    then = second[first == least].min()
    return (float(least), float(then)), np.flatnonzero((first == least) & (second == then))


def _groups(product: Product, heads: list[Head]) -> Iterator[_Group]:
    """The runs to heads that are equally far from the start."""
    ways, states = _prefix_ways(product, np.array([head.state for head in heads]))
    prefixes = chain([ways])
    head_of = {head.state: head for head in heads}
    loops_of: dict[tuple[Head, ...], tuple[Chain, tuple[int, ...]]] = {}
    for node, members in prefixes.ends:
        key = tuple(head_of[int(states[member])] for member in members)
        if key not in loops_of:
            loops = chain([_loop_ways(product, head) for head in key])
            loops_of[key] = loops, tuple(end for end, _ in loops.ends)
        yield _Group(prefixes, node, *loops_of[key])


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


def _loop_ways(product: Product, head: Head) -> Ways:
    """The best loops of a head, as ways from it to itself."""
    if head.place is not None:
        return loop_ways(product, *head.place)
    triangles, order = product.parts(np.repeat(np.array([head.state]), 2))
    one = np.ones(1, dtype=np.int64)
    return Ways(triangles, order, np.array([0.0, head.loop]), 0 * one, 0 * one, one, one)
