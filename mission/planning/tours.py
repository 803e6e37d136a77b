"""Best tours: the cheapest closed walks of a component that bear every acceptance mark.

The order in which a walk bears the marks is free, so this is a travelling salesman's problem over sets of transitions.
It is solved exactly on the *lifted* graph, whose vertices are a state and the set of marks borne since the walk began:
a tour through a state is a way from that state without marks to the same state with all of them. The lifted graph is
2^K times as large as the component, so only that part of it is made through which a tour can go that is not worse than
one already known (``mission.planning.bounds``). Every tour passes through an anchor; for each of these in the order of
their bounds, one sweep forward and one backward give the cheapest tours through it and through every state with it.
The sweeps are guided by the distances to and from *all* anchors (Hart, Nilsson and Raphael, "A formal basis for the
heuristic determination of minimum cost paths", 1968: reduced weights w + h(v) - h(u) are not negative), and so touch
little more than what can be on a tour that is good enough.
"""

from collections.abc import Iterator

import numpy as np

from mission.errors import SearchSizeError
from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.planning.bounds import Marked, TourTable
from mission.planning.objective import Objective, Rank
from mission.planning.product import MOST_SETS
from mission.planning.recurrence import Component
from mission.planning.sweeps import Graph

_MOST_VERTICES = 8_000_000
_ROUNDING = 1e-6
"""Costs are whole numbers; a bound of them that was divided by a weight need not be."""


def tours(
    component: Component, prefixes: FloatArray, nearest: float, objective: Objective, rank: Rank, *, floor: float = 0.0
) -> tuple[FloatArray, Rank]:
    """Find the best tours of a component.

    Args:
        component: An accepting component of a product.
        prefixes: (n,) cost of the cheapest way to each of its states.
        nearest: Cost of the cheapest way to any of its triangles, in whatever state of A.
        objective: What is best.
        rank: What is known to be reached elsewhere; worse tours are of no interest.
        floor: What cheaper tours are taken to cost: a stay, which is one, may be looked at elsewhere.

    Returns:
        (n,) cost of the cheapest tour through each state, exact where a lasso of least rank, from any state of A in one
        of its triangles, can have such a loop, and else perhaps infinite; and the least rank of lassos that enter the
        component and go round, or the one that was given where none is as good.

    Raises:
        SearchSizeError: There are too many marks, or too many states are in question.
    """
    sets = component.every.bit_length()
    if sets > MOST_SETS:
        raise SearchSizeError(f"a tour of {sets} tasks is beyond an exact search, which takes at most {MOST_SETS}")
    marked = Marked.of(component, sets)
    mark, anchors = marked.anchors()
    table = TourTable.of(marked, mark)
    best = min(rank, objective.rank(float(prefixes.max()), _some_tour(marked, table, anchors)))
    longest = objective.longest_suffix(best, nearest) + _ROUNDING

    bounds = table.through(np.arange(component.size))
    bounds[-1, anchors] = bounds[0, anchors]  # a tour ends where it began, with all marks
    kept = bounds.min(axis=0) <= longest
    if not kept[anchors].any():
        return np.full(component.size, np.inf), rank
    lifted = _Lifted.of(component.part(kept), bounds[:, kept] <= longest)
    number = np.cumsum(kept) - 1
    lengths = np.full(component.size, np.inf)
    best = rank
    for found in lifted.tours_through(number[anchors[kept[anchors]]], longest):
        lengths[kept] = np.minimum(lengths[kept], np.maximum(found, floor))
        first, second = objective.ranks(prefixes, lengths)
        least = first.min()
        best = min(best, (float(least), float(second[first == least].min())))
        lifted.longest = min(lifted.longest, objective.longest_suffix(best, nearest) + _ROUNDING)
    return lengths, best


