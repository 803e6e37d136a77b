"""``mission verify``: judge what a written plan claims, and compare what the planner chose with its mission."""

import json
from argparse import Namespace
from pathlib import Path
from typing import Any, Final

from mission.cli import flown
from mission.cli.inputs import read_plan
from mission.cli.mission_input import mission_in
from mission.cli.plan import print_plan
from mission.cli.screen import out, print_json
from mission.errors import Fault, NoPlanError, SpecError
from mission.plan import FlightPlan, difference, plan_mission, plan_to_json
from mission.printable import printable
from mission.spec.document import document_of
from mission.spec.model import FIELD
from mission.verify.plans import JUDGED, Claim, claims

_CHOSEN: Final = ("region", "heading_deg", "exact", "ways_m", "lanes_m", "planned_share")  # of lanes


def run(arguments: Namespace) -> int:
    """Read a plan, judge each of its claims, and say which are true; 0 where all are."""
    if arguments.flight is not None:
        return flown.run(arguments)
    if arguments.plan is None:
        raise SpecError((Fault(0, 0, "", "there is nothing to verify", "name a plan, or a log with --flight"),))
    plan, text = read_plan(Path(arguments.plan))
    try:
        asked = () if arguments.mission is None else (_asked(plan, arguments.mission),)
        judged = (*asked, *claims(text, arguments.plan), _choices(plan, json.loads(text)))
    except SpecError as error:
        raise SpecError(error.faults, error.source or arguments.plan) from error
    fault = next((claim for claim in judged if claim.fault), None)
    if arguments.json:
        document = {
            "exit_code": int(fault is not None),
            "plan": arguments.plan,
            "proved": fault is None,
            "guidance": plan.spec.flight.guidance,
            "claims": [claim._asdict() for claim in judged],
        }
        print_json(document)
    if fault:
        out.print(f"{printable(arguments.plan)}: not proved: {fault.fault}", markup=False)
    else:
        out.print(
            f"{printable(arguments.plan)}: proved: every word within {plan.certificate.tube_m:g} m per axis of the "
            f"trajectory satisfies {plan.specification}",
            markup=False,
        )
    if plan.spec.flight.guidance == FIELD:
        about = "this is about the plan alone: the flight is led by the field, of which no tube is proved"
        out.print(f"  {about}", markup=False)
    for claim in judged:
        said = f"wrong: {claim.fault}" if claim.fault else f"ok     {claim.figure}"
        out.print(f"  {claim.name:<12}  {said.rstrip()}", markup=False)
    if arguments.verbose:
        print_plan(plan)
    return int(fault is not None)


def _asked(plan: FlightPlan, file: str) -> Claim:
    """Whether the mission in the plan is that of a file: a plan tells its own, and proves no other."""
    fault = difference(document_of(plan.spec), document_of(mission_in(file)), "mission")
    return Claim("asked", fault and f"the plan is not of {printable(file)}: {fault}", f"the mission is that of {file}")


def _choices(plan: FlightPlan, written: dict[str, Any]) -> Claim:
    """Whether the planner chooses the same for the mission in the file: what no flight depends on, such as figures."""
    try:
        due = json.loads(plan_to_json(plan_mission(plan.spec, start_m=plan.start_m, run=plan.asked_run)))
    except NoPlanError as error:
        return Claim("choices", f"its mission has no plan from this start: {error}", "")
    count = plan.shortest_runs
    figure = f"run {plan.run_index} of {count}, and all else that is told, as its mission plans to"
    return Claim("choices", difference(_told(written), _told(due)), figure)


def _told(document: dict[str, Any]) -> dict[str, Any]:
    """What a plan tells beside what is judged, or more than can be judged without planning."""
    back = document["homeward"]
    return {
        **{key: value for key, value in document.items() if key not in JUDGED},
        "run": document["run"],
        "path": None if "segments" in document["path"] else document["path"],
        "covers": [{key: visit[key] for key in _CHOSEN} for visit in document["covers"]],
        "certificate": {"reason": document["certificate"]["reason"]},
        "homeward": back and {"certificate": {"reason": back["certificate"]["reason"]}},
    }
