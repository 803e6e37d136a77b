"""Loops of patrols are optimal tours: beside every order of the regions tried out, on meshes and with any weights."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.errors import NoPlanError, SearchSizeError
from mission.logic.formula.parser import parse_formula
from mission.planning.objective import Objective
from mission.planning.product import Product
from mission.planning.search import search
from mission.spec.model import Semantics
from tests.support.drawn_cases import tried
from tests.support.patrols import loop_cost, optimal_tour, patrol
from tests.support.required import required


@tried(40)
@given(
    seed=st.integers(0, 2**32 - 1),
    regions=st.integers(2, 5),
    size=st.sampled_from([1, 4]),
    most=st.sampled_from([1, 9]),
)
def test_patrols_of_a_few_regions_are_optimal_tours(seed: int, regions: int, size: int, most: int) -> None:
    system = patrol(seed, 24, regions, size, most)
    formula = parse_formula(" & ".join(f"G F r{i}" for i in range(regions)))
    automaton = required(formula, system.letters)
    start = int(np.argmax(system.letter_of == 0))
    product = Product(system, automaton, start, Semantics.STANDARD)
    optimum = optimal_tour(system, start, regions)
    if not np.isfinite(optimum):
        with pytest.raises(NoPlanError):
            search(product)
        return
    runs = search(product)
    for index in {0, runs.count // 2, runs.count - 1}:
        assert loop_cost(system, runs[index]) == optimum
    # Weights draw the loop nearer, never the sum above that of the best loop.
    nearer = search(product, Objective(1, 2))
    assert nearer.cost <= runs.cost + optimum
    assert loop_cost(system, nearer[0]) >= optimum


@pytest.mark.parametrize("seed", range(3))
def test_a_patrol_of_eight_regions_is_an_optimal_tour(seed: int) -> None:
    system = patrol(seed, 100, 8, 1, 1)
    formula = parse_formula(" & ".join(f"G F r{i}" for i in range(8)))
    start = int(np.argmax(system.letter_of == 0))
    automaton = required(formula, system.letters)
    best = search(Product(system, automaton, start, Semantics.STANDARD))[0]
    assert len(best.suffix) == optimal_tour(system, start, 8)
    # One acceptance set, whose automaton waits for the regions in one order, cannot do better.
    in_turn = Product(system, automaton.in_turn(), start, Semantics.STANDARD)
    assert len(search(in_turn, closing=True)[0].suffix) >= len(best.suffix)


def test_more_acceptance_sets_than_an_exact_search_takes_are_refused() -> None:
    system = patrol(0, 60, 13, 1, 1)
    formula = parse_formula(" & ".join(f"G F r{i}" for i in range(13)))
    automaton = required(formula, system.letters)
    start = int(np.argmax(system.letter_of == 0))
    with pytest.raises(SearchSizeError, match="13"):
        search(Product(system, automaton, start, Semantics.STANDARD))
