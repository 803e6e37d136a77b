"""What a mission's ``search`` section asks for, on the paper's domain and on meshes that tell the costs apart."""

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from mission.errors import SpecError
from mission.logic.formula.parser import parse_formula
from mission.plan import FlightPlan, plan_from_json, plan_mission, plan_to_json, shortest_runs
from mission.plan.best_runs import best_runs
from mission.plan.costs import run_costs, transition_weights
from mission.planning.objective import Objective
from mission.planning.transition_system import TransitionSystem
from mission.spec.loader import load_mission, parse_mission
from mission.spec.model import Cost, Search, Semantics
from mission.spec.specification import Specification
from mission.steering.polyline import Polyline
from tests.support.usual_cases import sampled

MISSIONS = Path(__file__).parents[3] / "missions"

# Two ways from a to b: over the top in few long triangles, or along the bottom in many short ones.
FAN = """\
domain:
  nodes: [[0, 0], [0, 10], [40, 0], [40, 10], [10, 0], [12, 1], [15, 0], [18, 1], [20, 0], [22, 1], [25, 0], [28, 1],
          [30, 0], [20, 60]]
regions:
  a: {kind: home, at: [2, 5]}
  b: {kind: survey, at: [38, 5]}
mission:
  formula: F b
start:
  position_m: [2, 5]
search:
"""


COSTED = [("patrol", Cost.TIME), ("paper", Cost.TRANSITIONS), ("response", Cost.DISTANCE)]
"""Which mission is planned by which cost in each run of the suite."""


def fan(search: str) -> FlightPlan:
    return plan_mission(parse_mission((FAN + search).encode(), "fan.yaml"))


def costs_of(plan: FlightPlan, cost: Cost) -> float:
    weights = transition_weights(plan.partition, cost, plan.spec.flight.speed_m_s)
    return sum(run_costs(weights, plan.run, cost))


def test_each_cost_finds_the_run_that_has_least_of_it() -> None:
    plans = {cost: fan(f"  cost: {cost}\nsmoothing: {{frequencies: auto}}\n") for cost in Cost}
    for cost, plan in plans.items():
        assert costs_of(plan, cost) == min(costs_of(other, cost) for other in plans.values())
    assert plans[Cost.TRANSITIONS].run != plans[Cost.DISTANCE].run
    assert len(plans[Cost.TRANSITIONS].run.states) < len(plans[Cost.DISTANCE].run.states)


@sampled(("name", "cost"), product(("patrol", "paper", "response"), Cost), COSTED)
def test_plans_by_any_cost_are_proved_and_survive_json(name: str, cost: Cost) -> None:
    spec = replace(load_mission(MISSIONS / f"{name}.yaml"), search=Search(cost, 2, 3))
    plan = plan_mission(spec)
    assert plan.certificate.holds
    assert plan.spec.search == Search(cost, 2, 3)
    again = plan_from_json(plan_to_json(plan))
    assert again.spec.search == spec.search
    assert again.best_in_any_order
    runs = shortest_runs(again)
    assert runs.count == plan.shortest_runs
    by_search = isinstance(plan.path, Polyline) and plan.way is None  # then a run of the search is not what is flown
    assert by_search or runs[plan.run_index] == plan.run
    assert plan.costs == again.costs


def test_a_heavier_suffix_shortens_the_loop_at_the_cost_of_the_prefix() -> None:
    # A corridor of triangles; near the start a loop of four, at its far end, behind a long way, one of two.
    successors = np.full((9, 4), -1)
    successors[:, 0] = np.arange(9)
    for i in range(8):
        successors[i, 2], successors[i + 1, 1] = i + 1, i
    letters = (frozenset[str](), frozenset({"p"}), frozenset({"q"}))
    system = TransitionSystem(successors, np.array([1, 0, 2, 0, 0, 0, 0, 1, 2]), letters)
    patrol = Specification(parse_formula("G F p & G F q"))
    near = best_runs(system, patrol, 2, Semantics.STANDARD, Objective(1, 1))
    far = best_runs(system, patrol, 2, Semantics.STANDARD, Objective(1, 5))
    decided = best_runs(system, patrol, 2, Semantics.STANDARD, Objective())
    assert [len(found.runs[0].suffix) for found in (near, far, decided)] == [4, 2, 2]
    assert all(found.exact for found in (near, far, decided))


def test_more_recurring_tasks_than_can_be_ordered_exactly_are_met_in_turn_and_the_plan_says_so() -> None:
    side = 14
    successors = np.full((side, 4), -1)
    successors[:, 0] = np.arange(side)
    successors[:-1, 2], successors[1:, 1] = np.arange(1, side), np.arange(side - 1)
    letters = tuple(frozenset({f"r{i}"}) for i in range(side))
    system = TransitionSystem(successors, np.arange(side), letters)
    names = [f"r{i}" for i in range(13)]
    patrol = Specification(parse_formula(" & ".join(f"G F {name}" for name in names)))
    found = best_runs(system, patrol, 0, Semantics.STANDARD, Objective())
    assert not found.exact
    assert set(range(13)) <= set(found.runs[0].suffix)


@pytest.mark.parametrize("search", ["  cost: fuel\n", "  prefix_weight: 0\n", "  suffix_weight: 1.5\n"])
def test_what_cannot_be_asked_for_is_refused(search: str) -> None:
    with pytest.raises(SpecError):
        parse_mission((FAN + search).encode(), "fan.yaml")
