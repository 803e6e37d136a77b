"""From a mission to a flight plan: the pure stages, composed; and the plan as JSON."""

from mission.plan.comparison import difference
from mission.plan.covering import CoveredVisit
from mission.plan.flight_plan import FlightPlan, prover_of
from mission.plan.pace import trajectory_of
from mission.plan.serial import plan_from_json, plan_to_json
from mission.plan.stages import plan_mission, shortest_runs
from mission.plan.tasks import DroppedTask
from mission.spec.specification import formula_of

__all__ = [
    "CoveredVisit",
    "DroppedTask",
    "FlightPlan",
    "difference",
    "formula_of",
    "plan_from_json",
    "plan_mission",
    "plan_to_json",
    "prover_of",
    "shortest_runs",
    "trajectory_of",
]
