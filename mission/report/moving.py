"""Where regions that move are at a time, as they are drawn."""

import numpy as np
from shapely.geometry.base import BaseGeometry

from mission.geometry.simplices import Partition
from mission.plan import FlightPlan
from mission.spec.motion import Motion
from mission.spec.moving import shape_then


def partition_at(plan: FlightPlan, time_s: float) -> Partition:
    """The triangles at a time on the clock of the trajectory."""
    return plan.partition if plan.moving is None else plan.moving.at(time_s)


def drifting(plan: FlightPlan) -> dict[str, tuple[float, float]]:
    """The regions of which something moves, by their names, and from when to when."""
    if plan.moving is None:
        return {}
    moves = np.asarray(plan.moving.moves[plan.partition.triangles].any(axis=1))
    spans = {region.name: _span_s(region.motion, plan.moving.last_s) for region in plan.spec.regions}
    return {name: span for name, span in spans.items() if moves[plan.labelling.triangles_of(name)].any()}


def _span_s(motion: Motion | None, last_s: float) -> tuple[float, float]:
    return (0.0, last_s) if motion is None else motion.spans_s


def shape_at(plan: FlightPlan, name: str, shape: BaseGeometry, time_s: float) -> BaseGeometry:
    """A shape that is drawn of a region, at a time: it goes along as a whole, or is what its triangles are then."""
    if plan.moving is None or name not in drifting(plan):
        return shape
    motion = next(region.motion for region in plan.spec.regions if region.name == name)
    return shape_then(shape, motion, plan.moving, plan.labelling.triangles_of(name), time_s)
