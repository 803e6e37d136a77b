"""Flights in steady wind end where they should, on the ground and disarmed."""

import io
from dataclasses import replace
from itertools import product
from pathlib import Path

import pytest

from mission.fly import fly
from mission.plan import plan_mission
from mission.report.record import FlightRecord
from mission.spec.loader import load_mission
from tests.support.lockstep import LockstepVehicle, vehicle_of
from tests.support.usual_cases import sampled
from vehicle_sim.dynamics.airframe import Dynamics

MISSIONS = Path(__file__).parents[2] / "missions"


BLOWING = (("ardupilot", 9.4, 330.0), ("px4", 12.0, 90.0))


@sampled(
    ("flavour", "wind_m_s", "from_deg", "dynamics"),
    [(*wind, dynamics) for wind, dynamics in product(BLOWING, Dynamics)],
    [(*wind, dynamics) for wind, dynamics in zip(BLOWING, Dynamics, strict=True)],
)
def test_a_mission_is_achieved_in_strong_wind(
    flavour: str, wind_m_s: float, from_deg: float, dynamics: Dynamics
) -> None:
    plan = plan_mission(load_mission(MISSIONS / "response.yaml"))
    config = vehicle_of(flavour, seed=3, wind_m_s=wind_m_s, wind_from_deg=from_deg)
    vehicle = LockstepVehicle(replace(config, dynamics=dynamics))
    result = fly(plan, vehicle, vehicle, FlightRecord(io.BytesIO(), mission="windy"))
    assert result.achieved, result.reason
    assert result.largest_error_m <= plan.certificate.tube_m
    assert not vehicle.vehicle.autopilot.armed
    motion = vehicle.vehicle.truth
    assert motion.on_ground
    assert motion.roll_rad == pytest.approx(0.0)
    assert motion.pitch_rad == pytest.approx(0.0)
    assert vehicle.vehicle.estimate.roll_rad == pytest.approx(0.0, abs=0.02)
