"""What one step of the vehicle costs, without MAVLink."""

import time

import pytest

from tests.support.bare_vehicle import hovering, run
from vehicle_sim.dynamics.airframe import Dynamics
from vehicle_sim.signals import Setpoint

pytestmark = pytest.mark.bench


@pytest.mark.parametrize("dynamics", Dynamics)
def test_microseconds_a_step(dynamics: Dynamics) -> None:
    vehicle = hovering(wind_m_s=4.0, dynamics=dynamics)
    n, e, d = vehicle.estimate.position_ned_m
    setpoint = Setpoint(position_ned_m=(n + 5.0, e, d), velocity_ned_m_s=(0.1, 0.0, 0.0))
    spans = []
    for _ in range(12):
        start_s = time.process_time()
        run(vehicle, 5.0, setpoint)
        spans.append((time.process_time() - start_s) / 500)
    best, median = min(spans) * 1e6, sorted(spans)[len(spans) // 2] * 1e6
    print(f"\n{dynamics}: {median:.1f} us a step of 10 ms (best {best:.1f}); {1e4 / median:.0f} x real time")
    assert median < 100.0
