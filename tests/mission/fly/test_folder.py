"""The folder of a flight that is taken away, or has no room, while it is flown."""

import errno
import io
import json
import shutil
import sys
from pathlib import Path

import pytest

from mission.fly.folder import EVENTS_FILE, LINK_FILE, VERDICT_FILE, FlightFolder
from mission.fly.recording import Recording
from mission.growing_file import GrowingFile
from mission.report.record import RECORD_FILE


class Said(io.BytesIO):
    """A link on which one frame is heard."""

    def send(self, data: bytes) -> None:
        """Nobody listens."""

    def receive(self, within_s: float) -> list[bytes]:  # noqa: ARG002 - a transport's
        return [bytes([0xFD, 0, *[0] * 10])]


@pytest.mark.skipif(sys.platform == "win32", reason="files that are open cannot be removed")
def test_a_folder_that_is_removed_is_told_of_once_and_costs_no_flight(tmp_path: Path) -> None:
    warnings: list[str] = []
    with FlightFolder.begun(tmp_path / "flights", "small", lambda: 0) as folder:
        link = folder.logged(Said())
        record = Recording(folder, warnings.append)
        record.write("event", 1.0, name="before")
        link.receive(0.0)
        assert folder.incomplete == {}
        shutil.rmtree(tmp_path / "flights")
        for t_s in (2.0, 3.0):
            record.write("event", t_s, name="after")
        assert link.receive(0.0)
        assert folder.incomplete == dict.fromkeys((EVENTS_FILE, LINK_FILE), "no such file or directory")
    assert warnings == ["the record cannot be written: no such file or directory; the flight goes on without it"]
    assert record.lost_text == "2 lines of the record could not be written"


@pytest.mark.skipif(sys.platform == "win32", reason="files that are open cannot be removed")
@pytest.mark.parametrize("file", [EVENTS_FILE, RECORD_FILE])
def test_a_verdict_is_kept_whatever_became_of_other_files(file: str, tmp_path: Path) -> None:
    with FlightFolder.begun(tmp_path, "small", lambda: 0) as folder:
        (folder.path / file).unlink()
        Recording(folder, lambda _: None).write("verdict", 1.0, achieved=True)
    assert json.loads((folder.path / VERDICT_FILE).read_text())["achieved"] is True


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a file on a disk that is full")
def test_what_has_no_room_says_why() -> None:
    with Path("/dev/full").open("wb", buffering=0) as full:
        file = GrowingFile(full)
        for _ in range(2):
            with pytest.raises(OSError, match="No space"):
                file.add(b"entry")
    assert file.failure is not None
    assert file.failure.errno == errno.ENOSPC
