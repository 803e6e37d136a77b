"""Small random meshes, and how they move."""

import numpy as np

from mission.geometry.moving import MovingPartition, rim_of
from mission.geometry.simplices import Partition
from mission.geometry.triangulation import triangulate_nodes


def some_mesh(seed: int, nodes: int = 14) -> Partition:
    """The Delaunay mesh of random nodes in a square of 20 m whose corners are nodes."""
    inner = np.random.default_rng(seed).uniform(1.0, 19.0, (nodes, 2))
    return triangulate_nodes(np.concatenate(([[0, 0], [20, 0], [20, 20], [0, 20]], inner)))


def shaken(seed: int, most_m: float) -> MovingPartition:
    """A mesh whose inner vertices go to three random places each."""
    mesh, rng = some_mesh(seed), np.random.default_rng(seed + 1)
    steps = rng.uniform(-most_m, most_m, (3, *mesh.vertices_m.shape)) * ~rim_of(mesh)[:, None]
    places = mesh.vertices_m + np.concatenate((np.zeros((1, *mesh.vertices_m.shape)), steps))
    return MovingPartition(mesh, np.array([0.0, 2.0, 3.0, 7.0]), places)
