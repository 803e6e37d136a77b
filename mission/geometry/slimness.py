"""Triangles seen from their shortest edge: how thin they are, and where a vertex mends them."""

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
        turned: Shape (N, 3): vertices, beginning with the one opposite the shortest edge.
        shortest: Length of the shortest edge, shape (N,).
        longest: Length of the longest.
        radius: Of the circumscribed circle; 0 where the triangle is flat, for that one lies on a straight rim, between
            vertices that rounding keeps off it.
        corners: Positions of ``turned``, shape (N, 3, 2).
    """

    turned: IntArray
    shortest: FloatArray
    longest: FloatArray
    radius: FloatArray
    corners: FloatArray

    @classmethod
    def of(cls, vertices: FloatArray, triangles: IntArray) -> "Slimness":
        """Measure triangles, shape (N, 3), of vertices, shape (V, 2)."""
        corners = vertices[triangles]
        sides = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
        lengths = np.linalg.norm(sides, axis=-1)
        doubled = np.abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0])
        longest = lengths.max(axis=1)
        flat = doubled <= _FLAT * longest**2
        radius = np.where(flat, 0.0, lengths.prod(axis=1) / (2.0 * np.where(flat, 1.0, doubled)))
        turn = (lengths.argmin(axis=1)[:, None] + np.arange(3)) % 3
        rows = np.arange(len(triangles))[:, None]
        return cls(triangles[rows, turn], lengths.min(axis=1), longest, radius, corners[rows, turn])

    def off_centres(self, ratio: float) -> FloatArray:
        """Where new vertices mend the triangles, shape (N, 2).

        It is the circumcentre, but no farther from the shortest edge than where that is seen under the least angle.

        Args:
            ratio: Of circumradius and shortest edge at the least angle.
        """
        apex, a, b = np.moveaxis(self.corners, 1, 0)
        middle, along = (a + b) / 2.0, (b - a) / self.shortest[:, None]
        normal = np.stack((-along[:, 1], along[:, 0]), axis=1)
        normal *= np.sign(((apex - middle) * normal).sum(axis=1))[:, None]
        height = np.sqrt(np.maximum(self.radius**2 - self.shortest**2 / 4.0, 0.0))
        off = _NEARER * self.shortest * (ratio + np.sqrt(max(ratio**2 - 0.25, 0.0)))
        height = np.where(self.radius > ratio * self.shortest, np.minimum(height, off), height)
        centres: FloatArray = middle + normal * height[:, None]
        return centres
