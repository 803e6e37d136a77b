"""A triangulated domain: vertices, triangles, neighbours, and what follows from them.

Conventions, shared by the whole planner (paper, Sec. 2 and 4.2): the vertices of a triangle are counter-clockwise;
facet ``j`` of a triangle is the edge opposite its vertex ``j``; control ``u_{j+1}`` leaves through facet ``j``,
``u_0`` stays. In arrays, ``j`` counts from 0.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mission.errors import GeometryError
from mission.geometry.arrays import FloatArray, IntArray, frozen_floats, frozen_ints

ROUNDING = 1e-9
"""Lengths below this part of the domain's extent are rounding: points so close together are one point."""

_FARTHEST_M = 1e12
"""Of what lies farther, areas and their products are no numbers any more."""


@dataclass(frozen=True, eq=False)
class Partition:
    """A conforming triangulation of a planar domain.

    Attributes:
        vertices_m: Shape (V, 2), ENU, metres.
        triangles: Shape (M, 3), vertex indices, counter-clockwise.
        neighbours: Shape (M, 3); ``neighbours[i, j]`` is the triangle across facet ``j`` of ``i``; -1 for none.

    Raises:
        GeometryError: If the arrays do not fit together, or a triangle is not counter-clockwise.
    """

    vertices_m: FloatArray
    triangles: IntArray
    neighbours: IntArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices_m", frozen_floats(self.vertices_m))
        object.__setattr__(self, "triangles", frozen_ints(self.triangles))
        object.__setattr__(self, "neighbours", frozen_ints(self.neighbours))
        vertices, triangles, neighbours = self.vertices_m, self.triangles, self.neighbours
        if vertices.ndim != 2 or vertices.shape[1] != 2 or not (np.abs(vertices) < _FARTHEST_M).all():  # noqa: PLR2004 - the plane
            raise GeometryError(f"vertices must be points of the plane nearer than {_FARTHEST_M:g} m, shape (V, 2)")
        if not len(triangles) or triangles.shape[1:] != (3,) or neighbours.shape != triangles.shape:
            raise GeometryError("triangles and neighbours must both have shape (M, 3), M at least 1")
        if triangles.min() < 0 or triangles.max() >= len(vertices):
            raise GeometryError(f"a triangle names a vertex outside 0 to {len(vertices) - 1}")
        if neighbours.min() < -1 or neighbours.max() >= len(triangles):
            raise GeometryError(f"a neighbour lies outside -1 to {len(triangles) - 1}")
        if (self.areas_m2 <= 0).any():
            raise GeometryError(f"triangle {int(np.argmin(self.areas_m2))} is flat or not counter-clockwise")

    @property
    def size(self) -> int:
        """Number of triangles, M."""
        return len(self.triangles)

    @cached_property
    def extent_m(self) -> float:
        """The longer side of the domain's bounding box."""
        return float(np.ptp(self.vertices_m, axis=0).max())

    @cached_property
    def corners_m(self) -> FloatArray:
        """Corner positions, shape (M, 3, 2)."""
        return frozen_floats(self.vertices_m[self.triangles])

    @cached_property
    def edges_m(self) -> FloatArray:
        """Facets as vectors, shape (M, 3, 2): facet ``j`` runs from vertex ``j+1`` to vertex ``j+2``."""
        corners = self.corners_m
        return frozen_floats(np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1))

    @cached_property
    def edge_lengths_m(self) -> FloatArray:
        """Lengths of the facets, shape (M, 3)."""
        return frozen_floats(np.linalg.norm(self.edges_m, axis=-1))

    @cached_property
    def normals(self) -> FloatArray:
        """Outward unit normals of the facets, shape (M, 3, 2); facet ``j`` is opposite vertex ``j``."""
        edges = self.edges_m
        normals = np.stack((edges[..., 1], -edges[..., 0]), axis=-1)
        return frozen_floats(normals / self.edge_lengths_m[..., None])

    @cached_property
    def angles_rad(self) -> FloatArray:
        """Angles at the vertices, shape (M, 3)."""
        following, last = np.roll(self.edges_m, -1, axis=1), np.roll(self.edges_m, -2, axis=1)
        return frozen_floats(np.arctan2(2.0 * self.areas_m2[:, None], -(following * last).sum(axis=-1)))

    @cached_property
    def areas_m2(self) -> FloatArray:
        """Areas, shape (M,)."""
        a, b, c = np.moveaxis(self.corners_m, 1, 0)
        u, v = b - a, c - a
        return frozen_floats(0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]))

    @cached_property
    def heights_m(self) -> FloatArray:
        """Distance of each vertex from its opposite facet's line, shape (M, 3)."""
        return frozen_floats(2.0 * self.areas_m2[:, None] / self.edge_lengths_m)

    @cached_property
    def inradii_m(self) -> FloatArray:
        """Radii of the inscribed circles, shape (M,)."""
        return frozen_floats(2.0 * self.areas_m2 / self.edge_lengths_m.sum(axis=1))

    @cached_property
    def incentres_m(self) -> FloatArray:
        """Centres of the inscribed circles, shape (M, 2)."""
        weights = self.edge_lengths_m / self.edge_lengths_m.sum(axis=1, keepdims=True)
        return frozen_floats((weights[..., None] * self.corners_m).sum(axis=1))

    @cached_property
    def circumradii_m(self) -> FloatArray:
        """Radii of the circumscribed circles, shape (M,)."""
        return frozen_floats(self.edge_lengths_m.prod(axis=1) / (4.0 * self.areas_m2))

    def barycentric(self, triangles: IntArray, points_m: FloatArray) -> FloatArray:
        """Barycentric coordinates of each point in the triangle beside it.

        Args:
            triangles: Shape (P,), triangle indices.
            points_m: Shape (P, 2).

        Returns:
            Shape (P, 3); rows sum to 1, and are not negative where the point lies in the closed triangle.
        """
        starts = np.roll(self.corners_m[triangles], -1, axis=1)
        edges = self.edges_m[triangles]
        offsets = np.asarray(points_m, dtype=np.float64)[:, None, :] - starts
        doubled = edges[..., 0] * offsets[..., 1] - edges[..., 1] * offsets[..., 0]
        shares: FloatArray = doubled / (2.0 * self.areas_m2[triangles])[:, None]
        return shares
