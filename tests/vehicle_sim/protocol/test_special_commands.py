"""Commands of rare pages: what to look at, circles, following, tests of motors, servos; each flavour's answers."""

from math import atan2, degrees, hypot, nan

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import Mode
from vehicle_sim.geodesy import geodetic_at
from vehicle_sim.parameters import Flavour

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4
ACCEPTED, REJECTED, DENIED, UNSUPPORTED, FAILED = range(5)
UNANSWERED = -1


@pytest.mark.parametrize(
    ("name", "ardupilot", "px4"),
    [
        ("DO_SET_ROI_NONE", ACCEPTED, ACCEPTED),
        ("DO_SET_ROI_LOCATION", FAILED, ACCEPTED),  # ArduPilot wants a place
        ("DO_SET_ROI_WPNEXT_OFFSET", UNSUPPORTED, ACCEPTED),
        ("DO_SET_ROI_SYSID", FAILED, UNSUPPORTED),
        ("DO_ORBIT", UNSUPPORTED, ACCEPTED),
        ("DO_CHANGE_ALTITUDE", UNSUPPORTED, REJECTED),
        ("DO_FOLLOW", UNSUPPORTED, UNSUPPORTED),
        ("DO_MOTOR_TEST", FAILED, UNSUPPORTED),
        ("ACTUATOR_TEST", UNSUPPORTED, UNSUPPORTED),
        ("DO_SET_SERVO", FAILED, UNSUPPORTED),
        ("DO_GRIPPER", ACCEPTED, UNANSWERED),
        ("DO_SET_ACTUATOR", UNSUPPORTED, ACCEPTED),
        ("DO_LAND_START", FAILED, UNSUPPORTED),
    ],
)
def test_answers_without_parameters(name: str, ardupilot: int, px4: int) -> None:
    command = getattr(mavlink, f"MAV_CMD_{name}")
    assert Station(endpoint_of(AP)).command(command) == ardupilot
    assert Station(endpoint_of(PX4)).command(command) == px4


def pulses(station: Station) -> list[int]:
    station.request(mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW)
    message = station.last("SERVO_OUTPUT_RAW")
    return [getattr(message, f"servo{number}_raw") for number in range(1, 10)]


def test_ardupilot_tests_motors_one_after_another() -> None:
    station = Station(endpoint_of(AP))
    station.run(0.1)
    assert station.command(mavlink.MAV_CMD_DO_MOTOR_TEST, 4, 0, 20, 0.5, 2) == ACCEPTED
    assert "starting motor test" in station.texts()
    assert pulses(station)[:4] == [1000, 1000, 1000, 1200]
    station.run(0.55)
    assert pulses(station)[:4] == [1200, 1000, 1000, 1000]
    station.run(0.5)
    assert pulses(station)[:4] == [1000] * 4
    for wrong in ((5, 0, 20, 1, 1), (1, 0, 120, 1, 1), (1, 2, 20, 1, 1), (nan, 0, 20, 1, 1)):
        assert station.command(mavlink.MAV_CMD_DO_MOTOR_TEST, *wrong) == FAILED


def test_px4_tests_actuators_by_their_function() -> None:
    station = Station(endpoint_of(PX4))
    station.run(0.1)
    test = mavlink.MAV_CMD_ACTUATOR_TEST
    assert station.command(test, 0.15, 1.0, 0, 0, 1102) == ACCEPTED
    assert station.command(test, 0.3, 9.0, 0, 0, 1) == ACCEPTED
    assert pulses(station)[:4] == [1300, 1150, 1000, 1000]
    station.run(1.1)
    assert pulses(station)[:4] == [1300, 1000, 1000, 1000]
    station.run(2.0)  # no test is longer than three seconds
    assert pulses(station)[:4] == [1000] * 4
    assert station.command(test, 0.15, 1.0, 0, 0, 77) == UNSUPPORTED
    station.wait_for_position()
    assert station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1) == ACCEPTED
    assert station.command(test, 0.15, 1.0, 0, 0, 1102) == DENIED


def test_ardupilots_servos_stay_where_they_were_set() -> None:
    station = Station(endpoint_of(AP))
    assert station.command(mavlink.MAV_CMD_DO_SET_SERVO, 2, 1500) == FAILED
    assert station.texts()[-1] == "ServoRelayEvent: Channel 2 is already in use"
    assert station.command(mavlink.MAV_CMD_DO_SET_SERVO, 9, 1700) == ACCEPTED
    assert pulses(station)[8] == 1700
    assert station.command(mavlink.MAV_CMD_DO_SET_SERVO, nan, 1700) == FAILED


def lat_lon(station: Station, north_m: float, east_m: float) -> tuple[float, float]:
    place = geodetic_at(station.endpoint.vehicle.config.home, (north_m, east_m, 0.0))
    return place.lat_deg, place.lon_deg


