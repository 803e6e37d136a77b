"""Everything that a ground station asks for gets an answer: clocks, texts, files."""

from struct import pack

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.drawn_cases import tried
from tests.support.station import Station, endpoint_of
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.statustext import CHUNK, TextChunker


@pytest.mark.parametrize("flavour", Flavour)
def test_timesync_is_answered_at_once_in_nanoseconds(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.run(1.23)
    station.send(mavlink.MAVLink_timesync_message(0, 123_456_789))
    answer = station.last("TIMESYNC")
    assert (answer.tc1, answer.ts1) == (1_230_000_000, 123_456_789)
    station.forget()
    station.send(mavlink.MAVLink_timesync_message(5, 6))
    assert station.heard == []


@pytest.mark.parametrize("flavour", Flavour)
def test_ping_is_answered_by_px4_only(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.send(mavlink.MAVLink_ping_message(77, 5, 0, 0))
    answers = [(m.time_usec, m.seq, m.target_system, m.target_component) for m in station.of("PING")]
    assert answers == ([(77, 5, 255, 190)] if flavour is Flavour.PX4 else [])


def test_answers_to_files_are_not_answered() -> None:
    station = Station(endpoint_of(Flavour.PX4))
    for opcode in (128, 129):
        reply = pack("<HBBBBBxI", 1, 3, opcode, 0, 0, 0, 0)
        station.send(mavlink.MAVLink_file_transfer_protocol_message(0, 1, 1, reply.ljust(251, b"\0")))
    assert station.heard == []


def test_an_origin_that_is_asked_for_is_told() -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    station.send(mavlink.MAVLink_set_gps_global_origin_message(1, 0, 0, 0))
    assert station.heard == []
    station.wait_for_position()
    station.forget()
    station.send(mavlink.MAVLink_set_gps_global_origin_message(1, 0, 0, 0))
    assert station.last("GPS_GLOBAL_ORIGIN").latitude != 0


@tried(60)
@given(st.text(st.characters(min_codepoint=32, max_codepoint=126), max_size=400))
def test_chunks_of_a_text_spell_it(text: str) -> None:
    chunker = TextChunker()
    for number in (1, 2):
        messages = chunker.messages(4, text)
        assert "".join(message.text for message in messages) == text
        if len(text) <= CHUNK:
            assert [(message.id, message.chunk_seq) for message in messages] == [(0, 0)]
        else:
            assert [message.chunk_seq for message in messages] == list(range(len(messages)))
            assert {message.id for message in messages} == {number}
            assert len(messages[-1].text) < CHUNK  # a full last chunk would ask for another


def test_texts_are_ascii() -> None:
    (message,) = TextChunker().messages(4, "höher")
    assert message.text == "h?her"
