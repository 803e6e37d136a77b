"""Calibrations measure what the vehicle was made with, and what they write holds for the next flight."""

from dataclasses import replace

import pytest

from mission.errors import LinkError, VehicleError
from mission.fly import FlightOptions, StopRequest
from mission.fly.calibration import Calibration, calibrate
from mission.spec.loader import parse_mission
from mission.spec.model import MissionSpec
from tests.support.lockstep import LockstepVehicle, vehicle_of
from tests.support.usual_cases import ARDUPILOT
from vehicle_sim.control.controller import PX4_GAINS

FIELD = """\
domain: {boundary: [[-40, -40], [40, -40], [40, 40], [-40, 40]]}
regions: {field: {kind: area, centre: [0, 0], radius_m: 30}}
mission: {formula: "true"}
start: {position_m: [0, 0]}
flight: {speed_m_s: 4, altitude_m: 5}
"""
LANDS = FlightOptions(land_when_stopped=True)


@pytest.fixture
def field() -> MissionSpec:
    return parse_mission(FIELD.encode())


def with_what_is_written(found: Calibration, field: MissionSpec) -> MissionSpec:
    """The field's file with the part that a calibration writes for it."""
    return parse_mission((FIELD.partition("flight:")[0] + found.fragment(field)).encode())


@ARDUPILOT
def test_a_vehicle_as_it_comes_stays_within_the_default_tube(flavour: str, field: MissionSpec) -> None:
    vehicle = LockstepVehicle(vehicle_of(flavour, seed=2, wind_m_s=4.0, wind_from_deg=250.0))
    found = calibrate(field, vehicle, vehicle, options=LANDS)
    assert not vehicle.vehicle.autopilot.armed
    assert found.speed_m_s == pytest.approx(4.0, rel=0.05)
    assert found.position_m.half <= found.position_m.most <= found.position_m.largest <= field.flight.tube_m
    assert found.velocity_m_s.largest <= field.flight.tube_m_s
    assert found.lag_s == pytest.approx(0.0, abs=0.1)
    assert found.drag_per_s == pytest.approx(0.1, abs=0.04)
    # From 250 degrees it blows to the east and a little to the north.
    assert found.wind_m_s == pytest.approx((3.76, 1.37), abs=1.0)
    assert with_what_is_written(found, field).flight.margins == found.margins


@pytest.mark.long
def test_drag_is_measured_and_what_is_written_holds(field: MissionSpec) -> None:
    config = replace(vehicle_of("px4", seed=2, drag_per_s=0.95), gains=PX4_GAINS)
    first = LockstepVehicle(config)
    found = calibrate(field, first, first, options=LANDS)
    assert found.drag_per_s == pytest.approx(0.95, abs=0.1)
    written = with_what_is_written(found, field)
    assert written.flight.margins == found.margins
    again = LockstepVehicle(replace(config, seed=3))
    assert calibrate(written, again, again, options=LANDS).position_m.largest <= written.flight.tube_m


def test_a_calibration_that_is_stopped_measures_nothing_and_lands(field: MissionSpec) -> None:
    vehicle = LockstepVehicle(vehicle_of("ardupilot"))

    def wish() -> StopRequest | None:
        return StopRequest("ended by the test") if vehicle.now_s() > 40.0 else None

    asked: list[StopRequest] = []

    def once() -> StopRequest | None:
        request = None if asked else wish()
        asked.extend([request] if request else [])
        return request

    with pytest.raises(VehicleError, match="nothing was measured: ended by the test"):
        calibrate(field, vehicle, vehicle, options=LANDS, stop_request=once)
    assert not vehicle.vehicle.autopilot.armed


class Silent(LockstepVehicle):
    """Nothing comes from it for two seconds of its flight."""

    def receive(self, within_s: float) -> list[bytes]:
        heard = super().receive(within_s)
        return [] if 40.0 <= self.now_s() < 42.0 else heard


def test_a_link_that_was_silent_for_a_while_measures_nothing(field: MissionSpec) -> None:
    """The vehicle is metres off then, for want of setpoints."""
    vehicle = Silent(vehicle_of("ardupilot"))
    with pytest.raises(LinkError, match="nothing was measured: where it was is unknown for 2"):
        calibrate(field, vehicle, vehicle, options=LANDS)
    assert not vehicle.vehicle.autopilot.armed
