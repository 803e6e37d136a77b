"""What weak rotors make of a command: less thrust, and a turn towards the weak one."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vehicle_sim.dynamics.rotor_weakness import SOUND_ROTORS, weakened
from vehicle_sim.signals import GRAVITY_M_S2, Command, FourRotors

HOVER = Command(GRAVITY_M_S2, (0.0, 0.0, 0.0))
SMALL = st.floats(-0.5, 0.5)


@given(thrust=st.floats(0.5, 1.5), p=SMALL, q=SMALL, r=SMALL)
def test_sound_rotors_give_what_is_asked(thrust: float, p: float, q: float, r: float) -> None:
    command = Command(thrust * GRAVITY_M_S2, (p, q, r))
    given_by = weakened(command, SOUND_ROTORS)
    assert given_by.thrust_m_s2 == pytest.approx(command.thrust_m_s2)
    assert given_by.angular_acceleration_rad_s2 == pytest.approx((p, q, r), abs=1e-9)


@given(share=st.floats(0.0, 1.0))
def test_equal_weakness_only_costs_thrust(share: float) -> None:
    given_by = weakened(HOVER, (share, share, share, share))
    assert given_by.thrust_m_s2 == pytest.approx(share * GRAVITY_M_S2)
    assert given_by.angular_acceleration_rad_s2 == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


@pytest.mark.parametrize(
    ("weak", "signs"),
    [
        ((0.5, 1, 1, 1), (0, -1, -1)),
        ((1, 0.5, 1, 1), (1, 0, 1)),
        ((1, 1, 0.5, 1), (0, 1, -1)),
        ((1, 1, 1, 0.5), (-1, 0, 1)),
    ],
)
def test_the_vehicle_tips_towards_the_weak_rotor(weak: FourRotors, signs: tuple[int, int, int]) -> None:
    given_by = weakened(HOVER, weak)
    assert given_by.thrust_m_s2 == pytest.approx(0.875 * GRAVITY_M_S2)
    assert tuple((turn > 1e-9) - (turn < -1e-9) for turn in given_by.angular_acceleration_rad_s2) == signs
