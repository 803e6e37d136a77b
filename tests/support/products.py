"""Random transition systems and automata, and all shortest lassos of their product by brute force."""

from itertools import product as tuples

import numpy as np

from mission.logic.automaton import CompiledAutomaton
from mission.planning.transition_system import TransitionSystem

Lasso = tuple[tuple[int, ...], tuple[int, ...]]


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


def random_automaton(rng: np.random.Generator, states: int, letters: int, density: float) -> CompiledAutomaton:
    """Any automaton, deterministic or not."""
    rows = np.array([row for row in tuples(range(states), range(letters), range(states)) if rng.random() < density])
    rows = rows.astype(np.int64).reshape(-1, 3)
    initial = np.flatnonzero(rng.random(states) < 0.5)
    return CompiledAutomaton(
        states=states,
        sources=rows[:, 0],
        letters=rows[:, 1],
        targets=rows[:, 2],
        initial=initial if len(initial) else np.array([0]),
        accepting=rng.random(states) < 0.4,
    )


def brute_force(
    system: TransitionSystem, automaton: CompiledAutomaton, start: int, *, reads_start: bool, most: int
) -> tuple[int, set[Lasso]] | None:
    """Cost and set of the shortest lassos, by listing walks of T of growing length and following A along each."""
    table: dict[tuple[int, int], set[int]] = {}
    for q, letter, target in zip(
        automaton.sources.tolist(), automaton.letters.tolist(), automaton.targets.tolist(), strict=True
    ):
        table.setdefault((q, letter), set()).add(target)

    def read(states: set[int], triangle: int) -> set[int]:
        letter = int(system.letter_of[triangle])
        return set().union(*(table.get((q, letter), set()) for q in states))

    def follow(states: set[int], triangles: tuple[int, ...]) -> set[int]:
        for triangle in triangles:
            states = read(states, triangle)
        return states

    first = set(automaton.initial.tolist())
    first = read(first, start) if reads_start else first

    def accepted(walk: tuple[int, ...], split: int) -> bool:
        heads = follow(first, walk[1 : split + 1])
        return any(automaton.accepting[q] and q in follow({q}, walk[split + 1 :]) for q in heads)

    walks: list[tuple[int, ...]] = [(start,)]
    for cost in range(1, most + 1):
        walks = [(*walk, int(y)) for walk in walks for y in set(system.successors[walk[-1]].tolist()) - {-1}]
        lassos = [(walk, split) for walk in walks for split in range(cost) if walk[split] == walk[-1]]
        found = {(walk[:split], walk[split:-1]) for walk, split in lassos if accepted(walk, split)}
        if found:
            return cost, found
    return None
