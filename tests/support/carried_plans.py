"""Plans of missions in which something moves and that are flown by fields."""

from dataclasses import replace

from mission.plan import FlightPlan, plan_mission
from mission.spec.model import FIELD
from tests.support.drifting_missions import DRIFT, drifting
from tests.support.drifting_plans import standing


def drifting_by_field(
    formula: str = "F (S1 & F G home) & G !K", motion: str = DRIFT, kind: str = "restricted"
) -> FlightPlan:
    """The plan of the map as it is drawn, for the map that moves: its triangles are the same, and so is their run.

    Args:
        formula: What is asked for.
        motion: How K moves.
        kind: What kind of region it is.
    """
    spec = drifting(formula, motion, kind)
    spec = replace(spec, flight=replace(spec.flight, guidance=FIELD))
    return replace(plan_mission(standing(spec)), spec=spec)
