"""Control to a facet, and to stay, in triangles that move (paper, Sec. 4.4).

A field u = F x + g is made in the fixed triangle and carried over into the moving one, which is its image under
x -> A(t) x + b(t): the velocity in space is A (F x + g) + A' x + b'. Barycentric coordinates are the same in both, so
their rates are: with vertex velocities u_i and outward normals n_j of the fixed triangle, whose heights are h_j, the
j-th coordinate changes at the vertex i by -n_j . u_i / h_j, whatever the motion. Across the moving facet j, and against
the frame that moves with the triangle, a vehicle at that vertex goes out by h_j(t) n_j . u_i / h_j. Heights are
positive, so each strict inequality of Eq. 13 to 15, or 21, stays one at every instant, with a margin that the least
height tells. And a field that is slowed down by a factor changes coordinates by that factor: all else stays.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from mission.geometry.arrays import FloatArray, IntArray
from mission.geometry.heights import height_bounds
from mission.geometry.moving import MovingPartition


def _conditions() -> IntArray:
    """What the control u_c asks of the rate across facet j at vertex i: 1 out, -1 not out, 0 nothing; (4, 3, 3)."""
    asked = np.zeros((4, 3, 3), dtype=np.int64)
    every = np.arange(3)
    asked[0] = np.eye(3, dtype=np.int64) - 1
    for exit_facet in range(3):
        asked[1 + exit_facet] = asked[0]
        asked[1 + exit_facet, exit_facet] = every != exit_facet
    return asked


_ASKED: Final = _conditions()
"""Eq. 21, and Eq. 13 to 15 but for the third row of Eq. 13, which is the sum of the two before it."""


@dataclass(frozen=True, eq=False)
class MovingFields:
    """Fields that are carried over into moving triangles.

    Attributes:
        moving: The triangles.
        triangles: Shape (N,), that of each field.
        velocities_m_s: Shape (N, 3, 2), the vertex velocities of each in its fixed triangle.
    """

    moving: MovingPartition
    triangles: IntArray
    velocities_m_s: FloatArray

    @cached_property
    def coordinate_rates(self) -> FloatArray:
        """By how much the j-th barycentric coordinate changes at vertex i, shape (N, 3, 3) as [field, j, i], 1/s."""
        fixed = self.moving.fixed
        slopes = -fixed.normals[self.triangles] / fixed.heights_m[self.triangles][..., None]
        return np.asarray(np.einsum("njx,nix->nji", slopes, self.velocities_m_s))

    def vertex_velocities(self, time_s: float) -> FloatArray:
        """The velocities in space at the moving vertices, from a time on, shape (N, 3, 2), m/s."""
        corners = self.moving.vertices_at(time_s)[self._vertices]
        return self._against_frame(corners) + self.moving.velocities_at(time_s)[self._vertices]

    @cached_property
    def facet_rates(self) -> tuple[FloatArray, FloatArray]:
        """The least and the largest rate across facet j at vertex i while all moves, both (N, 3, 3), m/s.

        Outward, along the normal that the facet has then, and against the frame that moves with the triangle; at the
        ends of the facet that is against the facet. Both bounds are attained.
        """
        places = self.moving.places_m[:, self._vertices]  # (K, N, 3, 2)
        least, largest = height_bounds(places, np.concatenate((places[1:], places[-1:])))
        ends = [-height[..., None] * self.coordinate_rates for height in (least.min(axis=0), largest.max(axis=0))]
        return np.minimum(*ends), np.maximum(*ends)

    def margins(self, controls: IntArray) -> FloatArray:
        """What is left at any time of the tightest inequality of Eq. 13 to 15, or of Eq. 21, shape (N,), m/s.

        Args:
            controls: Shape (N,), the control u_0 to u_3 that each field is.

        Returns:
            Positive where each is strict at every instant, so that the field does what its control says.
        """
        asked = _ASKED[controls]
        least, largest = self.facet_rates
        held = np.where(asked > 0, least, -largest)
        return np.asarray(np.where(asked == 0, np.inf, held).min(axis=(1, 2)))

    @cached_property
    def frame_speeds_m_s(self) -> FloatArray:
        """How fast the vertices themselves move, shape (K, N, 3): from each instant to the next, and after the last."""
        return np.asarray(np.linalg.norm(self._drifts, axis=-1))

    @cached_property
    def speeds_m_s(self) -> FloatArray:
        """The largest speed in space anywhere in the triangle, shape (K, N), for the times of ``frame_speeds_m_s``.

        A velocity is affine in place, and at a vertex affine in time between two instants; its norm is convex, so it is
        largest at a vertex, and at an instant. It is attained there.
        """
        return np.asarray(np.linalg.norm(self._own + self._drifts, axis=-1).max(axis=(0, 3)))

    def factors(self, limit_m_s: float) -> FloatArray:
        """By what each field is slowed down so that no speed in space is beyond a limit, shape (K, N), at most 1.

        Args:
            limit_m_s: The limit, positive.

        Returns:
            For the times of ``frame_speeds_m_s`` the largest factor; 0 where the frame leaves nothing.
        """
        # |f a + w|^2 = L^2, whose larger root is in f wherever |w| < L.
        a2 = (self._own**2).sum(axis=-1)
        half = (self._own * self._drifts).sum(axis=-1)
        spare = limit_m_s**2 - self.frame_speeds_m_s**2
        root = np.sqrt(np.maximum(half**2 + a2 * spare, 0.0))
        largest = np.divide(root - half, a2, out=np.ones_like(root), where=a2 > 0.0)
        return np.asarray(np.where(spare > 0.0, largest, 0.0).clip(0.0, 1.0).min(axis=(0, 3)))

    @property
    def _vertices(self) -> IntArray:
        return self.moving.fixed.triangles[self.triangles]

    @cached_property
    def _drifts(self) -> FloatArray:
        """Velocities of the vertices, (K, N, 3, 2)."""
        return self.moving.drifts_m_s[:, self._vertices]

    @cached_property
    def _own(self) -> FloatArray:
        """Velocities against the frame at both ends of the times of ``frame_speeds_m_s``, (2, K, N, 3, 2)."""
        at = self._against_frame(self.moving.places_m[:, self._vertices])
        return np.stack((at, np.concatenate((at[1:], at[-1:]))))

    def _against_frame(self, corners_m: FloatArray) -> FloatArray:
        """Vertex velocities (..., N, 3, 2) of triangles with such corners (..., N, 3, 2), less that of the vertices."""
        return np.asarray(np.einsum("nji,...njx->...nix", self.coordinate_rates, corners_m))
