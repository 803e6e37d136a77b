"""What QGroundControl asks a vehicle that it has just found, in its order and within its time-outs.

Sequence: QGroundControl's initial connection (version, modes, component information, parameters, mission, geofence,
rally points), then what its views ask for. Time-outs: 3 s for an acknowledgement of a command, 5 s for the first
parameter, 1.5 s for a mission message, 1 s for a file transfer. A request that gets no answer within its time-out
makes the ground station repeat itself, wait, and complain.
"""

from collections.abc import Callable
from struct import pack, unpack_from

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import Message
from vehicle_sim.protocol.flavour import Rates

COMMAND_S = 3.0
FIRST_PARAMETER_S = 5.0
PLAN_S = 1.5
FILE_S = 1.0

AVAILABLE_MODES = 435
COMPONENT_METADATA = 397
COMPONENT_INFORMATION = 395
PROTOCOL_VERSION = 300
FLIGHT_INFORMATION = 264
CAMERA_INFORMATION = 259
GIMBAL_MANAGER_INFORMATION = 280

ACK, NAK = 128, 129
TERMINATE, RESET, LIST, OPEN, READ, BURST = 1, 2, 3, 4, 5, 15


class GroundStation(Station):
    """A station that wants an answer to each of its requests in time."""

    def __init__(self, flavour: Flavour) -> None:
        super().__init__(endpoint_of(flavour), rates=Rates.GROUND_STATION)
        self.flavour = flavour
        self._file_sequence = 0

    def asks(self, request: Message, answers: Callable[[Message], bool], within_s: float) -> Message:
        """Send a request and return the first answer to it."""
        self.forget()
        self.send(request)
        found: list[Message] = []

        def answered() -> bool:
            found[:] = [message for message in self.heard if answers(message)]
            return bool(found)

        self.wait_until(answered, within_s=within_s)
        return found[0]

    def commands(self, command: int, *params: float, component: int = 1) -> int:
        """Send a command and return the result of its acknowledgement, which is addressed to this station."""
        seven = (*params, *(0.0,) * (7 - len(params)))
        ack = self.asks(
            mavlink.MAVLink_command_long_message(1, component, command, 0, *seven),
            lambda message: message.get_type() == "COMMAND_ACK" and message.command == command,
            COMMAND_S,
        )
        assert (ack.target_system, ack.target_component) == (255, 190)
        return int(ack.result)

    def requests(self, message_id: int, index: int = 0) -> Message | None:
        """Ask for a message; None where the vehicle says that it has no such message."""
        if self.commands(mavlink.MAV_CMD_REQUEST_MESSAGE, message_id, index) != mavlink.MAV_RESULT_ACCEPTED:
            return None
        return next(message for message in self.heard if message.get_msgId() == message_id)

    def plan(self, mission_type: int) -> list[Message]:
        """Download a plan."""

        def of_plan(kind: str) -> Callable[[Message], bool]:
            return lambda message: message.get_type() == kind and message.mission_type == mission_type

        request_list = mavlink.MAVLink_mission_request_list_message(1, 1, mission_type)
        count = self.asks(request_list, of_plan("MISSION_COUNT"), PLAN_S).count
        items = []
        for seq in range(count):
            request = mavlink.MAVLink_mission_request_int_message(1, 1, seq, mission_type)
            items.append(self.asks(request, of_plan("MISSION_ITEM_INT"), PLAN_S))
        self.send(mavlink.MAVLink_mission_ack_message(1, 1, mavlink.MAV_MISSION_ACCEPTED, mission_type))
        return items

    def file_request(
        self, opcode: int, data: bytes = b"", *, session: int = 0, offset: int = 0, size: int = 0
    ) -> bytes:
        """Send one request of the file transfer protocol and return the payload of its answer."""
        self._file_sequence = sequence = (self._file_sequence + 1) & 0xFFFF
        header = pack("<HBBBBBxI", sequence, session, opcode, size or len(data), 0, 0, offset)
        payload = (header + data).ljust(251, b"\0")
        answer = self.asks(
            mavlink.MAVLink_file_transfer_protocol_message(0, 1, 1, payload),
            lambda message: (
                message.get_type() == "FILE_TRANSFER_PROTOCOL"
                and unpack_from("<H", bytes(message.payload))[0] == (sequence + 1) & 0xFFFF
            ),
            FILE_S,
        )
        assert (answer.target_system, answer.target_component) == (255, 190)
        answered = bytes(answer.payload)
        assert answered[3] in (ACK, NAK)
        assert answered[5] == opcode
        return answered


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


def test_parameters_arrive_whole_although_some_are_lost(station: GroundStation) -> None:
    values: dict[int, Message] = {}

    def is_value(message: Message) -> bool:
        return bool(message.get_type() == "PARAM_VALUE" and message.param_id != "_HASH_CHECK")

    def values_heard() -> int:
        return sum(is_value(message) for message in station.heard)

    request = mavlink.MAVLink_param_request_list_message(1, mavlink.MAV_COMP_ID_ALL)
    count = station.asks(request, is_value, FIRST_PARAMETER_S).param_count
    station.wait_until(lambda: values_heard() >= count, within_s=30.0)
    heard = [message for message in station.heard if is_value(message)]
    values = {message.param_index: message for place, message in enumerate(heard) if place % 3}  # one of three is lost

    missing = [index for index in range(count) if index not in values]
    assert missing
    for batch in (missing[start : start + 10] for start in range(0, len(missing), 10)):
        station.forget()
        station.send(*(mavlink.MAVLink_param_request_read_message(1, 1, b"", index) for index in batch))
        assert values_heard() == len(batch)  # at once
        values.update({message.param_index: message for message in station.heard if is_value(message)})
    assert sorted(values) == list(range(count))
    assert len({message.param_id for message in values.values()}) == count


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
