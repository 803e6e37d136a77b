"""Frames among noise and damage: what a checksum vouches for is found, whatever stands around it."""

import random
from itertools import accumulate, pairwise

from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.link.framing import Stream, split
from mission.link.messages import Codec
from mission.link.values import LocalPosition

_KEY = bytes(range(32))
_STRAY = bytes.fromhex("fdff00")


def _position(number: int, *, old: bool = False, signed: bool = False) -> bytes:
    mav = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    if signed:
        mav.signing.secret_key, mav.signing.sign_outgoing, mav.signing.timestamp = _KEY, True, 1
    message = mavlink.MAVLink_local_position_ned_message(number, 1.5, -2.5, -10.0, 0.5, 0.25, 0.125)
    return bytes(message.pack(mav, force_mavlink1=old))


def _unneeded(number: int) -> bytes:
    mav = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    return bytes(mavlink.MAVLink_vfr_hud_message(1.0, 1.0, 90, number % 100, 10.0, 0.0).pack(mav))


def _numbers(pieces: list[bytes]) -> list[int]:
    codec = Codec(255, 191)
    bodies = [received.body for piece in pieces for received in codec.decode(piece)]
    return [body.time_boot_ms for body in bodies if isinstance(body, LocalPosition)]


_FRAMES = st.lists(st.tuples(st.booleans(), st.booleans()), min_size=1, max_size=8).map(
    lambda kinds: [_position(n, old=old, signed=signed and not old) for n, (old, signed) in enumerate(kinds)]
)
# Beginnings of frames are what noise must be made of to do harm.
_NOISE = st.lists(
    st.one_of(st.binary(max_size=12), st.sampled_from([_STRAY, b"\xfd", b"\xfe\xff", b"\xfd\x09\x01\x00"])), max_size=4
).map(b"".join)


def _cut(data: bytes, cuts: list[int]) -> list[bytes]:
    ends = sorted({0, len(data), *(cut % (len(data) + 1) for cut in cuts)})
    return [data[a:b] for a, b in pairwise(ends)]


def _streamed(pieces: list[bytes]) -> list[bytes]:
    stream = Stream()
    return [stream.take(piece) for piece in pieces]


@given(_FRAMES, st.lists(_NOISE, min_size=9, max_size=9))
def test_noise_between_frames_of_a_datagram_costs_none_of_them(frames: list[bytes], noise: list[bytes]) -> None:
    data = b"".join(between + frame for between, frame in zip(noise, frames, strict=False)) + noise[-1]
    assert _numbers([data]) == list(range(len(frames)))


@given(_FRAMES, st.lists(_NOISE, min_size=9, max_size=9))
def test_noise_in_datagrams_of_its_own_costs_no_frame_of_the_next(frames: list[bytes], noise: list[bytes]) -> None:
    assert _numbers([piece for pair in zip(noise, frames, strict=False) for piece in pair]) == list(range(len(frames)))


def test_half_a_frame_of_one_peer_is_not_completed_by_another() -> None:
    frame = _position(7)
    assert _numbers([frame[:20], _position(8), frame[20:]]) == [8]


@given(_FRAMES, st.lists(_NOISE, min_size=9, max_size=9), st.lists(st.integers(0, 10_000), max_size=12))
def test_a_stream_may_be_cut_anywhere_and_hold_noise(frames: list[bytes], noise: list[bytes], cuts: list[int]) -> None:
    data = b"".join(between + frame for between, frame in zip(noise, frames, strict=False)) + noise[-1]
    # What noise at the end seems to begin is waited for, and no longer than a frame is.
    pieces = _streamed([*_cut(data, cuts), bytes(300)])
    assert b"".join(pieces) == data + bytes(300)
    assert _numbers(pieces) == list(range(len(frames)))


def test_a_frame_of_a_stream_is_there_with_its_last_byte() -> None:
    frame = _position(7)
    pieces = _streamed([frame[i : i + 1] for i in range(len(frame))])
    assert [len(piece) for piece in pieces] == [0] * (len(frame) - 1) + [len(frame)]


@given(st.binary(max_size=600), st.lists(st.integers(0, 600), max_size=20))
def test_what_a_stream_keeps_back_is_less_than_a_frame(noise: bytes, cuts: list[int]) -> None:
    pieces = _cut(noise, cuts)
    given_back = accumulate(map(len, _streamed(pieces)))
    assert all(sent - given < 280 for sent, given in zip(accumulate(map(len, pieces)), given_back, strict=True))


@given(st.sampled_from([0.02, 0.1, 0.3, 0.7, 1.0]), st.integers(0, 2**32), st.booleans())
def test_damaged_lengths_cost_the_frames_that_they_hit_and_no_other(rate: float, seed: int, streamed: bool) -> None:  # noqa: FBT001 - drawn
    numbers = random.Random(seed)  # noqa: S311 - damage, not a secret
    intact, data = [], bytearray()
    for sent in range(60):
        frame = bytearray(_position(sent) if sent % 3 else _unneeded(sent))
        hit = numbers.random() < rate
        if hit:
            frame[1] = (frame[1] + numbers.randrange(1, 256)) % 256
        elif sent % 3:
            intact.append(sent)
        data += frame
    pieces = [bytes(data)]
    if streamed:
        pieces = _streamed([*_cut(bytes(data), [numbers.randrange(len(data)) for _ in range(30)]), bytes(300)])
    assert _numbers(pieces) == intact


def test_three_stray_bytes_many_times_a_second_cost_no_report() -> None:
    telemetry = [_position(n) for n in range(420)]
    assert _numbers([piece for report in telemetry for piece in (_STRAY, report, _STRAY)]) == list(range(420))


def test_a_frame_of_a_message_that_is_not_of_the_dialect_hides_nothing() -> None:
    inside = _position(5)
    unknown = bytes((0xFD, len(inside), 0, 0, 0, 1, 1, 0xFF, 0xFF, 0x7F)) + inside + b"\0\0"
    assert [frame.data for frame in split(unknown)[0]] == [inside]


@given(st.sampled_from([0, 1, 30, 32, 33, 49, 77, 147, 148, 193, 230, 245, 253]), st.binary(max_size=255))
def test_any_payload_under_a_right_checksum_is_read_without_an_error(number: int, payload: bytes) -> None:
    covered = bytes((len(payload), 0, 0, 0, 1, 1, number, 0, 0)) + payload
    extra = bytes((mavlink.mavlink_map[number].crc_extra,))
    frame = b"\xfd" + covered + mavlink.x25crc(covered + extra).crc.to_bytes(2, "little")
    assert len(Codec(255, 191).decode(frame)) == 1
