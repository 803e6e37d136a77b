"""Best runs are those of the definition: lassos over triangles whose words satisfy the formula, each once.

No automaton has a part in what they are compared with: walks are listed, and their words judged by the definition.
"""

from random import Random

import numpy as np
import pytest
from hypothesis import Phase, given
from hypothesis import strategies as st

from mission.errors import AutomatonSizeError, NoPlanError
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.word import satisfies
from mission.plan.best_runs import best_runs
from mission.planning.objective import Objective
from mission.planning.transition_system import TransitionSystem
from mission.spec.model import Semantics
from mission.spec.specification import Specification
from tests.support.drawn_cases import tried
from tests.support.lassos import lasso_of, lassos, random_map, random_mission, rank_of, word_of

MOST = 5
OBJECTIVES = [Objective(), Objective(1, 1), Objective(1, 3)]


@tried(60, phases=[Phase.generate])
@given(
    seed=st.integers(0, 2**32 - 1),
    triangles=st.integers(2, 5),
    most=st.sampled_from([1, 1, 3]),
    objective=st.sampled_from(OBJECTIVES),
    semantics=st.sampled_from(list(Semantics)),
)
def test_cost_count_and_runs_are_those_of_listed_lassos(
    *, seed: int, triangles: int, most: int, objective: Objective, semantics: Semantics
) -> None:
    text = random_mission(Random(seed))  # noqa: S311 - no secrets here
    check(text, seed, triangles, most, objective=objective, semantics=semantics)


def check(text: str, seed: int, triangles: int, most: int, *, objective: Objective, semantics: Semantics) -> None:
    system, formula = random_map(np.random.default_rng(seed), triangles, most), parse_formula(text)
    every = [
        (objective.rank(prefix, suffix), lasso)
        for lasso, prefix, suffix in lassos(system, 0, lambda word: satisfies(word, formula), semantics, MOST)
    ]
    try:
        found = best_runs(system, Specification(formula), 0, semantics, objective)
    except NoPlanError:
        assert not every
        return
    runs = list(found.runs)
    listed = [lasso_of(run) for run in runs]
    assert found.exact
    assert found.runs.count == len(listed) == len(set(listed))
    (rank,) = {rank_of(system, run, objective) for run in runs}
    for lasso in listed:
        assert satisfies(word_of(system, lasso, semantics), formula)
    assert not [lasso for other, lasso in every if other < rank]
    assert {lasso for other, lasso in every if other == rank} <= set(listed)


def test_waiting_for_a_guess_costs_nothing() -> None:
    # A corridor: what must hold from some time on, beside what must come once and what must come again and again.
    successors = np.full((4, 4), -1)
    successors[:, 0] = np.arange(4)
    successors[:-1, 1], successors[1:, 2] = np.arange(1, 4), np.arange(3)
    letters = (frozenset[str](), frozenset({"a"}), frozenset({"b"}))
    system = TransitionSystem(successors, np.array([0, 1, 0, 2]), letters)
    required = Specification(parse_formula("G F b & F G !a & F a"))
    found = best_runs(system, required, 0, Semantics.STANDARD, Objective())
    assert (found.runs.cost, found.runs.count) == (4, 1)
    assert lasso_of(found.runs[0]) == ((0, 1, 2), (3,))


@pytest.mark.parametrize(("reactions", "states"), [(8, 256), (12, 4096)])
def test_reactions_are_searched_with_a_state_for_each_set_of_those_that_are_due(reactions: int, states: int) -> None:
    triangles = 2 * reactions + 1
    successors = np.full((triangles, 4), -1)
    successors[:, 0] = np.arange(triangles)
    successors[:-1, 1], successors[1:, 2] = np.arange(1, triangles), np.arange(triangles - 1)
    letters = (frozenset[str](), *(frozenset({f"r{i}"}) for i in range(2 * reactions)))
    system = TransitionSystem(successors, np.arange(triangles), letters)
    formula = " & ".join(f"G (r{2 * i} -> F r{2 * i + 1})" for i in range(reactions))
    last = f" & F r{2 * reactions - 1}"
    found = best_runs(system, Specification(parse_formula(formula)), 0, Semantics.STANDARD, Objective())
    assert found.product.full_size == triangles * states
    assert (found.runs.cost, found.runs.count, found.exact) == (1, 1, True)
    through = best_runs(system, Specification(parse_formula(formula + last)), 0, Semantics.STANDARD, Objective())
    assert (through.runs.cost, through.runs.count) == (triangles, 1)


def test_too_many_tasks_in_any_order_are_refused_with_the_bound_and_a_cure() -> None:
    letters = tuple(frozenset({f"r{i}"}) for i in range(20))
    system = TransitionSystem(np.array([[0, -1, -1, -1]] * 20), np.arange(20), letters)
    every = Specification(parse_formula(" & ".join(f"F r{i}" for i in range(20))))
    with pytest.raises(AutomatonSizeError, match=r"more than 40000 states.*an order"):
        best_runs(system, every, 0, Semantics.STANDARD, Objective())
