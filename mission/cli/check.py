"""``mission check``: report every fault of mission files, whether each has a plan, and whether a vehicle may fly it."""

from argparse import Namespace
from contextlib import ExitStack

from mission.cli.extent import extent
from mission.cli.findings import print_table
from mission.cli.inputs import planned
from mission.cli.mission_input import shown
from mission.cli.plan import print_plan, summary
from mission.cli.screen import err, error_values, out, print_error, print_json, print_warnings, tube_text
from mission.cli.vehicle_link import UNHEARD, link_options
from mission.clock import WallClock
from mission.decimals import count, decimal
from mission.errors import Fault, LinkError, MissionError, SpecError
from mission.fly.linking import open_link
from mission.fly.preflight import Findings, NoGoError, inspect
from mission.link.address import parse_address
from mission.plan import FlightPlan
from mission.printable import printable
from mission.spec.model import FIELD
from mission.spec.moving import motions_by_name


def run(arguments: Namespace) -> int:
    """Check each file; the exit code is that of the worst of them."""
    _check_options(arguments)
    codes: list[int] = []
    found: list[dict[str, object]] = []
    vehicle: dict[str, object] = {}
    for name in arguments.files:
        try:
            plan = planned(name)
        except MissionError as error:
            print_error(error, source=shown(name))
            codes.append(error.exit_code)
            found.append({"file": name, **error_values(error)})
            continue
        codes.append(0)
        found.append({"file": name, "exit_code": 0, "warnings": list(plan.warnings), "plan": summary(plan)})
        _print_plan(plan, shown(name))
        if arguments.verbose:
            print_plan(plan)
        else:
            print_warnings(plan.warnings, source=shown(name))
        if arguments.connect is not None:
            findings = _look(arguments, plan)
            print_table(findings, out)
            vehicle = {"mission": plan.spec.name, **findings.values()}
            codes.append(0 if findings.go else NoGoError(findings).exit_code)
    bad = sum(code > 0 for code in codes)
    if bad and len(codes) > 1 and arguments.connect is None:
        err.print(f"[bold red]{bad:,} of {count(len(codes), 'file')} cannot be flown[/]")
    if arguments.json:
        print_json({"exit_code": max(codes), "missions": found, **vehicle})
    return max(codes)


def _check_options(arguments: Namespace) -> None:
    """Refuse what belongs to a vehicle without one, and several missions for one.

    Raises:
        SpecError: There is such.
    """
    if arguments.connect is not None:
        parse_address(arguments.connect)
        if len(arguments.files) > 1:
            raise SpecError((Fault(0, 0, "--connect", "looks at a vehicle for one mission", "name one file"),))
        return
    if arguments.system_id is not None:
        raise SpecError((Fault(0, 0, "--system-id", "is for a vehicle", "say with --connect where it is"),))


def _look(arguments: Namespace, plan: FlightPlan) -> Findings:
    """Look at the vehicle: go or no-go."""
    link = link_options(arguments)
    with ExitStack() as stack:
        transport = open_link(arguments.connect, link)
        stack.callback(transport.close)
        try:
            return inspect(plan, transport, WallClock(), link=link)
        except LinkError as error:
            raise LinkError(f"{error}; {UNHEARD}") from error
        finally:
            if link.signatures is not None:
                link.signatures.end()


def _print_plan(plan: FlightPlan, name: str) -> None:
    by_field = plan.spec.flight.guidance == FIELD
    out.print(
        f"{printable(name)}: sound; "
        f"{count(plan.partition.size, 'triangle')}, {count(plan.shortest_runs, 'shortest run')}, "
        f"{extent(plan, 1)}, {'led by the field, without a proof of a tube' if by_field else 'proved'}",
        markup=False,
    )
    if not by_field and (causes := tube_text(plan.spec.flight)):
        out.print(f"  tube  {causes}", markup=False, highlight=False)
    if plan.spec.tasks or plan.spec.automaton:
        for kind, text in plan.written:
            out.print(f"  {kind}  {text}", markup=False, highlight=False)
    for moved, motion in motions_by_name(plan.spec).items():
        out.print(f"  moves  {moved} {motion.text}", markup=False, highlight=False)
    for task in plan.dropped:
        out.print(
            f"  dropped  {task.task} (weight {decimal(task.weight)}): {task.reason}", markup=False, highlight=False
        )
