"""A Delaunay triangulation that grows: many vertices at once, each in a cavity of its own.

A new vertex replaces the triangles in whose circumcircles it lies, its cavity, by triangles from it to the cavity's rim
(Bowyer, "Computing Dirichlet tessellations", and Watson, "Computing the n-dimensional Delaunay tessellation", both of
1981). Vertices whose cavities neither overlap nor touch do not know of each other and go in together, as arrays.
"""

from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from scipy.spatial import Delaunay, cKDTree

from mission.geometry.arrays import BoolArray, FloatArray, IntArray

_ROUNDING = 1e-12


@dataclass(frozen=True, eq=False)
class Growth:
    """What an insertion changed.

    Attributes:
        taken: Which of the offered points went in, shape (P,).
        triangles: Indices of the triangles that are new, shape (T,); some replace triangles of the same index.
        lost: Edges that are gone, pairs of vertices, shape (L, 2).
    """

    taken: BoolArray
    triangles: IntArray
    lost: IntArray


@dataclass(frozen=True, eq=False)
class Cavities:
    """The triangles that points would replace: pairs of a point and a triangle, sorted.

    Attributes:
        owner: Index of the point, shape (C,).
        triangle: Index of the triangle, shape (C,).
    """

    owner: IntArray
    triangle: IntArray

    def of(self, kept: BoolArray) -> "Cavities":
        """Those of some of the points, which are numbered anew; ``kept`` has shape (P,)."""
        some = kept[self.owner]
        return Cavities((np.cumsum(kept) - 1)[self.owner[some]], self.triangle[some])


