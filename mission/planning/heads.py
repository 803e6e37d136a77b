"""Where the loops of best lassos begin: the heads.

A head is a state (x, q) of P: the flight comes to the triangle x having read what makes q, and goes round a loop from x
for ever. Loops that bring A back to q as well are tours of the components of P (``tours``). Any loop comes to that
after a few rounds, if A does not count rounds; so the cheapest tours through the states of a triangle say what a loop
from there costs at least. The heads for which that may suffice are looked at one by one, cheapest first, with all loops
that their triangles have (``loops``).
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from mission.errors import SearchSizeError
from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.planning.chains import Ways
from mission.planning.loops import Loops
from mission.planning.objective import Objective, Rank
from mission.planning.product import Product
from mission.planning.recurrence import accepting_components, has_runs
from mission.planning.rounds import Rounds
from mission.planning.sweeps import Graph
from mission.planning.tours import tours
from mission.planning.transition_system import TransitionSystem

_NO_RANK: Rank = (np.inf, np.inf)
_MOST_LOOKS = 50_000_000  # triangles times the loops' vertices that are looked at where nothing bounds loops


@dataclass(frozen=True, eq=False)
class Head:
    """A product state at which a best lasso enters its loop.

    Attributes:
        state: The product state.
        triangle: Its triangle.
        distance: Cost of the cheapest way to it.
        loop: Cost of the loop.
        loops: What the loop is among; None for a stay.
        actions: What rounds of such loops do.
    """

    state: int
    triangle: int
    distance: float
    loop: float
    loops: Loops | None = None
    actions: IntArray | None = None

    def ways(self) -> Ways:
        """The best loops, as ways from the head to itself."""
        if self.loops is not None and self.actions is not None:
            return self.loops.ways(self.triangle, self.actions, self.loop)
        one = np.ones(1, dtype=np.int64)
        return Ways(np.repeat(self.triangle, 2), np.arange(2), np.array([0.0, self.loop]), 0 * one, 0 * one, one, one)


def best_heads(product: Product, objective: Objective, *, closing: bool = False) -> list[Head]:
    """All heads of the least rank, by state; none where no run is accepted.

    A stay is a loop of one transition, the cheapest there can be; every other loop takes two transitions at least, so
    it is looked for only where it could be as good.

    Args:
        product: P.
        objective: What is best.
        closing: Whether only such loops count that bring A back to where it was after one round.

    Raises:
        SearchSizeError: If the best loop is beyond an exact search.
    """
    system = product.system
    distances = product.distances.reshape(product.automaton.size, system.size)
    stays = product.automaton.repeated[:, system.letter_of] & (system.successors[:, 0] == np.arange(system.size))
    loops = np.where(stays, system.weights[:, 0], np.inf)
    rank = _least(*objective.ranks(distances, loops))
    of_two = 2.0 * float(system.weights.min())
    if objective.rank(0.0, of_two) <= rank and has_runs(product):
        escape = np.zeros(1) if closing else _before_escape(product)
        for tour, reached, chosen in _bounds(product, objective, rank, closing=closing):
            longer = np.maximum(tour, escape)
            if not _not_worse(*objective.ranks(distances, longer), reached).any():
                if reached == rank:
                    break
                continue
            bounds = objective.ranks(distances, np.minimum(loops, longer))
            found = _Search(product, objective, tour.min(axis=0), bounds, closing=closing).heads(reached, chosen)
            if found:
                return found
    first, second = objective.ranks(distances, loops)
    return [
        Head(state, state % system.size, float(product.distances[state]), float(loops.flat[state]))
        for state in np.flatnonzero(_not_worse(first, second, rank)).tolist()
    ]


def _bounds(
    product: Product, objective: Objective, rank: Rank, *, closing: bool
) -> Iterator[tuple[FloatArray, Rank, set[int]]]:
    """Ever better bounds of the costs of loops, by more and more parts of A, beginning with those of one state.

    Yields:
        Costs of loops at least, (Q, M) for each state or (1, M) for each triangle, the rank of lassos to look for, and
        the parts that made the bounds, to which those that refuse loops are to be added.
    """
    automaton = product.automaton
    every = set(range(len(automaton.parts)))
    if closing:
        yield *_tours(product, product.distances, objective, rank), every
        return
    free = every - automaton.counting
    chosen = {number for number in free if automaton.parts[number].size == 1}
    passing = {number for number in free if not np.any(automaton.parts[number].recurrent, axis=0).all()}
    while True:
        tour, reached = _tours_of_parts(product, sorted(chosen), objective, rank)
        tried = len(chosen)
        yield tour.min(axis=0, keepdims=True), reached, chosen
        if tried == len(free):
            break
        chosen &= free
        for more in (passing, free):
            if len(chosen) == tried:
                chosen |= more
    # Several rounds of a loop may be one tour: nothing is known of what one costs.
    triangles = np.isfinite(product.nearest)
    if int(triangles.sum()) * product.reachable_size > _MOST_LOOKS:
        raise SearchSizeError(
            "the mission's automaton counts the rounds of loops, and the map is too large to look at all of them: give "
            "a formula, or an automaton that does not"
        )
    bound = np.where(triangles, 2.0 * float(product.system.weights.min()), np.inf)[None]
    yield bound, _tours(product, product.distances, objective, rank)[1], every


def _tours_of_parts(product: Product, chosen: list[int], objective: Objective, rank: Rank) -> tuple[FloatArray, Rank]:
    """What tours cost at least, by some parts of A and by what the others must read, if the latter is not too much."""
    part, distances = product.projected(chosen, implied=True)
    try:
        return _tours(part, distances, objective, rank, nearest=product.nearest)
    except SearchSizeError:
        part, distances = product.projected(chosen, implied=False)
        return _tours(part, distances, objective, rank, nearest=product.nearest)


class _Search:
    """Looks at heads, each of which has a rank of ``bounds`` (two of (Q, M)) at least."""

    def __init__(
        self,
        product: Product,
        objective: Objective,
        tour: FloatArray,
        bounds: tuple[FloatArray, FloatArray],
        *,
        closing: bool,
    ) -> None:
        self._product, self._objective, self._closing = product, objective, closing
        self._tour = tour
        self._bounds = bounds[0].ravel(), bounds[1].ravel()
        self._costs: dict[tuple[int, int], FloatArray] = {}

    def heads(self, rank: Rank, chosen: set[int]) -> list[Head]:
        """All heads of the least rank, by state; none where it is worse than ``rank``.

        Where there are none, parts of A that refuse a cheapest loop among those that the ``chosen`` parts accept are
        added to these.
        """
        first, second = self._bounds
        candidates = np.flatnonzero(_not_worse(first, second, rank))
        candidates = candidates[np.lexsort((second[candidates], first[candidates]))]
        triangles, states = self._product.parts(candidates)
        distances = self._product.distances[candidates]
        limits = np.array([self._objective.longest_suffix(rank, distance) for distance in distances.tolist()])
        kept = (self._tour <= limits.max()) & _within(self._product.system, triangles, limits)
        kept[triangles] = True
        among = {} if self._closing else dict.fromkeys(states.tolist(), Loops(self._product, kept, np.unique(states)))
        found: list[Head] = []
        refused: tuple[Rank, set[int]] = _NO_RANK, set()
        for state, x, q, distance in zip(
            candidates.tolist(), triangles.tolist(), states.tolist(), distances.tolist(), strict=True
        ):
            if (first[state], second[state]) > rank:
                break
            if q not in among:
                among[q] = Loops(self._product, kept, np.array([q]), closing=True)
            rounds = among[q].rounds
            accepted = rounds.accepted(q)
            if not accepted.any() and found:
                continue
            costs = self._costs_of(among[q], x, q)
            cost = float(costs[accepted].min(initial=np.inf))
            reached = self._objective.rank(distance, cost)
            if reached < rank:
                found, rank = [], reached
            if reached == rank and cost < np.inf:
                found.append(Head(state, x, distance, cost, among[q], np.flatnonzero(accepted & (costs == cost))))
            elif not found:
                refused = min(refused, self._refusing(rounds, q, distance, costs, chosen), key=lambda one: one[0])
        if not found:
            chosen |= refused[1]
        return sorted(found, key=lambda head: head.state)

    def _costs_of(self, loops: Loops, x: int, q: int) -> FloatArray:
        key = x, q if self._closing else 0
        if key not in self._costs:
            self._costs[key] = loops.costs(x)
        return self._costs[key]

    def _refusing(
        self, rounds: Rounds, q: int, distance: float, costs: FloatArray, chosen: set[int]
    ) -> tuple[Rank, set[int]]:
        """The rank of a cheapest loop that the ``chosen`` parts accept, and the parts that do not."""
        good = np.isfinite(costs)
        for number in chosen:
            good &= rounds.accepted_by(number, q)
        if not good.any():
            return _NO_RANK, set()
        action = int(np.flatnonzero(good)[np.argmin(costs[good])])
        others = set(range(len(self._product.automaton.parts))) - chosen
        refusing = {number for number in others if not rounds.accepted_by(number, q)[action]}
        return self._objective.rank(distance, float(costs[action])), refusing


def _tours(
    product: Product, distances: FloatArray, objective: Objective, rank: Rank, nearest: FloatArray | None = None
) -> tuple[FloatArray, Rank]:
    """What tours that are no stays cost, (Q, M) through each state, where that may do; and the least rank of lassos.

    Args:
        product: P.
        distances: (M * Q,) cost of the cheapest way to each of its states.
        objective: What is best.
        rank: Of lassos that are known.
        nearest: (M,) cost of the cheapest way to each triangle.
    """
    tour = np.full(product.full_size, np.inf)
    to_triangles = product.nearest if nearest is None else nearest
    of_two = 2.0 * float(product.system.weights.min())
    for pair in range(len(product.automaton.whole.pairs)):
        for component in accepting_components(product, pair, distances):
            near = float(to_triangles[product.parts(component.states)[0]].min())
            lengths, rank = tours(component, distances[component.states], near, objective, rank, floor=of_two)
            tour[component.states] = np.minimum(tour[component.states], lengths)
    return tour.reshape(product.automaton.size, -1), rank


def _before_escape(product: Product) -> FloatArray:
    """(Q, M) what a loop costs at least because it must lead parts of A on from states in which they cannot remain."""
    automaton = product.automaton
    costs = np.zeros((automaton.size, product.system.size))
    for number, part in enumerate(automaton.parts):
        if not np.any(part.recurrent, axis=0).all():
            one, states = automaton.of_parts([number])
            np.maximum(costs, _escape(product.along(one))[states], out=costs)
    return costs


def _escape(product: Product) -> FloatArray:
    """The same of one part: the loop leaves the state somewhere, and goes back from there to where it began."""
    automaton, system, graph = product.automaton, product.system, product.graph
    weights = np.broadcast_to(np.asarray(graph.weights, dtype=np.float64), len(graph.targets))
    leaves = graph.sources // system.size != graph.targets // system.size
    sources, targets = graph.sources[~leaves], graph.targets[~leaves]
    backward = Graph.from_edges(graph.size, targets, sources, weights[~leaves])
    root = np.array([graph.size])
    onward = backward.with_root(graph.sources[leaves], weights[leaves]).distances(root)[:-1]
    # Back through T alone, in a copy of it for each state of A.
    x, u = np.nonzero(system.successors >= 0)
    copies = system.size * np.arange(automaton.size)[:, None]
    every = np.tile(system.weights[x, u].astype(np.float64), automaton.size)
    free = Graph.from_edges(graph.size, (copies + x).ravel(), (copies + system.successors[x, u]).ravel(), every)
    left = graph.sources[leaves] // system.size * system.size + graph.targets[leaves] % system.size
    costs: FloatArray = (onward + free.distances(np.unique(left))).reshape(automaton.size, -1)
    costs[np.any(automaton.whole.recurrent, axis=0)] = 0.0
    return costs


def _within(system: TransitionSystem, triangles: IntArray, limits: FloatArray) -> BoolArray:
    """(M,) whether a triangle can be visited from one of ``triangles`` and back at no more than its limit."""
    x, u = np.nonzero(system.successors >= 0)
    graph = Graph.from_edges(system.size, x, system.successors[x, u], system.weights[x, u].astype(np.float64))
    most, root = float(limits.max()), np.array([system.size])
    # Half of what a triangle lacks to the largest limit is added to the way out, half to the way back; and 1 to either.
    lacks = 1.0 + (most - limits) / 2.0
    both = sum(way.with_root(triangles, lacks).distances(root)[:-1] for way in (graph, graph.reversed))
    return np.asarray(both <= most + 2.0)


def _least(first: FloatArray, second: FloatArray) -> Rank:
    """The least of many ranks."""
    least = float(first.min(initial=np.inf))
    return (least, float(second[first == least].min())) if np.isfinite(least) else _NO_RANK


def _not_worse(first: FloatArray, second: FloatArray, rank: Rank) -> BoolArray:
    found: BoolArray = np.isfinite(first) & ((first < rank[0]) | ((first == rank[0]) & (second <= rank[1])))
    return found & np.isfinite(second)
