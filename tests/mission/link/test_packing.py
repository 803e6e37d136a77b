"""Frames are read and written as pymavlink does it, for each message of the dialect."""

import random
import struct
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.link.framing import Frame, split
from mission.link.packing import frame_of, message_of


def any_message(kind: Any, chance: random.Random) -> Any:  # noqa: ANN401 - pymavlink ships no types
    """A message of a kind with any bytes in it, as pymavlink reads them; its characters end with a zero at last."""
    payload = bytes(chance.randrange(256) for _ in range(kind.unpacker.size - chance.choice((0, 1, 2))))
    frame = mavlink.MAVLink_message(kind.id, kind.msgname)
    frame._signed = False
    data = frame._pack(mavlink.MAVLink(None, srcSystem=3, srcComponent=7), kind.crc_extra, payload or b"\1")
    return mavlink.MAVLink(None).decode(bytearray(data))


def as_bytes(message: Any) -> list[bytes]:  # noqa: ANN401 - pymavlink ships no types
    """What is in the fields, with what is no number told apart by its bits."""
    parts = (getattr(message, name) for name in message.get_fieldnames())
    return [struct.pack("<d", part) if isinstance(part, float) else repr(part).encode() for part in parts]


def test_each_message_is_unpacked_as_pymavlink_does() -> None:
    chance = random.Random(1)  # noqa: S311 - no secret
    for number, kind in mavlink.mavlink_map.items():
        message = any_message(kind, chance)
        read = message_of(Frame(number, bytes(message.get_msgbuf())))
        assert type(read) is type(message)
        assert as_bytes(read) == as_bytes(message), kind.msgname


def test_each_message_is_packed_as_pymavlink_does() -> None:
    chance = random.Random(2)  # noqa: S311 - no secret
    mav = mavlink.MAVLink(None, srcSystem=255, srcComponent=191)
    for number, kind in mavlink.mavlink_map.items():
        message, mav.seq = any_message(kind, chance), number & 0xFF
        frame = frame_of(message, mav)
        assert frame == bytes(message.pack(mav)), kind.msgname
        assert split(frame) == ([Frame(number, frame)], len(frame))


def test_a_message_of_zeros_keeps_its_first_byte() -> None:
    message = mavlink.MAVLink_ping_message(0, 0, 0, 0)
    assert frame_of(message, mavlink.MAVLink(None, srcSystem=1, srcComponent=1))[1] == 1
