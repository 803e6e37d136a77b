"""What MAVSDK, both versions, and mavros take from a vehicle, message by message: `expectations.toml`."""

import tomllib
from pathlib import Path
from struct import pack
from typing import Any

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import Mode
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import Message

NEEDS: list[dict[str, Any]] = tomllib.loads(Path(__file__).with_name("expectations.toml").read_text(encoding="utf-8"))[
    "need"
]
NUMBERS = {kind.msgname: number for number, kind in mavlink.mavlink_map.items()}
REQUEST, INTERVAL = mavlink.MAV_CMD_REQUEST_MESSAGE, mavlink.MAV_CMD_SET_MESSAGE_INTERVAL


def rows(how: str) -> list[Any]:
    """Return a case for each message and each flavour that is to have it."""
    return [
        pytest.param(flavour, name, id=f"{flavour}-{need['client']}-{name}")
        for need in NEEDS
        if need.get("how", "absent") == how
        for flavour in (Flavour if "only" not in need else (Flavour(need["only"]),))
        for name in need["messages"]
    ]


def command(number: int, *params: float) -> Message:
    return mavlink.MAVLink_command_long_message(1, 1, number, 0, *params, *(0.0,) * (7 - len(params)))


def waypoint() -> Message:
    place = (0.0, 0.0, 0.0, 0.0, 473_977_420, 85_455_940, 10.0, 0)
    return mavlink.MAVLink_mission_item_int_message(1, 1, 0, 6, 16, 0, 1, *place)


SENT: dict[str, list[Message]] = {
    "COMMAND_ACK": [command(REQUEST, NUMBERS["HEARTBEAT"])],
    "PARAM_VALUE": [mavlink.MAVLink_param_request_read_message(1, 1, b"", 0)],
    "MISSION_COUNT": [mavlink.MAVLink_mission_request_list_message(1, 1, 0)],
    "MISSION_REQUEST": [mavlink.MAVLink_mission_count_message(1, 1, 1, 0)],
    "MISSION_ACK": [mavlink.MAVLink_mission_count_message(1, 1, 1, 0), waypoint()],
    "MISSION_ITEM_INT": [
        mavlink.MAVLink_mission_count_message(1, 1, 1, 0),
        waypoint(),
        mavlink.MAVLink_mission_request_int_message(1, 1, 0, 0),
    ],
    "FILE_TRANSFER_PROTOCOL": [
        mavlink.MAVLink_file_transfer_protocol_message(
            0, 1, 1, pack("<HBBBBBxI", 1, 0, 2, 0, 0, 0, 0).ljust(251, b"\0")
        )
    ],
    "LOG_ENTRY": [mavlink.MAVLink_log_request_list_message(1, 1, 0, 0xFFFF)],
    "TIMESYNC": [mavlink.MAVLink_timesync_message(0, 1)],
    "STATUSTEXT": [command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1)],
    "EVENT": [command(mavlink.MAV_CMD_RUN_PREARM_CHECKS)],
    "COMPONENT_METADATA": [command(REQUEST, NUMBERS["COMPONENT_METADATA"])],
    "MAG_CAL_PROGRESS": [command(mavlink.MAV_CMD_DO_START_MAG_CAL)],
}
"""What a client sends to get each of them."""


@pytest.fixture(scope="module")
def flying() -> dict[Flavour, Station]:
    """Return vehicles in the air that go somewhere."""
    stations = {}
    for flavour in Flavour:
        station = stations[flavour] = Station(endpoint_of(flavour))
        station.take_off(4.0)
        for _ in range(5):
            station.setpoint((5.0, 0.0, -4.0), mask=0xDF8)
            station.run(0.1)
        station.set_mode(Mode.GUIDED)
    return stations


@pytest.mark.parametrize(("flavour", "name"), rows("streamed"))
def test_is_streamed_and_sent_on_request(flying: dict[Flavour, Station], flavour: Flavour, name: str) -> None:
    station, number = flying[flavour], NUMBERS[name]
    station.setpoint((5.0, 0.0, -4.0), mask=0xDF8)
    station.forget()
    assert station.command(REQUEST, number) == mavlink.MAV_RESULT_ACCEPTED
    assert station.of(name)
    assert station.command(INTERVAL, number, 100_000) == mavlink.MAV_RESULT_ACCEPTED
    station.forget()
    station.run(0.25)
    if number not in station.endpoint.table.told_on_change:
        assert station.of(name)
    station.command(INTERVAL, number, -1)


@pytest.mark.parametrize(("flavour", "name"), rows("answered"))
def test_is_the_answer_to_something(flavour: Flavour, name: str) -> None:
    station = Station(endpoint_of(flavour))
    station.send(*SENT[name])
    station.run(0.2)
    # PX4 asks for items by the newer of the two messages.
    assert station.of(name) or station.of(name.replace("MISSION_REQUEST", "MISSION_REQUEST_INT"))


@pytest.mark.parametrize(("flavour", "name"), rows("absent"))
def test_is_not_there_for_a_reason(flavour: Flavour, name: str) -> None:
    station = Station(endpoint_of(flavour))
    if name in NUMBERS:
        assert station.command(REQUEST, NUMBERS[name]) == station.endpoint.table.no_message


def test_every_row_says_how_or_why_not() -> None:
    for need in NEEDS:
        assert need["client"] in ("MAVSDK", "mavros")
        assert need["part"]
        assert len(need.get("absent", "")) > 20 if "how" not in need else need["how"] in ("streamed", "answered")
