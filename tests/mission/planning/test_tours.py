"""Loops of patrols are optimal tours: beside every order of the regions tried out, on meshes and with any weights."""

from itertools import permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mission.errors import NoPlanError, SearchSizeError
from mission.geometry.arrays import FloatArray
from mission.geometry.regions import label_triangles
from mission.geometry.triangulation import triangulate_nodes
from mission.logic.automaton import compile_generalised, compile_to_alphabet
from mission.logic.parser import parse_formula
from mission.logic.translate import translate, translate_generalised
from mission.planning.objective import Objective
from mission.planning.product import Product
from mission.planning.run import Run
from mission.planning.search import search
from mission.planning.transition_system import TransitionSystem
from mission.spec.model import Semantics
from tests.support.domains import random_nodes
from tests.support.products import weighted


def patrol(seed: int, nodes: int, regions: int, size: int, most: int) -> TransitionSystem:
    """A mesh with some regions of up to ``size`` triangles each, and a twentieth of the others closed."""
    partition, rng = triangulate_nodes(random_nodes(seed, nodes)), np.random.default_rng(seed)
    free = rng.permutation(partition.size)
    members = {}
    for i in range(regions):
        centre = partition.corners_m[free[0]].mean(axis=0)
        near = np.argsort(np.linalg.norm(partition.corners_m.mean(axis=1)[free] - centre, axis=1), kind="stable")
        chosen = free[near[: int(rng.integers(1, size + 1))]]
        members[f"r{i}"] = np.isin(np.arange(partition.size), chosen)
        free = free[~np.isin(free, chosen)]
    blocked = np.isin(np.arange(partition.size), free[1 : 1 + partition.size // 20])
    labelling = label_triangles(partition.size, members)
    return weighted(rng, TransitionSystem.from_partition(partition, labelling, blocked), most)


def all_pairs(system: TransitionSystem) -> FloatArray:
    """Cheapest ways between all triangles, (M, M), by Floyd and Warshall."""
    ways = np.full((system.size, system.size), np.inf)
    np.fill_diagonal(ways, 0.0)
    rows, controls = np.nonzero(system.successors[:, 1:] >= 0)
    ways[rows, system.successors[rows, controls + 1]] = system.weights[rows, controls + 1]
    for middle in range(system.size):
        ways = np.minimum(ways, ways[:, middle, None] + ways[None, middle])
    return ways


def optimal_tour(system: TransitionSystem, start: int, regions: int) -> float:
    """The cheapest tour of all regions among the triangles that can be reached, in whatever order."""
    ways = all_pairs(system)
    reached = np.isfinite(ways[start])
    inside = [
        np.flatnonzero(np.array([f"r{i}" in letter for letter in system.letters])[system.letter_of] & reached)
        for i in range(regions)
    ]
    best = np.inf
    for order in permutations(range(1, regions)):
        for begin in inside[0].tolist():
            here, costs = np.array([begin]), np.zeros(1)
            for region in order:
                there = inside[region]
                here, costs = there, (costs[:, None] + ways[np.ix_(here, there)]).min(axis=0, initial=np.inf)
            best = min(best, float((costs + ways[here, begin]).min(initial=np.inf)))
    return best


def cost(system: TransitionSystem, run: Run) -> int:
    """What the loop of a run costs."""
    controls = run.controls[len(run.prefix) :]
    return int(system.weights[list(run.suffix), list(controls)].sum())


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    regions=st.integers(2, 5),
    size=st.sampled_from([1, 4]),
    most=st.sampled_from([1, 9]),
)
def test_patrols_of_a_few_regions_are_optimal_tours(seed: int, regions: int, size: int, most: int) -> None:
    system = patrol(seed, 24, regions, size, most)
    formula = parse_formula(" & ".join(f"G F r{i}" for i in range(regions)))
    automaton = compile_generalised(translate_generalised(formula), system.letters)
    start = int(np.argmax(system.letter_of == 0))
    product = Product(system, automaton, start, Semantics.STANDARD)
    optimum = optimal_tour(system, start, regions)
    if not np.isfinite(optimum):
        with pytest.raises(NoPlanError):
            search(product)
        return
    runs = search(product)
    for index in {0, runs.count // 2, runs.count - 1}:
        assert cost(system, runs[index]) == optimum
    # Weights draw the loop nearer, never the sum above that of the best loop.
    nearer = search(product, Objective(1, 2))
    assert nearer.cost <= runs.cost + optimum
    assert cost(system, nearer[0]) >= optimum


@pytest.mark.parametrize("seed", range(3))
def test_a_patrol_of_eight_regions_is_an_optimal_tour(seed: int) -> None:
    system = patrol(seed, 100, 8, 1, 1)
    formula = parse_formula(" & ".join(f"G F r{i}" for i in range(8)))
    start = int(np.argmax(system.letter_of == 0))
    automaton = compile_generalised(translate_generalised(formula), system.letters)
    best = search(Product(system, automaton, start, Semantics.STANDARD))[0]
    assert len(best.suffix) == optimal_tour(system, start, 8)
    # One acceptance set, whose automaton waits for the regions in one order, cannot do better.
    in_turn = compile_to_alphabet(translate(formula), system.letters)
    assert len(search(Product(system, in_turn, start, Semantics.STANDARD))[0].suffix) >= len(best.suffix)


def test_more_acceptance_sets_than_an_exact_search_takes_are_refused() -> None:
    system = patrol(0, 60, 13, 1, 1)
    formula = parse_formula(" & ".join(f"G F r{i}" for i in range(13)))
    automaton = compile_generalised(translate_generalised(formula), system.letters)
    start = int(np.argmax(system.letter_of == 0))
    with pytest.raises(SearchSizeError, match="13"):
        search(Product(system, automaton, start, Semantics.STANDARD))
