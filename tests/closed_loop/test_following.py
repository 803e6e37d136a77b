"""A vehicle that follows late is kept within what was proved, by what is asked of it and by when."""

import io
from dataclasses import replace
from pathlib import Path

import pytest

from mission.fly import FlightResult, fly
from mission.plan import FlightPlan, plan_mission
from mission.report.record import FlightRecord
from mission.spec.loader import load_mission
from tests.support.lockstep import LockstepVehicle, as_it_comes
from tests.support.usual_cases import sampled
from vehicle_sim.vehicle import VehicleConfig

MISSIONS = Path(__file__).parents[2] / "missions"
_LANDING_S = 40.0


def flown(plan: FlightPlan, config: VehicleConfig) -> FlightResult:
    vehicle = LockstepVehicle(config)
    return fly(plan, vehicle, vehicle, FlightRecord(io.BytesIO(), mission="following"))


@pytest.fixture(scope="module")
def survey() -> FlightPlan:
    return plan_mission(load_mission(MISSIONS / "survey.yaml"))


@sampled(("wind_m_s", "longer_s"), [(0.0, 5.0), (4.0, 150.0)], [(0.0, 5.0)])
def test_survey_is_flown_within_its_proof_with_drag_like_px4s_simulator(
    survey: FlightPlan, wind_m_s: float, longer_s: float
) -> None:
    """Without any correction it was followed with 1.2 m at worst, and in PX4's own simulator with 1.7 to 2.0 m.

    In calm air it is not made so by slowing down. Against the wind, the tilt that the mission allows is not enough for
    its speed.
    """
    result = flown(survey, as_it_comes("px4", 5, wind_m_s=wind_m_s, wind_from_deg=250.0))
    assert result.achieved, result.reason
    assert result.largest_error_m <= 0.6
    assert result.beyond_tube_s <= 0.1
    assert result.began_s is not None
    assert result.ended_s is not None
    assert result.ended_s - result.began_s < survey.trajectory.duration_s + longer_s + _LANDING_S


@pytest.mark.long
def test_what_no_vehicle_can_fly_is_flown_more_slowly() -> None:
    """At 8 m/s that drag alone asks for a lean of 38 degrees, and the mission allows 25."""
    spec = replace(load_mission(MISSIONS / "farm.yaml"), origin=None)
    plan = plan_mission(spec)
    result = flown(plan, as_it_comes("px4", 5, wind_m_s=4.0, wind_from_deg=250.0))
    assert result.achieved, result.reason
    assert result.largest_error_m <= plan.certificate.tube_m
