"""Bytes to messages and back: golden frames, both versions of MAVLink, and noise around frames."""

from pathlib import Path
from xml.etree import ElementTree as ET

import pymavlink
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.drawn_cases import tried
from vehicle_sim.protocol.dialect import V1_PAYLOAD_LENGTHS
from vehicle_sim.protocol.link import MAX_DATAGRAM, Link

# After the serialisation guide: header, fields by descending size, checksum with CRC_EXTRA (checked bit by bit below).
HEARTBEAT_V2 = bytes.fromhex("fd 09 00 00 00 01 01 00 00 00 04 00 00 00 02 03 51 03 03 7e 22")
HEARTBEAT_V1 = bytes.fromhex("fe 09 00 01 01 00 04 00 00 00 02 03 51 03 03 e4 e1")


def crc_x25(data: bytes) -> int:
    """CRC-16/MCRF4XX bit by bit, from its polynomial; shares nothing with pymavlink."""
    crc = 0xFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ 0x8408 if crc & 1 else crc >> 1
    return crc


def heartbeat() -> object:
    return mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 3, 3)


def station(seq: int = 0) -> bytes:
    mav = mavlink.MAVLink(None, srcSystem=255, srcComponent=190)
    mav.seq = seq
    frame: bytes = mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3).pack(mav)
    return frame


def v1_station() -> bytes:
    mav = mavlink.MAVLink(None, srcSystem=255, srcComponent=190)
    frame: bytes = mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3).pack(mav, force_mavlink1=True)
    return frame


def test_golden_heartbeat_in_mavlink_2() -> None:
    link = Link("a", system_id=1)
    link.send(heartbeat())
    assert link.drain() == [HEARTBEAT_V2]
    assert crc_x25(HEARTBEAT_V2[1:-2] + bytes([50])) == int.from_bytes(HEARTBEAT_V2[-2:], "little")


def test_golden_heartbeat_to_a_peer_that_speaks_mavlink_1() -> None:
    link = Link("a", system_id=1)
    assert len(link.decode(v1_station())) == 1
    link.send(heartbeat())
    assert link.drain() == [HEARTBEAT_V1]
    assert crc_x25(HEARTBEAT_V1[1:-2] + bytes([50])) == int.from_bytes(HEARTBEAT_V1[-2:], "little")


def test_golden_local_position() -> None:
    link = Link("a", system_id=1)
    link.send(mavlink.MAVLink_local_position_ned_message(1000, 1.0, -2.0, -10.0, 0.5, 0.0, 0.0))
    payload = "e8030000 0000803f 000000c0 000020c1 0000003f"
    (frame,) = link.drain()
    # Trailing zeros are cut: the last two of seven fields; those inside 0.5 do not trail.
    assert frame[:-2] == bytes.fromhex("fd 14 00 00 00 01 01 20 00 00" + payload)
    assert crc_x25(frame[1:-2] + bytes([185])) == int.from_bytes(frame[-2:], "little")


def test_a_peer_that_turns_to_mavlink_2_gets_2_for_good() -> None:
    link = Link("a", system_id=1)
    answers = []
    for heard in (v1_station(), station(), v1_station()):
        link.decode(heard)
        answers.append(link.speaks_v1)
    assert answers == [True, False, False]


def test_mavlink_1_never_carries_extensions_or_large_ids() -> None:
    link = Link("a", system_id=1)
    link.decode(v1_station())
    link.send(mavlink.MAVLink_command_ack_message(400, 0, 0, 0, 255, 190))
    link.send(mavlink.MAVLink_odometry_message(0, 1, 12, *(0,) * 3, (1, 0, 0, 0), *(0,) * 6, (0,) * 21, (0,) * 21))
    (frame,) = link.drain()
    assert frame[:2] == bytes([0xFE, 3])
    assert crc_x25(frame[1:-2] + bytes([143])) == int.from_bytes(frame[-2:], "little")
    parser = mavlink.MAVLink(None)
    assert parser.parse_buffer(frame)[0].command == 400


def test_a_field_called_id_is_not_the_number_of_the_message() -> None:
    link = Link("a", system_id=1)
    link.decode(v1_station())
    link.send(mavlink.MAVLink_statustext_message(6, b"long", 40_000, 0))
    (frame,) = link.drain()
    assert frame[:2] == bytes([0xFE, 51])


