"""How fast a whole flight runs in one process: planner, session, monitor, record and vehicle, in lock-step.

The figure to compare is that of a machine that takes 0.85 s for ten million turns of a plain loop, at the level of a
module (``ten_million_turns.py``), by processor time: the loop is measured before, within and after the flight.
"""

import io
import runpy
import time
from dataclasses import replace
from pathlib import Path
from statistics import mean

import pytest

from mission.fly import fly
from mission.plan import plan_mission
from mission.report.record import FlightRecord
from mission.spec.loader import load_mission
from tests.support.lockstep import LockstepVehicle, vehicle_of
from vehicle_sim.dynamics.airframe import Dynamics

MISSIONS = Path(__file__).parents[2] / "missions"
TURNS = str(Path(__file__).with_name("ten_million_turns.py"))
LOOP_S = 0.85
EVERY_STEPS = 20_000


class Yardstick:
    """Measures the loop at a flight's start and each so many steps of it."""

    def __init__(self) -> None:
        self.took_s: list[float] = []

    def measure(self) -> None:
        began_s = time.process_time()
        runpy.run_path(TURNS)
        self.took_s.append(time.process_time() - began_s)

    def at_step(self, vehicle: LockstepVehicle) -> None:
        if vehicle.vehicle.steps % EVERY_STEPS == 0:
            self.measure()


@pytest.mark.bench
@pytest.mark.timeout(900)
@pytest.mark.parametrize("dynamics", Dynamics)
@pytest.mark.parametrize("flavour", ["ardupilot", "px4"])
def test_the_papers_mission(flavour: str, dynamics: Dynamics) -> None:
    plan = plan_mission(load_mission(MISSIONS / "paper.yaml"))
    loop = Yardstick()
    vehicle = LockstepVehicle(replace(vehicle_of(flavour), dynamics=dynamics), loop.at_step)
    began_s = time.process_time()
    loop.measure()
    result = fly(plan, vehicle, vehicle, FlightRecord(io.BytesIO(), mission="paper"))
    work_s = time.process_time() - began_s - sum(loop.took_s)
    loop.measure()
    flown_s = vehicle.now_s()
    print(
        f"\n{flavour} {dynamics}: {flown_s:.0f} s flown in {work_s:.1f} s of the processor, of which the loop takes "
        f"{mean(loop.took_s):.2f} s: {flown_s / work_s * mean(loop.took_s) / LOOP_S:.0f} times real time where that is "
        f"{LOOP_S} s, {result.reason}"
    )
    assert result.achieved
