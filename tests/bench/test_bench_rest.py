"""How soon what is left of a flight is planned, with its proof.

What a flight goes on with is to be there within 0.2 s of an idle machine that takes 0.85 s for ten million turns of a
plain loop, at the level of a module (``ten_million_turns.py``). The flight is in motion, as it is when a mission is
changed; from each of the rounds the next one keeps nothing but the plan that is flown.
"""

import runpy
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from mission.monitor.flight import FlightMonitor
from mission.monitor.stage import Stage
from mission.plan import FlightPlan, plan_mission
from mission.plan.rest import Rest, plan_rest
from mission.spec.amendment import amended
from mission.spec.loader import load_mission
from tests.support.measuring import compared, seconds

ROUNDS = 5
TURNS = str(Path(__file__).with_name("ten_million_turns.py"))
LOOP_S = 0.85
MOST_S = 0.2
AT_S = (
    (1.0, ""),
    (6.0, ""),
    (6.0, "restrict ahead [[24, 44], [32, 44], [32, 52], [24, 52]]"),
    (20.0, "formula F (S1 & F (S2 & F home)) & G !K1 & G !K2"),
    (30.0, ""),
    (60.0, ""),
)
"""When something is asked for, and the change of the mission, if there is one."""


def flown(plan: FlightPlan, until_s: float) -> Rest:
    watched = FlightMonitor(plan)
    times = np.arange(0.0, until_s, 0.1)
    for t_s, (x, y) in zip(times.tolist(), plan.trajectory.position(times).tolist(), strict=True):
        watched.report(Stage.FLY, t_s, (x, y))
    (x, y), (vx, vy), (ax, ay) = (each[0].tolist() for each in plan.trajectory.state(until_s))
    return Rest(watched.monitor.word, (x, y), (vx, vy), (ax, ay), flown_s=until_s)


@pytest.mark.bench
@pytest.mark.timeout(600)
def test_bench_the_rest_of_a_survey() -> None:
    plan = plan_mission(load_mission("missions/survey.yaml"))
    for at_s, change in AT_S:
        rest = flown(plan, at_s)
        asked = amended(plan.spec, [change], rest.place_m) if change else None
        took = compared(partial(plan_rest, plan, rest, asked), partial(runpy.run_path, TURNS), ROUNDS)
        there_s = LOOP_S * took.units
        print(f"\nafter {at_s:g} s {change}: {seconds(took.times.processor_s)}, {there_s:.2f} s there")
        assert there_s < MOST_S
