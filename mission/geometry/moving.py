"""Triangles that move (paper, Sec. 4.4): each is the image of a fixed one under an affine map that changes with time.

The vertices move, straight between the instants of a list, and the triangles keep their vertices. So the maps of two
triangles agree on the edge that both have, and all of them together are one map of the domain onto itself, which is
the identity on its boundary: that does not move. Between two instants whatever is asked of a triangle is a quadratic.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
import shapely

from mission.errors import GeometryError
from mission.geometry.arrays import BoolArray, FloatArray, IntArray, frozen_floats
from mission.geometry.simplices import ROUNDING, Partition

FLATTEST: Final = 0.01
"""A triangle that moves is never flatter: its smallest height is this part of its longest side at least."""

_AT_ONCE: Final = 1 << 20
"""Pairs of a point and a triangle that are looked at together."""


@dataclass(frozen=True, eq=False)
class Flat:
    """A triangle that folds, or becomes too flat.

    Attributes:
        triangle: Its number.
        time_s: When it is first seen to be so.
    """

    triangle: int
    time_s: float


@dataclass(frozen=True, eq=False)
class MovingPartition:
    """A partition whose inner vertices move, in straight lines between instants; after the last one they stand.

    Attributes:
        fixed: As it is at the first instant; all its triangles are images of these.
        times_s: Shape (K,), the instants, ascending from 0.
        places_m: Shape (K, V, 2), where the vertices are.

    Raises:
        GeometryError: The arrays do not fit together, or vertices of the boundary move.
    """

    fixed: Partition
    times_s: FloatArray
    places_m: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "times_s", frozen_floats(self.times_s))
        object.__setattr__(self, "places_m", frozen_floats(self.places_m))
        times, places = self.times_s, self.places_m
        if places.shape != (len(times), *self.fixed.vertices_m.shape) or not np.isfinite(places).all():
            raise GeometryError("places of vertices must be finite, one set for each instant")
        if not len(times) or times[0] != 0.0 or (np.diff(times) <= 0.0).any() or not np.isfinite(times).all():
            raise GeometryError("instants must ascend from 0")
        if (places[0] != self.fixed.vertices_m).any() or (places[:, self.rim] != places[:1, self.rim]).any():
            raise GeometryError("vertices begin where they are, and those of the boundary stay there")

    @cached_property
    def rim(self) -> BoolArray:
        """Which vertices lie on the boundary, shape (V,)."""
        return rim_of(self.fixed)

    @property
    def last_s(self) -> float:
        """When all of them stand."""
        return float(self.times_s[-1])

    @cached_property
    def moves(self) -> BoolArray:
        """Which vertices move at some time, shape (V,)."""
        return np.asarray((self.places_m != self.places_m[:1]).any(axis=(0, 2)))

    @cached_property
    def drifts_m_s(self) -> FloatArray:
        """How fast the vertices move from each instant to the next, and after the last, shape (K, V, 2)."""
        steps = np.diff(self.places_m, axis=0) / np.diff(self.times_s)[:, None, None]
        return frozen_floats(np.concatenate((steps, np.zeros_like(self.places_m[:1]))))

    @cached_property
    def fastest_m_s(self) -> float:
        """The largest speed of any vertex."""
        return float(np.hypot(self.drifts_m_s[..., 0], self.drifts_m_s[..., 1]).max())

    def vertices_at(self, time_s: float) -> FloatArray:
        """Where the vertices are at a time, shape (V, 2)."""
        k, share = self._between(np.array([time_s]))
        here, there = self.places_m[k[0]], self.places_m[min(k[0] + 1, len(self.times_s) - 1)]
        return np.asarray(here + share[0] * (there - here))

    def at(self, time_s: float) -> Partition:
        """The partition as it is at a time."""
        return Partition(self.vertices_at(time_s), self.fixed.triangles, self.fixed.neighbours)

    def velocities_at(self, time_s: float) -> FloatArray:
        """How fast the vertices move from a time on, shape (V, 2), m/s."""
        if time_s < 0.0:
            return np.zeros_like(self.fixed.vertices_m)
        return np.asarray(self.drifts_m_s[self._between(np.array([time_s]))[0][0]])

    def corners_at(self, times_s: FloatArray, triangles: IntArray) -> FloatArray:
        """The corners of a triangle at each time, both (P,): shape (P, 3, 2)."""
        k, share = self._between(np.asarray(times_s, dtype=np.float64))
        vertices, after = self.fixed.triangles[triangles], np.minimum(k + 1, len(self.times_s) - 1)
        here, there = self.places_m[k[:, None], vertices], self.places_m[after[:, None], vertices]
        return np.asarray(here + share[:, None, None] * (there - here))

    def pulled_back(self, times_s: FloatArray, points_m: FloatArray) -> FloatArray:
        """The points of the fixed partition of which places are the images, each at its time.

        Args:
            times_s: Shape (P,).
            points_m: Shape (P, 2), ENU, metres; what lies outside the domain is its own image.

        Returns:
            Shape (P, 2).
        """
        points = np.array(points_m, dtype=np.float64).reshape(-1, 2)
        times = np.broadcast_to(np.asarray(times_s, dtype=np.float64), len(points))
        found, size = points.copy(), self.fixed.size
        every = np.arange(size)
        for first in range(0, len(points), max(1, _AT_ONCE // size)):
            part = slice(first, first + max(1, _AT_ONCE // size))
            some = points[part]
            corners = self.corners_at(np.repeat(times[part], size), np.tile(every, len(some)))
            shares = _barycentric(corners.reshape(len(some), size, 3, 2), some[:, None])
            best = shares.min(axis=2).argmax(axis=1)
            own = shares[np.arange(len(some)), best]
            inside = own.min(axis=1) >= -ROUNDING
            found[part][inside] = np.einsum("pj,pji->pi", own, self.fixed.corners_m[best])[inside]
        return found

    def carried(self, times_s: FloatArray, points_m: FloatArray, triangles: IntArray) -> FloatArray:
        """The images of points (P, 2) of fixed triangles (P,), each at its time (P,): shape (P, 2)."""
        shares = self.fixed.barycentric(triangles, points_m)
        return np.asarray(np.einsum("pj,pji->pi", shares, self.corners_at(times_s, triangles)))

    def first_flat(self) -> Flat | None:
        """The first triangle that folds or is flatter than ``FLATTEST`` at some time; None where none ever is.

        Twice the area less a part of the square of each side is a quadratic between two instants, whose least value is
        known exactly: at an end, or at its vertex.
        """
        of = self.places_m[:, self.fixed.triangles]  # (K, M, 3, 2)
        edges = np.roll(of, -2, axis=2) - np.roll(of, -1, axis=2)
        for k, begin_s in enumerate(self.times_s[:-1].tolist()):
            e, d = edges[k], edges[k + 1] - edges[k]
            area = [
                _cross(e[:, 1], e[:, 2]),
                _cross(e[:, 1], d[:, 2]) + _cross(d[:, 1], e[:, 2]),
                _cross(d[:, 1], d[:, 2]),
            ]
            side = [(e * e).sum(axis=2), 2.0 * (e * d).sum(axis=2), (d * d).sum(axis=2)]
            c0, c1, c2 = (a[:, None] - FLATTEST * s for a, s in zip(area, side, strict=True))
            turn = np.clip(np.divide(-c1, 2.0 * c2, out=np.zeros_like(c1), where=c2 > 0.0), 0.0, 1.0)
            least = np.stack([c0 + u * (c1 + u * c2) for u in (np.zeros_like(turn), turn, np.ones_like(turn))])
            bad = np.flatnonzero((least <= 0.0).any(axis=(0, 2)))
            if len(bad):
                share, triangle = min((_first_below(c0[t], c1[t], c2[t]), t) for t in bad.tolist())
                return Flat(triangle, begin_s + share * (float(self.times_s[k + 1]) - begin_s))
        return None

    def _between(self, times_s: FloatArray) -> tuple[IntArray, FloatArray]:
        """Of times (P,), the instant before each, and how far it is on the way to the next one, from 0 to 1."""
        k = np.clip(np.searchsorted(self.times_s, times_s, side="right") - 1, 0, len(self.times_s) - 1)
        lasts = np.append(np.diff(self.times_s), 1.0)[k]
        share = np.where(k == len(self.times_s) - 1, 0.0, (times_s - self.times_s[k]) / lasts)
        return k, np.clip(share, 0.0, 1.0)


def hulls_of(points_m: FloatArray) -> "np.ndarray[tuple[int], np.dtype[np.object_]]":
    """The convex hulls of sets of points (N, K, 2), shape (N,): of a triangle at two times, all places between."""
    numbers = np.repeat(np.arange(len(points_m)), points_m.shape[1])
    return np.asarray(shapely.convex_hull(shapely.multipoints(points_m.reshape(-1, 2), indices=numbers)))


def rim_of(partition: Partition) -> BoolArray:
    """Which vertices of a partition lie on its boundary, shape (V,)."""
    triangles, facets = np.nonzero(partition.neighbours < 0)
    rim = np.zeros(len(partition.vertices_m), dtype=np.bool_)
    for step in (1, 2):
        rim[partition.triangles[triangles, (facets + step) % 3]] = True
    return rim


def _barycentric(corners_m: FloatArray, points_m: FloatArray) -> FloatArray:
    """Barycentric coordinates (..., 3) of points (..., 2) in triangles (..., 3, 2)."""
    edges = np.roll(corners_m, -2, axis=-2) - np.roll(corners_m, -1, axis=-2)
    doubled = _cross(edges, points_m[..., None, :] - np.roll(corners_m, -1, axis=-2))
    return np.asarray(doubled / doubled.sum(axis=-1, keepdims=True))


def _cross(one: FloatArray, other: FloatArray) -> FloatArray:
    return np.asarray(one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0])


def _first_below(*coefficients: FloatArray) -> float:
    """Where between 0 and 1 one of some quadratics, by their constants, slopes and bends (3,), first comes to 0."""
    found = [1.0]
    for constant, slope, bend in zip(*coefficients, strict=True):
        roots = np.roots([bend, slope, constant])
        found += [0.0] if constant <= 0.0 else [root.real for root in roots if root.imag == 0.0 <= root.real <= 1.0]
    return min(found)
