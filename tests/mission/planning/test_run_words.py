"""Every shortest run's word satisfies its formula, by the direct evaluation of LTL; none is found where none is."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.errors import NoPlanError
from mission.geometry.regions import label_triangles
from mission.geometry.triangulation import triangulate_nodes
from mission.logic.automata.automaton import GeneralisedBuchi, MarkedEdge
from mission.logic.automata.guards import Guard
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.syntax import negation
from mission.logic.formula.word import LassoWord, satisfies
from mission.planning.product import Product
from mission.planning.run import Run
from mission.planning.search import search
from mission.planning.transition_system import TransitionSystem
from mission.spec.model import Semantics
from tests.support.domains import random_nodes
from tests.support.drawn_cases import tried
from tests.support.required import given as given_automaton
from tests.support.required import required

FORMULAS = [
    "F (a & F b) & G !c",
    "F a & F b & F c",
    "G F a & G F b",
    "G F a & G F b & G !c",
    "F G a",
    "(!a U b) & F a",
    "G (a -> F b) & F a",
    "G F a | F G b",
    "F (a & X (!a U b))",
    "G (a -> X !a) & G F a",
    "a R (b | !c)",
]


def word_of(system: TransitionSystem, run: Run, semantics: Semantics) -> LassoWord:
    labels = tuple(system.letters[int(system.letter_of[x])] for x in run.states)
    loop = labels[len(run.prefix) :]
    if semantics is Semantics.STANDARD:
        return LassoWord(labels[: len(run.prefix)], loop)
    # The first label is not read: the word begins with the triangle entered first.
    return LassoWord(labels[1 : len(run.prefix)], loop) if run.prefix else LassoWord(loop[1:], loop)


@tried(150)
@given(
    seed=st.integers(0, 2**32 - 1),
    count=st.integers(4, 14),
    formula=st.sampled_from(FORMULAS),
    negated=st.booleans(),
    semantics=st.sampled_from(list(Semantics)),
)
def test_words_of_shortest_runs_satisfy_the_formula(
    seed: int, count: int, formula: str, *, negated: bool, semantics: Semantics
) -> None:
    partition = triangulate_nodes(random_nodes(seed, count))
    rng = np.random.default_rng(seed)
    labelling = label_triangles(partition.size, {name: rng.random(partition.size) < 0.25 for name in "abc"})
    blocked = rng.random(partition.size) < 0.15
    system = TransitionSystem.from_partition(partition, labelling, blocked)
    wanted = negation(parse_formula(formula)) if negated else parse_formula(formula)
    automaton = required(wanted, system.letters)
    start = int(np.argmin(blocked))
    try:
        runs = search(Product(system, automaton, start, semantics))
    except NoPlanError:
        return
    for index in {0, runs.count // 3, runs.count // 2, runs.count - 1}:
        run = runs[index]
        assert run.cost == runs.cost
        assert run.states[0] == start
        assert not blocked[list(run.states[1:])].any()
        assert satisfies(word_of(system, run, semantics), wanted)


@pytest.mark.parametrize("side", [3, 40])
def test_a_guessing_automaton_has_the_runs_of_the_one_that_does_not_guess(side: int) -> None:
    """F a, once deterministic and once by guessing when a comes: as many runs, and the same ones, in one order."""
    places = np.arange(side * side)
    grid = places.reshape(side, side)
    successors = np.full((side * side, 4), -1)
    successors[:, 0] = places
    successors[grid[:, :-1].ravel(), 1], successors[grid[:-1].ravel(), 2] = grid[:, 1:].ravel(), grid[1:].ravel()
    letter_of = (places == places[-1]).astype(np.int64)
    letters = (frozenset[str](), frozenset({"a"}))
    system = TransitionSystem(successors, letter_of, letters)
    a, other, anything = (Guard(("a",), (cube,)) for cube in ((1, 0), (0, 1), (0, 0)))
    # 0 and 1 both read anything on the way, and either may be the one that sees a: two ways for each sequence.
    moves = [(0, other, 0), (0, other, 1), (0, a, 2), (1, other, 0), (1, other, 1), (1, a, 2)]
    edges = (*(MarkedEdge(*move, ()) for move in moves), MarkedEdge(2, anything, 2, (0,)))
    guessing = GeneralisedBuchi(("a",), 3, (0, 1), 1, edges)
    plain = search(Product(system, required("F a", letters), 0, Semantics.STANDARD))
    guessed = search(Product(system, given_automaton(guessing, letters), 0, Semantics.STANDARD))
    assert (guessed.cost, guessed.count) == (plain.cost, plain.count)
    for index in (0, 1, plain.count // 2, plain.count - 1):
        assert guessed[index] == plain[index]
