"""The ground side of signed packets: judged by pymavlink's own signing, which shares nothing with it."""

import hashlib
import os
from pathlib import Path
from typing import Any

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.errors import LinkError, SpecError
from mission.link.contact import Contact
from mission.link.identity import LinkOptions
from mission.link.key_file import open_signatures
from mission.link.messages import Codec
from mission.link.signing import Signatures

KEY, OTHER = bytes(range(32)), bytes(range(1, 33))
NOW = 30_000_000 * 100_000
MINUTE = 60 * 100_000
BEAT = mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 3, 3)


def signatures(key: bytes = KEY) -> Signatures:
    return Signatures(key, lambda: NOW)


def vehicle(key: bytes | None, timestamp: int = NOW, system: int = 1) -> Any:  # noqa: ANN401 - pymavlink ships no types
    mav = mavlink.MAVLink(None, srcSystem=system, srcComponent=1)
    mav.robust_parsing = True
    if key is not None:
        mav.signing.secret_key, mav.signing.sign_outgoing, mav.signing.timestamp = key, True, timestamp
    return mav


def test_what_is_sent_is_signed_and_accepted_by_who_holds_the_key() -> None:
    codec, holder, other = Codec(255, 191, signatures()), vehicle(KEY), vehicle(OTHER)
    frames = [codec.heartbeat() for _ in range(3)]
    for frame in frames:
        assert [m.get_type() for m in holder.parse_buffer(frame)] == ["HEARTBEAT"]
        assert [m.get_type() for m in other.parse_buffer(frame)] == ["BAD_DATA"]
    assert [m.get_type() for m in holder.parse_buffer(frames[-1])] == ["BAD_DATA"]  # heard before
    stamps = [int.from_bytes(frame[-12:-6], "little") for frame in frames]
    assert stamps == [NOW, NOW + 1, NOW + 2]


def test_what_is_sent_later_is_signed_later() -> None:
    contact = Contact(LinkOptions(signatures=signatures()), needs_origin=False)
    ping = mavlink.MAVLink_ping_message(1_000_000, 7, 0, 0)
    contact.receive(bytes(ping.pack(vehicle(KEY))), 0.0)
    contact.advance(0.0)
    holder = vehicle(KEY, 0)
    heard = [m.get_type() for frame in contact.outgoing() for m in holder.parse_buffer(frame)]
    assert heard == ["HEARTBEAT", "PING"]


def test_only_what_is_rightly_signed_and_new_is_heard() -> None:
    codec = Codec(255, 191, signatures())
    genuine = bytes(BEAT.pack(vehicle(KEY)))
    damaged = bytearray(genuine)
    damaged[-1] ^= 1
    refused = [
        BEAT.pack(vehicle(None)),
        BEAT.pack(vehicle(None), force_mavlink1=True),
        BEAT.pack(vehicle(OTHER, 2 * NOW)),
        BEAT.pack(vehicle(KEY, NOW - MINUTE - 1, system=9)),
        damaged,
    ]
    for frame in refused:
        assert codec.decode(bytes(frame)) == []
    assert codec.refused == len(refused)
    assert len(codec.decode(genuine)) == 1
    assert codec.decode(genuine) == []
    assert codec.decode(BEAT.pack(vehicle(KEY, NOW - 5))) == []
    assert len(codec.decode(BEAT.pack(vehicle(KEY, NOW + 5)))) == 1


def test_timestamps_go_on_over_restarts_and_follow_what_is_heard() -> None:
    kept = [0]
    used: list[int] = []
    for _ in range(3):
        signer = Signatures(KEY, lambda: 7, begin=kept[0], keep=lambda stamp: kept.__setitem__(0, stamp))
        used += [signer.stamp() for _ in range(4)]
        assert used[-1] <= kept[0]
    assert used == sorted(set(used))
    signer = signatures()
    assert signer.take(bytes(BEAT.pack(vehicle(KEY, NOW + 1000))))
    assert signer.stamp() == NOW + 1001


def test_what_an_earlier_run_heard_is_not_heard_again() -> None:
    kept = [0]
    signer = Signatures(KEY, lambda: NOW, keep=lambda stamp: kept.__setitem__(0, stamp))
    recorded = bytes(BEAT.pack(vehicle(KEY, NOW + 500)))
    assert signer.take(recorded)
    crashed = Signatures(KEY, lambda: NOW, begin=kept[0])
    signer.end()
    ended = Signatures(KEY, lambda: NOW, begin=kept[0])
    for later in (crashed, ended):
        assert not later.take(recorded)
        assert later.take(bytes(BEAT.pack(vehicle(KEY, later.stamp()))))  # who has heard us signs by a later time
    assert ended.take(bytes(BEAT.pack(vehicle(KEY, NOW + 700, system=9))))


