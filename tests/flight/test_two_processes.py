"""Planner and vehicle as two processes over loopback UDP, in lock-step: as fast as the machine can."""

import os
import select
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from mission.cli import main
from mission.clock import WallClock
from mission.errors import LinkError
from mission.fly import BundledVehicle, FlightOptions, FlightResult, Progress, StopSignals, VehicleOptions, fly
from mission.link.ending import Ending
from mission.link.lockstep import LockstepLink
from mission.link.transport import open_transport
from mission.monitor.stage import Stage
from mission.report.reading import read_record
from mission.report.record import RECORD_FILE, FlightRecord
from tests.support.commands import ROOT
from tests.support.small_missions import ROUNDS, SMALL, plan_of
from tests.support.usual_cases import PX4

SPEED = 500.0
"""More than any machine reaches."""


class TwoProcesses:
    """One flight; what is watched may act on the vehicle's process."""

    def __init__(self, folder: Path, flavour: str = "ardupilot", text: str = SMALL, speed: float = SPEED) -> None:
        self.folder, self.flavour, self.text, self.speed = folder, flavour, text, speed
        self.process_id = 0

    def run(self) -> FlightResult:
        plan = plan_of(self.text)
        acted: list[bool] = []
        options = VehicleOptions(speed=self.speed, seed=1, flavour=self.flavour, ground_station=False)
        with FlightRecord.in_folder(self.folder, "small") as record, BundledVehicle(options) as vehicle:
            self.process_id = vehicle.process_id
            transport = open_transport(vehicle.address)
            link = LockstepLink(transport, WallClock())

            def watch(progress: Progress) -> None:
                if progress.stage is Stage.FLY and progress.trajectory_s > 5.0 and not acted:
                    acted.append(True)
                    self.act(vehicle)

            with StopSignals() as stop:
                try:
                    return fly(
                        plan,
                        link,
                        link,
                        record,
                        options=FlightOptions(land_when_stopped=True),
                        on_progress=watch,
                        vehicle_failure=vehicle.failure,
                        stop_request=stop.take,
                    )
                finally:
                    transport.close()

    def act(self, vehicle: BundledVehicle) -> None:
        """Do nothing by default."""


def is_running(process_id: int) -> bool:
    try:
        os.kill(process_id, 0)
    except ProcessLookupError:
        return False
    return True


@PX4
def test_a_flight_over_udp_is_the_same_at_any_speed(tmp_path: Path, flavour: str) -> None:
    for speed in (15.0, SPEED):
        flight = TwoProcesses(tmp_path, flavour, speed=speed)
        result = flight.run()
        assert result.achieved, result.reason
        assert not is_running(flight.process_id)
    record = read_record(tmp_path / "small-1")
    assert record.verdict is not None
    assert record.verdict["setpoints"] > 100
    one, other = ((tmp_path / folder / RECORD_FILE).read_bytes() for folder in ("small-1", "small-2"))
    assert one == other


def test_the_vehicle_killed_in_flight_is_a_link_failure_with_a_readable_record(tmp_path: Path) -> None:
    class Killed(TwoProcesses):
        def act(self, vehicle: BundledVehicle) -> None:
            os.kill(vehicle.process_id, signal.SIGKILL)

    flight = Killed(tmp_path)
    with pytest.raises(LinkError, match="has ended"):
        flight.run()
    assert not is_running(flight.process_id)
    record = read_record(tmp_path / "small-1")
    assert not record.cut
    assert record.verdict is not None
    assert record.verdict["achieved"] is False
    assert len(record.track.t_s) > 50


def test_ctrl_c_lands_the_bundled_vehicle(tmp_path: Path) -> None:
    class Interrupted(TwoProcesses):
        def act(self, vehicle: BundledVehicle) -> None:
            assert vehicle.failure() == ""
            signal.raise_signal(signal.SIGINT)

    flight = Interrupted(tmp_path)
    result = flight.run()
    assert result.interrupted
    assert result.ending is Ending.STOPPED
    assert not is_running(flight.process_id)
    stages = [event.values.get("stage") for event in read_record(tmp_path / "small-1").events if event.text == "stage"]
    assert stages[-5:] == ["holding", "going to land", "landing", "disarming", "done"]


