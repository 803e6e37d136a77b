"""The paper's closed loop on the path of the fields in triangles that move: against the loop stepped by a solver."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from mission.geometry.arrays import FloatArray
from mission.plan import FlightPlan
from mission.plan.carried import carried_path, is_carried
from mission.simulate import Simulation, judged, simulate_plan
from tests.support.carried_plans import drifting_by_field
from tests.support.drifting_plans import standing


@cache
def plan() -> FlightPlan:
    return drifting_by_field()


@cache
def simulation() -> Simulation:
    return simulate_plan(plan(), off_m=(0.5, -1.0))


def stepped(until_s: float) -> tuple[FloatArray, FloatArray]:
    """Positions and velocities (N, 4) at times of the simulation, by Eq. 5 under Eq. 12, from knot to knot."""
    path, tau, found = carried_path(plan()), plan().spec.flight.time_constant_s, simulation()
    state = np.concatenate((found.position_m[0], found.velocity_m_s[0]))
    times, states = [np.zeros(1)], [state[None]]
    knots = [t for t in path.knots_s.tolist() if t < until_s]
    for begin_s, end_s in zip(knots, [*knots[1:], until_s], strict=True):

        def motion(t_s: float, x: FloatArray, last_s: float = end_s) -> FloatArray:
            position, velocity, acceleration = (each[0] for each in path.state([min(t_s, np.nextafter(last_s, 0.0))]))
            control = acceleration - (x[:2] - position) / tau**2 - 2.0 * (x[2:] - velocity) / tau
            return np.concatenate((x[2:], control))

        within = found.t_s[(found.t_s > begin_s) & (found.t_s < end_s)]
        asked = np.append(within, end_s)
        flown = solve_ivp(motion, (begin_s, end_s), state, t_eval=asked, rtol=1e-9, atol=1e-10).y.T
        times.append(within)
        states.append(flown[:-1])
        state = flown[-1]
    return np.concatenate(times), np.concatenate(states)


def test_the_closed_form_is_what_the_integrated_loop_does_over_all_jumps() -> None:
    times, states = stepped(6.0)
    rows = np.searchsorted(simulation().t_s, times)
    exact = np.hstack((simulation().position_m, simulation().velocity_m_s))[rows]
    assert len(times) > 100
    assert np.abs(exact - states).max() < 1e-6


def test_the_true_states_are_continuous_where_the_steering_law_jumps() -> None:
    flown, path = simulate_plan(plan()), carried_path(plan())
    assert np.linalg.norm(path.jumps_m_s, axis=1).max() > 1.0
    steps = np.linalg.norm(np.diff(flown.velocity_m_s, axis=0), axis=1)
    most = np.linalg.norm(flown.control_m_s2, axis=1).max()
    assert steps.max() < 1.5 * most * flown.t_s[1]


def test_the_word_is_that_of_the_run_while_the_region_drifts_across_its_way() -> None:
    flown = simulate_plan(plan())
    monitor = judged(plan(), flown)
    assert monitor.outcome(stays=True).achieved
    assert tuple(visit.triangle for visit in monitor.visits) == plan().run.states
    speeds = np.linalg.norm(flown.asked_velocity_m_s, axis=1)
    assert speeds.max() <= plan().spec.limits.speed_m_s


def test_a_mission_that_stands_still_is_not_carried() -> None:
    drawn = replace(plan(), spec=standing(plan().spec))
    assert is_carried(plan())
    assert not is_carried(drawn)
    with pytest.raises(ValueError, match="nothing moves"):
        carried_path(drawn)
