"""A flight over loopback UDP, and a third process that changes its mission."""

import subprocess
import sys
import time
from pathlib import Path
from threading import Event

from mission.clock import WallClock
from mission.fly import BundledVehicle, VehicleOptions, fly
from mission.fly.amendments import AmendmentFolder
from mission.fly.replanner import SynchronousReplanner
from mission.link.lockstep import LockstepLink
from mission.link.transport import open_transport
from mission.report.record import FlightRecord
from mission.spec.loader import load_mission
from tests.support.commands import ROOT
from tests.support.small_missions import SMALL, plan_of

SPEED = 10.0
WITHIN_S = 120.0
LINE = "formula F G home & G !pond\n"


def handed_in(folder: Path) -> "subprocess.Popen[str]":
    """The program with a line on its standard input, once it has handed that in."""
    command = [sys.executable, "-m", "mission", "amend", "--within", f"{WITHIN_S:g}", str(folder)]
    pipe = subprocess.PIPE
    process = subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, text=True, cwd=ROOT)
    assert process.stdin is not None
    process.stdin.write(LINE)
    process.stdin.close()
    until_s, pause = time.monotonic() + WITHIN_S, Event()
    while not list(folder.glob("*.amendment.json")):
        assert process.poll() is None
        assert time.monotonic() < until_s
        pause.wait(0.01)
    return process


def test_a_line_on_standard_input_changes_the_mission_of_a_flight(tmp_path: Path) -> None:
    options = VehicleOptions(speed=SPEED, seed=1, flavour="ardupilot", ground_station=False)
    with FlightRecord.in_folder(tmp_path, "small") as record, BundledVehicle(options) as vehicle:
        assert record.folder is not None
        folder = record.folder
        process = handed_in(folder)
        transport = open_transport(vehicle.address)
        link = LockstepLink(transport, WallClock())
        texts: dict[int, str] = {}
        try:
            result = fly(
                plan_of(SMALL),
                link,
                link,
                record,
                vehicle_failure=vehicle.failure,
                replanner=SynchronousReplanner(link.now_s),
                on_plan=texts.__setitem__,
                amendments=AmendmentFolder(folder),
            )
        finally:
            transport.close()
    assert process.stdout is not None
    assert process.stderr is not None
    out, errors = process.stdout.read(), process.stderr.read()
    assert process.wait(timeout=WITHIN_S) == 0, errors
    process.stdout.close()
    process.stderr.close()
    assert out.startswith("accepted"), errors
    assert result.achieved, result.reason
    assert list(texts) == [2]
    assert result.word[-1] == {"home"}
    assert load_mission(folder / "mission-2.yaml").formula == "F G home & G !pond"
