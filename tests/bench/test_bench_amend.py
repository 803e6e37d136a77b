"""How soon a change of a mission is flown: from its line on standard input to the first setpoint of the new plan.

    python -m pytest -m bench -n 0 -s tests/bench/test_bench_amend.py

``missions/survey.yaml`` is flown in real time over UDP, changed by ``mission amend`` again and again, each change is
timed: until the flight takes it, until a plan is asked for, until it is there, and until the vehicle is sent its first
setpoint. Of the planner's process it is also told how long it computed and how long it waited for a processor that
others had: on a machine of which others take a part, the latter is not this program's.
"""

import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path
from threading import Thread
from typing import Any

import pytest

from mission.clock import WallClock
from mission.fly import BundledVehicle, VehicleOptions, fly
from mission.fly.amendments import Amendment, AmendmentAnswer, AmendmentFolder
from mission.fly.planner_process import PlannerProcess
from mission.fly.replanner import PlanAnswer, PlanRequest
from mission.link.transport import open_transport
from mission.monitor.stage import Stage
from mission.plan import plan_mission
from mission.report.record import FlightRecord
from mission.spec.loader import load_mission
from tests.support.commands import ROOT

CHANGES = (
    (6.0, "restrict ahead [[24, 44], [32, 44], [32, 52], [24, 52]]"),
    (12.0, "drop ahead"),
    (20.0, "formula F (S1 & F (S2 & F home)) & G !K1 & G !K2"),
    (34.0, "formula F (S2 & F (S3 & F home)) & G !K1 & G !K2"),
    (42.0, "restrict near [[88, 40], [98, 40], [98, 50], [88, 50]]"),
    (50.0, "drop near"),
    (58.0, "formula F home & G !S1 & G !K1 & G !K2"),
)
"""So long after the trajectory began, this is asked for."""


def processor_s(process_id: int) -> tuple[float, float]:
    """What the threads of a process have computed, and waited for a processor."""
    used = [each.read_text().split() for each in Path(f"/proc/{process_id}/task").glob("*/schedstat")]
    return sum(int(row[0]) for row in used) / 1e9, sum(int(row[1]) for row in used) / 1e9


@dataclass
class Times:
    """Of one change, by the clock here: when each thing was done; and what the planner's process took."""

    line: str
    given_s: float
    taken_s: float = 0.0
    asked_s: list[float] = field(default_factory=list)
    planned_s: float = 0.0
    computed_s: float = 0.0
    waited_s: float = 0.0
    flown_s: float = 0.0
    told: str = ""

    def row(self) -> str:
        def ms(from_s: float, until_s: float) -> str:
            return f"{1e3 * (until_s - from_s):6.0f}" if until_s else "     -"

        first = self.asked_s[0] if self.asked_s else 0.0
        return (
            f"{self.line[:34]:34s} {ms(self.given_s, self.taken_s)} {ms(self.taken_s, first)} "
            f"{ms(first, self.planned_s)} {1e3 * self.computed_s:6.0f} {1e3 * self.waited_s:6.0f} "
            f"{ms(self.planned_s, self.flown_s)} {ms(self.given_s, self.flown_s)} {len(self.asked_s):3d}  "
            f"{self.told[:60]}"
        )


HEAD = f"{'':34s}   take    ask   plan  (cpu) (wait)   join    all  asks"


class Timed:
    """Stands between a flight and its record, its changes and its planner, and keeps the time."""

    def __init__(self, folder: AmendmentFolder, record: FlightRecord, planner: PlannerProcess) -> None:
        self._folder, self._record, self._planner = folder, record, planner
        self.times: list[Times] = []
        self.began_s = self._leg_s = float("inf")
        self._used = (0.0, 0.0)
        self._taken = 0

    @property
    def _now(self) -> Times:
        """Of the change that was taken last."""
        return self.times[max(self._taken - 1, 0)]

    # -- as the source of changes

    def take(self) -> Amendment | None:
        taken = self._folder.take()
        if taken is not None:
            self._taken += 1
            self._now.taken_s = time.monotonic()
        return taken

    def answer(self, amendment: Amendment, answer: AmendmentAnswer) -> None:
        self._now.told = f"{'accepted' if answer.accepted else 'refused'}: {answer.words}"
        self._folder.answer(amendment, answer)

    def keep(self, *kept: Any) -> None:  # noqa: ANN401 - passed on
        self._folder.keep(*kept)

    # -- as the record

    def write(self, kind: str, t_s: float | None, **values: Any) -> None:  # noqa: ANN401 - passed on
        if kind == "event" and values.get("stage") is Stage.FLY:
            self.began_s = time.monotonic()
        if kind == "event" and values.get("name") == "leg" and t_s is not None:
            self._leg_s = t_s
        if kind == "setpoint" and t_s is not None and t_s >= self._leg_s - 1e-3:
            self._leg_s, self._now.flown_s = float("inf"), time.monotonic()
        self._record.write(kind, t_s, **values)

    # -- as the planner

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401 - passed on
        return getattr(self._planner, name)

    def ask(self, request: PlanRequest) -> None:
        self._now.asked_s.append(time.monotonic())
        self._used = processor_s(self._planner.process_id or 0)
        self._planner.ask(request)

    def answer_of_planner(self) -> PlanAnswer | None:
        answer = self._planner.answer()
        if answer is not None:
            now, used = self._now, processor_s(self._planner.process_id or 0)
            now.planned_s = time.monotonic()
            now.computed_s, now.waited_s = (b - a for a, b in zip(self._used, used, strict=True))
        return answer


class Planner:
    """The planner's side of ``Timed``, whose ``answer`` is another's."""

    def __init__(self, timed: Timed) -> None:
        self._timed = timed

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401 - passed on
        return getattr(self._timed, name)

    def answer(self) -> PlanAnswer | None:
        return self._timed.answer_of_planner()


def hand_in(folder: Path, timed: Timed, changes: tuple[tuple[float, str], ...]) -> None:
    """Write the changes to the standard input of ``mission amend``, each when it is due."""
    command = [sys.executable, "-m", "mission", "amend", str(folder)]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=subprocess.DEVNULL, text=True, cwd=ROOT) as process:  # noqa: S603
        assert process.stdin is not None
        for due_s, line in changes:
            while time.monotonic() < timed.began_s + due_s:
                time.sleep(0.01)
            timed.times.append(Times(line, time.monotonic()))
            process.stdin.write(line + "\n")
            process.stdin.flush()
        process.stdin.close()


@pytest.mark.bench
@pytest.mark.timeout(600)
@pytest.mark.parametrize("flavour", ["ardupilot", "px4"])
def test_bench_a_change_in_flight(flavour: str, tmp_path: Path) -> None:
    plan = plan_mission(load_mission(ROOT / "missions/survey.yaml"))
    options = VehicleOptions(speed=1.0, seed=1, flavour=flavour, ground_station=False)
    with FlightRecord.in_folder(tmp_path, "survey") as record, BundledVehicle(options) as vehicle:
        assert record.folder is not None
        transport, planner = open_transport(vehicle.address), PlannerProcess()
        timed = Timed(AmendmentFolder(record.folder), record, planner)
        changing = Thread(target=hand_in, args=(record.folder, timed, CHANGES), daemon=True)
        changing.start()
        try:
            result = fly(
                plan,
                transport,
                WallClock(),
                timed,
                vehicle_failure=vehicle.failure,
                replanner=Planner(timed),
                amendments=timed,
            )
        finally:
            transport.close()
            planner.close()
    print(f"\n{flavour}: {result.reason}\n{HEAD}")
    for each in timed.times:
        print(each.row())
