"""Telemetry of what is steered to, against the truth of a flight."""

import math

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.endpoint import Endpoint
from vehicle_sim.protocol.motion import quaternion
from vehicle_sim.vehicle import Vehicle, VehicleConfig

BOTH = pytest.mark.parametrize("flavour", Flavour)


def station_in_wind(flavour: Flavour, wind_m_s: float = 0.0, from_deg: float = 270.0) -> Station:
    config = VehicleConfig(flavour=flavour, wind_m_s=wind_m_s, wind_from_deg=from_deg)
    station = Station(Endpoint(Vehicle(config), flavour))
    station.take_off(8.0)
    station.run(10.0)
    return station


def asked(station: Station, name: str) -> mavlink.MAVLink_message:
    assert station.request(getattr(mavlink, f"MAVLINK_MSG_ID_{name}")) == mavlink.MAV_RESULT_ACCEPTED
    return station.last(name)


@BOTH
def test_the_attitude_target_is_what_the_vehicle_takes_up(flavour: Flavour) -> None:
    station = station_in_wind(flavour, 6.0)
    target, estimate = asked(station, "ATTITUDE_TARGET"), station.endpoint.vehicle.estimate
    assert tuple(target.q) == pytest.approx(quaternion(estimate), abs=0.03)
    assert math.hypot(*target.q) == pytest.approx(1.0, abs=1e-6)
    assert target.thrust == pytest.approx(0.5, abs=0.05)  # the rotors lift twice the weight
    assert target.type_mask == 0b111
    assert abs(estimate.roll_rad) + abs(estimate.pitch_rad) > 0.03


@BOTH
def test_on_the_ground_the_attitude_target_is_level_without_thrust(flavour: Flavour) -> None:
    station = Station(Endpoint(Vehicle(VehicleConfig(flavour=flavour)), flavour))
    station.run(4.0)
    target = asked(station, "ATTITUDE_TARGET")
    yaw = station.endpoint.vehicle.estimate.yaw_rad
    assert tuple(target.q) == pytest.approx((math.cos(yaw / 2), 0, 0, math.sin(yaw / 2)), abs=1e-6)
    assert target.thrust == 0.0


def test_way_and_height_to_the_target() -> None:
    station = station_in_wind(Flavour.ARDUPILOT)
    north, east, down = station.endpoint.vehicle.estimate.position_ned_m
    station.setpoint((north - 30.0, east - 40.0, down - 2.0), mask=0xDF8)
    station.run(0.05)
    output = asked(station, "NAV_CONTROLLER_OUTPUT")
    assert output.wp_dist == pytest.approx(50, abs=1)
    assert output.target_bearing == pytest.approx(-127, abs=1)
    assert output.nav_bearing == output.target_bearing
    assert output.alt_error == pytest.approx(2.0, abs=0.2)
    station.run(1.0)
    output, estimate = asked(station, "NAV_CONTROLLER_OUTPUT"), station.endpoint.vehicle.estimate
    assert (output.nav_roll, output.nav_pitch) == pytest.approx(
        (math.degrees(estimate.roll_rad), math.degrees(estimate.pitch_rad)), abs=4.0
    )
    assert abs(output.nav_pitch) > 2.0


@pytest.mark.parametrize(("from_deg", "shown"), [(270.0, -90.0), (30.0, 30.0)])
def test_the_wind_is_told_as_it_blows(from_deg: float, shown: float) -> None:
    station = station_in_wind(Flavour.ARDUPILOT, 6.0, from_deg)
    wind = asked(station, "WIND")
    assert wind.speed == pytest.approx(6.0, abs=1.5)
    assert math.remainder(wind.direction - shown, 360.0) == pytest.approx(0.0, abs=15.0)
    assert wind.speed_z == 0.0


def test_before_it_flies_no_wind_is_known() -> None:
    station = Station(Endpoint(Vehicle(VehicleConfig(wind_m_s=6.0)), Flavour.ARDUPILOT))
    station.run(1.0)
    assert asked(station, "WIND").speed == 0.0


def test_simstate_is_the_truth_and_no_estimate() -> None:
    station = station_in_wind(Flavour.ARDUPILOT, 4.0)
    state, vehicle = asked(station, "SIMSTATE"), station.endpoint.vehicle
    truth, place = vehicle.truth, vehicle.true_place
    assert (state.roll, state.pitch) == pytest.approx((truth.roll_rad, truth.pitch_rad), abs=1e-6)
    assert math.remainder(state.yaw - truth.yaw_rad, math.tau) == pytest.approx(0.0, abs=1e-6)
    assert (state.xacc, state.yacc, state.zacc) == pytest.approx(truth.specific_force_m_s2, abs=1e-4)
    assert (state.lat, state.lng) == (round(place.lat_deg * 1e7), round(place.lon_deg * 1e7))


def test_ahrs_tells_the_drift_that_is_taken_out() -> None:
    station = station_in_wind(Flavour.ARDUPILOT)
    message, vehicle = asked(station, "AHRS"), station.endpoint.vehicle
    true_bias = vehicle._sensors._gyro_bias
    assert (message.omegaIx, message.omegaIy, message.omegaIz) == pytest.approx(true_bias, abs=1e-3)
    assert 0.0 <= message.error_rp < 0.02
    assert 0.0 <= message.error_yaw < 0.2
