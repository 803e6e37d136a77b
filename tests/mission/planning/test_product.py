"""P of Eq. 25 against its definition, written out with sets."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mission.logic.automata.automaton import CompiledAutomaton, CompiledGeneralised
from mission.planning.product import Product
from mission.planning.transition_system import TransitionSystem
from mission.spec.model import Semantics
from tests.support.products import Shape, random_automaton, random_system

State = tuple[int, int]


def by_definition(system: TransitionSystem, automaton: CompiledGeneralised) -> dict[tuple[State, int], set[State]]:
    """delta_P((x, q), u) = {(x', q') : x' = delta(x, u), q' in R(q, o(x'))}."""
    rows = zip(automaton.sources.tolist(), automaton.letters.tolist(), automaton.targets.tolist(), strict=True)
    relation = set(rows)
    found: dict[tuple[State, int], set[State]] = {}
    for x in range(system.size):
        for u in range(4):
            y = int(system.successors[x, u])
            for q in range(automaton.states):
                letter = int(system.letter_of[y])
                found[(x, q), u] = {
                    (y, after) for after in range(automaton.states) if y >= 0 and (q, letter, after) in relation
                }
    return found


def distances(delta: dict[tuple[State, int], set[State]], sources: set[State]) -> dict[State, int]:
    reached, frontier, level = dict.fromkeys(sources, 0), sources, 0
    while frontier:
        level += 1
        frontier = set().union(*(delta[state, u] for state in frontier for u in range(4))) - reached.keys()
        reached |= dict.fromkeys(frontier, level)
    return reached


@settings(max_examples=120, deadline=None)
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
    automaton = random_automaton(rng, 2, Shape(states, 1, density))
    product = Product(system, automaton, 0, semantics)

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
    initial = {(0, q) for q in automaton.initial.tolist()}
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
    none = np.zeros(0, dtype=np.int64)
    stuck = CompiledAutomaton(1, none, none, none, np.array([0]), np.array([True]))
    product = Product(system, stuck, 0, semantics)
    assert len(product.initial) == (0 if semantics is Semantics.STANDARD else 1)
    assert product.reachable_size == len(product.initial)
