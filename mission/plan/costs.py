"""What the transitions of T cost: as many as there are, the distance, or the time that they take.

Costs are whole numbers of a small unit, so that runs of equal cost are equal exactly and are counted as such. A stay
costs as much as the cheapest transition of the map: it leads nowhere, and yet a loop of stays is not free.
"""

import numpy as np

from mission.geometry.arrays import FloatArray, IntArray
from mission.geometry.simplices import Partition
from mission.planning.run import Run
from mission.planning.transition_system import CONTROLS
from mission.spec.model import Cost
from mission.steering.facet_control import exit_velocities

UNIT = {Cost.TRANSITIONS: ("", 1.0), Cost.DISTANCE: ("m", 1e-3), Cost.TIME: ("s", 1e-3)}
"""Of each cost the unit in which people read it, and how much of it the whole number 1 stands for."""

MEASURED = {
    Cost.TRANSITIONS: "triangles that are entered, and stays",
    Cost.DISTANCE: "metres from incentre to incentre through the middles of the edges between",
    Cost.TIME: "seconds that the fields take at most to leave their triangles",
}
"""What each cost counts; the path that is flown is smoother, and another run's may come out shorter."""


def transition_weights(partition: Partition, cost: Cost, speed_m_s: float) -> IntArray:
    """The costs of all controls, shape (M, 4), at least 1: ones, millimetres or milliseconds.

    Args:
        partition: M triangles.
        cost: What is counted.
        speed_m_s: Reference speed c of the fields.
    """
    if cost is Cost.TRANSITIONS:
        return np.ones((partition.size, CONTROLS), dtype=np.int64)
    exact = passage_lengths(partition) if cost is Cost.DISTANCE else passage_times(partition, speed_m_s)
    weights = np.ones((partition.size, CONTROLS), dtype=np.int64)
    weights[:, 1:] = np.maximum(1, np.rint(exact / UNIT[cost][1]))
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


def passage_times(partition: Partition, speed_m_s: float) -> FloatArray:
    """How long each field takes at most to leave its triangle, from wherever it is entered, shape (M, 3), seconds.

    The distance s to the exit facet falls at a rate that is affine in the position: a at the opposite vertex, where s
    is the height h, and at least b on the facet. So -ds/dt >= b + (a - b) s / h, and s reaches 0 after
    h log(a / b) / (a - b) at the latest.
    """
    velocities = exit_velocities(partition, speed_m_s)
    rates = np.einsum("mjx,mjvx->mjv", partition.normals, velocities)
    facets = np.arange(3)
    apex = rates[:, facets, facets]
    on_facet = np.minimum(rates[:, facets, (facets + 1) % 3], rates[:, facets, (facets + 2) % 3])
    # log(a / b) / (a - b) by the relative difference, which may be 0.
    change = apex / on_facet - 1.0
    alike = np.abs(change) < 1e-9  # noqa: PLR2004 - below rounding, log(1 + x) / x is 1
    factor = np.where(alike, 1.0, np.log1p(change) / np.where(alike, 1.0, change))
    times: FloatArray = partition.heights_m / on_facet * factor
    return times
