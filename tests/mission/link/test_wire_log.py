"""What goes over a link, logged as ground stations do."""

import errno
from pathlib import Path

import pytest
from pymavlink import mavutil
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.errors import LinkError
from mission.growing_file import GrowingFile
from mission.link.wire_log import LoggedLink, whole_frames

BEAT = mavlink.MAVLink_heartbeat_message(2, 3, 0, 0, 4, 3)
PING = mavlink.MAVLink_ping_message(7, 1, 0, 0)
NOISE = b"\xfd\x03noise"


def framed(message: mavlink.MAVLink_message, system: int) -> bytes:
    return bytes(message.pack(mavlink.MAVLink(None, srcSystem=system, srcComponent=1)))


class Line:
    """A link on which these pieces arrive."""

    def __init__(self, *pieces: bytes) -> None:
        self.pieces, self.sent, self.broken = [*pieces], b"", False

    def send(self, data: bytes) -> None:
        if self.broken:
            raise LinkError("broken")
        self.sent += data

    def receive(self, within_s: float) -> list[bytes]:
        del within_s
        pieces, self.pieces = self.pieces, []
        return pieces

    def close(self) -> None:
        """Nothing to release."""


class Times:
    """A second passes at each look."""

    def __init__(self) -> None:
        self.us = 1_790_000_000_000_000

    def __call__(self) -> int:
        self.us += 1_000_000
        return self.us


def read(log: Path) -> list[tuple[float, int, str]]:
    """What pymavlink finds: times since the first, systems, names."""
    opened = mavutil.mavlink_connection(str(log))
    found = []
    while (message := opened.recv_match()) is not None:
        found.append((message._timestamp, message.get_srcSystem(), message.get_type()))
    opened.close()
    return [(t_s - found[0][0], system, kind) for t_s, system, kind in found]


def logged(path: Path) -> list[tuple[float, int, str]]:
    """Frames of both directions, logged in ``path``: what pymavlink should find."""
    line = Line(framed(BEAT, 1) + framed(PING, 1), NOISE + framed(PING, 1) + NOISE)
    log = GrowingFile.at(path, whole_frames)
    link = LoggedLink(line, log, Times())
    assert len(link.receive(0.0)) == 2
    link.send(framed(BEAT, 255))
    line.broken = True
    with pytest.raises(LinkError):
        link.send(framed(PING, 255))
    log.close()
    return [(0.0, 1, "HEARTBEAT"), (0.0, 1, "PING"), (0.0, 1, "PING"), (1.0, 255, "HEARTBEAT")]


def test_both_directions_are_logged_and_noise_is_not(tmp_path: Path) -> None:
    expected = logged(tmp_path / "flight.tlog")
    assert read(tmp_path / "flight.tlog") == expected


def test_a_log_cut_within_its_last_frame_is_read_up_to_there(tmp_path: Path) -> None:
    whole, cut = tmp_path / "whole.tlog", tmp_path / "cut.tlog"
    expected, data = logged(whole), whole.read_bytes()
    for end in range(len(data) - 8 - len(framed(BEAT, 255)), len(data)):
        cut.write_bytes(data[:end])
        assert read(cut) == expected[:-1]


def test_a_log_cut_anywhere_is_gone_on_with_after_its_last_whole_frame(tmp_path: Path) -> None:
    whole, cut = tmp_path / "whole.tlog", tmp_path / "cut.tlog"
    expected, data = logged(whole), whole.read_bytes()
    ends = [0, *(end for end in range(1, len(data) + 1) if whole_frames(data[:end]) == end)]
    assert len(ends) == 1 + len(expected)
    for end in range(len(data)):
        cut.write_bytes(data[:end])
        log = GrowingFile.at(cut, whole_frames)
        assert cut.read_bytes() == data[: max(each for each in ends if each <= end)]
        LoggedLink(Line(), log, Times()).send(framed(PING, 255))
        log.close()
        assert whole_frames(cut.read_bytes()) == cut.stat().st_size
    assert read(cut)[:-1] == expected[:-1]


class FullDisk:
    """A disk without room."""

    def write(self, data: bytes, /) -> int:
        del data
        raise OSError(errno.ENOSPC, "no space left on device")

    def close(self) -> None:
        """Nothing to release."""


def test_what_cannot_be_logged_is_carried_all_the_same() -> None:
    line = Line(framed(BEAT, 1))
    link = LoggedLink(line, GrowingFile(FullDisk()), Times())
    assert link.receive(0.0) == [framed(BEAT, 1)]
    link.send(framed(PING, 255))
    assert line.sent == framed(PING, 255)
    link.close()
