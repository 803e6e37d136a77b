"""What runs cost: their transitions, or the length of the shortest way along them, or the time that it takes.

Lengths and times are those of ways in the plane (``mission.plan.shortest_way``). The weights of T stand for them where
runs are searched in T all the same, because a specification counts triangles, and on the way back from laps.

Costs are whole numbers of a small unit, so that runs of equal cost are equal exactly and are counted as such. A stay
costs as much as the cheapest transition of the map: it leads nowhere, and yet a loop of stays is not free.
"""

import numpy as np

from mission.geometry.arrays import FloatArray, IntArray
from mission.geometry.simplices import Partition
from mission.planning.run import Run
from mission.planning.transition_system import CONTROLS
from mission.spec.model import Cost

UNIT = {Cost.TRANSITIONS: ("", 1.0), Cost.DISTANCE: ("m", 1e-3), Cost.TIME: ("s", 1e-3)}
"""Of each cost the unit in which people read it, and how much of it the whole number 1 stands for."""

MEASURED = {
    Cost.TRANSITIONS: "triangles that are entered, and stays",
    Cost.DISTANCE: "metres of the shortest way, which touches what it visits and has room for the tube",
    Cost.TIME: "seconds of the fastest way, which touches what it visits and has room for the tube, with its stops",
}
"""What each cost counts."""


def transition_weights(partition: Partition, cost: Cost, speed_m_s: float) -> IntArray:
    """The costs of all controls, shape (M, 4), at least 1: ones, millimetres or milliseconds.

    Args:
        partition: M triangles.
        cost: What is counted.
        speed_m_s: How fast the flight is.
    """
    if cost is Cost.TRANSITIONS:
        return np.ones((partition.size, CONTROLS), dtype=np.int64)
    unit_m = UNIT[cost][1] * (speed_m_s if cost is Cost.TIME else 1.0)
    weights = np.ones((partition.size, CONTROLS), dtype=np.int64)
    weights[:, 1:] = np.maximum(1, np.rint(passage_lengths(partition) / unit_m))
    weights[:, 0] = weights[:, 1:].min()
    return weights


def run_costs(weights: IntArray, run: Run, cost: Cost) -> tuple[float, float]:
    """What the prefix and the suffix of a run cost, in transitions, metres or seconds.

    Args:
        weights: As from ``transition_weights``.
        run: The run.
        cost: What they count.
    """
    costs = weights[list(run.states), list(run.controls)] * UNIT[cost][1]
    head = len(run.prefix)
    return float(costs[:head].sum()), float(costs[head:].sum())


def passage_lengths(partition: Partition) -> FloatArray:
    """From the incentre of each triangle over the middle of a facet to the incentre behind it, shape (M, 3), metres.

    A run that stays within its triangles can be followed along these pieces. Of a facet without a triangle behind it,
    the length is that of the way to the facet.
    """
    corners, centres = partition.corners_m, partition.incentres_m
    middles = (np.roll(corners, -1, axis=1) + np.roll(corners, -2, axis=1)) / 2.0
    beyond = np.where((partition.neighbours >= 0)[..., None], centres[partition.neighbours], middles)
    to_facet = np.linalg.norm(middles - centres[:, None], axis=-1)
    lengths: FloatArray = to_facet + np.linalg.norm(beyond - middles, axis=-1)
    return lengths
