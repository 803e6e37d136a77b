"""Shortest runs against a brute force that lists walks, and against the paper's table."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mission.errors import NoPlanError
from mission.geometry.regions import Labelling
from mission.geometry.triangulation import triangulate_nodes
from mission.logic.automata.automaton import CompiledAutomaton, compile_to_alphabet
from mission.logic.automata.translate import translate
from mission.logic.formula.parser import parse_formula
from mission.planning.objective import Objective
from mission.planning.product import Product
from mission.planning.search import ShortestRuns, search
from mission.planning.transition_system import TransitionSystem
from mission.spec.loader import load_mission
from mission.spec.model import NodesDomain, Semantics
from tests.support.products import Lasso, Shape, best_lassos, listed_lassos, random_automaton, random_system, weighted

MISSIONS = Path(__file__).parents[3] / "missions"
LETTERS = (frozenset[str](), frozenset({"R"}), frozenset({"S1"}), frozenset({"S2"}), frozenset({"K1"}))


def paper_system(*, blocked: bool = True) -> TransitionSystem:
    spec = load_mission(MISSIONS / "paper.yaml")
    assert isinstance(spec.domain, NodesDomain)
    partition = triangulate_nodes(np.array(spec.domain.nodes_m))
    letter_of = np.zeros(13, dtype=np.int64)
    letter_of[[10, 3, 0, 6]] = 1, 2, 3, 4
    keep_off = np.zeros(13, dtype=np.bool_)
    keep_off[6] = blocked
    return TransitionSystem.from_partition(partition, Labelling(LETTERS, letter_of), keep_off)


def compiled(formula: str) -> CompiledAutomaton:
    return compile_to_alphabet(translate(parse_formula(formula)), LETTERS)


@pytest.mark.parametrize("semantics", list(Semantics))
@pytest.mark.parametrize("blocked", [False, True])
def test_the_papers_runs_in_the_papers_order(semantics: Semantics, *, blocked: bool) -> None:
    product = Product(paper_system(blocked=blocked), compiled("F (S1 & F R) & G !K1"), 0, semantics)
    runs = search(product)
    assert product.full_size == 39
    assert (runs.cost, runs.count) == (13, 4)
    common = (0, 8, 11, 12, 4, 5)
    middles = [(7, 3, 1), (1, 3, 1), (7, 3, 7), (1, 3, 7)]
    assert [run.states for run in runs] == [(*common, *middle, 5, 4, 12, 10) for middle in middles]
    assert runs[0].controls == (1, 3, 3, 1, 1, 3, 1, 2, 2, 2, 3, 2, 0)
    assert runs[0].suffix == (10,)


def test_a_recurrent_run_moves_round_its_loop() -> None:
    product = Product(paper_system(), compiled("G F S1 & G F R & G !K1"), 0, Semantics.STANDARD)
    run = search(product)[0]
    assert run.recurrent
    assert {3, 10} <= set(run.suffix)
    assert 6 not in run.states


SHAPES = st.builds(Shape, st.integers(1, 4), st.integers(0, 4), st.sampled_from([0.15, 0.3, 0.5]))


def check(runs: ShortestRuns, expected: tuple[int, set[Lasso]], system: TransitionSystem) -> None:
    listed = list(runs)
    assert runs.cost == expected[0]
    assert runs.count == len(listed) == len(expected[1])
    assert {(run.prefix, run.suffix) for run in listed} == expected[1]
    assert [runs[i] for i in range(runs.count)] == listed
    for run in listed:
        entered = [*run.states[1:], run.suffix[0]]
        assert [system.successors[x, u] for x, u in zip(run.states, run.controls, strict=True)] == entered


@settings(max_examples=150, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    triangles=st.integers(1, 6),
    shape=SHAPES,
    semantics=st.sampled_from(list(Semantics)),
)
def test_cost_count_and_runs_equal_those_of_listed_walks(
    seed: int, triangles: int, shape: Shape, semantics: Semantics
) -> None:
    rng = np.random.default_rng(seed)
    system = random_system(rng, triangles, 2)
    automaton = random_automaton(rng, 2, shape)
    expected = listed_lassos(system, automaton, 0, reads_start=semantics is Semantics.STANDARD, most=6)
    product = Product(system, automaton, 0, semantics)
    try:
        runs = search(product, Objective(1, 1))
    except NoPlanError:
        assert expected is None
        return
    if expected is None:
        assert runs.cost > 6
        return
    check(runs, expected, system)


@settings(max_examples=250, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    triangles=st.integers(1, 9),
    shape=SHAPES,
    most=st.sampled_from([1, 3]),
    objective=st.sampled_from([Objective(), Objective(1, 1), Objective(2, 3), Objective(1, 50)]),
    semantics=st.sampled_from(list(Semantics)),
)
def test_cost_count_and_runs_equal_the_definition(
    *, seed: int, triangles: int, shape: Shape, most: int, objective: Objective, semantics: Semantics
) -> None:
    rng = np.random.default_rng(seed)
    system = weighted(rng, random_system(rng, triangles, 3), most)
    automaton = random_automaton(rng, 3, shape)
    expected = best_lassos(system, automaton, 0, objective, reads_start=semantics is Semantics.STANDARD)
    product = Product(system, automaton, 0, semantics)
    if expected is None:
        with pytest.raises(NoPlanError):
            search(product, objective)
        return
    runs = search(product, objective)
    if len(expected[1]) <= 2000:
        check(runs, expected, system)


def test_numbers_of_runs_are_exact_beyond_every_machine_integer() -> None:
    side = 60
    grid = np.arange(side * side).reshape(side, side)
    successors = np.full((side * side, 4), -1)
    successors[:, 0] = np.arange(side * side)
    successors[grid[:, :-1].ravel(), 1] = grid[:, 1:].ravel()
    successors[grid[:-1].ravel(), 2] = grid[1:].ravel()
    letter_of = np.zeros(side * side, dtype=np.int64)
    letter_of[-1] = 1
    system = TransitionSystem(successors, letter_of, LETTERS)
    runs = search(Product(system, compiled("F R"), 0, Semantics.STANDARD))
    lattice_paths = 1
    for k in range(1, side):
        lattice_paths = lattice_paths * (side - 1 + k) // k
    assert runs.count == lattice_paths > 2**64
    assert runs[runs.count - 1].suffix == (side * side - 1,)
    with pytest.raises(IndexError):
        runs[runs.count]
