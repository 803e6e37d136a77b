"""The checker of plans: it shares the geometry, the automata and the reader of missions with the planner."""

from mission.verify.plans.checker import JUDGED, Claim, claims

__all__ = ["JUDGED", "Claim", "claims"]
