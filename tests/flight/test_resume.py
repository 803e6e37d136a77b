"""``mission fly`` killed in flight by SIGKILL, and ``mission fly --resume``: processes, loopback UDP, real files."""

import json
import os
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest

from mission.cli import main
from mission.report.reading import read_record
from tests.support.commands import ROOT
from tests.support.small_missions import SMALL
from tests.support.vehicle_program import running

SPEED = "4"
LONGEST_S = 120.0


def flying(folder: Path) -> bool:
    """Whether the record in a folder of flights says that the trajectory has been flown for a while."""
    for record in folder.glob("*/record.jsonl"):
        for line in record.read_bytes().splitlines():
            with suppress(ValueError):
                if (json.loads(line).get("trajectory_s") or 0.0) > 4.0:
                    return True
    return False


@pytest.mark.skipif(sys.platform == "win32", reason="SIGKILL")
@pytest.mark.parametrize("flavour", ["ardupilot", pytest.param("px4", marks=pytest.mark.long)])
def test_a_killed_program_is_followed_by_another(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], flavour: str
) -> None:
    mission, flights = tmp_path / "small.yaml", tmp_path / "flights"
    mission.write_text(SMALL)
    with running("--speed", SPEED, "--flavour", flavour, "--listen", "udpin:127.0.0.1:0") as (_, addresses):
        address = addresses[0].replace("udpin", "udpout")
        command = [sys.executable, "-m", "mission", "fly", str(mission), "--connect", address, "--out", str(flights)]
        process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for _ in range(int(LONGEST_S / 0.1)):
            with suppress(subprocess.TimeoutExpired):
                process.wait(timeout=0.1)
            if process.poll() is not None or flying(flights):
                break
        assert process.poll() is None
        [folder] = flights.iterdir()
        assert main(["fly", "--resume", str(folder), "--connect", address]) == 2
        assert "another program still flies this flight" in capsys.readouterr().err
        os.kill(process.pid, signal.SIGKILL)
        process.wait(timeout=LONGEST_S)
        cut = read_record(folder)
        assert cut.verdict is None
        assert main(["fly", "--resume", str(folder), "--connect", address, "--no-pictures"]) == 0
    said = capsys.readouterr().out
    assert "taken up again from" in said
    assert "ACHIEVED" in said
    record = read_record(folder)
    assert record.verdict is not None
    assert record.verdict["achieved"] is True
    assert [number for _, number, _, _ in record.takeovers] == [2]
    assert (folder / "plan-2.json").is_file()
    assert main(["fly", "--resume", str(folder), "--connect", address]) == 2
    assert "has come to its end" in capsys.readouterr().err


def test_what_does_not_go_with_resuming_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["fly"]) == 2
    assert "no mission file is named" in capsys.readouterr().err
    assert main(["fly", "--resume", str(tmp_path), "--laps", "3"]) == 2
    said = capsys.readouterr().err
    assert "--laps" in said
    assert "--connect" in said
    assert main(["fly", "--resume", str(tmp_path), "--connect", "udpout:127.0.0.1:9"]) == 2
    assert "this is not the folder of a flight" in capsys.readouterr().err
