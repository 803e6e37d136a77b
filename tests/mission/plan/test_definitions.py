"""The numbers of the paper's definitions, against the plan that flies and against the definitions themselves."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from mission.plan import FlightPlan, plan_mission
from mission.plan.definitions import fields_of_run, product_steps
from mission.spec.loader import load_mission, parse_mission
from mission.steering.path import SteeringPath
from tests.support.small_missions import SMALL

MISSIONS = Path(__file__).parents[3] / "missions"


@cache
def paper() -> FlightPlan:
    return plan_mission(load_mission(MISSIONS / "paper.yaml"))


def test_the_fields_are_those_that_steer() -> None:
    path = paper().path
    assert isinstance(path, SteeringPath)
    steering = {(each.triangle, each.control): each for each in path.segments}
    fields = fields_of_run(paper())
    assert [field.triangle for field in fields] == [0, 8, 11, 12, 4, 5, 7, 3, 1, 5, 4, 12, 10]
    for field in fields:
        flown = steering[field.triangle, field.control]
        assert np.allclose(field.F, flown.F, rtol=0.0, atol=1e-14)
        assert np.allclose(field.g, flown.g, rtol=0.0, atol=1e-14)


def test_each_field_interpolates_its_vertex_velocities_and_its_conditions_hold() -> None:
    plan = paper()
    for field in fields_of_run(plan):
        corners = plan.partition.vertices_m[list(field.vertices)]
        assert corners @ field.F.T + field.g == pytest.approx(field.velocities_m_s, abs=1e-12)
        assert field.cost == pytest.approx(0.0, abs=1e-20)
        assert all(condition.margin_m_s > 0.0 for condition in field.conditions)
        if field.equilibrium_m is not None:
            assert field.F @ field.equilibrium_m + field.g == pytest.approx([0.0, 0.0], abs=1e-12)


def test_each_row_says_what_its_margin_is() -> None:
    """The words of a row, read as a product of a normal and a velocity, give its margin."""
    for field in fields_of_run(paper()):
        names = {f"n{i}": n for i, n in enumerate(field.normals, 1)}
        for row, margin_m_s in ((each.row, each.margin_m_s) for each in field.conditions):
            left, velocity = row.removeprefix("-").rsplit(" ", 1)
            normal = sum(names[name] for name in left.strip("()").split(" + "))
            sign = -1.0 if row.startswith("-") else 1.0
            assert sign * normal @ field.velocities_m_s[int(velocity[1]) - 1] == pytest.approx(margin_m_s, abs=1e-15)


def test_the_rows_of_equation_18_for_the_first_facet_are_the_papers() -> None:
    first = fields_of_run(paper())[0]
    assert first.control == 1
    rows = ["-n2 u1", "-n3 u1", "-(n2 + n3) u1", "n1 u2", "-n3 u2", "n1 u3", "-n2 u3"]
    assert [each.row for each in first.conditions] == rows
    assert [each.equation for each in first.conditions] == [13, 13, 13, 14, 14, 15, 15]
    last = fields_of_run(paper())[-1]
    assert {each.row for each in last.conditions} == {f"-n{i} u{j}" for i in (1, 2, 3) for j in (1, 2, 3) if i != j}


def test_the_product_reaches_as_many_states_as_the_search_counts() -> None:
    steps = product_steps(paper())
    assert len({step[:2] for step in steps}) == paper().product_states_reachable == 34
    assert len(set(steps)) == len(steps)


@pytest.mark.parametrize(
    "formula", ["F goal & F home & G !pond", "F (goal & F G home) & G !pond", "G F goal & G F home"]
)
def test_each_step_is_one_of_t_and_one_of_a(formula: str) -> None:
    plan = plan_mission(parse_mission(SMALL.replace("F (goal & F G home) & G !pond", formula).encode(), "small.yaml"))
    steps = product_steps(plan)
    edges = {(edge.source, edge.target): edge.guard for edge in plan.shown_automaton.edges}
    for step in steps:
        assert plan.successors[step.triangle, step.control] == step.to_triangle
        if plan.shown_parts == 1:
            assert (step.state, step.to_state) in edges
    # Every step of the run is one.
    moves = {(step.triangle, step.control, step.to_triangle) for step in steps}
    states = plan.run.states
    for here, control, there in zip(states, plan.run.controls, states[1:], strict=False):
        assert (here, control, there) in moves
