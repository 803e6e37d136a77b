"""The full quadrotor against its equations, written down a second time with rotation matrices."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from tests.support.airframes import PerfectFlight
from tests.support.drawn_cases import tried
from vehicle_sim.dynamics.airframe import Dynamics
from vehicle_sim.dynamics.hover import DRAG_PER_S, VERTICAL_DRAG_PER_S
from vehicle_sim.dynamics.quadrotor import Quadrotor, angles_of, quaternion_of
from vehicle_sim.dynamics.rotors import RotorSet
from vehicle_sim.signals import GRAVITY_M_S2, IDLE, Command, FourRotors, Motion, Setpoint, Vector

STEP_S = 0.01
ROTORS = RotorSet()
CALM: Vector = (0.0, 0.0, 0.0)
Array = NDArray[np.float64]


def asking(*outputs: float) -> Command:
    front, right, rear, left = outputs
    return Command(0.0, (0.0, 0.0, 0.0), (front, right, rear, left))


def airborne(rotors: RotorSet = ROTORS) -> Quadrotor:
    quadrotor = Quadrotor(step_s=STEP_S, rotors=rotors)
    for _ in range(300):
        quadrotor.step(asking(0.6, 0.6, 0.6, 0.6), CALM)
    assert not quadrotor.motion.on_ground
    return quadrotor


def matrix_of(motion: Motion) -> Array:
    """Rotation from body to local axes, as the product of three."""
    (cr, cp, cy), (sr, sp, sy) = (f([motion.roll_rad, motion.pitch_rad, motion.yaw_rad]) for f in (np.cos, np.sin))
    yaw = np.array([[cy, -sy, 0.0], [sy, cy, 0.0], [0.0, 0.0, 1.0]])
    pitch = np.array([[cp, 0.0, sp], [0.0, 1.0, 0.0], [-sp, 0.0, cp]])
    roll = np.array([[1.0, 0.0, 0.0], [0.0, cr, -sr], [0.0, sr, cr]])
    product: Array = yaw @ pitch @ roll
    return product


def momentum(rates: Array, speeds: Array) -> Array:
    """Angular momentum in body axes: of the body, and of rotors of which 1 and 3 turn counterclockwise from above."""
    spin = speeds @ np.array([-1.0, 1.0, -1.0, 1.0])
    total: Array = np.array(ROTORS.inertia_kg_m2) * rates + np.array([0.0, 0.0, ROTORS.rotor_inertia_kg_m2 * spin])
    return total


def equations(outputs: FourRotors, wind: Vector) -> Callable[[float, Array], Array]:
    """Newton and Euler, with 22 states: place, velocity, rotation matrix by rows, rates, rotor speeds."""
    targets = ROTORS.most_speed_rad_s * np.sqrt(np.array(outputs))
    inertia, drag = np.array(ROTORS.inertia_kg_m2), np.diag([DRAG_PER_S, DRAG_PER_S, VERTICAL_DRAG_PER_S])

    def right_side(_t: float, x: Array) -> Array:
        velocity, turn, rates, speeds = x[3:6], x[6:15].reshape(3, 3), x[15:18], x[18:22]
        spin_up = (targets - speeds) / ROTORS.response_s
        forces = ROTORS.lift * speeds**2
        torque = np.array(
            [
                ROTORS.arm_m * (forces[3] - forces[1]),
                ROTORS.arm_m * (forces[0] - forces[2]),
                ROTORS.drag * (speeds**2 @ np.array([1.0, -1.0, 1.0, -1.0])),
            ]
        )
        reaction = momentum(np.zeros(3), spin_up)
        push = np.array([0.0, 0.0, -forces.sum() / ROTORS.mass_kg]) - drag @ (turn.T @ (velocity - np.array(wind)))
        skew = np.array([[0.0, -rates[2], rates[1]], [rates[2], 0.0, -rates[0]], [-rates[1], rates[0], 0.0]])
        return np.concatenate(
            [
                velocity,
                turn @ push + np.array([0.0, 0.0, GRAVITY_M_S2]),
                (turn @ skew).ravel(),
                (torque - reaction - np.cross(rates, momentum(rates, speeds))) / inertia,
                spin_up,
            ]
        )

    return right_side


def state_of(quadrotor: Quadrotor) -> Array:
    motion = quadrotor.motion
    return np.array(
        [
            *motion.position_ned_m,
            *motion.velocity_ned_m_s,
            *matrix_of(motion).ravel(),
            *motion.rates_rad_s,
            *quadrotor.speeds_rad_s,
        ]
    )


def solved(start: Array, course: list[FourRotors], wind: Vector) -> Array:
    """The state after all of `course`, each output held for a step."""
    state = start
    for outputs in course:
        solution = solve_ivp(equations(outputs, wind), (0.0, STEP_S), state, method="DOP853", rtol=1e-8, atol=1e-9)
        state = solution.y[:, -1]
    return state


@pytest.mark.parametrize("target", [(2.0, 1.0, -21.0), (40.0, -30.0, -24.0)], ids=["survey", "at the limits"])
def test_ten_seconds_of_manoeuvre_agree_with_a_fine_solution(target: Vector) -> None:
    """The same outputs, step by step, without feedback: so errors of the integration add up."""
    flight = PerfectFlight(Dynamics.QUADROTOR)
    flight.fly(Setpoint(position_ned_m=(0.0, 0.0, -20.0)), 12.0)
    flight.wind = (3.0, -2.0, 0.5)
    assert isinstance(flight.airframe, Quadrotor)
    start = state_of(flight.airframe)
    flight.outputs.clear()
    for where, yaw in ((target, 1.0), ((0.0, 0.0, -20.0), -0.5)):
        flight.fly(Setpoint(position_ned_m=where, yaw_rad=yaw), 5.0)
    end = solved(start, flight.outputs, flight.wind)
    got = state_of(flight.airframe)
    assert np.allclose(got[:3], end[:3], atol=0.1)
    assert np.allclose(got[3:6], end[3:6], atol=0.03)
    assert np.allclose(got[6:18], end[6:18], atol=3e-4)
    assert np.allclose(got[18:], end[18:], rtol=1e-9)


def test_halving_the_step_quarters_the_error() -> None:
    outputs = [(0.52, 0.5, 0.49, 0.51)] * 20 + [(0.48, 0.5, 0.51, 0.49)] * 20
    errors = []
    for parts in (1, 2):
        quadrotor = Quadrotor(step_s=STEP_S / parts)
        for _ in range(300 * parts):
            quadrotor.step(asking(0.6, 0.6, 0.6, 0.6), CALM)
        start = state_of(quadrotor)
        for wanted in outputs:
            for _ in range(parts):
                quadrotor.step(asking(*wanted), CALM)
        errors.append(np.linalg.norm((state_of(quadrotor) - solved(start, outputs, CALM))[:18]))
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.3)


def test_near_hover_the_rates_obey_the_corrected_equation_6() -> None:
    """The terms of Eq. 6 by themselves: gyroscopic pairs with their corrected signs, from one short step."""
    quadrotor = airborne()
    for outputs in ((0.53, 0.5, 0.5, 0.53), (0.5, 0.5, 0.5, 0.5)):
        for _ in range(5):
            quadrotor.step(asking(*outputs), CALM)
    before, speeds = quadrotor.motion.rates_rad_s, np.array(quadrotor.speeds_rad_s)
    quadrotor.step(asking(0.5, 0.5, 0.5, 0.5), CALM)
    gained = (np.array(quadrotor.motion.rates_rad_s) - before) / STEP_S
    mean = 0.5 * (np.array(quadrotor.motion.rates_rad_s) + before)
    speeds = 0.5 * (speeds + np.array(quadrotor.speeds_rad_s))
    (ixx, iyy, izz), ip, (p, q, r) = ROTORS.inertia_kg_m2, ROTORS.rotor_inertia_kg_m2, mean
    omega = speeds[1] - speeds[0] + speeds[3] - speeds[2]
    u2 = ROTORS.arm_m * ROTORS.lift * (speeds[3] ** 2 - speeds[1] ** 2)
    u3 = ROTORS.arm_m * ROTORS.lift * (speeds[0] ** 2 - speeds[2] ** 2)
    assert gained[0] == pytest.approx((iyy - izz) / ixx * q * r - ip / ixx * q * omega + u2 / ixx, abs=0.02)
    assert gained[1] == pytest.approx((izz - ixx) / iyy * p * r + ip / iyy * p * omega + u3 / iyy, abs=0.02)


@pytest.mark.parametrize(
    ("roll", "pitch", "yaw"), [(0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (0.1, -0.2, 0.7), (-0.3, 0.25, -2.0)]
)
def test_thrust_accelerates_along_equation_6(roll: float, pitch: float, yaw: float) -> None:
    """The corrected factors of Eq. 6 with its axes forward, left, up: north stays, pitch, yaw and y change sign."""
    quadrotor = airborne()
    quadrotor._attitude = quaternion_of(roll, pitch, yaw)
    quadrotor.motion = quadrotor.motion._replace(
        roll_rad=roll, pitch_rad=pitch, yaw_rad=yaw, velocity_ned_m_s=CALM, rates_rad_s=CALM
    )
    motion = quadrotor.step(asking(0.6, 0.6, 0.6, 0.6), CALM)
    phi, theta, psi, u1 = roll, -pitch, -yaw, quadrotor.thrust_m_s2
    x = (np.sin(psi) * np.sin(phi) + np.cos(psi) * np.sin(theta) * np.cos(phi)) * u1
    y = (-np.cos(psi) * np.sin(phi) + np.sin(psi) * np.sin(theta) * np.cos(phi)) * u1
    z = -GRAVITY_M_S2 + np.cos(theta) * np.cos(phi) * u1
    assert motion.acceleration_ned_m_s2 == pytest.approx((x, -y, -z), abs=0.02)


def test_angular_momentum_is_kept_where_nothing_outside_turns_it() -> None:
    """Rotors without air, spinning up and down in a tumbling body: only the sum stays."""
    vacuum = RotorSet(lift=1e-12, drag=0.0, most_speed_rad_s=ROTORS.most_speed_rad_s)
    quadrotor = Quadrotor(step_s=0.001, rotors=vacuum)
    quadrotor._on_ground = False
    quadrotor.motion = quadrotor.motion._replace(
        position_ned_m=(0.0, 0.0, -500.0), rates_rad_s=(0.8, -0.5, 0.3), on_ground=False
    )

    def total() -> Array:
        state = state_of(quadrotor)
        whole: Array = state[6:15].reshape(3, 3) @ momentum(state[15:18], state[18:])
        return whole

    start = total()
    for outputs in ((0.9, 0.1, 0.8, 0.2), (0.0, 0.5, 0.1, 0.9)):
        for _ in range(500):
            quadrotor.step(asking(*outputs), CALM)
        assert total() == pytest.approx(start, abs=2e-5)
    assert np.linalg.norm(np.array(quadrotor.motion.rates_rad_s) - (0.8, -0.5, 0.3)) > 0.2


def test_energy_is_what_thrust_and_drag_put_in() -> None:
    quadrotor = airborne()
    for outputs in ((0.51, 0.5, 0.5, 0.5), (0.48, 0.5, 0.5, 0.51)):
        for _ in range(20):
            quadrotor.step(asking(*outputs), CALM)

    def energy() -> float:
        motion = quadrotor.motion
        v = np.array(motion.velocity_ned_m_s)
        return float(0.5 * v @ v - GRAVITY_M_S2 * motion.position_ned_m[2])

    # The accelerometer feels exactly the forces that are not gravity; their power is what the energy grows by.
    before, work = energy(), 0.0
    for _ in range(100):
        was = quadrotor.motion
        motion = quadrotor.step(asking(0.5, 0.51, 0.5, 0.5), (1.0, 0.0, 0.0))
        force = matrix_of(motion) @ np.array(motion.specific_force_m_s2)
        work += float(force @ (np.array(was.velocity_ned_m_s) + motion.velocity_ned_m_s)) * 0.5 * STEP_S
    assert energy() - before == pytest.approx(work, abs=1e-3)


def test_a_free_fall_is_damped_by_drag_alone() -> None:
    quadrotor = Quadrotor(step_s=STEP_S)
    quadrotor._on_ground = False
    quadrotor.motion = quadrotor.motion._replace(position_ned_m=(0.0, 0.0, -400.0), on_ground=False)
    for _ in range(300):
        quadrotor.step(IDLE, CALM)
    k = VERTICAL_DRAG_PER_S
    assert quadrotor.motion.velocity_ned_m_s[2] == pytest.approx(GRAVITY_M_S2 / k * (1.0 - np.exp(-3.0 * k)), rel=1e-5)


@tried(50)
@given(angles=st.tuples(st.floats(-3.1, 3.1), st.floats(-1.5, 1.5), st.floats(-3.1, 3.1)))
def test_angles_and_quaternions_are_inverse(angles: Vector) -> None:
    quaternion = quaternion_of(*angles)
    assert np.linalg.norm(quaternion) == pytest.approx(1.0)
    assert angles_of(quaternion) == pytest.approx(angles, abs=1e-9)


def test_the_ground_carries_it_until_thrust_exceeds_weight() -> None:
    quadrotor = Quadrotor(step_s=STEP_S, yaw_rad=0.7)
    for _ in range(300):
        quadrotor.step(asking(0.52, 0.49, 0.45, 0.5), (5.0, 0.0, 0.0))
    assert quadrotor.motion.on_ground
    assert quadrotor.motion.position_ned_m == (0.0, 0.0, 0.0)
    assert quadrotor.motion.specific_force_m_s2 == pytest.approx((0.0, 0.0, -GRAVITY_M_S2))
    assert quadrotor.motion.yaw_rad == 0.7


def test_a_fall_ends_on_the_ground_at_rest_and_level() -> None:
    quadrotor = airborne()
    for _ in range(8):
        quadrotor.step(asking(0.5, 0.5, 0.45, 0.5), CALM)
    for _ in range(2000):
        quadrotor.step(IDLE, (3.0, 0.0, 0.0))
    motion = quadrotor.motion
    assert motion.on_ground
    assert motion.position_ned_m[2] == 0.0
    assert motion.velocity_ned_m_s == (0.0, 0.0, 0.0)
    assert (motion.roll_rad, motion.pitch_rad) == (0.0, 0.0)


def test_a_weak_rotor_gives_its_share_of_the_thrust_for_its_share_of_the_drag() -> None:
    quadrotor = Quadrotor(step_s=STEP_S)
    quadrotor.weaken((1.0, 0.5, 1.0, 0.0))
    for _ in range(200):
        quadrotor.step(asking(0.4, 0.4, 0.4, 0.4), CALM)
    assert quadrotor.outputs == pytest.approx((0.4, 0.2, 0.4, 0.0))
    with pytest.raises(ValueError, match="efficiency"):
        quadrotor.weaken((1.0, 1.1, 1.0, 1.0))


def test_power_at_hover_is_that_of_the_hover_model() -> None:
    quadrotor = Quadrotor(step_s=STEP_S)
    for _ in range(100):
        quadrotor.step(asking(0.5, 0.5, 0.5, 0.5), CALM)
    assert quadrotor.power_w == pytest.approx(140.0, rel=0.05)
