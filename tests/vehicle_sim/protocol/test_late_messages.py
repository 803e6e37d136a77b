"""Messages that the dialect lacks: their numbers are those that their definitions amount to, and links read them."""

import re

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol import late_messages
from vehicle_sim.protocol.late_messages import LateMessage, RequestEvent

DEFINITIONS = {
    397: "COMPONENT_METADATA uint32_t time_boot_ms uint32_t file_crc char uri[100]",
    410: "EVENT uint32_t id uint32_t event_time_boot_ms uint16_t sequence uint8_t destination_component "
    "uint8_t destination_system uint8_t log_levels uint8_t arguments[40]",
    411: "CURRENT_EVENT_SEQUENCE uint16_t sequence uint8_t flags",
    412: "REQUEST_EVENT uint16_t first_sequence uint16_t last_sequence uint8_t target_system uint8_t target_component",
    413: "RESPONSE_EVENT_ERROR uint16_t sequence uint16_t sequence_oldest_available uint8_t target_system "
    "uint8_t target_component uint8_t reason",
    435: "AVAILABLE_MODES uint32_t custom_mode uint32_t properties uint8_t number_modes uint8_t mode_index "
    "uint8_t standard_mode char mode_name[35]",
    436: "CURRENT_MODE uint32_t custom_mode uint32_t intended_custom_mode uint8_t standard_mode",
    437: "AVAILABLE_MODES_MONITOR uint8_t seq",
}
"""The fields in the order of the wire, by `common.xml`."""

FIELD = re.compile(r"^(\w+)(?:\[(\d+)\])?$")
SIZES = {"uint32_t": 4, "uint16_t": 2, "uint8_t": 1, "char": 1}
KINDS = [kind for kind in vars(late_messages).values() if isinstance(kind, type) and issubclass(kind, LateMessage)]


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind is not LateMessage], ids=lambda kind: kind.msgname)
def test_names_sizes_and_checksums_follow_from_the_definitions(kind: type[LateMessage]) -> None:
    name, *words = DEFINITIONS[kind.id].split()
    fields = [(words[at], *FIELD.findall(words[at + 1])[0]) for at in range(0, len(words), 2)]
    crc = mavlink.x25crc(f"{name} ".encode())
    for form, field, length in fields:
        crc.accumulate(f"{form} {field} ".encode() + (bytes([int(length)]) if length else b""))
    assert kind.crc_extra == crc.crc & 0xFF ^ crc.crc >> 8
    assert kind.msgname == name
    assert kind.fieldnames == [field for _form, field, _length in fields]
    assert kind.unpacker.size == sum(SIZES[form] * int(length or 1) for form, _field, length in fields)
    assert kind.id in mavlink.mavlink_map


def test_one_with_a_wrong_checksum_is_not_heard() -> None:
    endpoint = endpoint_of(Flavour.PX4)
    station = Station(endpoint)
    frame = bytearray(station.packed(RequestEvent(1, 1, 1, 1)))
    assert endpoint.receive("station", bytes(frame)) == 1
    frame[-1] ^= 1
    assert endpoint.receive("station", bytes(frame)) == 0
