"""A triangulated domain: vertices, triangles, neighbours, and what follows from them.

Conventions, shared by the whole planner (paper, Sec. 2 and 4.2): the vertices of a triangle are counter-clockwise;
facet ``j`` of a triangle is the edge opposite its vertex ``j``; control ``u_{j+1}`` leaves through facet ``j``,
``u_0`` stays. In arrays, ``j`` counts from 0.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mission.geometry.arrays import FloatArray, IntArray, frozen_floats, frozen_ints


@dataclass(frozen=True, eq=False)
class Partition:
    """A conforming triangulation of a planar domain.

    Attributes:
        vertices_m: Shape (V, 2), ENU, metres.
        triangles: Shape (M, 3), vertex indices, counter-clockwise.
        neighbours: Shape (M, 3); ``neighbours[i, j]`` is the triangle across facet ``j`` of ``i``; -1 for none.
    """

    vertices_m: FloatArray
    triangles: IntArray
    neighbours: IntArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices_m", frozen_floats(self.vertices_m))
        object.__setattr__(self, "triangles", frozen_ints(self.triangles))
        object.__setattr__(self, "neighbours", frozen_ints(self.neighbours))

    @property
    def size(self) -> int:
        """Number of triangles, M."""
        return len(self.triangles)

    @cached_property
    def corners_m(self) -> FloatArray:
        """Corner positions, shape (M, 3, 2)."""
        return frozen_floats(self.vertices_m[self.triangles])

    @cached_property
    def normals(self) -> FloatArray:
        """Outward unit normals of the facets, shape (M, 3, 2); facet ``j`` is opposite vertex ``j``."""
        corners = self.corners_m
        edges = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
        normals = np.stack((edges[..., 1], -edges[..., 0]), axis=-1)
        return frozen_floats(normals / np.linalg.norm(normals, axis=-1, keepdims=True))

    @cached_property
    def areas_m2(self) -> FloatArray:
        """Areas, shape (M,)."""
        a, b, c = np.moveaxis(self.corners_m, 1, 0)
        u, v = b - a, c - a
        return frozen_floats(0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]))
