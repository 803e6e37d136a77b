"""``mission verify``: prove a written plan again."""

from argparse import Namespace
from dataclasses import replace
from pathlib import Path

import numpy as np

from mission.cli.inputs import read_plan
from mission.cli.screen import out
from mission.plan import FlightPlan, certify_again, certify_homeward_again, trajectory_of
from mission.spec.domain import build_domain

_MOMENTS = 257
_LAPS = 2  # enough to see how one follows another
_SAME_M = 1e-3


def run(arguments: Namespace) -> int:
    """Read a plan, certify its trajectory anew, and say what was proved."""
    plan = read_plan(Path(arguments.plan))
    if not _has_domain_of_its_mission(plan):
        return _refused(arguments.plan, "its triangles or labels are not those of its mission")
    certificate = certify_again(plan)
    if not certificate.holds:
        return _refused(arguments.plan, certificate.reason)
    homeward = certify_homeward_again(plan, certificate)
    if homeward is not None and not homeward.holds:
        return _refused(arguments.plan, f"the way back {homeward.reason}")
    if not _keeps_limits_of_its_mission(plan):
        return _refused(arguments.plan, "it is not flown at the speeds and the altitude of its mission")
    out.print(
        f"{arguments.plan}: proved: every word within {certificate.tube_m:g} m per axis of the trajectory satisfies "
        f"{plan.specification}",
        markup=False,
    )
    return 0


def _refused(name: str, why: str) -> int:
    out.print(f"{name}: not proved: {why}", markup=False)
    return 1


def _has_domain_of_its_mission(plan: FlightPlan) -> bool:
    """Whether the triangles and labels in the file are those that its mission describes."""
    partition, labelling = build_domain(plan.spec)
    return (
        np.array_equal(partition.vertices_m, plan.partition.vertices_m)
        and np.array_equal(partition.triangles, plan.partition.triangles)
        and np.array_equal(partition.neighbours, plan.partition.neighbours)
        and labelling.letters == plan.labelling.letters
        and np.array_equal(labelling.letter_of, plan.labelling.letter_of)
    )


def _keeps_limits_of_its_mission(plan: FlightPlan) -> bool:
    """Whether the trajectory is where, at each time, the mission's limits and the stops in the file put it."""
    flown = plan.trajectory
    due = trajectory_of(plan.spec, plan.curve, plan.stops, flown.lap)
    if (flown.altitude_m, flown.laps) != (due.altitude_m, due.laps):
        return False
    flown, due = (replace(trajectory, laps=_LAPS) for trajectory in (flown, due))
    if not np.isclose(flown.duration_s, due.duration_s):
        return False
    moments_s = np.linspace(0.0, due.duration_s, _MOMENTS)
    return np.allclose(flown.position(moments_s), due.position(moments_s), atol=_SAME_M)
