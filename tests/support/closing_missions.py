"""A small mission with a gate that is there for a time only, two places beyond it, and room to go round it or none."""

from functools import cache

from mission.plan import FlightPlan, plan_mission
from mission.spec.loader import parse_mission
from mission.spec.model import MissionSpec
from tests.support.small_missions import FLOWN_BRISKLY

_MAP = """\
name: A gate
domain:
  boundary: [[0, 0], [80, 0], [80, 30], [0, 30]]
regions:
  home: {{kind: home, polygon: [[4, 10], [14, 10], [14, 20], [4, 20]]}}
  near: {{kind: survey, polygon: [[24, 18], [32, 18], [32, 26], [24, 26]]{near}}}
  gate: {{kind: {kind}, polygon: [[40, 0], [46, 0], [46, {to}], [40, {to}]]{gate}}}
  far: {{kind: survey, polygon: [[60, 8], [70, 8], [70, 18], [60, 18]]{far}}}
start:
  position_m: [9, 15]
"""


def closing(
    formula: str = "F G home",
    tasks: str = "[visit: far]",
    *,
    kind: str = "restricted",
    round_it: bool = False,
    more: str = "",
    **windows: str,
) -> MissionSpec:
    """The mission, each window as it is written: ``gate="[10, 40]"``."""
    keys = {name: f", active_s: {windows[name]}" if name in windows else "" for name in ("near", "gate", "far")}
    text = _MAP.format(kind=kind, to=24 if round_it else 30, **keys)
    text += f"mission: {{formula: {formula!r}}}\ntasks: {tasks}\nsmoothing: corridor\n{more}{FLOWN_BRISKLY}"
    return parse_mission(text.encode())


@cache
def closing_plan(
    formula: str = "F G home",
    tasks: str = "[visit: far]",
    *,
    kind: str = "restricted",
    round_it: bool = False,
    **windows: str,
) -> FlightPlan:
    """Its plan."""
    return plan_mission(closing(formula, tasks, kind=kind, round_it=round_it, **windows))
