"""The paper's closed loop: its closed form against Eq. 5, integrated; its numbers; and what is flown."""

import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from mission.geometry.arrays import FloatArray
from mission.plan import FlightPlan, plan_mission
from mission.simulate import SETTLED, Simulation, judged, simulate_plan
from mission.spec.loader import load_mission, parse_mission

PAPER = Path(__file__).parents[3] / "missions" / "paper.yaml"
OFF = st.floats(-2.0, 2.0)
LAPS = """
domain: {boundary: [[0, 0], [40, 0], [40, 20], [0, 20]]}
regions:
  west: {kind: survey, polygon: [[2, 5], [10, 5], [10, 15], [2, 15]]}
  east: {kind: survey, polygon: [[30, 5], [38, 5], [38, 15], [30, 15]]}
mission: {formula: G F west & G F east, laps: until_stopped}
start: {position_m: [6, 10]}
"""


@cache
def paper() -> FlightPlan:
    return plan_mission(load_mission(PAPER))


def integrated(plan: FlightPlan, simulation: Simulation, until_s: float) -> FloatArray:
    """Positions and velocities by Eq. 5 under Eq. 12, stepped by a solver, shape (N, 4)."""
    tau = plan.spec.flight.time_constant_s

    def motion(t_s: float, x: FloatArray) -> FloatArray:
        position, velocity, acceleration = (each[0] for each in plan.trajectory.state([t_s]))
        control = acceleration - (x[:2] - position) / tau**2 - 2.0 * (x[2:] - velocity) / tau
        return np.concatenate((x[2:], control))

    start = np.concatenate((simulation.position_m[0], simulation.velocity_m_s[0]))
    times = simulation.t_s[simulation.t_s <= until_s][::20]
    span = 0.0, float(times[-1])
    found = solve_ivp(motion, span, start, method="DOP853", t_eval=times, rtol=1e-11, atol=1e-12, max_step=0.5)
    return np.asarray(found.y.T)


@settings(max_examples=3)
@given(OFF, OFF)
def test_the_closed_form_is_what_the_integrated_loop_does(east: float, north: float) -> None:
    plan = paper()
    simulation = simulate_plan(plan, off_m=(east, north))
    stepped = integrated(plan, simulation, 30.0)
    exact = np.hstack((simulation.position_m, simulation.velocity_m_s))[: 20 * len(stepped) : 20]
    assert np.abs(stepped - exact).max() < 1e-7


def test_the_gain_makes_both_eigenvalues_of_each_axis_minus_one_over_tau() -> None:
    simulation = simulate_plan(paper())
    a = np.block([[np.zeros((2, 2)), np.eye(2)], [np.zeros((2, 4))]])
    b = np.vstack((np.zeros((2, 2)), np.eye(2)))
    # A double root is only as exact as the root of the rounding.
    assert np.linalg.eigvals(a - b @ simulation.gain) == pytest.approx(np.full(4, -1.0 / 5.0), abs=1e-6)
    assert simulation.gain[0].tolist() == pytest.approx([0.04, 0.0, 0.4, 0.0])


def test_the_paper_begins_a_third_of_a_metre_off_and_converges() -> None:
    """The even extension moves the start by 0.33 m, and 2 % are left of it after some 5.8 time constants."""
    simulation = simulate_plan(paper())
    assert simulation.distance_m[0] == pytest.approx(0.33, abs=0.005)
    assert simulation.velocity_m_s[0].tolist() == pytest.approx([0.02, 0.0])
    assert simulation.settled_s(SETTLED * float(simulation.distance_m[0])) == pytest.approx(5.8 * 5.0, rel=0.05)
    assert simulation.distance_m[-1] < 1e-12


def test_the_simulated_flight_of_the_paper_satisfies_its_formula() -> None:
    plan = paper()
    monitor = judged(plan, simulate_plan(plan))
    assert monitor.verdict_at_end(stays=True).achieved
    assert [visit.triangle for visit in monitor.visits] == [0, 8, 11, 12, 4, 5, 7, 3, 1, 5, 4, 12, 10]


def test_a_vehicle_that_begins_in_what_is_restricted_has_not_achieved() -> None:
    plan = paper()
    at_k1 = np.mean(plan.partition.corners_m[6], axis=0) - plan.start_m
    outcome = judged(plan, simulate_plan(plan, off_m=tuple(at_k1.tolist()))).verdict_at_end(stays=True)
    assert not outcome.achieved
    assert "K1" in outcome.reason


def test_the_control_is_the_acceleration_of_the_states() -> None:
    simulation = simulate_plan(paper(), off_m=(0.3, 0.4))
    step = simulation.t_s[1]
    slopes = np.gradient(simulation.velocity_m_s, step, axis=0)
    # At both ends the jerk of the time law bends the control within a step.
    quiet = (simulation.t_s > 1.0) & (simulation.t_s < simulation.t_s[-1] - 1.0)
    assert np.abs(slopes - simulation.control_m_s2)[quiet].max() < 1e-5
    assert np.abs(np.gradient(simulation.position_m, step, axis=0) - simulation.velocity_m_s)[1:-1].max() < 1e-4


def test_what_is_never_near_is_never_settled() -> None:
    simulation = simulate_plan(paper())
    assert simulation.settled_s(-1.0) == math.inf
    assert simulation.settled_s(1.0) == 0.0


def test_laps_without_an_end_are_simulated_once() -> None:
    plan = plan_mission(parse_mission(LAPS.encode(), "laps.yaml"))
    monitor = judged(plan, simulate_plan(plan))
    outcome = monitor.verdict_at_end(stays=False)
    assert (outcome.achieved, monitor.laps) == (True, 1), outcome.reason
