"""A flight over loopback UDP, and a third process that changes its mission."""

import subprocess
import sys
from pathlib import Path

from mission.clock import WallClock
from mission.fly import BundledVehicle, Progress, VehicleOptions, fly
from mission.fly.amendments import AmendmentFolder
from mission.fly.replanner import SynchronousReplanner
from mission.link.lockstep import LockstepLink
from mission.link.transport import open_transport
from mission.monitor.stage import Stage
from mission.report.record import FlightRecord
from mission.spec.loader import load_mission
from tests.support.commands import ROOT
from tests.support.small_missions import SMALL, plan_of

SPEED = 3.0
LINES = "formula F G home & G !pond\nlaps many\n"


def test_lines_on_standard_input_change_the_mission_of_a_flight(tmp_path: Path) -> None:
    options = VehicleOptions(speed=SPEED, seed=1, flavour="ardupilot", ground_station=False)
    handing_in: list[subprocess.Popen[str]] = []
    with FlightRecord.in_folder(tmp_path, "small") as record, BundledVehicle(options) as vehicle:
        assert record.folder is not None
        folder = record.folder
        transport = open_transport(vehicle.address)
        link = LockstepLink(transport, WallClock())

        def watch(progress: Progress) -> None:
            if progress.stage is Stage.CLIMB and not handing_in:
                command = [sys.executable, "-m", "mission", "amend", str(folder)]
                pipe = subprocess.PIPE
                process = subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, text=True, cwd=ROOT)
                handing_in.append(process)
                assert process.stdin is not None
                process.stdin.write(LINES)
                process.stdin.close()

        def keep(number: int, text: str) -> None:
            (folder / f"plan-{number}.json").write_text(text)

        try:
            result = fly(
                plan_of(SMALL),
                link,
                link,
                record,
                on_progress=watch,
                vehicle_failure=vehicle.failure,
                replanner=SynchronousReplanner(link.now_s),
                on_plan=keep,
                amendments=AmendmentFolder(folder),
            )
        finally:
            transport.close()
    [process] = handing_in
    assert process.stdout is not None
    assert process.stderr is not None
    out, errors = process.stdout.read(), process.stderr.read()
    assert process.wait(timeout=60.0) == 1
    process.stdout.close()
    process.stderr.close()
    assert out.startswith("accepted")
    assert errors.startswith("refused")
    assert "`many` is no number of laps" in errors
    assert result.achieved, result.reason
    assert len(result.plans) == 2
    assert result.word[-1] == {"home"}
    assert load_mission(folder / "mission-2.yaml").formula == "F G home & G !pond"
    assert (folder / "plan-2.json").is_file()
