"""The record of a flight: whole lines, whatever happens."""

import errno
import io
import json
import math
import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.errors import RecordError
from mission.report.reading import parse_record, read_record
from mission.report.record import SCHEMA, FlightRecord, new_flight_folder
from mission.spec.model import RegionKind
from mission.whole_file import write_whole
from tests.support.drawn_cases import tried


def a_flight(record: FlightRecord) -> None:
    record.write("vehicle", 0.5, autopilot="ArduPilot", system_id=1)
    for k in range(5):
        t = 1.0 + 0.1 * k
        position = np.array([k, -2.0 * k, math.nan if k == 3 else 5.0])
        record.write("telemetry", t, position_m=position, velocity_m_s=[1, 2, 3], attitude_rad=(0.1, 0.2, 0.3))
        record.write("setpoint", t, position_m=(k, 0.0, 5.0), trajectory_s=None if k == 0 else 0.1 * k)
    record.write("visit", 1.2, triangle=np.int64(3), labels=frozenset({"S1", "A"}))
    record.write("event", 1.3, name="armed", mode=RegionKind.HOME)
    record.write("text", 1.4, severity=4, text="wind\u2028 <b>high</b>\n")
    record.write("verdict", 2.0, achieved=True, reason="all visited")


def bytes_of_a_flight() -> bytes:
    stream = io.BytesIO()
    a_flight(FlightRecord(stream, mission="paper"))
    return stream.getvalue()


def test_what_was_written_is_read_back() -> None:
    record = parse_record(bytes_of_a_flight())
    assert record.mission == "paper"
    assert record.vehicle == {"t_s": 0.5, "autopilot": "ArduPilot", "system_id": 1}
    np.testing.assert_array_equal(record.track.t_s, 1.0 + 0.1 * np.arange(5))
    np.testing.assert_array_equal(record.track.position_m[:, 1], -2.0 * np.arange(5))
    assert np.flatnonzero(np.isnan(record.track.position_m[:, 2])).tolist() == [3]
    assert record.track.attitude_rad.shape == (5, 3)
    assert np.isnan(record.setpoints.trajectory_s[0])
    np.testing.assert_array_equal(record.setpoints.trajectory_s[1:], 0.1 * np.arange(1, 5))
    assert np.isnan(record.setpoints.acceleration_m_s2).all()
    assert record.visits[0].triangle == 3
    assert record.visits[0].labels == {"S1", "A"}
    assert record.events[0].text == "armed"
    assert record.events[0].values == {"mode": "home"}
    assert record.texts[0].text == "wind\u2028 <b>high</b>\n"
    assert record.texts[0].values == {"severity": 4}
    assert record.verdict == {"t_s": 2.0, "achieved": True, "reason": "all visited"}
    assert not record.cut


def test_a_record_cut_at_any_byte_gives_every_line_that_was_whole() -> None:
    data = bytes_of_a_flight()
    for end in range(len(data)):
        record = parse_record(data[:end])
        lines = [json.loads(line) for line in data[:end].splitlines(keepends=True) if line.endswith(b"\n")]
        assert len(record.track.t_s) == sum(line["kind"] == "telemetry" for line in lines)
        assert len(record.setpoints.t_s) == sum(line["kind"] == "setpoint" for line in lines)
        assert len(record.texts) == sum(line["kind"] == "text" for line in lines)
        assert record.cut == (end > 0 and data[end - 1 : end] != b"\n")
        assert record.verdict is None


def test_the_bytes_follow_from_the_values_alone(tmp_path: Path) -> None:
    data = bytes_of_a_flight()
    assert data == bytes_of_a_flight()
    with FlightRecord.in_folder(tmp_path, "paper") as record:
        a_flight(record)
    assert (tmp_path / "paper-1" / "record.jsonl").read_bytes() == data
    assert data.isascii()
    assert json.loads(data.split(b"\n")[0]) == {"kind": "header", "mission": "paper", "schema": SCHEMA, "t_s": None}


def test_lines_are_on_disk_before_the_record_is_closed(tmp_path: Path) -> None:
    with FlightRecord.in_folder(tmp_path, "paper") as record:
        assert record.folder is not None
        for k in range(3):
            record.write("telemetry", float(k), position_m=(0, 0, k))
            assert len(read_record(record.folder).track.t_s) == k + 1


class Disk:
    """A disk with room for so many bytes."""

    def __init__(self, room: int) -> None:
        self.data, self.room = b"", room

    def write(self, data: bytes, /) -> int:
        if self.room == 0:
            raise OSError(errno.ENOSPC, "no space left on device")
        taken = data[: self.room]
        self.data, self.room = self.data + taken, self.room - len(taken)
        return len(taken)

    def close(self) -> None:
        """Nothing to release."""


