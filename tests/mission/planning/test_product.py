"""P of Eq. 25 against its definition, written out with sets."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.logic.automata.conjunction import Conjunction
from mission.logic.automata.rabin import DEAD, Rabin
from mission.planning.product import Product
from mission.planning.transition_system import TransitionSystem
from mission.spec.model import Semantics
from tests.support.drawn_cases import tried
from tests.support.products import random_rabin, random_system

State = tuple[int, int]


def alone(automaton: Rabin) -> Conjunction:
    """As it is, states that accept nothing included."""
    return Conjunction((automaton,), automaton, np.arange(automaton.size)[:, None])


def by_definition(system: TransitionSystem, automaton: Rabin) -> dict[tuple[State, int], set[State]]:
    """delta_P((x, q), u) = {(x', q') : x' = delta(x, u), q' in R(q, o(x'))}."""
    relation = {(q, letter, int(after)) for (q, letter), after in np.ndenumerate(automaton.targets)}
    found: dict[tuple[State, int], set[State]] = {}
    for x in range(system.size):
        for u in range(4):
            y = int(system.successors[x, u])
            for q in range(automaton.size):
                letter = int(system.letter_of[y])
                found[(x, q), u] = {
                    (y, after) for after in range(automaton.size) if y >= 0 and (q, letter, after) in relation
                }
    return found


def distances(delta: dict[tuple[State, int], set[State]], sources: set[State]) -> dict[State, int]:
    reached, frontier, level = dict.fromkeys(sources, 0), sources, 0
    while frontier:
        level += 1
        frontier = set().union(*(delta[state, u] for state in frontier for u in range(4))) - reached.keys()
        reached |= dict.fromkeys(frontier, level)
    return reached


@tried(120)
@given(
    seed=st.integers(0, 2**32 - 1),
    triangles=st.integers(1, 8),
    states=st.integers(1, 4),
    density=st.sampled_from([0.0, 0.15, 0.4]),
    semantics=st.sampled_from(list(Semantics)),
)
def test_transitions_distances_and_ways_are_those_of_the_definition(
    seed: int, triangles: int, states: int, density: float, semantics: Semantics
) -> None:
    rng = np.random.default_rng(seed)
    system = random_system(rng, triangles, 2)
    automaton = random_rabin(rng, 2, states, density)
    product = Product(system, alone(automaton), 0, semantics)

    def pair(code: int) -> State:
        x, q = product.parts(np.array([code], dtype=np.int32))
        return int(x[0]), int(q[0])

    delta = by_definition(system, automaton)
    everything = np.arange(product.full_size, dtype=np.int32)
    steps = product.out(everything)
    listed = [
        (pair(row), u, pair(after))
        for row, u, after in zip(steps.rows.tolist(), steps.controls.tolist(), steps.states.tolist(), strict=True)
    ]
    assert sorted(listed) == sorted((s, u, after) for (s, u), entered in delta.items() for after in entered)
    initial = {(0, automaton.initial)}
    if semantics is Semantics.STANDARD:  # A reads o(x_0) first: as if u_0 led to the start
        initial = set().union(*(delta[state, 0] for state in initial))
    assert {pair(c) for c in product.initial.tolist()} == initial
    expected = distances(delta, initial)
    assert {pair(c): d for c, d in enumerate(product.distances.tolist()) if d < np.inf} == expected
    assert product.reachable_size == len(expected)
    graph = product.graph
    edges = {(pair(a), pair(b)) for a, b in zip(graph.sources.tolist(), graph.targets.tolist(), strict=True)}
    assert edges == {(s, after) for (s, _), entered in delta.items() for after in entered if after != s}


@pytest.mark.parametrize("semantics", list(Semantics))
def test_a_start_that_the_automaton_rejects_has_no_initial_state(semantics: Semantics) -> None:
    rng = np.random.default_rng(0)
    system = random_system(rng, 3, 2)
    stuck = Rabin(np.full((1, 2), DEAD), np.zeros((1, 2), dtype=np.int64), ((0, 1),))
    product = Product(system, alone(stuck), 0, semantics)
    assert len(product.initial) == (0 if semantics is Semantics.STANDARD else 1)
    assert product.reachable_size == len(product.initial)
