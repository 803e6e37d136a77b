"""``mission verify``: prove a written plan again."""

from argparse import Namespace
from pathlib import Path

import numpy as np

from mission.cli.inputs import read_plan
from mission.cli.screen import out
from mission.plan import FlightPlan, certify_again
from mission.spec.domain import build_domain


def run(arguments: Namespace) -> int:
    """Read a plan, certify its trajectory anew, and say what was proved."""
    plan = read_plan(Path(arguments.plan))
    if not _of_its_mission(plan):
        out.print(f"{arguments.plan}: not proved: its triangles or labels are not those of its mission", markup=False)
        return 1
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


def _of_its_mission(plan: FlightPlan) -> bool:
    """Whether the triangles and labels in the file are those that its mission describes."""
    partition, labelling = build_domain(plan.spec)
    return (
        np.array_equal(partition.vertices_m, plan.partition.vertices_m)
        and np.array_equal(partition.triangles, plan.partition.triangles)
        and np.array_equal(partition.neighbours, plan.partition.neighbours)
        and labelling.letters == plan.labelling.letters
        and np.array_equal(labelling.letter_of, plan.labelling.letter_of)
    )
