"""``mission check``: report every fault of mission files, and whether each has a plan."""

from argparse import Namespace

from mission.cli.extent import extent
from mission.cli.inputs import planned
from mission.cli.screen import count, err, out, print_error, print_warnings, tube_text
from mission.decimals import decimal
from mission.errors import MissionError
from mission.printable import printable
from mission.spec.model import FIELD


def run(arguments: Namespace) -> int:
    """Check each file; the exit code is that of the worst of them."""
    codes = []
    for name in arguments.files:
        try:
            plan = planned(name)
        except MissionError as error:
            print_error(error, source=name)
            codes.append(error.exit_code)
            continue
        codes.append(0)
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
        for task in plan.dropped:
            out.print(
                f"  dropped  {task.task} (weight {decimal(task.weight)}): {task.reason}", markup=False, highlight=False
            )
        print_warnings(plan.warnings, source=name)
    bad = sum(code > 0 for code in codes)
    if bad and len(codes) > 1:
        err.print(f"[bold red]{bad:,} of {count(len(codes), 'file')} cannot be flown[/]")
    return max(codes)
