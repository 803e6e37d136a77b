"""A small mission with a gate that opens, two places in a row and a home, for bounds in seconds."""

from functools import cache

from mission.plan import FlightPlan, plan_mission
from mission.spec.loader import parse_mission
from mission.spec.model import MissionSpec
from tests.support.small_missions import FLOWN_BRISKLY

_MAP = """\
name: In time
domain:
  boundary: [[0, 0], [80, 0], [80, 30], [0, 30]]
regions:
  home: {kind: home, polygon: [[4, 10], [14, 10], [14, 20], [4, 20]]}
  near: {kind: survey, polygon: [[24, 18], [32, 18], [32, 26], [24, 26]]}
  gate: {kind: area, polygon: [[40, 0], [46, 0], [46, 30], [40, 30]]}
  far: {kind: survey, polygon: [[60, 8], [70, 8], [70, 18], [60, 18]]}
start:
  position_m: [9, 15]
"""


def timed(formula: str = "F G home", tasks: str = "[visit: [near, far]]") -> MissionSpec:
    """The mission with such a formula and tasks."""
    text = f"{_MAP}mission: {{formula: {formula!r}}}\ntasks: {tasks}\nsmoothing: corridor\n{FLOWN_BRISKLY}"
    return parse_mission(text.encode())


@cache
def timed_plan(formula: str = "F G home", tasks: str = "[visit: [near, far]]") -> FlightPlan:
    """Its plan."""
    return plan_mission(timed(formula, tasks))
