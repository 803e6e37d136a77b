"""Random transition systems and deterministic automata."""

from dataclasses import replace

import numpy as np

from mission.logic.automata.rabin import DEAD, Rabin
from mission.planning.transition_system import TransitionSystem


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


def random_rabin(rng: np.random.Generator, letters: int, states: int, density: float) -> Rabin:
    """A deterministic automaton with one acceptance set; some transitions are missing."""
    targets = np.where(rng.random((states, letters)) < density, rng.integers(states, size=(states, letters)), DEAD)
    return Rabin(targets, rng.integers(2, size=targets.shape), ((0, 1),))
