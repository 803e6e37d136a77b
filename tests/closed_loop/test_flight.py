"""Planner, session and vehicle in one process, in lock-step: whole flights, deterministic to the byte."""

import io
from pathlib import Path
from typing import NamedTuple

import pytest

from mission.errors import VehicleError
from mission.fly import FlightResult, fly
from mission.link.ending import Ending
from mission.plan import FlightPlan, plan_mission
from mission.report.reading import Record, parse_record
from mission.report.record import FlightRecord
from mission.spec.loader import load_mission
from tests.support.lockstep import LockstepVehicle, vehicle_of
from tests.support.small_missions import SMALL, at_a_place, plan_of
from tests.support.usual_cases import EACH, PX4

MISSIONS = Path(__file__).parents[2] / "missions"


@pytest.fixture(scope="module")
def plan() -> FlightPlan:
    return plan_of(SMALL)


class Flown(NamedTuple):
    """A flight as it ended."""

    vehicle: LockstepVehicle
    result: FlightResult
    data: bytes


@pytest.fixture(scope="module", params=["ardupilot", "px4"])
def usual(request: pytest.FixtureRequest, plan: FlightPlan) -> Flown:
    """The small mission, flown once with seed 5 by each flavour."""
    vehicle = LockstepVehicle(vehicle_of(request.param, 5))
    return Flown(vehicle, *flown(plan, vehicle))


def flown(plan: FlightPlan, vehicle: LockstepVehicle) -> tuple[FlightResult, bytes]:
    sink = io.BytesIO()
    result = fly(plan, vehicle, vehicle, FlightRecord(sink, mission="small"))
    return result, sink.getvalue()


def on_the_way(record: Record) -> bool:
    """Whether setpoints came at 20 Hz or more of vehicle time."""
    return record.verdict is not None and record.verdict["median_gap_s"] <= 0.05


def test_the_mission_is_achieved(plan: FlightPlan, usual: Flown) -> None:
    vehicle, result, data = usual
    assert result.achieved, result.reason
    assert result.ending is Ending.LANDED
    assert not vehicle.vehicle.autopilot.armed
    assert vehicle.vehicle.truth.on_ground
    record = parse_record(data)
    assert on_the_way(record)
    assert record.track.position_m[:, 2].max() == pytest.approx(plan.spec.flight.altitude_m, abs=1.0)
    assert not [event for event in record.events if event.text == "violation"]


def test_the_same_seed_twice_is_the_same_record_byte_for_byte(plan: FlightPlan, usual: Flown) -> None:
    flavour = usual.vehicle.vehicle.config.flavour
    second, other = (flown(plan, LockstepVehicle(vehicle_of(flavour, seed)))[1] for seed in (5, 6))
    assert usual.data == second
    assert usual.data != other


@PX4
def test_a_mission_with_a_place_is_flown_at_that_place(flavour: str) -> None:
    placed = plan_of(at_a_place(47.397742, 8.545594))
    # The vehicle boots about 12 m east and 14 m north of the domain's origin, which is not the mission's start.
    config = vehicle_of(flavour, home_lat_deg=47.397742 + 14.0 / 111_180.0, home_lon_deg=8.545594 + 12.0 / 75_470.0)
    result, data = flown(placed, LockstepVehicle(config))
    assert result.achieved, result.reason
    assert result.plan.start_m == pytest.approx((12.0, 14.0), abs=2.0)
    assert parse_record(data).track.position_m[0][:2] == pytest.approx((12.0, 14.0), abs=2.0)


def test_wind_is_held_against(plan: FlightPlan) -> None:
    result, _ = flown(plan, LockstepVehicle(vehicle_of("ardupilot", wind_m_s=3.0, wind_from_deg=270.0)))
    assert result.achieved, result.reason
    assert result.largest_distance_m < 2.0


def test_a_flight_that_ends_in_the_air_by_the_vehicles_own_failsafe(plan: FlightPlan) -> None:
    def drain(lockstep: LockstepVehicle) -> None:
        if lockstep.vehicle.time_s > 25.0:
            lockstep.vehicle.autopilot.return_to_launch()

    result, _ = flown(plan, LockstepVehicle(vehicle_of("px4"), at_step=drain))
    assert not result.achieved
    assert result.ending is Ending.HANDED_OVER


def test_lost_setpoints_are_the_vehicles_failsafe_and_not_fought(plan: FlightPlan) -> None:
    class Cut(LockstepVehicle):
        """Its uplink dies at 25 s."""

        def send(self, data: bytes) -> None:
            if self.vehicle.time_s < 25.0:
                super().send(data)

    vehicle = Cut(vehicle_of("px4"))
    with pytest.raises(VehicleError, match="failsafe"):
        flown(plan, vehicle)


@pytest.mark.parametrize(
    ("flavour", "parameters", "words"),
    [
        ("ardupilot", {"FENCE_ENABLE": 1, "FENCE_TYPE": 1, "FENCE_ALT_MAX": 10}, "RTL.*Max Alt fence breached"),
        ("px4", {"GF_MAX_VER_DIST": 4}, "AUTO.LOITER.*Geofence"),
    ],
)
def test_a_breach_of_the_vehicles_fence_ends_the_flight_and_is_not_fought(
    flavour: str, parameters: dict[str, float], words: str
) -> None:
    """ArduPilot's heartbeat does not call a breach a failsafe; its own words do."""

    def fence(lockstep: LockstepVehicle) -> None:
        if lockstep.vehicle.time_s > 25.0:
            for name, value in parameters.items():
                lockstep.vehicle.parameters.set(name, value)

    plan = plan_of(SMALL.replace("altitude_m: 6", "altitude_m: 12"))
    vehicle = LockstepVehicle(vehicle_of(flavour), at_step=fence)
    with pytest.raises(VehicleError, match=f"a failsafe put the vehicle into {words}"):
        flown(plan, vehicle)
    sent = vehicle.sent
    vehicle.receive(1.0)
    assert vehicle.sent == sent


@pytest.mark.long
@EACH
def test_the_papers_mission_twice_is_the_same_record(flavour: str) -> None:
    plan = plan_mission(load_mission(MISSIONS / "paper.yaml"))
    first, second = (flown(plan, LockstepVehicle(vehicle_of(flavour)))[1] for _ in range(2))
    assert first == second
    assert parse_record(first).verdict is not None
