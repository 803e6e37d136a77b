"""Random transition systems and automata, and all best lassos of their product by brute force."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from heapq import heappop, heappush
from itertools import product as tuples

import numpy as np

from mission.logic.automata.automaton import CompiledGeneralised
from mission.planning.objective import Objective
from mission.planning.transition_system import TransitionSystem

Lasso = tuple[tuple[int, ...], tuple[int, ...]]
State = tuple[int, int]
Lifted = tuple[int, int, int]


def random_system(rng: np.random.Generator, triangles: int, letters: int) -> TransitionSystem:
    """A symmetric graph of degree at most three, as a partition would give."""
    successors = np.full((triangles, 4), -1)
    successors[:, 0] = np.arange(triangles)
    pairs = [(i, j) for i in range(triangles) for j in range(i)]
    for i, j in rng.permutation(pairs).tolist() if pairs else []:
        free_i, free_j = np.flatnonzero(successors[i] < 0), np.flatnonzero(successors[j] < 0)
        if len(free_i) and len(free_j) and rng.random() < 0.7:
            successors[i, rng.choice(free_i)] = j
            successors[j, rng.choice(free_j)] = i
    names = tuple(frozenset({f"p{i}"}) for i in range(letters))
    return TransitionSystem(successors, rng.integers(letters, size=triangles), names)


def weighted(rng: np.random.Generator, system: TransitionSystem, most: int) -> TransitionSystem:
    """The same with weights between 1 and ``most``."""
    return replace(system, weights=rng.integers(1, most + 1, size=system.successors.shape))


@dataclass(frozen=True)
class Shape:
    """Size of a random automaton: states, acceptance sets, and the share of the possible transitions that it has."""

    states: int
    sets: int = 1
    density: float = 0.3


def random_automaton(rng: np.random.Generator, letters: int, shape: Shape) -> CompiledGeneralised:
    """Any automaton, deterministic or not, with marks on its transitions."""
    states, sets, density = shape.states, shape.sets, shape.density
    rows = np.array([row for row in tuples(range(states), range(letters), range(states)) if rng.random() < density])
    rows = rows.astype(np.int64).reshape(-1, 3)
    initial = np.flatnonzero(rng.random(states) < 0.5)
    return CompiledGeneralised(
        states=states,
        sets=sets,
        sources=rows[:, 0],
        letters=rows[:, 1],
        targets=rows[:, 2],
        marks=rng.random((len(rows), sets)) < 0.4,
        initial=initial if len(initial) else np.array([0]),
    )


class Definition:
    """P by its definition, with dictionaries.

    Attributes:
        first: The product states before the first transition.
        every: The set of all marks, as bits.
    """

    def __init__(
        self, system: TransitionSystem, automaton: CompiledGeneralised, start: int, *, reads_start: bool
    ) -> None:
        self._system = system
        self._table: dict[tuple[int, int], list[tuple[int, int]]] = {}
        rows = zip(
            automaton.sources.tolist(),
            automaton.letters.tolist(),
            automaton.targets.tolist(),
            automaton.marks.tolist(),
            strict=True,
        )
        for q, letter, target, flags in rows:
            marks = sum(1 << bit for bit, flag in enumerate(flags) if flag) if automaton.sets else 1
            self._table.setdefault((q, letter), []).append((target, marks))
        self.every = (1 << max(1, automaton.sets)) - 1
        initial = set(automaton.initial.tolist())
        if reads_start:
            initial = {after for q in initial for after, _ in self._read(q, start)}
        self.first = {(start, q) for q in initial}

    def _read(self, q: int, triangle: int) -> list[tuple[int, int]]:
        return self._table.get((q, int(self._system.letter_of[triangle])), [])

    def steps(self, state: Lifted) -> Iterator[tuple[Lifted, int]]:
        """What follows a state with the marks that it has borne, and the cost of the transition."""
        x, q, borne = state
        for u, y in enumerate(self._system.successors[x].tolist()):
            if y >= 0:
                for after, marks in self._read(q, y):
                    yield (y, after, borne | marks), int(self._system.weights[x, u])

    def distances(self, sources: set[Lifted], *, bears: bool) -> dict[Lifted, int]:
        """Cheapest ways by Dijkstra's algorithm; without ``bears`` marks are forgotten."""
        found: dict[Lifted, int] = {}
        queue = [(0, state) for state in sources]
        while queue:
            distance, state = heappop(queue)
            if state not in found:
                found[state] = distance
                for (y, q, borne), weight in self.steps(state):
                    heappush(queue, (distance + weight, (y, q, borne if bears else 0)))
        return found

    def walks(self, sources: set[Lifted], goal: Lifted, cost: int, *, bears: bool) -> set[tuple[int, ...]]:
        """The triangles of all walks of one cost from any of ``sources`` to ``goal``, both included."""
        back: dict[Lifted, set[tuple[Lifted, int]]] = {}
        reached = self.distances(sources, bears=bears)
        for state in reached:
            for (y, q, borne), weight in self.steps(state):
                back.setdefault((y, q, borne if bears else 0), set()).add((state, weight))
        walks: set[tuple[int, ...]] = set()
        stack: list[tuple[Lifted, int, tuple[int, ...]]] = [(goal, cost, (goal[0],))]
        while stack:
            state, left, tail = stack.pop()
            if left == 0 and state in sources:
                walks.add(tail)
            stack.extend(
                (before, left - weight, (before[0], *tail))
                for before, weight in back.get(state, ())
                if reached[before] <= left - weight
            )
        return walks