@pytest.mark.parametrize("room", [0, 1, 7])
def test_a_line_that_a_full_disk_cuts_is_completed_when_there_is_room_again(room: int) -> None:
    disk = Disk(10_000)
    record = FlightRecord(disk, mission="small")
    disk.room = room
    for number in range(3):
        with pytest.raises(OSError, match="no space"):
            record.write("event", 1.0, name=f"full {number}")
    disk.room = 10_000
    record.write("event", 2.0, name="room again")
    read = parse_record(disk.data)
    assert [event.text for event in read.events] == [*(["full 0"] if room else []), "room again"]
    assert not read.cut


def test_no_flight_writes_over_another(tmp_path: Path) -> None:
    names = [new_flight_folder(tmp_path / "flights", "paper").name for _ in range(3)]
    assert names == ["paper-1", "paper-2", "paper-3"]
    stamped = [new_flight_folder(tmp_path, "paper", "20250101T000000Z").name for _ in range(2)]
    assert stamped == ["paper-20250101T000000Z", "paper-20250101T000000Z-2"]


@pytest.mark.parametrize("name", ["../../etc", "a/b\\c", "..", "", "\0", "Vermessung Süd: 1", "x" * 500, "-rf", ".git"])
def test_the_name_of_a_mission_cannot_leave_the_folder(tmp_path: Path, name: str) -> None:
    folder = new_flight_folder(tmp_path, name)
    assert folder.parent == tmp_path
    assert folder.resolve().parent == tmp_path.resolve()
    assert not folder.name.startswith((".", "-"))


@tried(60)
@given(st.recursive(st.none() | st.booleans() | st.floats() | st.text(), st.lists, max_leaves=8))
def test_any_value_of_an_event_survives(value: object) -> None:
    stream = io.BytesIO()
    FlightRecord(stream, mission="m").write("event", 0.0, name="e", value=value)
    assert stream.getvalue().count(b"\n") == 2
    assert parse_record(stream.getvalue()).events[0].values == {"value": without_infinities(value)}


def without_infinities(value: object) -> object:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return [without_infinities(part) for part in value] if isinstance(value, list) else value


def test_what_is_no_value_is_refused() -> None:
    with pytest.raises(TypeError, match="object"):
        FlightRecord(io.BytesIO(), mission="m").write("event", 0.0, name=object())


HEADER = b'{"kind":"header","t_s":null,"mission":"m","schema":1}\n'


@pytest.mark.parametrize(
    ("data", "line"),
    [
        (b"{}\n", 1),
        (b'{"kind":"telemetry","t_s":0}\n', 1),
        (b'{"kind":"header","t_s":null,"schema":99}\n', 1),
        (HEADER + b"garbage\n" + HEADER, 2),
        (HEADER + b"[1]\n", 2),
        (HEADER + b"[" * 100_000 + b"\n", 2),
        (HEADER + b'{"kind":"telemetry","t_s":0,"position_m":[1,2]}\n', 0),
        (HEADER + b'{"kind":"visit","t_s":0,"triangle":"x","labels":[]}\n', 0),
        (HEADER + b'{"kind":"event","t_s":[]}\n', 0),
    ],
)
def test_damage_before_the_end_is_an_error_with_its_line(data: bytes, line: int) -> None:
    with pytest.raises(RecordError) as caught:
        parse_record(data)
    assert caught.value.line == line
    assert caught.value.exit_code == 2


@pytest.mark.skipif(os.name != "posix", reason="links are POSIX")
@pytest.mark.parametrize("private", [False, True])
def test_no_link_leads_the_writing_elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, private: bool) -> None:
    victim, path = tmp_path / "victim", tmp_path / "plan.json"
    victim.write_text("kept")
    (tmp_path / f".plan.json.{os.getpid()}.part").symlink_to(victim)
    path.symlink_to(victim)
    write_whole(path, "written", private=private)
    assert (victim.read_text(), path.read_text(), path.is_symlink()) == ("kept", "written", False)
    assert (path.stat().st_mode & 0o077 == 0) == private
    monkeypatch.setattr("mission.whole_file.token_hex", lambda _bytes: "guessed")
    (tmp_path / ".guessed.part").symlink_to(victim)
    with pytest.raises(FileExistsError):
        write_whole(path, "written again", private=private)
    assert (victim.read_text(), path.read_text()) == ("kept", "written")
    assert (tmp_path / ".guessed.part").is_symlink()


def test_a_file_is_written_whole_or_not_at_all(tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    write_whole(path, "Büchi")
    assert path.read_bytes() == "Büchi".encode()
    write_whole(path, b"\x00\x01")
    assert path.read_bytes() == b"\x00\x01"
    with pytest.raises(UnicodeEncodeError):
        write_whole(path, "\ud800")
    with pytest.raises(FileNotFoundError):
        write_whole(tmp_path / "nowhere" / "plan.json", b"")
    assert [file.name for file in tmp_path.iterdir()] == ["plan.json"]
    assert path.read_bytes() == b"\x00\x01"
