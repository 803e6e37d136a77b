from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from tests.support.drawn_cases import tried
from vehicle_sim.dynamics.hover import (
    DRAG_PER_S,
    ROTOR_TIME_S,
    VERTICAL_DRAG_PER_S,
    Hover,
    discretise,
    horizontal_model,
    vertical_model,
)
from vehicle_sim.dynamics.kinematics import body_rates, specific_force, to_body
from vehicle_sim.signals import GRAVITY_M_S2, IDLE, Command, Vector

STEP_S = 0.01
Model = tuple[NDArray[np.float64], NDArray[np.float64]]
RightSide = Callable[[float, NDArray[np.float64]], NDArray[np.float64]]


def airborne(yaw_rad: float = 0.0) -> Hover:
    """A vehicle some metres up."""
    hover = Hover(step_s=STEP_S, yaw_rad=yaw_rad)
    for _ in range(200):
        hover.step(Command(1.2 * GRAVITY_M_S2, (0.0, 0.0, 0.0)), (0.0, 0.0, 0.0))
    assert not hover.motion.on_ground
    return hover


def ode(roll_up: float, pitch_up: float, thrust: float, wind: Vector, yaw: float) -> RightSide:
    """Eq. 9 and what is behind it, written down a second time, as one system in body tilt angles at fixed yaw."""

    def right_side(_t: float, x: NDArray[np.float64]) -> NDArray[np.float64]:
        v, (roll, pitch), (roll_rate, pitch_rate), t = x[3:6], x[6:8], x[8:10], x[10]
        ahead, right = -GRAVITY_M_S2 * pitch, GRAVITY_M_S2 * roll
        return np.array(
            [
                *v,
                np.cos(yaw) * ahead - np.sin(yaw) * right - DRAG_PER_S * (v[0] - wind[0]),
                np.sin(yaw) * ahead + np.cos(yaw) * right - DRAG_PER_S * (v[1] - wind[1]),
                GRAVITY_M_S2 - t - VERTICAL_DRAG_PER_S * (v[2] - wind[2]),
                roll_rate,
                pitch_rate,
                roll_up,
                pitch_up,
                (thrust - t) / ROTOR_TIME_S,
            ]
        )

    return right_side


@pytest.mark.parametrize("model", [horizontal_model, vertical_model])
def test_discretisation_agrees_with_the_integral_of_the_matrix_exponential(model: Callable[[], Model]) -> None:
    a, b = model()
    phi, gamma = discretise(a, b, STEP_S)
    assert np.allclose(phi, expm(a * STEP_S), atol=1e-14)
    s, weights = np.polynomial.legendre.leggauss(8)
    times = 0.5 * STEP_S * (s + 1.0)
    integral = sum(0.5 * STEP_S * w * expm(a * t) @ b for t, w in zip(times, weights, strict=True))
    assert np.allclose(gamma, integral, atol=1e-13)


@tried(10)
@given(
    up=st.tuples(*[st.floats(-0.3, 0.3)] * 2),
    thrust=st.floats(9.0, 11.0),
    wind=st.tuples(*[st.floats(-8.0, 8.0)] * 3),
    yaw=st.floats(-3.0, 3.0),
)
def test_steps_agree_with_an_ode_solver(up: tuple[float, float], thrust: float, wind: Vector, yaw: float) -> None:
    hover = airborne(yaw)
    start = hover.motion
    x0 = [*start.position_ned_m, *start.velocity_ned_m_s, 0.0, 0.0, 0.0, 0.0, hover.thrust_m_s2]
    for _ in range(50):
        hover.step(Command(thrust, (*up, 0.0)), wind)
    solution = solve_ivp(ode(*up, thrust, wind, yaw), (0.0, 0.5), x0, rtol=1e-11, atol=1e-12)
    end = hover.motion
    assert np.allclose(end.position_ned_m, solution.y[:3, -1], atol=1e-9)
    assert np.allclose(end.velocity_ned_m_s, solution.y[3:6, -1], atol=1e-9)
    assert np.allclose((end.roll_rad, end.pitch_rad), solution.y[6:8, -1], atol=1e-9)