def test_ctrl_c_lets_laps_be_completed_and_the_vehicle_return(tmp_path: Path) -> None:
    class Interrupted(TwoProcesses):
        def act(self, vehicle: BundledVehicle) -> None:
            assert vehicle.failure() == ""
            signal.raise_signal(signal.SIGINT)

    result = Interrupted(tmp_path, text=ROUNDS.replace("laps: 2", "laps: until_stopped")).run()
    assert result.achieved, result.reason
    assert result.interrupted
    assert result.ending is Ending.LANDED
    assert result.laps == 1
    assert result.word[-1] == {"home"}


@pytest.fixture
def mission_file(tmp_path: Path) -> Path:
    file = tmp_path / "small.yaml"
    file.write_text(SMALL)
    return file


def arguments(file: Path) -> list[str]:
    return [
        "fly",
        str(file),
        "--out",
        str(file.parent / "out"),
        "--no-pictures",
        "--no-ground-station",
        "--speed",
        str(SPEED),
    ]


def test_the_command_achieves_its_mission_whoever_listens_and_hurries_it(mission_file: Path) -> None:
    """A signal while the pictures are drawn leaves them out; neither that nor a closed output changes the verdict."""
    script = (
        "import signal, sys, mission.report.report as report\n"
        "report.save_all = lambda *_: signal.raise_signal(signal.SIGINT)\n"
        "from mission.cli import main; sys.exit(main())"
    )
    options = [option for option in arguments(mission_file) if option != "--no-pictures"]
    command = [sys.executable, "-c", script, *options]
    done = subprocess.run(
        ["/bin/sh", "-c", 'exec "$@" >&-', "sh", *command], stderr=subprocess.PIPE, check=False, cwd=ROOT
    )
    assert done.returncode == 0
    assert b"the pictures are left out; `mission report" in done.stderr
    assert b"Traceback" not in done.stderr
    (folder,) = (mission_file.parent / "out").iterdir()
    assert (folder / "report.html").is_file()
    assert not list(folder.glob("*.png"))
    verdict = read_record(folder).verdict
    assert verdict is not None
    assert verdict["achieved"] is True


def test_the_command_ends_with_4_when_the_vehicle_is_killed(
    mission_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    started: list[BundledVehicle] = []

    class Watched(BundledVehicle):
        """Kills itself when the flight asks how it is for the thousandth time."""

        asked = 0

        def failure(self) -> str:
            if not started:
                started.append(self)
            self.asked += 1
            if self.asked == 1000:
                os.kill(self.process_id, signal.SIGKILL)
            return super().failure()

    monkeypatch.setattr("mission.fly.linking.BundledVehicle", Watched)
    assert main(arguments(mission_file)) == 4
    (folder,) = (mission_file.parent / "out").iterdir()
    record = read_record(folder)
    assert record.verdict is not None
    assert "ended" in record.verdict["reason"]
    assert not is_running(started[0].process_id)


def test_a_planner_that_is_killed_takes_the_vehicle_with_it(tmp_path: Path) -> None:
    if not hasattr(os, "pidfd_open"):
        pytest.skip("this system cannot wait for a process that is not a child")
    script = (
        "import sys; from mission.fly import BundledVehicle, VehicleOptions\n"
        "with BundledVehicle(VehicleOptions(ground_station=False)) as vehicle:\n"
        "    print(vehicle.process_id, flush=True); sys.stdin.read()"
    )
    with subprocess.Popen(
        [sys.executable, "-c", script], stdin=subprocess.PIPE, stdout=subprocess.PIPE, cwd=tmp_path
    ) as planner:
        assert planner.stdout is not None
        vehicle = os.pidfd_open(int(planner.stdout.readline()))
        assert not select.select([vehicle], [], [], 0.0)[0]
        planner.kill()
    ended = select.select([vehicle], [], [], 60.0)[0]
    os.close(vehicle)
    assert ended
