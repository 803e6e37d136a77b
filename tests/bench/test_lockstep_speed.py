"""How fast a whole flight runs in one process: planner, session, monitor, record and vehicle, in lock-step."""

import io
import time
from dataclasses import replace
from pathlib import Path

import pytest

from mission.fly import fly
from mission.plan import plan_mission
from mission.report.record import FlightRecord
from mission.spec.loader import load_mission
from tests.support.lockstep import LockstepVehicle, vehicle_of
from vehicle_sim.dynamics.airframe import Dynamics

MISSIONS = Path(__file__).parents[2] / "missions"


@pytest.mark.bench
@pytest.mark.parametrize("dynamics", Dynamics)
@pytest.mark.parametrize("flavour", ["ardupilot", "px4"])
def test_the_papers_mission(flavour: str, dynamics: Dynamics) -> None:
    plan = plan_mission(load_mission(MISSIONS / "paper.yaml"))
    vehicle = LockstepVehicle(replace(vehicle_of(flavour), dynamics=dynamics))
    wall_s, work_s = time.perf_counter(), time.process_time()
    result = fly(plan, vehicle, vehicle, FlightRecord(io.BytesIO(), mission="paper"))
    wall_s, work_s = time.perf_counter() - wall_s, time.process_time() - work_s
    flown_s = vehicle.now_s()
    print(
        f"\n{flavour} {dynamics}: {flown_s:.0f} s flown in {wall_s:.1f} s ({flown_s / wall_s:.0f} times real time; "
        f"{flown_s / work_s:.0f} times by processor time), {result.reason}"
    )
    assert result.achieved