@pytest.mark.parametrize(
    ("pitch_up", "roll_up", "axis", "sign"), [(-1.0, 0.0, 0, 1), (1.0, 0.0, 0, -1), (0.0, 1.0, 1, 1)]
)
def test_nose_down_flies_north_and_right_side_down_flies_east(
    pitch_up: float, roll_up: float, axis: int, sign: int
) -> None:
    hover = airborne()
    for command in ((roll_up, pitch_up), (-roll_up, -pitch_up)):
        for _ in range(30):
            hover.step(Command(GRAVITY_M_S2, (*command, 0.0)), (0.0, 0.0, 0.0))
    assert sign * hover.motion.velocity_ned_m_s[axis] > 0.1
    assert abs(hover.motion.velocity_ned_m_s[1 - axis]) < 1e-12


def test_yawing_does_not_move_the_thrust_vector() -> None:
    hover = airborne()
    for up in (1.0, -1.0):
        for _ in range(20):
            hover.step(Command(GRAVITY_M_S2, (0.0, -up, 0.0)), (0.0, 0.0, 0.0))
    before = hover.motion
    assert before.pitch_rad < -0.02
    for up in (1.0, -1.0):
        for _ in range(100):
            hover.step(Command(GRAVITY_M_S2, (0.0, 0.0, up)), (0.0, 0.0, 0.0))
    after = hover.motion
    assert after.yaw_rad == pytest.approx(1.0, abs=0.02)
    tilt = np.hypot(after.roll_rad, after.pitch_rad)
    assert tilt == pytest.approx(abs(before.pitch_rad), abs=1e-9)
    # Tilted to the north and looking east of it: the left side is down.
    assert after.roll_rad == pytest.approx(-tilt * np.sin(after.yaw_rad), abs=1e-9)


def test_the_ground_carries_the_vehicle_until_thrust_exceeds_weight() -> None:
    hover = Hover(step_s=STEP_S)
    for _ in range(300):
        hover.step(Command(0.99 * GRAVITY_M_S2, (1.0, 1.0, 1.0)), (5.0, 0.0, 0.0))
    assert hover.motion.on_ground
    assert hover.motion.position_ned_m == (0.0, 0.0, 0.0)
    assert hover.motion.specific_force_m_s2 == (0.0, 0.0, -GRAVITY_M_S2)


def test_a_fall_ends_on_the_ground_at_rest_and_level() -> None:
    hover = airborne()
    while not hover.motion.on_ground:
        hover.step(IDLE, (3.0, 0.0, 0.0))
    for _ in range(10):
        hover.step(IDLE, (3.0, 0.0, 0.0))
    motion = hover.motion
    assert motion.position_ned_m[2] == 0.0
    assert motion.velocity_ned_m_s == (0.0, 0.0, 0.0)
    assert (motion.roll_rad, motion.pitch_rad) == (0.0, 0.0)


@tried(50)
@given(angles=st.tuples(*[st.floats(-0.8, 0.8)] * 3), vector=st.tuples(*[st.floats(-20.0, 20.0)] * 3))
def test_body_axes_agree_with_the_product_of_three_rotations(angles: Vector, vector: Vector) -> None:
    def turn(axis: int, angle: float) -> NDArray[np.float64]:
        c, s = np.cos(angle), np.sin(angle)
        i, j = [(1, 2), (2, 0), (0, 1)][axis]
        matrix = np.eye(3)
        matrix[i, i] = matrix[j, j] = c
        matrix[i, j], matrix[j, i] = -s, s
        return matrix

    roll, pitch, yaw = angles
    body_to_ned = turn(2, yaw) @ turn(1, pitch) @ turn(0, roll)
    assert np.allclose(to_body(roll, pitch, yaw, vector), body_to_ned.T @ vector, atol=1e-12)
    assert np.allclose(
        specific_force(roll, pitch, yaw, vector), body_to_ned.T @ (np.array(vector) - [0, 0, GRAVITY_M_S2]), atol=1e-12
    )


@tried(50)
@given(angles=st.tuples(*[st.floats(-0.8, 0.8)] * 3), rates=st.tuples(*[st.floats(-2.0, 2.0)] * 3))
def test_body_rates_are_the_rotation_between_two_near_attitudes(angles: Vector, rates: Vector) -> None:
    h = 1e-6

    def axes(t: float) -> NDArray[np.float64]:
        roll, pitch, yaw = (a + r * t for a, r in zip(angles, rates, strict=True))
        units: tuple[Vector, ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
        return np.array([to_body(roll, pitch, yaw, unit) for unit in units]).T

    # d/dt of the matrix from local to body axes is -[omega]x times it.
    skew = -((axes(h) - axes(-h)) / (2 * h)) @ axes(0.0).T
    assert np.allclose(body_rates(angles[0], angles[1], rates), (skew[2, 1], skew[0, 2], skew[1, 0]), atol=1e-8)
