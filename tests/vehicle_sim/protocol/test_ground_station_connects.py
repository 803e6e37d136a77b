"""What QGroundControl asks a vehicle that it has just found, in its order and within its time-outs.

Sequence: QGroundControl's initial connection (version, modes, component information, parameters, mission, geofence,
rally points), then what its views ask for. A request that gets no answer within its time-out makes the ground station
repeat itself, wait, and complain.
"""

from struct import unpack_from

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.ground_station import ACK, NAK, GroundStation
from vehicle_sim.parameters import Flavour

AVAILABLE_MODES = 435
COMPONENT_METADATA = 397
COMPONENT_INFORMATION = 395
PROTOCOL_VERSION = 300
FLIGHT_INFORMATION = 264
CAMERA_INFORMATION = 259
GIMBAL_MANAGER_INFORMATION = 280

TERMINATE, RESET, LIST, OPEN, READ, BURST = 1, 2, 3, 4, 5, 15


@pytest.fixture(params=Flavour)
def station(request: pytest.FixtureRequest) -> GroundStation:
    return GroundStation(request.param)


def test_the_vehicle_is_found_by_its_heartbeat(station: GroundStation) -> None:
    beat = mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 4, 3)
    found = station.asks(beat, lambda message: message.get_type() == "HEARTBEAT", 1.1)
    assert found.type == mavlink.MAV_TYPE_QUADROTOR
    assert found.autopilot in (mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA, mavlink.MAV_AUTOPILOT_PX4)
    assert (found.get_srcSystem(), found.get_srcComponent()) == (1, 1)


def test_version_modes_and_component_information_are_answered(station: GroundStation) -> None:
    version = station.requests(mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION)
    assert version is not None
    assert version.capabilities & mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_INT
    assert version.capabilities & mavlink.MAV_PROTOCOL_CAPABILITY_COMMAND_INT
    station.requests(PROTOCOL_VERSION)

    first = station.requests(AVAILABLE_MODES, 1)
    if first is not None:
        pages = [station.requests(AVAILABLE_MODES, index) for index in range(1, first.number_modes + 1)]
        assert [page.mode_index for page in pages if page is not None] == list(range(1, first.number_modes + 1))
        assert len({page.custom_mode for page in pages if page is not None}) == first.number_modes
        assert station.requests(AVAILABLE_MODES, first.number_modes + 1) is None

    if station.requests(COMPONENT_METADATA) is None:
        station.requests(COMPONENT_INFORMATION)


def test_plans_of_all_kinds_are_downloaded(station: GroundStation) -> None:
    station.wait_for_position()
    mission = station.plan(mavlink.MAV_MISSION_TYPE_MISSION)
    assert len(mission) == (1 if station.flavour is Flavour.ARDUPILOT else 0)  # ArduPilot's home
    assert station.plan(mavlink.MAV_MISSION_TYPE_FENCE) == []
    assert station.plan(mavlink.MAV_MISSION_TYPE_RALLY) == []


def test_streams_and_single_messages_are_answered(station: GroundStation) -> None:
    station.wait_for_position()
    groups = {1: 2, 2: 2, 3: 2, 6: 3, 10: 10, 11: 10, 12: 3}
    if station.flavour is Flavour.ARDUPILOT:
        for group, rate in groups.items():
            station.send(mavlink.MAVLink_request_data_stream_message(1, 1, group, rate, 1))
    for message_id in (mavlink.MAVLINK_MSG_ID_HOME_POSITION, mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE):
        assert station.commands(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, message_id, 1e6) == mavlink.MAV_RESULT_ACCEPTED
    assert station.commands(mavlink.MAV_CMD_GET_HOME_POSITION) == mavlink.MAV_RESULT_ACCEPTED
    assert station.last("HOME_POSITION").latitude
    station.forget()
    station.run(3.0)
    shown = {message.get_type() for message in station.heard}
    assert {"SYS_STATUS", "GPS_RAW_INT", "GLOBAL_POSITION_INT", "ATTITUDE", "VFR_HUD", "BATTERY_STATUS"} <= shown
    assert {"HOME_POSITION", "EXTENDED_SYS_STATE", "HEARTBEAT"} <= shown


@pytest.mark.parametrize("message_id", [CAMERA_INFORMATION, GIMBAL_MANAGER_INFORMATION, FLIGHT_INFORMATION, 60_000])
def test_what_the_vehicle_does_not_have_is_refused_at_once(station: GroundStation, message_id: int) -> None:
    station.requests(message_id)


@pytest.mark.parametrize(
    "command",
    [
        mavlink.MAV_CMD_REQUEST_PROTOCOL_VERSION,
        mavlink.MAV_CMD_REQUEST_CAMERA_INFORMATION,
        mavlink.MAV_CMD_REQUEST_FLIGHT_INFORMATION,
        mavlink.MAV_CMD_REQUEST_STORAGE_INFORMATION,
        mavlink.MAV_CMD_LOGGING_START,
        mavlink.MAV_CMD_PREFLIGHT_STORAGE,
        mavlink.MAV_CMD_CONTROL_HIGH_LATENCY,
        mavlink.MAV_CMD_DO_SET_ROI_NONE,
    ],
)
def test_each_command_is_acknowledged(station: GroundStation, command: int) -> None:
    station.commands(command, 1)


def test_files_are_asked_for_without_waiting(station: GroundStation) -> None:
    assert station.file_request(RESET)[3] == ACK
    for path in (b"@PARAM/param.pck?withdefaults=1", b"/etc/extras/component_general.json.xz", b"/no/such/file"):
        opened = station.file_request(OPEN, path)
        if opened[3] == ACK:
            (size,) = unpack_from("<I", opened, 12)
            read = station.file_request(READ, session=opened[2], size=min(size, 80))
            assert read[3] == ACK
            assert station.file_request(TERMINATE, session=opened[2])[3] == ACK
    assert station.file_request(LIST, b"/")[3] in (ACK, NAK)
    assert station.file_request(READ, session=77, size=80)[3] == NAK
    assert station.file_request(BURST, session=77, size=239)[3] == NAK


def test_clocks_are_compared(station: GroundStation) -> None:
    station.run(0.1)
    answer = station.asks(
        mavlink.MAVLink_timesync_message(0, 123_456_789),
        lambda message: message.get_type() == "TIMESYNC" and message.ts1 == 123_456_789,
        0.1,
    )
    assert answer.tc1 > 0


def test_a_parameter_is_set_and_told_within_a_second(station: GroundStation) -> None:
    name, value = ("WPNAV_SPEED", 700.0) if station.flavour is Flavour.ARDUPILOT else ("MPC_XY_CRUISE", 7.0)
    told = station.asks(
        mavlink.MAVLink_param_set_message(1, 1, name.encode(), value, mavlink.MAV_PARAM_TYPE_REAL32),
        lambda message: message.get_type() == "PARAM_VALUE" and message.param_id == name,
        1.0,
    )
    assert told.param_value == value
