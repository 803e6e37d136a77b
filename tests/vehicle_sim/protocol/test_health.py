"""Health as clients read it: states of the heartbeat, estimator, landed state, home, clocks."""

from itertools import pairwise

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import Mode
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.flavour import TABLES, Rates

ACCEPTED = mavlink.MAV_RESULT_ACCEPTED
ARM = mavlink.MAV_CMD_COMPONENT_ARM_DISARM
SET = mavlink.MAV_CMD_SET_MESSAGE_INTERVAL
BOTH = pytest.mark.parametrize("flavour", Flavour)


def state_of(station: Station) -> int:
    station.request(mavlink.MAVLINK_MSG_ID_HEARTBEAT)
    return int(station.last("HEARTBEAT").system_status)


@BOTH
def test_the_heartbeat_is_standby_active_and_critical(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    name, timeout = ("NAV_DLL_ACT", 1) if flavour is Flavour.PX4 else ("FS_GCS_ENABLE", 5)
    assert state_of(station) == mavlink.MAV_STATE_STANDBY
    station.take_off()
    assert state_of(station) == mavlink.MAV_STATE_ACTIVE
    station.endpoint.vehicle.parameters.set(name, timeout)
    station.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
    station.run(1.0)
    assert state_of(station) == mavlink.MAV_STATE_ACTIVE
    station.run(11.0)
    assert state_of(station) == mavlink.MAV_STATE_CRITICAL


def test_an_empty_battery_is_an_emergency_of_px4() -> None:
    station = Station(endpoint_of(Flavour.PX4))
    station.take_off()
    station.endpoint.vehicle.parameters.set("BAT1_CAPACITY", 100)
    station.wait_until(lambda: state_of(station) == mavlink.MAV_STATE_EMERGENCY, within_s=60.0)
    station.request(mavlink.MAVLINK_MSG_ID_BATTERY_STATUS)
    assert station.last("BATTERY_STATUS").charge_state == mavlink.MAV_BATTERY_CHARGE_STATE_EMERGENCY


def test_the_estimator_of_ardupilot_says_when_it_is_ready() -> None:
    """dronekit's `ekf_ok`: an absolute or predicted horizontal position, and no constant-position mode."""
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    for message_id in (mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT, mavlink.MAVLINK_MSG_ID_GPS_RAW_INT):
        station.command(SET, message_id, 200_000)
    station.wait_for_position()
    station.run(0.5)
    flags = [report.flags for report in station.of("EKF_STATUS_REPORT")]
    assert not flags[0] & mavlink.EKF_POS_HORIZ_ABS
    assert flags[0] & mavlink.EKF_UNINITIALIZED
    assert flags[-1] & mavlink.EKF_POS_HORIZ_ABS
    assert flags[-1] & mavlink.EKF_PRED_POS_HORIZ_ABS
    assert not flags[-1] & mavlink.EKF_CONST_POS_MODE
    fixes = [fix.fix_type for fix in station.of("GPS_RAW_INT")]
    assert (fixes[0], fixes[-1]) == (1, 3)
    assert [text for text in station.texts() if text.startswith("EKF3")] == [
        "EKF3 IMU0 initialised",
        "EKF3 IMU0 tilt alignment complete",
        "EKF3 IMU0 MAG0 initial yaw alignment complete",
        "EKF3 IMU0 origin set",
        "EKF3 IMU0 is using GPS",
    ]


def test_armed_before_the_position_is_usable_ardupilot_refuses_guided_and_take_off() -> None:
    """The trap that clients fall into: armed does not mean that it can take off."""
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    vehicle = station.endpoint.vehicle
    station.wait_until(lambda: vehicle.estimate.status.attitude_ok, within_s=10.0)
    assert not vehicle.estimate.status.position_ok
    assert station.command(ARM, 1, 21196) == ACCEPTED
    assert station.set_mode(Mode.GUIDED) == mavlink.MAV_RESULT_FAILED
    assert station.command(mavlink.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 5) == mavlink.MAV_RESULT_FAILED
    assert vehicle.autopilot.mode is Mode.STABILIZE


@BOTH
def test_landed_states_in_their_order(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.command(SET, mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE, 50_000)
    station.take_off(6.0)
    station.run(6.0)
    assert station.command(mavlink.MAV_CMD_NAV_LAND) == ACCEPTED
    vehicle = station.endpoint.vehicle
    station.wait_until(lambda: not vehicle.autopilot.armed, within_s=60.0)
    station.run(0.2)
    just_after = station.last("EXTENDED_SYS_STATE").landed_state
    # ArduPilot goes on landing for a moment after it has disarmed.
    assert just_after == (4 if flavour is Flavour.ARDUPILOT else 1)
    station.run(1.0)
    states = [message.landed_state for message in station.of("EXTENDED_SYS_STATE")]
    assert [now for before, now in zip([0, *states], states, strict=False) if before != now] == [1, 3, 2, 4, 1]


@BOTH
def test_home_is_told_when_it_is_found_and_when_the_vehicle_is_armed(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.wait_for_position()
    station.run(0.5)
    assert len(station.of("HOME_POSITION")) == 1
    station.forget()
    assert station.command(ARM, 1) == ACCEPTED
    station.run(0.1)
    (told,) = station.of("HOME_POSITION")
    station.request(mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT)
    place = station.last("GLOBAL_POSITION_INT")
    assert (told.latitude, told.longitude) == pytest.approx((place.lat, place.lon), abs=30)
    station.request(mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN)
    origin = station.last("GPS_GLOBAL_ORIGIN")
    assert (told.latitude, told.longitude) != (origin.latitude, origin.longitude)


@BOTH
def test_every_message_tells_the_same_time_since_boot(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.take_off()
    station.forget()
    for message_id in mavlink.mavlink_map:
        if station.endpoint.has_telemetry(message_id):
            station.request(message_id)
    now_us = station.endpoint.now_us
    stamped = 0
    for message in station.heard:
        names = set(message.get_fieldnames())
        if "time_boot_ms" in names:
            assert message.time_boot_ms * 1000 == pytest.approx(now_us, abs=1000), message
            stamped += 1
        elif "time_usec" in names and message.get_type() != "GPS_RAW_INT":  # that is when the receiver measured
            assert message.time_usec == now_us, message
            stamped += 1
    assert stamped > 12


def test_system_time_is_sent_once_a_second_and_its_date_runs_with_the_clock() -> None:
    station = Station(endpoint_of(Flavour.PX4), rates=Rates.ONBOARD)
    station.run(20.0)
    times = station.of("SYSTEM_TIME")
    assert len(times) == pytest.approx(20, abs=1)
    assert {after.time_boot_ms - before.time_boot_ms for before, after in pairwise(times)} == {1000}
    known = [message for message in times if message.time_unix_usec]
    assert known
    assert len({message.time_unix_usec - message.time_boot_ms * 1000 for message in known}) == 1


NORMAL = {
    "ATTITUDE": 15, "VFR_HUD": 4, "GLOBAL_POSITION_INT": 5, "GPS_RAW_INT": 5, "LOCAL_POSITION_NED": 1, "SYS_STATUS": 1,
    "EXTENDED_SYS_STATE": 1, "BATTERY_STATUS": 0.5, "HOME_POSITION": 0.5, "ESTIMATOR_STATUS": 0.5,
    "POSITION_TARGET_LOCAL_NED": 1.5, "ATTITUDE_TARGET": 2, "RC_CHANNELS": 5, "SERVO_OUTPUT_RAW": 1, "ALTITUDE": 1,
    "CURRENT_MODE": 0.5, "GPS_GLOBAL_ORIGIN": 0, "PING": 0.1, "VIBRATION": 0.1,
}  # fmt: skip
ONBOARD = {
    "TIMESYNC": 10, "ATTITUDE": 100, "ATTITUDE_QUATERNION": 50, "HIGHRES_IMU": 50, "GLOBAL_POSITION_INT": 50,
    "LOCAL_POSITION_NED": 30, "ODOMETRY": 30, "VFR_HUD": 10, "SYS_STATUS": 5, "EXTENDED_SYS_STATE": 5,
    "POSITION_TARGET_LOCAL_NED": 10, "SYSTEM_TIME": 1, "PING": 1,
}  # fmt: skip


@pytest.mark.parametrize(("rates", "observed"), [(Rates.GROUND_STATION, NORMAL), (Rates.ONBOARD, ONBOARD)])
def test_rates_of_px4_as_observed(rates: Rates, observed: dict[str, float]) -> None:
    station = Station(endpoint_of(Flavour.PX4), rates=rates)
    station.take_off()
    station.forget()
    station.run(10.0)
    for name, hertz in observed.items():
        assert len(station.of(name)) == pytest.approx(10.0 * hertz, abs=1.1), name


GROUPS = {
    1: {"RAW_IMU", "SCALED_PRESSURE"},
    2: {"SYS_STATUS", "POWER_STATUS", "MISSION_CURRENT", "GPS_RAW_INT", "NAV_CONTROLLER_OUTPUT"},
    3: {"SERVO_OUTPUT_RAW", "RC_CHANNELS"},
    6: {"GLOBAL_POSITION_INT", "LOCAL_POSITION_NED"},
    10: {"ATTITUDE", "SIMSTATE"},
    11: {"VFR_HUD"},
    12: {"AHRS", "WIND", "SYSTEM_TIME", "BATTERY_STATUS", "EKF_STATUS_REPORT", "VIBRATION"},
}
IN_NO_GROUP = {"EXTENDED_SYS_STATE", "HOME_POSITION", "POSITION_TARGET_LOCAL_NED", "ATTITUDE_TARGET"}


def test_groups_of_ardupilot_as_observed() -> None:
    groups = {
        stream: {mavlink.mavlink_map[message_id].msgname for message_id in ids}
        for stream, ids in TABLES[Flavour.ARDUPILOT].stream_groups.items()
    }
    for stream, observed in GROUPS.items():
        assert observed <= groups[stream]
    assert not IN_NO_GROUP & set().union(*groups.values())


@pytest.mark.parametrize("flavour", Flavour)
def test_extended_parameters_are_a_matter_of_cameras(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.send(mavlink.MAVLink_param_ext_request_list_message(1, 1))
    station.send(mavlink.MAVLink_param_ext_request_read_message(1, 1, b"CAM", -1))
    assert station.heard == []


@BOTH
def test_a_flight_is_told_by_arming_take_off_and_number(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))

    def told() -> tuple[int, int, int]:
        assert station.request(mavlink.MAVLINK_MSG_ID_FLIGHT_INFORMATION) == ACCEPTED
        message = station.last("FLIGHT_INFORMATION")
        assert message.time_boot_ms == station.endpoint.now_us // 1000
        return message.arming_time_utc, message.takeoff_time_utc, message.flight_uuid

    assert told() == (0, 0, 0)
    station.take_off(2.0)
    armed_us, taken_off_us, number = told()
    assert 0 < armed_us < taken_off_us < station.endpoint.now_us
    assert number == 0
    assert station.command(mavlink.MAV_CMD_NAV_LAND) == ACCEPTED
    station.wait_until(lambda: not station.endpoint.vehicle.autopilot.armed, within_s=30.0)
    assert told() == (0, 0, 1)
    # Clients that want it again and again ask for a rate.
    assert station.command(SET, mavlink.MAVLINK_MSG_ID_FLIGHT_INFORMATION, 1e6) == ACCEPTED
    # The count is stored: it goes on after a restart.
    assert station.command(mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1) == ACCEPTED
    station.run(1.0)
    assert told() == (0, 0, 1)


@BOTH
def test_what_is_measured_is_told_in_units_of_physics(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    assert station.command(SET, mavlink.MAVLINK_MSG_ID_HIGHRES_IMU, 20_000) == ACCEPTED
    station.run(2.0)
    measured = station.last("HIGHRES_IMU")
    assert measured.zacc == pytest.approx(-9.8, abs=0.3)
    assert 900.0 < measured.abs_pressure < 1020.0
    assert measured.fields_updated & 0b1_1111_1111 == 0b1_1111_1111
