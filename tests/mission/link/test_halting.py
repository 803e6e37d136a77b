"""What is flown between two plans begins and ends as what is before and after it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.link.course import Course, Reference
from mission.link.guidance import Guidance
from mission.link.halting import Retimed, Transfer, slowed, stopping_place, taken_up, transfer
from mission.monitor.gaps import GAP_S
from tests.support.sessions import DURATION_S, Straight, anchor_at_start, course

PERIOD_S = 1.0 / 30.0
BEGAN_S = 100.0
MOST_M_S2 = 1.5
STEP_S = 1e-4
LEVEL = st.floats(-6.0, 6.0)


def jet(flown: Retimed | Transfer | Straight, t_s: float) -> np.ndarray:
    return np.array(flown.state(np.array([t_s])))[:, 0]


def check_derivatives(flown: Retimed | Transfer, t_s: float) -> None:
    """Velocity and acceleration are what the positions and velocities around a time say."""
    before, at, after = (jet(flown, t_s + d) for d in (-STEP_S, 0.0, STEP_S))
    slopes = (after[:2] - before[:2]) / (2.0 * STEP_S)
    assert slopes == pytest.approx(at[1:], abs=1e-4)


@given(from_s=st.floats(0.0, DURATION_S), rate=st.floats(0.3, 1.0), share=st.floats(0.01, 0.99))
def test_a_trajectory_comes_to_rest_along_itself(from_s: float, rate: float, share: float) -> None:
    halt = slowed(Straight(), from_s, rate, MOST_M_S2)
    begun, own = jet(halt, 0.0), jet(Straight(), from_s)
    assert begun == pytest.approx(own * np.array([[1.0], [rate], [rate**2]]))
    check_derivatives(halt, share * halt.duration_s)
    ended = jet(halt, halt.duration_s)
    assert np.abs(ended[1:]).max() < 1e-9
    assert jet(halt, halt.duration_s + 5.0) == pytest.approx(ended)
    assert ended[0] == pytest.approx(jet(Straight(), halt.planned_s(halt.duration_s))[0])
    times = np.linspace(0.0, halt.duration_s, 200)
    largest = np.hypot(*np.array(halt.state(times))[2].T).max()
    own = np.hypot(*np.array(Straight().state(np.linspace(0.0, DURATION_S, 200)))[2].T).max()
    assert largest <= max(1.4 * MOST_M_S2, own) + 1e-3


@given(from_s=st.floats(0.0, DURATION_S - 1.0))
def test_a_trajectory_is_taken_up_where_it_rested(from_s: float) -> None:
    onward = taken_up(Straight(), from_s, MOST_M_S2)
    begun = jet(onward, 0.0)
    assert begun[0] == pytest.approx(jet(Straight(), from_s)[0])
    assert np.abs(begun[1:]).max() < 1e-9
    assert jet(onward, onward.within_s) == pytest.approx(jet(Straight(), onward.planned_s(onward.within_s)))
    assert onward.planned_s(onward.duration_s) == pytest.approx(max(DURATION_S, onward.planned_s(onward.within_s)))


@given(velocity=st.tuples(LEVEL, LEVEL), acceleration=st.tuples(LEVEL, LEVEL), share=st.floats(0.01, 0.99))
def test_a_vehicle_comes_to_rest_where_it_is_to(
    velocity: tuple[float, float], acceleration: tuple[float, float], share: float
) -> None:
    begin = Reference((3.0, 4.0, 5.0), (*velocity, 0.0), (*acceleration, 0.0))
    way = transfer(begin, stopping_place(begin, MOST_M_S2), MOST_M_S2)
    assert jet(way, 0.0) == pytest.approx(np.array([(3.0, 4.0), velocity, acceleration]))
    check_derivatives(way, share * way.duration_s)
    assert jet(way, way.duration_s)[0] == pytest.approx(way.end_m)
    assert np.abs(jet(way, way.duration_s)[1:]).max() < 1e-8


def led(guidance: Guidance, from_s: float, to_s: float) -> list[Reference]:
    """The points that are asked for, 30 times a second."""
    ticks = range(round(from_s * 30.0), round(to_s * 30.0) + 1)
    due = [guidance.due(BEGAN_S + tick / 30.0) for tick in ticks]
    return [each[0] for each in due if each is not None]


def begun() -> Guidance:
    guidance = Guidance(course(), anchor_at_start((0.0, 0.0, 0.0)), PERIOD_S)
    assert guidance.due(BEGAN_S - PERIOD_S) is not None
    guidance.begin(BEGAN_S)
    return guidance


def halting(guidance: Guidance, at_s: float) -> tuple[Course, Retimed]:
    guidance.promise(at_s)
    from_s, rate = guidance.pace_at(at_s)
    halt = slowed(guidance.course.trajectory, from_s, rate, MOST_M_S2)
    return Course(halt, 0.0, planned_s=halt.planned_s, waits=True), halt


def test_another_course_is_taken_over_without_a_jump() -> None:
    guidance = begun()
    points = led(guidance, 0.0, 5.0)
    at_s = BEGAN_S + 5.3
    course_, halt = halting(guidance, at_s)
    guidance.redirect(course_, at_s)
    rest_s = at_s + halt.duration_s
    onward = taken_up(Straight(), halt.planned_s(halt.duration_s), MOST_M_S2)
    guidance.redirect(Course(onward, 0.0, planned_s=onward.planned_s), rest_s)
    assert guidance.left_s(at_s + 0.1) == float("inf")
    points += led(guidance, 5.0 + PERIOD_S, rest_s + onward.duration_s - BEGAN_S + 1.0)
    jets = np.array([[vector[:2] for vector in point] for point in points])
    steps = np.diff(jets, axis=0)
    mean = 0.5 * (jets[1:] + jets[:-1])
    assert steps[:, 0] == pytest.approx(mean[:, 1] * PERIOD_S, abs=2e-4)
    assert np.abs(steps[:, 2]).max() < 0.2
    assert jets[-1, 0] == pytest.approx(Straight().state(np.array([DURATION_S]))[0][0])
    assert guidance.trajectory_s(rest_s - 0.2) == pytest.approx(halt.planned_s(halt.duration_s - 0.2))
    assert guidance.trajectory_s(at_s - 0.2) == pytest.approx(5.1)


@pytest.mark.parametrize("ahead_s", [0.5, GAP_S + 1.5])
def test_what_was_promised_is_kept(ahead_s: float) -> None:
    guidance = begun()
    led(guidance, 0.0, 4.0)
    guidance.observe(BEGAN_S + 4.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    promised = guidance.promise(BEGAN_S + 4.0 + ahead_s)
    led(guidance, 4.0 + PERIOD_S, 4.0 + ahead_s)
    assert guidance.reference(BEGAN_S + 4.0 + ahead_s) == promised


def test_a_gap_before_the_takeover_puts_it_off() -> None:
    guidance = begun()
    led(guidance, 0.0, 5.0)
    at_s, gap_s = BEGAN_S + 5.2, 3.0
    promised = guidance.promise(at_s)
    course_, _ = halting(guidance, at_s)
    guidance.redirect(course_, at_s)
    assert gap_s > GAP_S
    due = guidance.due(BEGAN_S + 5.0 + gap_s)
    assert due is not None
    assert due[2] is not None
    assert guidance.reference(at_s + gap_s).position_m == pytest.approx(promised.position_m)
    assert guidance.reference(at_s + gap_s).velocity_m_s == pytest.approx(promised.velocity_m_s)
