"""What a parameter says holds from its acknowledgement on: no step of the vehicle lies between it and a request."""

import math

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import Mode
from vehicle_sim.battery import BatteryLevel
from vehicle_sim.parameters import Flavour, flight_settings

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4
ACCEPTED, FAILED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_FAILED
ARM = mavlink.MAV_CMD_COMPONENT_ARM_DISARM
VELOCITY = 0xDC7


def ready(flavour: Flavour) -> Station:
    station = Station(endpoint_of(flavour))
    station.wait_for_position()
    return station


def mode_of(station: Station) -> Mode:
    return station.endpoint.vehicle.autopilot.mode


def reposition_north(station: Station, metres: float, height_m: float) -> int:
    home = station.endpoint.vehicle.autopilot.home
    assert home is not None
    x, y = round((home.lat_deg + math.degrees(metres / 6.37e6)) * 1e7), round(home.lon_deg * 1e7)
    frame = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT
    return station.command_int(mavlink.MAV_CMD_DO_REPOSITION, frame, (-1, 1, 0, math.nan), (x, y, height_m))


@pytest.mark.parametrize("flavour", Flavour)
def test_each_parameter_is_in_force_with_its_acknowledgement(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    vehicle = station.endpoint.vehicle
    store, autopilot = vehicle.parameters, vehicle.autopilot
    for name in store:
        definition = store.definition(name)
        for value in (definition.minimum, definition.maximum, definition.default):
            if not definition.read_only and -(2**31) <= value < 2**31:
                station.set_parameter(name, value)
                assert autopilot.settings == flight_settings(store), name
                assert autopilot.pilot.hand == autopilot.settings.hand, name
    assert station.command(mavlink.MAV_CMD_PREFLIGHT_STORAGE, 2) == ACCEPTED
    assert autopilot.settings == flight_settings(store)


def test_px4_takes_off_to_the_height_that_has_just_been_set() -> None:
    station = ready(PX4)
    assert station.command(ARM, 1) == ACCEPTED
    station.set_parameter("MIS_TAKEOFF_ALT", 6.0)
    assert station.command(mavlink.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, *(math.nan,) * 4) == ACCEPTED
    station.wait_until(lambda: mode_of(station) is Mode.HOLD, within_s=30.0)
    assert station.height_m() == pytest.approx(6.0, abs=1.0)


def test_px4_judges_its_stream_by_the_age_that_has_just_been_set() -> None:
    station = Station(endpoint_of(PX4))
    station.take_off()
    station.wait_until(lambda: mode_of(station) is Mode.HOLD, within_s=30.0)
    station.setpoint(mask=VELOCITY)
    station.run(0.7)
    station.set_parameter("COM_OF_LOSS_T", 0.5)
    assert station.set_mode(Mode.GUIDED) == ACCEPTED
    assert mode_of(station) is Mode.HOLD
    station.set_parameter("COM_OF_LOSS_T", 1.0)
    assert station.set_mode(Mode.GUIDED) == ACCEPTED
    assert mode_of(station) is Mode.GUIDED


def test_arming_goes_by_what_has_just_been_set_for_battery_and_fence() -> None:
    station = ready(AP)
    battery = station.endpoint.vehicle.battery
    battery.consumed_mah = 50.0
    station.set_parameter("BATT_FS_CRT_ACT", 0)
    station.set_parameter("BATT_CRT_MAH", 4990)
    assert battery.level is BatteryLevel.CRITICAL
    assert station.command(ARM, 1) == FAILED
    station.set_parameter("ARMING_CHECK", 1 << 3)
    assert station.command(ARM, 1) == ACCEPTED
    assert station.command(ARM, 0) == ACCEPTED
    home = station.endpoint.vehicle.autopilot.home
    assert home is not None
    x, y = round((home.lat_deg + math.degrees(60.0 / 6.37e6)) * 1e7), round(home.lon_deg * 1e7)
    place = (x, y, home.alt_m)
    assert station.command_int(mavlink.MAV_CMD_DO_SET_HOME, mavlink.MAV_FRAME_GLOBAL, (0,) * 4, place) == ACCEPTED
    station.set_parameter("FENCE_RADIUS", 40.0)
    station.set_parameter("FENCE_ENABLE", 1)
    assert station.command(ARM, 1) == FAILED
    station.run(0.01)
    assert station.texts()[-1] == "Arm: vehicle outside fence"


def test_places_outside_a_fence_that_has_just_been_set_are_refused() -> None:
    station = Station(endpoint_of(AP))
    station.take_off(8.0)
    assert reposition_north(station, 50.0, 8.0) == ACCEPTED
    station.set_parameter("FENCE_RADIUS", 40.0)
    station.set_parameter("FENCE_ENABLE", 1)
    assert reposition_north(station, 50.0, 8.0) == FAILED
    station.set_parameter("FENCE_ENABLE", 0)
    assert reposition_north(station, 50.0, 8.0) == ACCEPTED


def test_ardupilot_hears_the_ground_station_that_has_just_been_named() -> None:
    station = Station(endpoint_of(AP), system_id=250)
    station.take_off()
    station.set_parameter("FS_GCS_ENABLE", 5)
    station.set_parameter("MAV_GCS_SYSID", 250)
    station.send(mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, 8, 0, 0, 4, 3))
    station.run(4.0)
    assert mode_of(station) is Mode.GUIDED
    station.wait_until(lambda: mode_of(station) is Mode.LAND, within_s=2.0)


def test_a_time_limit_holds_also_for_what_is_flown_already() -> None:
    station = Station(endpoint_of(AP))
    station.take_off(8.0)
    station.setpoint(velocity=(3.0, 0.0, 0.0), mask=VELOCITY)
    station.run(1.0)
    station.set_parameter("GUID_TIMEOUT", 1.2)
    target = station.endpoint.vehicle.autopilot.target
    assert target is not None
    assert target.velocity_ned_m_s[0] == 3.0
    station.run(0.3)
    stopped = station.endpoint.vehicle.autopilot.target
    assert stopped is not None
    assert stopped.velocity_ned_m_s[0] == 0.0


def test_a_landing_that_is_under_way_takes_the_speed_that_has_just_been_set() -> None:
    station = Station(endpoint_of(AP))
    station.take_off(8.0)
    assert station.command(mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH) == ACCEPTED
    autopilot = station.endpoint.vehicle.autopilot
    station.set_parameter("RTL_LOIT_TIME", 0)
    station.wait_until(lambda: autopilot._task.landing, within_s=20.0)
    station.set_parameter("LAND_SPEED", 30)
    station.run(0.1)
    assert autopilot.target is not None
    assert autopilot.target.velocity_ned_m_s[2] == pytest.approx(0.3)
