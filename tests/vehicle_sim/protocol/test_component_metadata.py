"""Component metadata: the message, and the files that it leads to, as a ground station fetches them."""

from json import loads
from lzma import decompress
from struct import unpack
from typing import Any
from zlib import crc32

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.file_client import CRC, OPEN, READ, TERMINATE, FileClient
from tests.support.station import Station, endpoint_of
from vehicle_sim.parameters import Flavour

COMPONENT_METADATA = 397
EVENTS, ACTUATORS = 4, 5


def fetched(client: FileClient, uri: str) -> bytes:
    path = uri.removeprefix("mftp:/").encode()
    opened = client.ask(OPEN, path)
    assert opened.error is None, uri
    (size,) = unpack("<I", opened.data)
    data = b""
    while len(data) < size:
        data += client.ask(READ, session=opened.session, offset=len(data), size=239).data
    client.ask(TERMINATE, session=opened.session)
    assert unpack("<I", client.ask(CRC, path).data) == (checksum(data),)
    return data


def checksum(data: bytes) -> int:
    """MAVLink's CRC-32: that of zlib without its inversions."""
    return crc32(data, 0xFFFFFFFF) ^ 0xFFFFFFFF


@pytest.fixture(scope="module")
def files() -> dict[int, Any]:
    """Return the content of each file, by the type of its metadata."""
    station = Station(endpoint_of(Flavour.PX4))
    client = FileClient(station)
    assert station.request(COMPONENT_METADATA) == mavlink.MAV_RESULT_ACCEPTED
    told = station.last("COMPONENT_METADATA")
    general = fetched(client, told.uri)
    assert told.file_crc == checksum(general)
    whole = loads(decompress(general))
    assert whole["version"] == 1
    content = {}
    for entry in whole["metadataTypes"]:
        data = fetched(client, entry["uri"])
        assert entry["fileCrc"] == checksum(data)
        content[entry["type"]] = loads(decompress(data))
    assert [name.split("\t")[0] for name in client.names(b"/etc/extras")] == [
        "Factuators.json.xz",
        "Fall_events.json.xz",
        "Fcomponent_general.json.xz",
    ]
    return content


def test_there_are_events_and_actuators_and_what_parameters_mean_is_left_to_others(files: dict[int, Any]) -> None:
    assert set(files) == {EVENTS, ACTUATORS}


def test_events_are_whole(files: dict[int, Any]) -> None:
    component = files[EVENTS]["components"]["1"]
    assert component["namespace"] == "px4"
    assert component["supported_protocols"] == ["health_and_arming_check"]
    groups = component["event_groups"]
    known = {"uint8_t", "uint32_t", "int32_t", "float"} | set(component["enums"])
    for group in groups.values():
        for number, event in group["events"].items():
            assert 0 <= int(number) < 1 << 24
            assert event["name"]
            assert event["message"]
            assert {argument["type"] for argument in event.get("arguments", ())} <= known
    checks = groups["arming_check"]["events"].values()
    # A reader of reports takes the first two arguments of each check for its modes and its component.
    for event in checks:
        if event.get("type") != "summary":
            assert [argument["type"] for argument in event["arguments"]][:2] == ["navigation_mode_group_t", "uint8_t"]
    assert [event["name"] for event in checks if event.get("type") == "summary"] == ["commander_arming_check_summary"]


def test_actuators_are_those_of_the_airframe(files: dict[int, Any]) -> None:
    actuators = files[ACTUATORS]
    motors = [int(number) for number in actuators["functions_v1"] if number != "0"]
    assert motors == [101, 102, 103, 104]
    (output,) = actuators["outputs_v1"]
    (channels,) = (subgroup["channels"] for subgroup in output["subgroups"])
    assert len(channels) == len(motors)
    motor = actuators["mixer_v1"]["actuator-types"]["motor"]
    assert motor["function-min"] <= min(motors) <= max(motors) <= motor["function-max"]


def test_ardupilot_has_none() -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    assert station.request(COMPONENT_METADATA) == mavlink.MAV_RESULT_FAILED
    assert FileClient(station).ask(OPEN, b"/etc/extras/component_general.json.xz").error is not None
