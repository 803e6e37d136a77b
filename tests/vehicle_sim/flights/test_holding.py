"""Holding a place: braking, wind, and the same flight from the same seed."""

import numpy as np
import pytest

from tests.support.bare_vehicle import hovering, place, run
from vehicle_sim.autopilot import Outcome
from vehicle_sim.parameters import Flavour
from vehicle_sim.signals import Setpoint

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4
BOTH = pytest.mark.parametrize("flavour", [AP, PX4])


def test_holding_brakes_without_coming_back() -> None:
    vehicle = hovering()
    run(vehicle, 6.0, Setpoint(velocity_ned_m_s=(8.0, 0.0, 0.0)))
    assert vehicle.autopilot.hold() is Outcome.ACCEPTED
    farthest = 0.0
    for _ in range(1000):
        vehicle.step()
        farthest = max(farthest, vehicle.truth.position_ned_m[0])
    assert farthest - vehicle.truth.position_ned_m[0] < 0.5
    assert abs(vehicle.truth.velocity_ned_m_s[0]) < 0.2


@pytest.mark.parametrize("wind_m_s", [0.0, 8.0])
def test_wind_does_not_carry_it_away(wind_m_s: float) -> None:
    vehicle = hovering(wind_m_s=wind_m_s)
    run(vehicle, 10.0)
    start = np.array(vehicle.truth.position_ned_m)
    run(vehicle, 20.0)
    assert np.linalg.norm(np.array(vehicle.truth.position_ned_m) - start) < 1.0


@BOTH
def test_the_same_seed_gives_the_same_flight(flavour: Flavour) -> None:
    def flown(seed: int) -> list[object]:
        vehicle = hovering(flavour, seed=seed, wind_m_s=4.0)
        vehicle.autopilot.reposition(place(vehicle, north=5.0))
        rows: list[object] = []
        for _ in range(200):
            vehicle.step()
            rows.append((vehicle.truth, vehicle.estimate, vehicle.readings, vehicle.battery.voltage_v))
        return rows

    assert flown(3) == flown(3)
    assert flown(3) != flown(4)