def best_lassos(
    system: TransitionSystem,
    automaton: CompiledGeneralised,
    start: int,
    objective: Objective,
    *,
    reads_start: bool,
) -> tuple[int, set[Lasso]] | None:
    """Cost and set of the best lassos: for every head the cheapest way to it, and round the cheapest loop."""
    product = Definition(system, automaton, start, reads_start=reads_start)
    first = {(x, q, 0) for x, q in product.first}
    heads = []
    for (x, q, _), prefix in product.distances(first, bears=False).items():
        loop = product.distances({(x, q, 0)}, bears=True).get((x, q, product.every))
        if loop is not None:
            heads.append((objective.rank(prefix, loop), (x, q), prefix, loop))
    if not heads:
        return None
    best = min(heads)[0]
    lassos: set[Lasso] = set()
    for rank, (x, q), prefix, loop in heads:
        if rank == best:
            ways = product.walks(first, (x, q, 0), prefix, bears=False)
            rounds = product.walks({(x, q, 0)}, (x, q, product.every), loop, bears=True)
            lassos |= {(way[:-1], round_[:-1]) for way in ways for round_ in rounds}
    _, _, prefix, loop = min(heads)
    return round(objective.cost(prefix, loop)), lassos


def listed_lassos(
    system: TransitionSystem, automaton: CompiledGeneralised, start: int, *, reads_start: bool, most: int
) -> tuple[int, set[Lasso]] | None:
    """Number of transitions and set of the shortest lassos, by listing walks of T and following A along each."""
    product = Definition(system, automaton, start, reads_start=reads_start)

    def follow(states: set[Lifted], triangles: tuple[int, ...]) -> set[Lifted]:
        for triangle in triangles:
            states = {after for state in states for after, _ in product.steps(state) if after[0] == triangle}
        return states

    def accepted(walk: tuple[int, ...], split: int) -> bool:
        heads = follow({(x, q, 0) for x, q in product.first}, walk[1 : split + 1])
        return any((x, q, product.every) in follow({(x, q, 0)}, walk[split + 1 :]) for x, q, _ in heads)

    walks: list[tuple[int, ...]] = [(start,)]
    for cost in range(1, most + 1):
        walks = [(*walk, int(y)) for walk in walks for y in set(system.successors[walk[-1]].tolist()) - {-1}]
        lassos = [(walk, split) for walk in walks for split in range(cost) if walk[split] == walk[-1]]
        found = {(walk[:split], walk[split:-1]) for walk, split in lassos if accepted(walk, split)}
        if found:
            return cost, found
    return None
