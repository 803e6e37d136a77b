"""All lassos over the triangles of small maps, judged by the definition of LTL: what searches are compared with."""

from collections.abc import Callable, Iterator
from functools import cache
from random import Random

import numpy as np

from mission.logic.formula.word import LassoWord, Letter
from mission.planning.objective import Objective, Rank
from mission.planning.run import Run
from mission.planning.transition_system import TransitionSystem
from mission.spec.model import Semantics

Lasso = tuple[tuple[int, ...], tuple[int, ...]]

NAMES = ("a", "b", "c")
_KINDS = (
    "G F {0}",
    "F G {0}",
    "F {0}",
    "G {0}",
    "G !{0}",
    "F G !{0}",
    "G F ({0} | {1})",
    "{0} U {1}",
    "!{0} U {1}",
    "G ({0} -> F {1})",
    "F ({0} & F {1})",
    "G F {0} | F G {1}",
    "G F {0} -> G F {1}",
    "F ({0} & G F {1})",
    "G ({0} -> X !{0})",
    "F {0} | G F {1}",
    "F (G {0} | G {1})",
)


def random_mission(random: Random) -> str:
    """A conjunction of one to four of what missions are made of."""
    return " & ".join(
        f"({random.choice(_KINDS).format(*random.sample(NAMES, 2))})" for _ in range(random.randrange(1, 5))
    )


def random_map(rng: np.random.Generator, triangles: int, most: int) -> TransitionSystem:
    """A strip of triangles with some doors between others, any labels, and weights up to ``most``."""
    successors = np.full((triangles, 4), -1)
    successors[:, 0] = np.arange(triangles)
    pairs = [(i, i + 1) for i in range(triangles - 1)]
    pairs += [(i, j) for i in range(triangles) for j in range(i + 2, triangles) if rng.random() < 0.2]
    for i, j in pairs:
        free = [np.flatnonzero(successors[x] < 0) for x in (i, j)]
        if all(map(len, free)):
            successors[i, free[0][0]], successors[j, free[1][0]] = j, i
    letters: list[Letter] = [frozenset(name for name in NAMES if rng.random() < 0.35) for _ in range(triangles)]
    distinct = tuple(dict.fromkeys(letters))
    letter_of = np.array([distinct.index(letter) for letter in letters])
    weights = rng.integers(1, most + 1, size=successors.shape)
    weights[:, 0] = weights.min()
    return TransitionSystem(successors, letter_of, distinct, weights)


def word_of(system: TransitionSystem, lasso: Lasso, semantics: Semantics) -> LassoWord:
    """What a lasso spells; in the paper's semantics the first label is not read."""
    labels = [system.letters[int(system.letter_of[x])] for x in (*lasso[0], *lasso[1])]
    prefix, loop = tuple(labels[: len(lasso[0])]), tuple(labels[len(lasso[0]) :])
    if semantics is Semantics.STANDARD:
        return LassoWord(prefix, loop)
    return LassoWord(prefix[1:], loop) if prefix else LassoWord(loop[1:], loop)


def lassos(
    system: TransitionSystem, start: int, accepts: Callable[[LassoWord], bool], semantics: Semantics, most: int
) -> Iterator[tuple[Lasso, int, int]]:
    """Every lasso of up to ``most`` transitions whose word is accepted, with the costs of its prefix and its suffix."""
    known = cache(accepts)
    walks: list[tuple[tuple[int, ...], tuple[int, ...]]] = [((start,), (0,))]
    for _ in range(most):
        walks = [
            ((*walk, y), (*costs, costs[-1] + int(system.weights[walk[-1], u])))
            for walk, costs in walks
            for u, y in enumerate(system.successors[walk[-1]].tolist())
            if y >= 0
        ]
        for walk, costs in walks:
            for split in range(len(walk) - 1):
                if walk[split] == walk[-1]:
                    lasso = walk[:split], walk[split:-1]
                    if known(word_of(system, lasso, semantics)):
                        yield lasso, costs[split], costs[-1] - costs[split]


def lasso_of(run: Run) -> Lasso:
    """The triangles of a run."""
    return run.prefix, run.suffix


def rank_of(system: TransitionSystem, run: Run, objective: Objective) -> Rank:
    """By what its prefix and its suffix cost."""
    costs, head = system.weights[list(run.states), list(run.controls)], len(run.prefix)
    return objective.rank(float(costs[:head].sum()), float(costs[head:].sum()))
