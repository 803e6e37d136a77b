"""Commands as timelines: what is asked, what is answered, what is done."""

import math

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import Mode
from vehicle_sim.geodesy import ned_offset_m
from vehicle_sim.parameters import Flavour
from vehicle_sim.signals import Geodetic

ACCEPTED = mavlink.MAV_RESULT_ACCEPTED
ARM = mavlink.MAV_CMD_COMPONENT_ARM_DISARM


@pytest.mark.parametrize("flavour", Flavour)
def test_unknown_commands_are_unsupported(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    assert station.command(31000) == mavlink.MAV_RESULT_UNSUPPORTED
    ack = station.last("COMMAND_ACK")
    assert (ack.command, ack.target_system, ack.target_component) == (31000, 255, 190)


@pytest.mark.parametrize("flavour", Flavour)
def test_other_targets_are_ignored_and_all_is_a_target(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    assert station.command(31000, target=2) == -1
    assert station.command(31000, target=0) == mavlink.MAV_RESULT_UNSUPPORTED
    assert station.command(31000, component=0) == mavlink.MAV_RESULT_UNSUPPORTED


@pytest.mark.parametrize(
    ("flavour", "result", "text"),
    [
        (Flavour.ARDUPILOT, mavlink.MAV_RESULT_FAILED, "Arm: "),
        (Flavour.PX4, mavlink.MAV_RESULT_TEMPORARILY_REJECTED, "Arming denied: Resolve system health failures firs"),
    ],
)
def test_arming_too_early_is_refused_with_words(flavour: Flavour, result: int, text: str) -> None:
    station = Station(endpoint_of(flavour))
    station.run(0.1)
    station.forget()
    assert station.command(ARM, 1) == result
    station.run(0.1)
    assert any(heard.startswith(text) for heard in station.texts())


@pytest.mark.parametrize("flavour", Flavour)
def test_arming_and_disarming_may_be_repeated(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.wait_for_position()
    for _ in range(3):
        assert station.command(ARM, 1) == ACCEPTED
    station.request(mavlink.MAVLINK_MSG_ID_HEARTBEAT)
    beat = station.last("HEARTBEAT")
    assert beat.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED
    assert beat.system_status == mavlink.MAV_STATE_ACTIVE
    for _ in range(3):
        assert station.command(ARM, 0) == ACCEPTED
    assert not station.endpoint.vehicle.autopilot.armed
    assert station.command(ARM, 0.5) == mavlink.MAV_RESULT_UNSUPPORTED
    assert station.command(ARM, math.nan) == mavlink.MAV_RESULT_UNSUPPORTED


@pytest.mark.parametrize("flavour", Flavour)
def test_in_the_air_only_force_disarms(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.take_off()
    assert station.command(ARM, 0) != ACCEPTED
    assert station.endpoint.vehicle.autopilot.armed
    assert station.command(ARM, 0, 21196) == ACCEPTED
    assert not station.endpoint.vehicle.autopilot.armed


def test_ardupilot_takes_off_in_guided_and_armed_only() -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    station.wait_for_position()
    assert station.command(mavlink.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 5) == mavlink.MAV_RESULT_FAILED
    assert station.command(mavlink.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, math.nan) == mavlink.MAV_RESULT_DENIED
    station.take_off(6.0)
    assert station.endpoint.vehicle.autopilot.mode is Mode.GUIDED
    assert station.height_m() == pytest.approx(6.0, abs=1.0)


def test_px4_takes_off_to_a_height_above_the_sea_and_holds() -> None:
    station = Station(endpoint_of(Flavour.PX4))
    station.take_off(6.0)
    station.wait_until(lambda: station.endpoint.vehicle.autopilot.mode is Mode.HOLD, within_s=20.0)
    station.run(3.0)
    assert station.height_m() == pytest.approx(6.0, abs=1.0)


@pytest.mark.parametrize("flavour", Flavour)
def test_modes_by_command_and_by_the_old_message(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.wait_for_position()
    assert station.set_mode(Mode.STABILIZE) == ACCEPTED
    number = station.endpoint.table.custom_modes[Mode.LAND]
    station.forget()
    station.send(mavlink.MAVLink_set_mode_message(1, 1, number))
    assert station.endpoint.vehicle.autopilot.mode is Mode.LAND
    assert station.last("COMMAND_ACK").result == ACCEPTED
    assert station.command(mavlink.MAV_CMD_DO_SET_MODE, 1, 99, 99) == station.endpoint.table.no_mode
    assert station.command(mavlink.MAV_CMD_DO_SET_MODE, 0, 4) == mavlink.MAV_RESULT_UNSUPPORTED
    assert station.command(mavlink.MAV_CMD_DO_SET_MODE, math.nan, math.inf) == mavlink.MAV_RESULT_DENIED
    assert station.endpoint.vehicle.autopilot.mode is Mode.LAND


def test_px4_in_the_air_accepts_offboard_without_a_stream_and_does_not_enter_it() -> None:
    station = Station(endpoint_of(Flavour.PX4))
    station.take_off()
    station.wait_until(lambda: station.endpoint.vehicle.autopilot.mode is Mode.HOLD, within_s=20.0)
    assert station.set_mode(Mode.GUIDED) == ACCEPTED
    station.run(0.5)
    assert station.endpoint.vehicle.autopilot.mode is Mode.HOLD
    # The text is longer than one message holds.
    joined = "".join(station.texts())
    assert "offboard" in joined.lower()


def place_north_of(station: Station, metres: float) -> tuple[int, int]:
    home = station.endpoint.vehicle.autopilot.home
    assert home is not None
    return round((home.lat_deg + math.degrees(metres / 6.37e6)) * 1e7), round(home.lon_deg * 1e7)


@pytest.mark.parametrize("flavour", Flavour)
def test_reposition_flies_there_and_stays(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.take_off(8.0)
    x, y = place_north_of(station, 15.0)
    frame, height = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, 8.0
    result = station.command_int(mavlink.MAV_CMD_DO_REPOSITION, frame, (-1, 1, 0, math.nan), (x, y, height))
    assert result == ACCEPTED
    origin = station.endpoint.vehicle.estimate.origin
    assert origin is not None
    north, east, _ = ned_offset_m(origin, Geodetic(x * 1e-7, y * 1e-7, 0.0))

    def miss_m() -> float:
        now_north, now_east, _ = station.endpoint.vehicle.estimate.position_ned_m
        return math.hypot(now_north - north, now_east - east)

    station.wait_until(lambda: miss_m() < 0.5, within_s=30.0)
    station.run(5.0)
    assert miss_m() < 1.0


def test_ardupilot_wants_places_in_command_int() -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    station.wait_for_position()
    only_int = station.command(mavlink.MAV_CMD_DO_REPOSITION, -1, 1, 0, math.nan, 47.0, 8.0, 10.0)
    assert only_int == mavlink.MAV_RESULT_COMMAND_INT_ONLY


@pytest.mark.parametrize("flavour", Flavour)
@pytest.mark.parametrize("latitude", [95.0, math.nan])
def test_places_off_the_earth_are_denied(flavour: Flavour, latitude: float) -> None:
    station = Station(endpoint_of(flavour))
    station.wait_for_position()
    home = station.endpoint.vehicle.autopilot.home
    assert station.command(mavlink.MAV_CMD_DO_SET_HOME, 0, 0, 0, 0, latitude, 8.0, 500.0) == mavlink.MAV_RESULT_DENIED
    assert station.endpoint.vehicle.autopilot.home == home


@pytest.mark.parametrize("flavour", Flavour)
def test_home_is_set_and_told_to_all(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.wait_for_position()
    station.run(0.1)
    station.forget()
    x, y = place_north_of(station, 20.0)
    assert (
        station.command_int(mavlink.MAV_CMD_DO_SET_HOME, mavlink.MAV_FRAME_GLOBAL, (0,) * 4, (x, y, 500.0)) == ACCEPTED
    )
    station.run(0.1)
    told = station.last("HOME_POSITION")
    assert (told.latitude, told.longitude, told.altitude) == (x, y, 500_000)
    assert told.x == pytest.approx(20.0, abs=2.0)
    assert station.command(mavlink.MAV_CMD_GET_HOME_POSITION) == ACCEPTED
    assert station.command(mavlink.MAV_CMD_DO_SET_HOME, 1) == ACCEPTED
    station.send(mavlink.MAVLink_set_home_position_message(1, x, y, 480_000, 0, 0, 0, (1, 0, 0, 0), 0, 0, 0))
    assert station.last("HOME_POSITION").altitude == 480_000


@pytest.mark.parametrize("flavour", Flavour)
def test_speed_turn_and_termination(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.take_off(8.0)
    station.run(5.0)
    assert station.command(mavlink.MAV_CMD_DO_CHANGE_SPEED, 1, 2.0, -1) == ACCEPTED
    assert station.command(mavlink.MAV_CMD_DO_CHANGE_SPEED, 1, -4.0, -1) == mavlink.MAV_RESULT_DENIED
    assert station.command(mavlink.MAV_CMD_DO_CHANGE_SPEED, math.inf, 2.0) == mavlink.MAV_RESULT_DENIED
    turned = station.command(mavlink.MAV_CMD_CONDITION_YAW, 90, 0, 1, 0)
    if flavour is Flavour.PX4:
        assert turned == mavlink.MAV_RESULT_UNSUPPORTED
    else:
        assert turned == ACCEPTED
        station.wait_until(lambda: abs(station.endpoint.vehicle.estimate.yaw_rad - math.pi / 2) < 0.1, within_s=20.0)
    assert station.command(mavlink.MAV_CMD_DO_FLIGHTTERMINATION, 0) != ACCEPTED
    assert station.command(mavlink.MAV_CMD_DO_FLIGHTTERMINATION, 1) == ACCEPTED
    assert not station.endpoint.vehicle.autopilot.armed


@pytest.mark.parametrize("flavour", Flavour)
def test_pause_return_and_hold(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.take_off(8.0)
    station.run(4.0)
    assert station.command(mavlink.MAV_CMD_DO_PAUSE_CONTINUE, 0) == ACCEPTED
    assert station.command(mavlink.MAV_CMD_DO_PAUSE_CONTINUE, 7) == mavlink.MAV_RESULT_DENIED
    assert station.command(mavlink.MAV_CMD_NAV_LOITER_UNLIM) == ACCEPTED
    assert station.command(mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH) == ACCEPTED
    assert station.endpoint.vehicle.autopilot.mode is Mode.RETURN


def test_prearm_checks_of_ardupilot_on_request() -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    station.run(0.1)
    station.forget()
    assert station.command(mavlink.MAV_CMD_RUN_PREARM_CHECKS) == ACCEPTED
    assert station.texts()
    assert all(text.startswith("PreArm: ") for text in station.texts())


def test_the_banner_of_ardupilot_names_its_version() -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    assert station.command(mavlink.MAV_CMD_DO_SEND_BANNER) == ACCEPTED
    assert station.texts() == ["ArduCopter V4.7.0-dev", "Frame: QUAD"]
    assert Station(endpoint_of(Flavour.PX4)).command(mavlink.MAV_CMD_DO_SEND_BANNER) == mavlink.MAV_RESULT_UNSUPPORTED
