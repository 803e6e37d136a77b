"""Plans beside regions that move."""

from dataclasses import replace
from functools import cache

from mission.plan import FlightPlan, plan_mission
from mission.spec.model import MissionSpec
from tests.support.drifting_missions import drifting

SLOW = "{velocity_m_s: [0, 0.5], until_s: 20}"


def standing(spec: MissionSpec) -> MissionSpec:
    """The mission with every region where it is drawn."""
    return replace(spec, regions=tuple(replace(region, motion=None) for region in spec.regions))


@cache
def drifting_plan(motion: str = SLOW, formula: str = "F (S1 & F G home)") -> FlightPlan:
    """The plan of a mission whose region K moves: up to 7 m beside the way from home to S1 and back, if slowly."""
    return plan_mission(drifting(formula, motion))