def test_lengths_without_extensions_are_those_of_the_definitions() -> None:
    sizes = {"char": 1, "int8_t": 1, "uint8_t": 1, "int16_t": 2, "uint16_t": 2}
    sizes |= {"int32_t": 4, "uint32_t": 4, "float": 4, "int64_t": 8, "uint64_t": 8, "double": 8}
    sizes["uint8_t_mavlink_version"] = 1
    folder = Path(pymavlink.__file__).parent / "dialects" / "v20"
    lengths: dict[int, int] = {}
    extended: set[int] = set()
    for name in ("minimal", "standard", "common", "ardupilotmega"):
        for message in ET.parse(folder / f"{name}.xml").getroot().iter("message"):  # noqa: S314 - pymavlink's own
            length = 0
            for child in message:
                if child.tag == "extensions":
                    extended.add(int(message.attrib["id"]))
                    break
                if child.tag == "field":
                    kind, _, count = child.attrib["type"].partition("[")
                    length += sizes[kind] * (int(count[:-1]) if count else 1)
            lengths[int(message.attrib["id"])] = length
    assert {number: lengths[number] for number in V1_PAYLOAD_LENGTHS} == V1_PAYLOAD_LENGTHS
    assert {number for number in extended if number <= 255} <= set(V1_PAYLOAD_LENGTHS)


def test_several_messages_share_a_datagram_up_to_its_limit() -> None:
    link = Link("a", system_id=1)
    for _ in range(200):
        link.send(heartbeat())
    datagrams = link.drain()
    assert sum(map(len, datagrams)) == 200 * 21
    assert len(datagrams) == 4
    assert max(map(len, datagrams)) <= MAX_DATAGRAM
    assert not link.drain()


def test_a_link_that_nobody_drains_keeps_its_memory() -> None:
    link = Link("a", system_id=1)
    for _ in range(100_000):
        link.forward(HEARTBEAT_V2)
    assert sum(map(len, link.drain())) < 1025 * MAX_DATAGRAM


@pytest.mark.parametrize("byte_stream", [False, True])
def test_a_false_start_swallows_nothing(*, byte_stream: bool) -> None:
    link = Link("a", system_id=1, byte_stream=byte_stream)
    noise = bytes.fromhex("fd ff 00 00")
    messages = link.decode(noise + b"".join(station(seq) for seq in range(20)))
    assert [message.get_seq() for message in messages] == list(range(20))


def test_a_truncated_datagram_does_not_delay_the_next_one() -> None:
    link = Link("a", system_id=1)
    assert link.decode(station()[:-3]) == []
    assert len(link.decode(station())) == 1


def test_a_byte_stream_may_split_frames_anywhere() -> None:
    link = Link("a", system_id=1, byte_stream=True)
    data = b"".join(station(seq) for seq in range(5))
    messages = [message for byte in data for message in link.decode(bytes([byte]))]
    assert [message.get_seq() for message in messages] == list(range(5))


@tried(60)
@given(st.lists(st.one_of(st.just(None), st.binary(max_size=12).filter(lambda b: 0xFD not in b and 0xFE not in b))))
def test_frames_survive_whatever_noise_lies_between(parts: list[bytes | None]) -> None:
    link = Link("a", system_id=1)
    data = b"".join(station() if part is None else part for part in parts)
    assert len(link.decode(data)) == parts.count(None)


@tried(100)
@given(st.lists(st.binary(max_size=300), max_size=8), st.booleans())
def test_no_bytes_raise(chunks: list[bytes], byte_stream: bool) -> None:  # noqa: FBT001 - hypothesis passes by position
    link = Link("a", system_id=1, byte_stream=byte_stream)
    for chunk in chunks:
        link.decode(b"\xfd" + chunk)


@tried(60)
@given(st.integers(0, 8 * len(HEARTBEAT_V2) - 1))
def test_a_flipped_bit_makes_a_frame_invalid(bit: int) -> None:
    frame = bytearray(HEARTBEAT_V2)
    frame[bit // 8] ^= 1 << bit % 8
    assert Link("a", system_id=1).decode(bytes(frame)) == []
