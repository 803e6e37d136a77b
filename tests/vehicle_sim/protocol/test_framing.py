"""Frames packed here are those that pymavlink packs, byte for byte, and are read as it reads them."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.drawn_cases import tried
from tests.support.station import Station, endpoint_of
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import Message
from vehicle_sim.protocol.framing import frame_of, message_of
from vehicle_sim.protocol.telemetry import BUILDERS


def mav_of(sequence: int = 0, *, key: bytes | None = None) -> mavlink.MAVLink:
    mav = mavlink.MAVLink(None, srcSystem=7, srcComponent=1)
    mav.seq = sequence
    if key is not None:
        mav.signing.secret_key, mav.signing.sign_outgoing, mav.signing.timestamp = key, True, 1
    return mav


@pytest.mark.parametrize("flavour", list(Flavour))
def test_all_telemetry(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.take_off()
    for number, build in BUILDERS.items():
        message = build(station.endpoint)
        if message is not None:
            assert frame_of(message, mav_of(number % 256)) == message.pack(mav_of(number % 256)), message.get_type()


_BYTE, _WORD = st.integers(0, 255), st.integers(0, 65535)
_MESSAGES = st.one_of(
    st.builds(mavlink.MAVLink_heartbeat_message, _BYTE, _BYTE, _BYTE, st.integers(0, 2**32 - 1), _BYTE, _BYTE),
    st.builds(mavlink.MAVLink_mission_current_message, _WORD),
    st.builds(mavlink.MAVLink_mission_count_message, _BYTE, _BYTE, _WORD, _BYTE),
    st.builds(mavlink.MAVLink_attitude_message, st.integers(0, 2**32 - 1), *[st.floats(width=32)] * 6),
    st.builds(mavlink.MAVLink_timesync_message, *[st.integers(-(2**63), 2**63 - 1)] * 2),
    st.builds(
        mavlink.MAVLink_actuator_output_status_message,
        st.integers(0, 2**64 - 1),
        st.integers(0, 2**32 - 1),
        st.lists(st.floats(width=32), min_size=32, max_size=32),
    ),
    st.builds(mavlink.MAVLink_v2_extension_message, *[_BYTE] * 3, _WORD, st.lists(_BYTE, min_size=249, max_size=249)),
    st.builds(mavlink.MAVLink_statustext_message, _BYTE, st.binary(max_size=50)),
)


@tried(300)
@given(message=_MESSAGES, sequence=_BYTE)
def test_any_values(message: Message, sequence: int) -> None:
    frame, reader = frame_of(message, mav_of(sequence)), mav_of()
    assert frame == message.pack(mav_of(sequence))
    read, expected = message_of(bytearray(frame), reader), reader.decode(bytearray(frame))
    assert type(read) is type(expected)
    assert vars(read.get_header()) == vars(expected.get_header())
    assert bytes(read.get_msgbuf()) == frame == read.pack(mav_of(sequence))


@tried(50)
@given(message=_MESSAGES, at=st.integers(1, 300), change=st.integers(1, 255))
def test_a_byte_that_was_changed_on_the_way(message: Message, at: int, change: int) -> None:
    frame = bytearray(frame_of(message, mav_of()))
    frame[10 + at % (len(frame) - 10)] ^= change  # behind its length and number
    with pytest.raises(mavlink.MAVError):
        message_of(frame, mav_of())


def test_a_message_of_nothing_but_zeros_keeps_one_byte() -> None:
    frame = frame_of(mavlink.MAVLink_mission_ack_message(0, 0, 0), mav_of())
    assert frame == mavlink.MAVLink_mission_ack_message(0, 0, 0).pack(mav_of())
    assert frame[1] == 1


def test_signed_frames_stay_signed() -> None:
    message = mavlink.MAVLink_timesync_message(1, 2)
    frame = frame_of(message, mav_of(key=b"k" * 32))
    assert frame == mavlink.MAVLink_timesync_message(1, 2).pack(mav_of(key=b"k" * 32))
    assert frame[2] == mavlink.MAVLINK_IFLAG_SIGNED
