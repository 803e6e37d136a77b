"""``mission verify``: prove a written plan again."""

from argparse import Namespace
from pathlib import Path

from mission.cli.screen import out
from mission.errors import Fault, SpecError
from mission.plan import certify_again, plan_from_json


def run(arguments: Namespace) -> int:
    """Read a plan, certify its trajectory anew, and say what was proved."""
    try:
        text = Path(arguments.plan).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        fault = Fault(0, 0, "", f"the plan cannot be read: {error}", "name a file that 'mission plan --out' wrote")
        raise SpecError((fault,), arguments.plan) from error
    plan = plan_from_json(text)
    certificate = certify_again(plan)
    if not certificate.holds:
        out.print(f"{arguments.plan}: not proved: {certificate.reason}", markup=False)
        return 1
    out.print(
        f"{arguments.plan}: proved: every word within {certificate.tube_m:g} m per axis of the trajectory satisfies "
        f"{plan.spec.formula}",
        markup=False,
    )
    return 0
