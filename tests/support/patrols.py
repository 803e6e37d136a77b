"""Patrols of regions on small meshes, and their best tours by trying out every order."""

from itertools import permutations

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.geometry.regions import label_triangles
from mission.geometry.triangulation import triangulate_nodes
from mission.planning.run import Run
from mission.planning.transition_system import TransitionSystem
from tests.support.domains import random_nodes
from tests.support.products import weighted


def patrol(seed: int, nodes: int, regions: int, size: int, most: int) -> TransitionSystem:
    """A mesh with some regions of up to ``size`` triangles each, and a twentieth of the others closed."""
    partition, rng = triangulate_nodes(random_nodes(seed, nodes)), np.random.default_rng(seed)
    free = rng.permutation(partition.size)
    members = {}
    for i in range(regions):
        centre = partition.corners_m[free[0]].mean(axis=0)
        near = np.argsort(np.linalg.norm(partition.corners_m.mean(axis=1)[free] - centre, axis=1), kind="stable")
        chosen = free[near[: int(rng.integers(1, size + 1))]]
        members[f"r{i}"] = np.isin(np.arange(partition.size), chosen)
        free = free[~np.isin(free, chosen)]
    blocked = np.isin(np.arange(partition.size), free[1 : 1 + partition.size // 20])
    labelling = label_triangles(partition.size, members)
    return weighted(rng, TransitionSystem.from_partition(partition, labelling, blocked), most)


def all_pairs(system: TransitionSystem) -> FloatArray:
    """Cheapest ways between all triangles, (M, M), by Floyd and Warshall."""
    ways = np.full((system.size, system.size), np.inf)
    np.fill_diagonal(ways, 0.0)
    rows, controls = np.nonzero(system.successors[:, 1:] >= 0)
    ways[rows, system.successors[rows, controls + 1]] = system.weights[rows, controls + 1]
    for middle in range(system.size):
        ways = np.minimum(ways, ways[:, middle, None] + ways[None, middle])
    return ways


def optimal_tour(system: TransitionSystem, start: int, regions: int) -> float:
    """The cheapest tour of all regions among the triangles that can be reached, in whatever order."""
    ways = all_pairs(system)
    reached = np.isfinite(ways[start])
    inside = [
        np.flatnonzero(np.array([f"r{i}" in letter for letter in system.letters])[system.letter_of] & reached)
        for i in range(regions)
    ]
    best = np.inf
    for order in permutations(range(1, regions)):
        for begin in inside[0].tolist():
            here, costs = np.array([begin]), np.zeros(1)
            for region in order:
                there = inside[region]
                here, costs = there, (costs[:, None] + ways[np.ix_(here, there)]).min(axis=0, initial=np.inf)
            best = min(best, float((costs + ways[here, begin]).min(initial=np.inf)))
    return best


def loop_cost(system: TransitionSystem, run: Run) -> int:
    """What the loop of a run costs."""
    controls = run.controls[len(run.prefix) :]
    return int(system.weights[list(run.suffix), list(controls)].sum())
