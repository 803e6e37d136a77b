"""``mission verify``: prove a written plan again, and compare what stands beside the proof with its mission."""

import json
from argparse import Namespace
from pathlib import Path
from typing import Any, Final

from mission.cli import flown
from mission.cli.inputs import read_plan
from mission.cli.screen import out
from mission.errors import Fault, NoPlanError, SpecError
from mission.plan import (
    FlightPlan,
    certify_again,
    certify_homeward_again,
    difference,
    plan_mission,
    plan_to_json,
)
from mission.printable import printable

_DOMAIN: Final = ("partition", "labels")  # what the proof stands on


def run(arguments: Namespace) -> int:
    """Read a plan, certify its trajectory anew, plan its mission anew, and say what was proved and what differs."""
    if arguments.flight is not None:
        return flown.run(arguments)
    if arguments.plan is None:
        raise SpecError((Fault(0, 0, "", "there is nothing to verify", "name a plan, or a log with --flight"),))
    plan, text = read_plan(Path(arguments.plan))
    fault, name = _fault(plan, json.loads(text)), printable(arguments.plan)
    if fault:
        out.print(f"{name}: not proved: {fault}", markup=False)
        return 1
    out.print(
        f"{name}: proved: every word within {plan.certificate.tube_m:g} m per axis of the trajectory "
        f"satisfies {plan.specification}\n"
        f"the rest of the file is what its mission plans to from this start",
        markup=False,
    )
    return 0


def _fault(plan: FlightPlan, written: dict[str, Any]) -> str | None:
    """Why the file is no proved plan of the mission in it; a proof covers no more than the trajectory's word."""
    try:
        due = json.loads(plan_to_json(plan_mission(plan.spec, start_m=plan.start_m, run=plan.asked_run)))
    except NoPlanError as error:
        return f"its mission has no plan from this start: {error}"
    stated, built = ({part: document[part] for part in _DOMAIN} for document in (written, due))
    return difference(stated, built) or _unproved(plan) or difference(written, due)


def _unproved(plan: FlightPlan) -> str | None:
    """Why the trajectory has no proof over the domain in the file; None where it has one."""
    certificate = certify_again(plan)
    if not certificate.holds:
        return certificate.reason
    homeward = certify_homeward_again(plan, certificate)
    return f"the way back {homeward.reason}" if homeward is not None and not homeward.holds else None