def _some_tour(marked: Marked, table: TourTable, anchors: IntArray) -> float:
    """The cost of a good tour: the order of the table's best one, from one of the anchors that it could go through."""
    component = marked.component
    anchor = int(anchors[np.argmin(table.through(anchors)[0])])
    weights = np.broadcast_to(marked.graph.weights, len(marked.graph.targets))
    graph = Graph(marked.graph.targets, marked.graph.begins, weights)  # as many, for a start at several distances
    reached = graph.distances(np.array([anchor]))
    for mark in table.order()[:-1]:
        bears = component.marks >> mark & 1 > 0
        after = reached[component.sources[bears]] + component.weights[bears]
        reached = graph.with_root(component.targets[bears], after).distances(np.array([component.size]))[:-1]
    closing = (component.targets == anchor) & (component.marks >> table.anchor & 1 > 0)
    return float((reached[component.sources[closing]] + component.weights[closing]).min())


class _Lifted:
    """The lifted graph of a component, or a part of it.

    Attributes:
        size: Number of vertices.
        state_of: The state of each vertex.
        borne: The marks borne at each vertex, as bits.
        longest: Cost of the costliest tour that is still of interest.
        sources: (E,) vertex that a transition leaves; ``targets``, ``weights`` likewise.
    """

    def __init__(
        self, component: Component, number: IntArray, sources: IntArray, targets: IntArray, edges: IntArray
    ) -> None:
        self._number = number
        self.borne, self.state_of = np.nonzero(number >= 0)
        self.size = len(self.borne)
        self.sources, self.targets = sources, targets
        self.weights = component.weights[edges]
        self.longest = np.inf
        self.graph = Graph.from_edges(self.size, sources, targets, self.weights)

    @staticmethod
    def of(component: Component, kept: BoolArray) -> "_Lifted":
        """Lift a component; ``kept`` (2^K, n) says which vertices are made."""
        size = int(np.count_nonzero(kept))
        if size > _MOST_VERTICES:
            raise SearchSizeError(f"the best tour is one of too many: {size:,} states of it are in question")
        number = np.where(kept, np.cumsum(kept, dtype=np.int32).reshape(kept.shape) - 1, np.int32(-1))
        sources, targets, edges = [], [], []
        for borne in range(component.every + 1):
            begin = number[borne, component.sources]
            end = number[borne | component.marks, component.targets]
            there = np.flatnonzero((begin >= 0) & (end >= 0) & (begin != end))
            sources.append(begin[there])
            targets.append(end[there])
            edges.append(there)
        return _Lifted(component, number, np.concatenate(sources), np.concatenate(targets), np.concatenate(edges))

    def ends(self, states: IntArray) -> tuple[IntArray, IntArray]:
        """The vertices at which tours through ``states`` begin and end, where there are both."""
        begin, end = self._number[0, states], self._number[-1, states]
        both = (begin >= 0) & (end >= 0)
        return begin[both], end[both]

    def tours_through(self, anchors: IntArray, longest: float) -> Iterator[FloatArray]:
        """For one anchor after the other, (n,) costs of the cheapest tours through it and each state.

        They are exact up to ``longest``, an attribute that may be lowered meanwhile, and infinite beyond it.
        """
        self.longest = longest
        begins, ends = self.ends(anchors)
        since, until = self.graph.distances(begins), self.graph.reversed.distances(ends)
        usable = np.flatnonzero((since + until)[self.sources] <= longest)
        usable = usable[(since + until)[self.targets[usable]] <= longest]
        sources, targets, weights = self.sources[usable], self.targets[usable], self.weights[usable]
        forward = Graph.from_edges(self.size, sources, targets, weights + until[targets] - until[sources])
        backward = Graph.from_edges(self.size, targets, sources, weights + since[sources] - since[targets])
        states = self._number.shape[1]
        for index in np.argsort(until[begins], kind="stable").tolist():
            begin, end = begins[index], ends[index]
            if until[begin] > self.longest:
                return
            onward = forward.distances(begins[index : index + 1], limit=self.longest - until[begin]) + until[begin]
            if not np.isfinite(onward[end]):
                continue
            back = backward.distances(ends[index : index + 1], limit=self.longest - since[end]) + since[end]
            # Reduced distances are what a whole tour costs at least; without the guide they are distances again.
            with np.errstate(invalid="ignore"):
                through = (onward - until) + (back - since)
            through[~np.isfinite(through)] = np.inf
            lengths = np.full(states, np.inf)
            np.minimum.at(lengths, self.state_of, through)
            yield np.where(lengths <= self.longest, lengths, np.inf)