def test_ardupilot_looks_at_a_place_until_there_is_none() -> None:
    station = Station(endpoint_of(AP))
    station.take_off(5.0)
    place = lat_lon(station, 0.0, 50.0)
    assert station.command(mavlink.MAV_CMD_DO_SET_ROI_LOCATION, 0, 0, 0, 0, *place, 0) == ACCEPTED
    station.run(5.0)
    assert degrees(station.endpoint.vehicle.truth.yaw_rad) == pytest.approx(90.0, abs=6.0)
    assert station.command(mavlink.MAV_CMD_DO_SET_ROI_NONE) == ACCEPTED


def distance_m(station: Station, north_m: float, east_m: float) -> float:
    north, east, _down = station.endpoint.vehicle.truth.position_ned_m
    return hypot(north - north_m, east - east_m)


@pytest.mark.parametrize("radius_m", [8.0, -8.0])
def test_px4_flies_circles_round_a_place(radius_m: float) -> None:
    station = Station(endpoint_of(PX4))
    station.take_off(5.0)
    station.wait_until(lambda: station.endpoint.vehicle.autopilot.mode is Mode.HOLD, within_s=10.0)
    place = lat_lon(station, 10.0, 0.0)
    assert station.command(mavlink.MAV_CMD_DO_ORBIT, radius_m, 2.0, 0, 0, *place, nan) == ACCEPTED
    station.run(12.0)
    assert distance_m(station, 10.0, 0.0) == pytest.approx(8.0, abs=1.0)
    north, east, _down = station.endpoint.vehicle.truth.position_ned_m
    before = atan2(east, north - 10.0)
    station.run(1.0)
    north, east, _down = station.endpoint.vehicle.truth.position_ned_m
    turned = (degrees(atan2(east, north - 10.0) - before) + 180.0) % 360.0 - 180.0
    assert turned * radius_m > 0.0
    assert station.request(mavlink.MAVLINK_MSG_ID_ORBIT_EXECUTION_STATUS) == ACCEPTED
    status = station.last("ORBIT_EXECUTION_STATUS")
    assert (status.radius, status.x) == (radius_m, pytest.approx(place[0] * 1e7, abs=20.0))
    station.set_mode(Mode.HOLD)
    assert station.request(mavlink.MAVLINK_MSG_ID_ORBIT_EXECUTION_STATUS) == station.endpoint.table.no_message


def test_ardupilots_circle_lies_ahead() -> None:
    station = Station(endpoint_of(AP))
    station.take_off(5.0)
    radius_m = station.endpoint.vehicle.parameters["CIRCLE_RADIUS"] / 100.0
    assert station.set_mode(Mode.CIRCLE) == ACCEPTED
    station.run(8.0)
    assert distance_m(station, radius_m, 0.0) == pytest.approx(radius_m, abs=1.5)
    assert distance_m(station, 0.0, 0.0) > 3.0


def test_px4_changes_its_height_alone() -> None:
    station = Station(endpoint_of(PX4))
    station.take_off(5.0)
    home = station.endpoint.vehicle.autopilot.home
    assert home is not None
    change = mavlink.MAV_CMD_DO_CHANGE_ALTITUDE
    assert station.command(change, home.alt_m + 8.0, mavlink.MAV_FRAME_GLOBAL) == ACCEPTED
    station.run(6.0)
    assert station.height_m() == pytest.approx(8.0, abs=1.0)
    assert distance_m(station, 0.0, 0.0) < 1.0


def test_px4_follows_whoever_tells_where_he_is() -> None:
    station = Station(endpoint_of(PX4))
    station.take_off(5.0)
    assert station.set_mode(Mode.FOLLOW) == ACCEPTED
    lat_deg, lon_deg = lat_lon(station, 20.0, 0.0)
    zeros = ([0.0] * 3, [1.0, 0.0, 0.0, 0.0], [0.0] * 3, [0.0] * 3)
    for _ in range(10):
        target = (0, 0, round(lat_deg * 1e7), round(lon_deg * 1e7), 0.0, [0.0, 2.0, 0.0])
        station.send(mavlink.MAVLink_follow_target_message(*target, *zeros, 0))
        station.run(1.0)
    assert distance_m(station, 20.0, -8.0) < 1.5  # behind one who goes east
    assert station.height_m() == pytest.approx(5.0, abs=1.0)


def test_wind_is_told_where_it_is_known() -> None:
    station = Station(endpoint_of(PX4))
    assert station.request(mavlink.MAVLINK_MSG_ID_WIND_COV) == station.endpoint.table.no_message
    station.take_off(3.0)
    assert station.request(mavlink.MAVLINK_MSG_ID_WIND_COV) == ACCEPTED
    assert abs(station.last("WIND_COV").wind_x) < 2.0
