"""Go or no-go: what a plan asks of a vehicle against what that tells of itself, before anything is armed."""

from mission.fly.preflight.gate import Checks, Gate
from mission.fly.preflight.inspection import inspect
from mission.fly.preflight.rows import Judgement, Level
from mission.fly.preflight.table import ROWS, Finding, Findings, NoGoError, check_forced, judged

__all__ = [
    "ROWS",
    "Checks",
    "Finding",
    "Findings",
    "Gate",
    "Judgement",
    "Level",
    "NoGoError",
    "check_forced",
    "inspect",
    "judged",
]
