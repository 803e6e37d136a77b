"""Reads telemetry logs: eight bytes of big-endian UTC microseconds before each MAVLink 2 frame."""

from struct import unpack_from

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from vehicle_sim.protocol.dialect import Message

V2_OVERHEAD = 12


def entries_of(data: bytes) -> list[tuple[int, Message]]:
    """Return time and message of each entry; what is not exactly such a log is an error."""
    parser, entries, at = mavlink.MAVLink(None), [], 0
    while at < len(data):
        (utc_us,) = unpack_from(">Q", data, at)
        frame = data[at + 8 : at + 8 + V2_OVERHEAD + data[at + 9]]
        assert len(frame) == V2_OVERHEAD + data[at + 9]
        entries.append((utc_us, parser.decode(bytearray(frame))))
        at += 8 + len(frame)
    return entries