class Triangulation:
    """The Delaunay triangulation of points in a square that is far larger than they are.

    The first vertices are the ``CORNERS`` of the square, then come the points in the order in which they were put in.
    """

    CORNERS = 4

    def __init__(self, points: FloatArray) -> None:
        low, high = points.min(axis=0), points.max(axis=0)
        middle, reach = (low + high) / 2.0, 4.0 * float((high - low).max())
        square = middle + reach * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
        self._vertices: FloatArray = np.concatenate((square, points))
        mesh = Delaunay(self._vertices)
        self._triangles: IntArray = np.asarray(mesh.simplices, dtype=np.int64)
        self._neighbours: IntArray = np.asarray(mesh.neighbors, dtype=np.int64)
        self._vertex_count, self._triangle_count = len(self._vertices), len(self._triangles)

    @property
    def vertices(self) -> FloatArray:
        """Positions, shape (V, 2)."""
        return self._vertices[: self._vertex_count]

    @property
    def triangles(self) -> IntArray:
        """Vertices of the triangles, shape (M, 3), counter-clockwise."""
        return self._triangles[: self._triangle_count]

    @property
    def neighbours(self) -> IntArray:
        """The triangle opposite each vertex, shape (M, 3); -1 for none."""
        return self._neighbours[: self._triangle_count]

    def conflicting(self, points: FloatArray) -> IntArray:
        """For each point a triangle in whose circumcircle it lies, shape (P,): one at the nearest vertex."""
        _, nearest = cKDTree(self.vertices).query(points)
        rows, places = np.nonzero(np.isin(self.triangles, nearest))
        order = np.argsort(self.triangles[rows, places], kind="stable")
        rows, hub = rows[order], self.triangles[rows, places][order]
        begin, end = np.searchsorted(hub, nearest), np.searchsorted(hub, nearest, "right")
        found = rows[begin]
        depth = self._depth(found, points)
        for step in range(1, int((end - begin).max())):
            other = rows[np.minimum(begin + step, end - 1)]
            deeper = self._depth(other, points)
            found, depth = np.where(deeper > depth, other, found), np.maximum(deeper, depth)
        return found

    def cavities(self, points: FloatArray, seeds: IntArray) -> Cavities:
        """The triangles in whose circumcircles points lie.

        Args:
            points: Shape (P, 2), none of them a vertex.
            seeds: Shape (P,), for each a triangle in whose circumcircle it lies.
        """
        size = self._triangle_count
        before, front = np.empty(0, dtype=np.int64), np.arange(len(points)) * size + seeds
        fronts = [front]
        while len(front):
            owner, triangle = np.repeat(front // size, 3), self._neighbours[front % size].reshape(-1)
            keys = np.unique((owner * size + triangle)[triangle >= 0])
            # What was found lies in this front or the one before it: neighbours are at most one step apart.
            keys = keys[~_among(keys, front)]
            keys = keys[~_among(keys, before)] if len(before) else keys
            before, front = front, keys[self._depth(keys % size, points[keys // size]) > 0.0]
            fronts.append(front)
        known = np.sort(np.concatenate(fronts))
        return Cavities(known // size, known % size)

    def insert(self, points: FloatArray, cavities: Cavities) -> Growth:
        """Put points in as far as their cavities keep apart; where they do not, the earlier point goes in.

        Args:
            points: Shape (P, 2), none of them a vertex.
            cavities: Theirs.
        """
        owner, cavity, size = cavities.owner, cavities.triangle, self._triangle_count
        outside, corners = self._neighbours[cavity], self._triangles[cavity]
        inner = _among((owner[:, None] * size + outside).reshape(-1), owner * size + cavity).reshape(-1, 3)
        inner &= outside >= 0
        taken = self._kept_apart(len(points), owner, cavity, outside)
        row, side = np.nonzero(~inner & taken[owner][:, None])
        whose, beyond = owner[row], outside[row, side]
        first, second = corners[row, (side + 1) % 3], corners[row, (side + 2) % 3]
        a, b = self._vertices[first], self._vertices[second]
        flat = _cross(b - a, points[whose] - a) <= _ROUNDING * ((b - a) ** 2).sum(axis=1)
        taken[whose[flat]] = False
        keep = taken[whose]
        whose, beyond, first, second = whose[keep], beyond[keep], first[keep], second[keep]
        gone = taken[owner]
        row, side = np.nonzero(inner & gone[:, None])
        lost = np.stack((corners[row, (side + 1) % 3], corners[row, (side + 2) % 3]), axis=1)
        number = self._vertex_count + np.cumsum(taken) - 1
        slots = self._grown(points[taken], cavity[gone], len(first))
        self._fill(slots, number[whose], first, second, beyond)
        return Growth(taken, slots, lost)

    def _kept_apart(self, count: int, owner: IntArray, cavity: IntArray, outside: IntArray) -> BoolArray:
        """Which points go in: no earlier one has a triangle of theirs, or one beside theirs, in its cavity."""
        earliest = np.full(self._triangle_count + 1, count)
        np.minimum.at(earliest, cavity, owner)
        # No neighbour (-1) picks the last entry, which is no cavity's.
        hindered = (earliest[cavity] < owner) | (earliest[outside].min(axis=1) < owner)
        taken = np.ones(count, dtype=np.bool_)
        taken[owner[hindered]] = False
        return taken

    def _grown(self, points: FloatArray, free: IntArray, wanted: int) -> IntArray:
        """Take in vertices, and make room for triangles: indices that are free, then new ones."""
        begin, size = self._vertex_count, self._triangle_count
        self._vertex_count += len(points)
        self._triangle_count += wanted - len(free)
        self._vertices = with_room(self._vertices, self._vertex_count)
        self._triangles = with_room(self._triangles, self._triangle_count)
        self._neighbours = with_room(self._neighbours, self._triangle_count)
        self._vertices[begin : self._vertex_count] = points
        return np.concatenate((free, np.arange(size, self._triangle_count)))

    def _fill(self, slots: IntArray, apex: IntArray, first: IntArray, second: IntArray, beyond: IntArray) -> None:
        """Write triangles from apexes to the edges of rims, and link them with each other and with what is beyond."""
        self._triangles[slots] = np.stack((apex, first, second), axis=1)
        # About an apex, the triangle whose first is this one's second comes next, and the other way round.
        begins, ends = (apex * self._vertex_count + end for end in (first, second))
        by_begin = np.argsort(begins)
        following = by_begin[np.searchsorted(begins[by_begin], ends)]
        preceding = np.empty_like(following)
        preceding[following] = np.arange(len(following))
        self._neighbours[slots] = np.stack((beyond, slots[following], slots[preceding]), axis=1)
        some = beyond >= 0
        facing = self._triangles[beyond[some]]
        side = ((facing != first[some, None]) & (facing != second[some, None])).argmax(axis=1)
        self._neighbours[beyond[some], side] = slots[some]

    def _depth(self, triangles: IntArray, points: FloatArray) -> FloatArray:
        """How deep each point lies in the circumcircle of the triangle beside it: above 0 inside by more than rounding.

        The determinant of the lifted corners, against the sum of the sizes of its terms.
        """
        corners = self._vertices[self._triangles[triangles]] - points[:, None]
        x, y = corners[..., 0], corners[..., 1]
        lifted = x * x + y * y
        one, other = [1, 2, 0], [2, 0, 1]
        plus, minus = x[:, one] * y[:, other], y[:, one] * x[:, other]
        terms, sizes = lifted * (plus - minus), lifted * (np.abs(plus) + np.abs(minus))
        depth: FloatArray = terms.sum(axis=1) - _ROUNDING * sizes.sum(axis=1)
        return depth


def _cross(u: FloatArray, v: FloatArray) -> FloatArray:
    product: FloatArray = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
    return product


def _among(keys: IntArray, known: IntArray) -> BoolArray:
    """Which keys are among others that are sorted and not empty."""
    found: BoolArray = known[np.minimum(np.searchsorted(known, keys), len(known) - 1)] == keys
    return found


_Array = TypeVar("_Array", FloatArray, IntArray, BoolArray)


def with_room(array: _Array, rows: int) -> _Array:
    """The array, or one of twice the size that begins with it, so that growing costs little in the long run."""
    if rows <= len(array):
        return array
    larger = np.empty((2 * rows, *array.shape[1:]), dtype=array.dtype)
    larger[: len(array)] = array
    return larger
