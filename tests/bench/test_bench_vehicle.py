"""What one step of the vehicle costs, without MAVLink, in turns of a plain loop."""

from functools import partial

import pytest

from tests.support.bare_vehicle import hovering, run
from tests.support.measuring import TURNS, compared, loop
from vehicle_sim.dynamics.airframe import Dynamics
from vehicle_sim.signals import Setpoint

pytestmark = pytest.mark.bench

MOST_TURNS = 4_000


@pytest.mark.parametrize("dynamics", Dynamics)
def test_microseconds_a_step(dynamics: Dynamics) -> None:
    vehicle = hovering(wind_m_s=4.0, dynamics=dynamics)
    n, e, d = vehicle.estimate.position_ned_m
    setpoint = Setpoint(position_ned_m=(n + 5.0, e, d), velocity_ned_m_s=(0.1, 0.0, 0.0))
    took = compared(partial(run, vehicle, 5.0, setpoint), loop, 12)
    step_us, turns = took.times.processor_s / 500 * 1e6, took.units * TURNS / 500
    print(f"\n{dynamics}: {turns:,.0f} turns a step of 10 ms; {step_us:.1f} us, {1e4 / step_us:.0f} x real time")
    assert turns < MOST_TURNS
