"""Messages that pymavlink's dialect of ArduPilot does not have yet, decoded by their definitions in common.xml."""

from collections.abc import Callable
from struct import unpack
from types import SimpleNamespace
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from vehicle_sim.protocol.dialect import Message

AVAILABLE_MODES = 435
CURRENT_MODE = 436


def _available_modes(payload: bytes) -> dict[str, Any]:
    custom, properties, count, index, standard, name = unpack("<IIBBB35s", payload)
    return {
        "custom_mode": custom,
        "properties": properties,
        "number_modes": count,
        "mode_index": index,
        "standard_mode": standard,
        "mode_name": name.rstrip(b"\0").decode("ascii"),
    }


def _current_mode(payload: bytes) -> dict[str, Any]:
    custom, intended, standard = unpack("<IIB", payload)
    return {"custom_mode": custom, "intended_custom_mode": intended, "standard_mode": standard}


# Name, payload length, CRC_EXTRA, fields.
_DEFINITIONS: dict[int, tuple[str, int, int, Callable[[bytes], dict[str, Any]]]] = {
    AVAILABLE_MODES: ("AVAILABLE_MODES", 46, 134, _available_modes),
    CURRENT_MODE: ("CURRENT_MODE", 9, 193, _current_mode),
}


def name_of(message_id: int) -> str:
    known = _DEFINITIONS.get(message_id)
    return str(mavlink.mavlink_map[message_id].msgname) if known is None else known[0]


def decoded(message: Message) -> Message:
    """Return a message of the definitions above as one with fields; any other as it is."""
    if not isinstance(message, mavlink.MAVLink_unknown):
        return message
    frame = bytes(message.get_msgbuf())
    number = int.from_bytes(frame[7:10], "little")
    if number not in _DEFINITIONS:
        return message
    name, length, crc_extra, fields = _DEFINITIONS[number]
    payload = frame[10 : 10 + frame[1]]
    checksum = int.from_bytes(frame[10 + frame[1] : 12 + frame[1]], "little")
    assert checksum == mavlink.x25crc(frame[1 : 10 + frame[1]] + bytes([crc_extra])).crc
    values = fields(payload.ljust(length, b"\0"))
    return SimpleNamespace(
        get_type=lambda: name,
        get_msgId=lambda: number,
        get_srcSystem=lambda: frame[5],
        get_seq=lambda: frame[4],
        to_dict=lambda: values,
        **values,
    )
