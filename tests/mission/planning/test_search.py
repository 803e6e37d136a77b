"""Shortest runs of any automaton against a brute force that lists walks, and against the paper's table."""

from pathlib import Path
from random import Random

import numpy as np
import pytest
from hypothesis import Phase, given
from hypothesis import strategies as st

from mission.errors import NoPlanError
from mission.geometry.regions import Labelling
from mission.geometry.triangulation import triangulate_nodes
from mission.logic.automata.conjunction import Conjunction
from mission.planning.objective import Objective
from mission.planning.product import Product
from mission.planning.search import search
from mission.planning.transition_system import TransitionSystem
from mission.spec.loader import load_mission
from mission.spec.model import NodesDomain, Semantics
from tests.support.automata import NAMES, accepts, random_automaton
from tests.support.drawn_cases import tried
from tests.support.lassos import lasso_of, lassos, random_map, rank_of, word_of
from tests.support.required import given as given_automaton
from tests.support.required import required

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


def compiled(formula: str) -> Conjunction:
    return required(formula, LETTERS)


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


@tried(50, phases=[Phase.generate])
@given(
    seed=st.integers(0, 2**32 - 1),
    triangles=st.integers(1, 4),
    size=st.integers(1, 3),
    sets=st.integers(0, 2),
    objective=st.sampled_from([Objective(), Objective(1, 1), Objective(1, 3)]),
    semantics=st.sampled_from(list(Semantics)),
)
def test_runs_of_any_automaton_are_the_lassos_whose_words_it_accepts(
    *, seed: int, triangles: int, size: int, sets: int, objective: Objective, semantics: Semantics
) -> None:
    system = random_map(np.random.default_rng(seed), triangles, 2)
    automaton = random_automaton(Random(seed), size, sets, 1.5, 4)  # noqa: S311 - no secrets here
    names = frozenset(NAMES)
    cut = tuple(letter & names for letter in system.letters)
    every = [
        (objective.rank(prefix, suffix), lasso)
        for lasso, prefix, suffix in lassos(system, 0, lambda word: accepts(automaton, word), semantics, 5)
    ]
    product = Product(system, given_automaton(automaton, cut), 0, semantics)
    try:
        runs = search(product, objective)
    except NoPlanError:
        assert not every
        return
    listed = [lasso_of(run) for run in runs]
    assert runs.count == len(listed) == len(set(listed))
    assert [lasso_of(runs[index]) for index in range(runs.count)] == listed
    (rank,) = {rank_of(system, run, objective) for run in runs}
    assert not [lasso for other, lasso in every if other < rank]
    assert {lasso for other, lasso in every if other == rank} <= set(listed)
    for run in runs:
        assert accepts(automaton, word_of(system, lasso_of(run), semantics))
        entered = [*run.states[1:], run.suffix[0]]
        assert [system.successors[x, u] for x, u in zip(run.states, run.controls, strict=True)] == entered


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
