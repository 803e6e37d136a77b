"""How the inner vertices of a mesh go along with those that are moved, so that no triangle folds as far as that can be.

At each of many instants the vertices that nobody moves are where the triangles are least distorted against those at
first: the sum of the squares of |J|^2 + |J^-1|^2 is least, J being the linear part of the map of a
triangle (the symmetric Dirichlet energy; Smith and Schaefer, 2015). It grows without end as one becomes flat, and
is least where nothing is moved. In place of det J there stands, after Escobar et al. (2003), a number above 0 that is
nearly det J where that is: a triangle that the step before has left folded is unfolded by it.
"""

from typing import Final

import numpy as np
from scipy.optimize import minimize

from mission.geometry.arrays import BoolArray, FloatArray
from mission.geometry.moving import MovingPartition, rim_of
from mission.geometry.simplices import Partition

_STEP: Final = 0.25
"""Of the mean edge, how far a vertex is moved from one instant to the next at most."""

_MOST_STEPS: Final = 400
_LITTLE: Final = (0.1, 1e-3)
"""What of det J counts as little: where a step has folded something, first so much that it is unfolded."""
_EXACT: Final = 1e-3
"""Of the slope of the energy: where it is less, the energy counts as least."""
_MOST_ITERATIONS: Final = 200


def carried_along(partition: Partition, times_s: FloatArray, moved: BoolArray, places_m: FloatArray) -> MovingPartition:
    """A partition of which some vertices are moved; those of the boundary stay, and the others go along.

    Args:
        partition: As it is at the first instant.
        times_s: Shape (K,), instants, ascending from 0.
        moved: Shape (V,), the vertices that are moved, or are held; those of the boundary are held anyhow.
        places_m: Shape (K, V, 2), where they are at the instants, and straight between; of others it is not read.

    Returns:
        With instants between these, as many as it takes for small steps. Triangles may fold.

    Raises:
        GeometryError: A vertex of the boundary is moved, or instants do not ascend from 0.
    """
    given, free = np.where(moved[:, None], places_m, partition.vertices_m), ~(moved | rim_of(partition))
    ways_m = np.linalg.norm(np.diff(given, axis=0), axis=2).max(axis=1, initial=0.0)
    step_m = max(_STEP * float(partition.edge_lengths_m.mean()), float(ways_m.sum()) / _MOST_STEPS)
    distortion = _Distortion(partition, free)
    times, found = [0.0], [partition.vertices_m]
    for k, way_m in enumerate(ways_m.tolist()):
        steps = max(1, int(np.ceil(way_m / step_m)))
        onward = np.zeros_like(partition.vertices_m)  # with what moves evenly the others nearly do
        for share in np.arange(1, steps + 1) / steps:
            there = given[k] + share * (given[k + 1] - given[k])
            there[free] = found[-1][free] + onward[free]
            times.append(float(times_s[k] + share * (times_s[k + 1] - times_s[k])))
            found.append(distortion.least(there) if free.any() and way_m > 0.0 else there)
            onward = found[-1] - found[-2]
    return MovingPartition(partition, np.array(times), np.stack(found))


class _Distortion:
    """The energy of a mesh as a function of where its free vertices are."""

    def __init__(self, partition: Partition, free: BoolArray) -> None:
        self._triangles, self._free = partition.triangles, free
        self._unit_m = float(partition.edge_lengths_m.mean())
        corners = partition.corners_m
        sides = np.stack((corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=2)
        self._inverse = np.linalg.inv(sides)

    def least(self, vertices_m: FloatArray) -> FloatArray:
        """The vertices (V, 2), the free ones where the energy is least, beginning with where they are."""
        found, free = vertices_m.copy(), self._free
        places = vertices_m[free].ravel() / self._unit_m
        for little in _LITTLE[0 if self._folds(vertices_m) else 1 :]:

            def energy(tried: FloatArray, little: float = little) -> tuple[float, FloatArray]:
                found[free] = self._unit_m * tried.reshape(-1, 2)
                value, slope = self._at(found, little)
                return value, self._unit_m * slope[free].ravel()

            best = minimize(
                energy,
                places,
                jac=True,
                method="CG",  # which calls no library that starts threads
                options={"maxiter": _MOST_ITERATIONS, "gtol": _EXACT},
            )
            places = np.asarray(best.x)
        found[free] = self._unit_m * places.reshape(-1, 2)
        return found

    def _folds(self, vertices_m: FloatArray) -> bool:
        a, b, c = (vertices_m[self._triangles[:, j]] for j in range(3))
        return bool((np.linalg.det(np.stack((b - a, c - a), axis=1)) <= 0.0).any())

    def _at(self, vertices_m: FloatArray, little: float) -> tuple[float, FloatArray]:
        """The energy, and its slope for each vertex (V, 2); ``little`` is what of det J counts so."""
        a, b, c = (vertices_m[self._triangles[:, j]] for j in range(3))
        jacobian = np.stack((b - a, c - a), axis=2) @ self._inverse
        (p, q), (r, s) = np.moveaxis(jacobian, 0, 2)
        det, squares = p * s - q * r, p * p + q * q + r * r + s * s
        root = np.sqrt(det * det + little**2)
        size = 0.5 * np.where(det > 0.0, det + root, little**2 / (root - np.minimum(det, 0.0)))  # in place of det J
        each = squares * (1.0 + 1.0 / size**2)
        by_det = -2.0 * squares / (size**2 * root)
        cofactor = np.moveaxis(np.array([[s, -r], [-q, p]]), 2, 0)
        slope = 2.0 * jacobian * (1.0 + 1.0 / size**2)[:, None, None] + cofactor * by_det[:, None, None]
        slope = slope * (2.0 / len(each) * each)[:, None, None]
        by_sides = slope @ np.swapaxes(self._inverse, 1, 2)  # (M, 2, 2): columns for b - a and c - a
        parts = np.concatenate((-by_sides.sum(axis=2), by_sides[:, :, 0], by_sides[:, :, 1]))
        vertices, size = self._triangles.T.ravel(), len(vertices_m)
        total = [np.bincount(vertices, parts[:, axis], size) for axis in (0, 1)]
        return float((each**2).mean()), np.stack(total, axis=1)
