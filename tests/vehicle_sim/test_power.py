"""What the motors draw: more in a climb and against the air; alike with either dynamics."""

from math import hypot

import numpy as np
import pytest

from tests.support.bare_vehicle import hovering, run
from vehicle_sim.dynamics.airframe import Airframe, Dynamics
from vehicle_sim.dynamics.hover import DRAG_PER_S, VERTICAL_DRAG_PER_S, Hover
from vehicle_sim.dynamics.quadrotor import Quadrotor
from vehicle_sim.signals import GRAVITY_M_S2, Command

STEP_S = 0.01
HOVER_W, MASS_KG, EFFICIENCY = 140.0, 1.5, 0.8


def drawn_w(thrust_m_s2: float, work_w_kg: float) -> float:
    return HOVER_W * float((thrust_m_s2 / GRAVITY_M_S2) ** 1.5) + MASS_KG * work_w_kg / EFFICIENCY


@pytest.mark.parametrize("airframe", [Hover(step_s=STEP_S), Quadrotor(step_s=STEP_S)], ids=["hover", "quadrotor"])
@pytest.mark.parametrize("climb_m_s", [3.0, -0.5])
def test_a_climb_takes_its_power_and_a_descent_wins_none(airframe: Airframe, climb_m_s: float) -> None:
    thrust = GRAVITY_M_S2 + VERTICAL_DRAG_PER_S * 3.0
    share = thrust / (2.0 * GRAVITY_M_S2)
    for _ in range(4000):
        airframe.step(Command(thrust, (0.0, 0.0, 0.0), (share,) * 4), (0.0, 0.0, 0.0))
    if climb_m_s < 0.0:
        thrust = GRAVITY_M_S2 + VERTICAL_DRAG_PER_S * climb_m_s
        share = thrust / (2.0 * GRAVITY_M_S2)
        for _ in range(4000):
            airframe.step(Command(thrust, (0.0, 0.0, 0.0), (share,) * 4), (0.0, 0.0, 0.0))
    assert airframe.motion.velocity_ned_m_s[2] == pytest.approx(-climb_m_s, abs=0.01)
    assert airframe.power_w == pytest.approx(drawn_w(thrust, thrust * max(climb_m_s, 0.0)), rel=0.05)


@pytest.mark.parametrize("dynamics", list(Dynamics))
@pytest.mark.parametrize("wind_m_s", [0.0, 10.0])
def test_to_hover_in_wind_takes_as_much_as_to_fly_in_calm_air(dynamics: Dynamics, wind_m_s: float) -> None:
    vehicle = hovering(dynamics=dynamics)
    vehicle.parameters.set("SIM_WIND_SPD", wind_m_s)
    run(vehicle, 8.0)
    seen = []
    for _ in range(30):
        run(vehicle, 0.1)
        seen.append(vehicle.airframe.power_w)
    drag_m_s2 = DRAG_PER_S * wind_m_s
    thrust = hypot(GRAVITY_M_S2, drag_m_s2)
    assert np.mean(seen) == pytest.approx(drawn_w(thrust, drag_m_s2 * wind_m_s), rel=0.05)
