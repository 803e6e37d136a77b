"""Whether the checker finds nothing wrong with a plan."""

from mission.plan import FlightPlan, plan_to_json
from mission.verify.plans import claims


def untrue(plan: FlightPlan) -> list[str]:
    """What is wrong with a plan, as it would be written; empty where all that it claims is true."""
    return [f"{claim.name}: {claim.fault}" for claim in claims(plan_to_json(plan)) if claim.fault]
