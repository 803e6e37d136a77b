import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vehicle_sim.dynamics.rotors import SURVEY_ROTORS, mix, squares_for, thrust_and_torques, vibration_m_s2

LEAST = 0.02
SMALL = st.floats(-0.08, 0.08)
SHARES = st.floats(-3.0, 3.0)
FACTORS = {"lift": SURVEY_ROTORS.lift, "drag": SURVEY_ROTORS.drag, "arm_m": SURVEY_ROTORS.arm_m}


def test_equation_7_is_the_sum_of_forces_and_their_moments() -> None:
    """Each rotor's force at its place, and the drag that turns the body against its sense of rotation."""
    squares = (1.0e5, 2.5e5, 3.0e5, 1.7e5)
    arm, up = SURVEY_ROTORS.arm_m, np.array([0.0, 0.0, -1.0])
    places = arm * np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
    counterclockwise = (1.0, -1.0, 1.0, -1.0)  # from above: its momentum points up, so its reaction points down
    forces = [SURVEY_ROTORS.lift * square * up for square in squares]
    moments = np.cross(places, np.array(forces)).sum(axis=0)
    drag = -SURVEY_ROTORS.drag * (np.array(squares) @ np.array(counterclockwise)) * up
    thrust, *torques = thrust_and_torques(squares, **FACTORS)
    assert thrust == pytest.approx(-sum(force[2] for force in forces))
    assert torques == pytest.approx((moments + drag).tolist(), abs=1e-12)


@given(wanted=st.tuples(st.floats(0.0, 30.0), *[st.floats(-2.0, 2.0)] * 3))
def test_the_inverse_of_equation_7(wanted: tuple[float, float, float, float]) -> None:
    assert thrust_and_torques(squares_for(wanted, **FACTORS), **FACTORS) == pytest.approx(wanted, abs=1e-9)


@given(
    thrust=st.floats(0.2, 0.8), roll=st.floats(-0.08, 0.08), pitch=st.floats(-0.08, 0.08), yaw=st.floats(-0.08, 0.08)
)
def test_what_fits_is_given_exactly(thrust: float, roll: float, pitch: float, yaw: float) -> None:
    outputs, fits = mix(thrust, roll, pitch, yaw, least=LEAST)
    assert fits
    assert outputs == pytest.approx(
        (thrust + pitch + yaw, thrust - roll - yaw, thrust - pitch + yaw, thrust + roll - yaw)
    )


@given(thrust=SHARES, roll=SHARES, pitch=SHARES, yaw=SHARES)
def test_what_does_not_fit_is_given_up_yaw_first_then_thrust_then_roll_and_pitch(
    thrust: float, roll: float, pitch: float, yaw: float
) -> None:
    outputs, fits = mix(thrust, roll, pitch, yaw, least=LEAST)
    front, right, rear, left = outputs
    assert min(outputs) >= LEAST - 1e-9
    assert max(outputs) <= 1.0 + 1e-9
    given_thrust, given_roll, given_pitch = sum(outputs) / 4.0, (left - right) / 2.0, (front - rear) / 2.0
    given_yaw = (front - right + rear - left) / 4.0
    scale = min(1.0, (1.0 - LEAST) / max(2.0 * abs(roll), 2.0 * abs(pitch), 1e-9))
    # Roll and pitch keep their direction, and their size as far as any outputs can give it.
    assert (given_roll, given_pitch) == pytest.approx((scale * roll, scale * pitch), abs=1e-9)
    reach = max(abs(given_roll), abs(given_pitch))
    assert given_thrust == pytest.approx(min(max(thrust, LEAST + reach), 1.0 - reach), abs=1e-9)
    assert abs(given_yaw) <= abs(yaw) + 1e-9
    assert given_yaw * yaw >= -1e-9
    exact = (given_thrust, given_roll, given_pitch, given_yaw) == pytest.approx((thrust, roll, pitch, yaw), abs=1e-9)
    assert exact or not fits
    if abs(given_yaw) < abs(yaw) - 1e-9:  # then some rotor is at its limit
        assert min(outputs) < LEAST + 1e-9 or max(outputs) > 1.0 - 1e-9


def test_vibration_grows_with_the_rotors_speeds_and_is_none_at_rest() -> None:
    assert vibration_m_s2((0.0,) * 4) == (0.0, 0.0)
    # Four rotors of 3e-6 kg m at the speed of hover, out of phase, on 1.5 kg.
    hover = 9.80665 * 1.5 / (4.0 * SURVEY_ROTORS.lift)
    assert vibration_m_s2((0.5,) * 4)[0] == pytest.approx(3e-6 * hover * np.sqrt(2.0) / 1.5)
