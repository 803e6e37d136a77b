"""Triangles seen from their shortest edge: how thin they are, and where a vertex mends them."""

import functools
from dataclasses import dataclass
from typing import Final

import numpy as np

from mission.geometry.arrays import FloatArray, IntArray

_FLAT: Final = 1e-9
_NEARER: Final = 0.95  # a little nearer than where the least angle is just met: what is left over is not thin again


@dataclass(frozen=True, eq=False)
class Slimness:
    """Shapes of N triangles.

    Attributes:
        corners: Positions, three of shape (N, 2).
        apex: Shape (N,), which of the corners is opposite the shortest edge, 0 to 2.
        shortest: Length of the shortest edge, shape (N,).
        longest: Length of the longest.
        radius: Of the circumscribed circle; 0 where the triangle is flat, for that one lies on a straight rim, between
            vertices that rounding keeps off it.
    """

    corners: tuple[FloatArray, FloatArray, FloatArray]
    apex: IntArray
    shortest: FloatArray
    longest: FloatArray
    radius: FloatArray

    @classmethod
    def of(cls, vertices: FloatArray, triangles: IntArray) -> "Slimness":
        """Measure triangles, shape (N, 3), of vertices, shape (V, 2)."""
        a, b, c = (vertices[ends] for ends in triangles.T)
        ab, bc, ca = (b - a).T, (c - b).T, (a - c).T
        lengths = opposite_a, opposite_b, opposite_c = np.hypot(*bc), np.hypot(*ca), np.hypot(*ab)
        doubled = np.abs(ab[0] * bc[1] - ab[1] * bc[0])
        # Columns, not rows of three: minima along short rows are slow.
        shortest, longest = functools.reduce(np.minimum, lengths), functools.reduce(np.maximum, lengths)
        flat = doubled <= _FLAT * longest**2
        radius = np.where(flat, 0.0, opposite_a * opposite_b * opposite_c / (2.0 * np.where(flat, 1.0, doubled)))
        apex = np.where(opposite_b == shortest, 1, 2)
        apex[opposite_a == shortest] = 0
        return cls((a, b, c), apex, shortest, longest, radius)

    def off_centres(self, ratio: float) -> FloatArray:
        """Where new vertices mend the triangles, shape (N, 2).

        It is the circumcentre, but no farther from the shortest edge than where that is seen under the least angle.

        Args:
            ratio: Of circumradius and shortest edge at the least angle.
        """
        rows, corners = np.arange(len(self.apex)), np.stack(self.corners, axis=1)
        apex, a, b = (corners[rows, (self.apex + turn) % 3] for turn in range(3))
        middle, along = (a + b) / 2.0, (b - a) / self.shortest[:, None]
        normal = np.stack((-along[:, 1], along[:, 0]), axis=1)
        normal *= np.sign(((apex - middle) * normal).sum(axis=1))[:, None]
        height = np.sqrt(np.maximum(self.radius**2 - self.shortest**2 / 4.0, 0.0))
        off = _NEARER * self.shortest * (ratio + np.sqrt(max(ratio**2 - 0.25, 0.0)))
        height = np.where(self.radius > ratio * self.shortest, np.minimum(height, off), height)
        centres: FloatArray = middle + normal * height[:, None]
        return centres