def test_a_clock_that_is_ahead_is_told_of_once_with_what_to_do(tmp_path: Path) -> None:
    file, year = tmp_path / "key", 365 * 24 * 60 * MINUTE
    file.write_bytes(KEY)
    file.chmod(0o600)
    said: list[str] = []
    signer = open_signatures(file, (255, 191), said.append)
    now = signer.stamp()
    assert signer.take(bytes(BEAT.pack(vehicle(KEY, now + MINUTE // 2))))
    assert said == []
    for later in range(2):
        assert signer.take(bytes(BEAT.pack(vehicle(KEY, now + year + later, system=7))))
    assert not signer.take(bytes(BEAT.pack(vehicle(KEY, now + MINUTE, system=8))))
    (told,) = said
    assert told.startswith("system 7, component 1 signs by a clock 365.0 days ahead of this machine's: ")
    assert f"end every program with the key, delete {file}.timestamp.255.191" in told
    open_signatures(file, (255, 191), said.append)
    assert said[1].startswith(f"the timestamps in {file}.timestamp.255.191 are 365.0 days ahead")
    (tmp_path / "key.timestamp.255.191").unlink()
    assert open_signatures(file, (255, 191), said.append).take(bytes(BEAT.pack(vehicle(KEY, now, system=8))))
    assert len(said) == 2


def test_the_memory_of_senders_is_bounded_and_forgets_none() -> None:
    signer = signatures()
    frames = [bytes(BEAT.pack(vehicle(KEY, system=system))) for system in range(1, 101)]
    assert sum(signer.take(frame) for frame in frames) == 64
    assert not any(signer.take(frame) for frame in frames)


@pytest.mark.parametrize(
    ("content", "key"),
    [
        (KEY, KEY),
        (KEY.hex().encode(), KEY),
        (KEY.hex().upper().encode() + b"\n", KEY),
        (b"open sesame\n", hashlib.sha256(b"open sesame").digest()),
        (b"thirty-two letters are no key...", hashlib.sha256(b"thirty-two letters are no key...").digest()),
        ("Büchi".encode(), hashlib.sha256("Büchi".encode()).digest()),
    ],
)
def test_key_files(tmp_path: Path, content: bytes, key: bytes) -> None:
    file = tmp_path / "key"
    file.write_bytes(content)
    file.chmod(0o600)
    said: list[str] = []
    assert open_signatures(file, (255, 191), said.append).key == key
    assert said == []


@pytest.mark.parametrize("content", [b"", b"\n", KEY[:31], bytes(32), b"0" * 64, b"two\nlines\n", b"\xff" * 33])
def test_what_is_no_key_says_what_to_write(tmp_path: Path, content: bytes) -> None:
    file = tmp_path / "key"
    file.write_bytes(content)
    with pytest.raises(SpecError, match="holds no signing key") as error:
        open_signatures(file, (255, 191), lambda _text: None)
    assert "passphrase" in error.value.faults[0].hint


@pytest.mark.skipif(os.name != "posix", reason="permissions are POSIX")
def test_a_key_that_others_can_read_is_told_of(tmp_path: Path) -> None:
    file = tmp_path / "key"
    file.write_bytes(KEY)
    file.chmod(0o644)
    said: list[str] = []
    open_signatures(file, (255, 191), said.append)
    assert "chmod 600" in said[0]


def test_timestamps_are_kept_beside_the_key(tmp_path: Path) -> None:
    file = tmp_path / "key"
    file.write_bytes(KEY)
    last = [open_signatures(file, (255, 191), lambda _text: None).stamp() for _ in range(3)]
    assert last == sorted(set(last))
    beside = tmp_path / "key.timestamp.255.191"
    assert int(beside.read_text()) >= last[-1]
    beside.write_text("soon")
    with pytest.raises(SpecError, match="timestamp"):
        open_signatures(file, (255, 191), lambda _text: None)
    with pytest.raises(SpecError, match="cannot be read"):
        open_signatures(tmp_path / "none", (255, 191), lambda _text: None)


@pytest.mark.skipif(os.name != "posix", reason="permissions and links are POSIX")
def test_timestamps_are_for_their_owner_and_lead_nowhere_else(tmp_path: Path) -> None:
    file, victim = tmp_path / "key", tmp_path / "victim"
    file.write_bytes(KEY)
    victim.write_text("kept")
    for name in ("key.timestamp.255.191.new", "key.timestamp.255.191"):
        (tmp_path / name).symlink_to(victim)
    victim.write_text("7")  # a link to read from does no harm
    open_signatures(file, (255, 191), lambda _text: None).stamp()
    assert victim.read_text() == "7"
    beside = tmp_path / "key.timestamp.255.191"
    assert not beside.is_symlink()
    assert beside.stat().st_mode & 0o777 == 0o600


def test_the_vehicle_that_was_asked_for_is_met_and_no_other() -> None:
    contact = Contact(LinkOptions(vehicle_id=2, connect_s=1.0), needs_origin=False)
    contact.receive(BEAT.pack(vehicle(None, system=1)), 0.0)
    assert contact.autopilot is None
    contact.receive(BEAT.pack(vehicle(None, system=2)), 0.0)
    assert contact.autopilot is not None


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (LinkOptions(vehicle_id=2, connect_s=1.0), "no vehicle of system id 2 was heard, only of 1,"),
        (LinkOptions(signatures=signatures(), connect_s=1.0), "signs with this key, but 1 other packets"),
    ],
)
def test_a_vehicle_that_was_not_heard_is_told_from_silence(options: LinkOptions, words: str) -> None:
    contact = Contact(options, needs_origin=False)
    contact.advance(0.0)
    contact.receive(BEAT.pack(vehicle(None)), 0.5)
    with pytest.raises(LinkError, match=words):
        contact.advance(2.0)


def test_timestamps_that_cannot_be_kept_in_flight_cost_one_warning(tmp_path: Path) -> None:
    folder = tmp_path / "keys"
    folder.mkdir()
    path = folder / "key"
    path.write_bytes(KEY)
    path.chmod(0o600)
    said: list[str] = []
    kept = open_signatures(path, (255, 191), said.append)
    stamps = [kept.stamp()]
    folder.rename(tmp_path / "gone")
    kept._kept = 0  # what was kept ahead is used up
    stamps += [kept.stamp() for _ in range(3)]
    kept._kept = 0
    stamps.append(kept.stamp())
    assert stamps == sorted(set(stamps))
    assert len(said) == 1
    assert "timestamp.255.191 cannot be written: no such file" in said[0]
