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
_Array = TypeVar("_Array", FloatArray, IntArray, BoolArray)


@dataclass(frozen=True, eq=False)
class Growth:
    """What an insertion changed. Edges are named by a triangle and the side of it, opposite its corner of that number.

    Attributes:
        taken: Which of the offered points went in, shape (P,).
        triangles: Indices of the triangles that are new, shape (T,); some replace triangles of the same index. The
            first corner of each is a new vertex.
        rims: The edge opposite that corner as it was named before, shape (T, 2).
        lost: Edges that are gone as they were named, shape (L, 2); each is listed from either side.
    """

    taken: BoolArray
    triangles: IntArray
    rims: IntArray
    lost: IntArray


@dataclass(frozen=True, eq=False)
class Cavities:
    """The triangles that points would replace: pairs of a point and a triangle.

    Attributes:
        owner: Index of the point, shape (C,).
        triangle: Index of the triangle, shape (C,).
        beyond: The triangles beside it, shape (C, 3); -1 for none.
        inner: Which of them are of the same cavity, shape (C, 3).
    """

    owner: IntArray
    triangle: IntArray
    beyond: IntArray
    inner: BoolArray

    def of(self, kept: BoolArray) -> "Cavities":
        """Those of some of the points, which are numbered anew; ``kept`` has shape (P,)."""
        some = kept[self.owner]
        number = np.cumsum(kept) - 1
        return Cavities(number[self.owner[some]], self.triangle[some], self.beyond[some], self.inner[some])


class Triangulation:
    """The Delaunay triangulation of points in a square that is far larger than they are.

    The first vertices are the ``CORNERS`` of the square, then come the points in the order in which they were put in.
    """

    CORNERS = 4

    def __init__(self, points: FloatArray) -> None:
        low, high = points.min(axis=0), points.max(axis=0)
        middle, reach = (low + high) / 2.0, 4.0 * float((high - low).max())
        square = middle + reach * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
        self._vertices: FloatArray = square
        self._vertex_count = len(square)
        self.begin_again(points)

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

    def begin_again(self, points: FloatArray) -> None:
        """Put points in, shape (P, 2), by triangulating all anew: for many at once, whose cavities overlap.

        Triangles get other indices.
        """
        self._vertices = np.concatenate((self.vertices, points))
        mesh = Delaunay(self._vertices)
        self._triangles: IntArray = np.asarray(mesh.simplices, dtype=np.int64)
        self._neighbours: IntArray = np.asarray(mesh.neighbors, dtype=np.int64)
        self._vertex_count, self._triangle_count = len(self._vertices), len(self._triangles)

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

        A cavity has no vertex inside, so its triangles hang together like a tree, and each is met once.

        Args:
            points: Shape (P, 2), none of them a vertex.
            seeds: Shape (P,), for each a triangle in whose circumcircle it lies.
        """
        owner, triangle, before = np.arange(len(points)), seeds, np.full(len(points), -2)
        found = []
        while len(owner):
            beyond = self._neighbours[triangle]
            inner = beyond == before[:, None]
            row, side = np.nonzero(~inner & (beyond >= 0))
            ahead = beyond[row, side]
            deep = self._depth(ahead, points[owner[row]]) > 0.0
            row, side, ahead = row[deep], side[deep], ahead[deep]
            inner[row, side] = True
            found.append((owner, triangle, beyond, inner))
            owner, triangle, before = owner[row], ahead, triangle[row]
        return Cavities(*map(np.concatenate, zip(*found, strict=True)))

    def insert(self, points: FloatArray, cavities: Cavities) -> Growth:
        """Put points in as far as their cavities keep apart; where they do not, the earlier point goes in.

        Args:
            points: Shape (P, 2), none of them a vertex.
            cavities: Theirs.
        """
        owner, cavity = cavities.owner, cavities.triangle
        taken = self._kept_apart(len(points), owner, cavity, cavities.beyond)
        row, side = np.nonzero(~cavities.inner & taken[owner][:, None])
        whose, whole = owner[row], cavity[row]
        first, second = self._triangles[whole, (side + 1) % 3], self._triangles[whole, (side + 2) % 3]
        a = self._vertices[first]
        along, aside = self._vertices[second] - a, points[whose] - a
        area, size = along[:, 0] * aside[:, 1] - along[:, 1] * aside[:, 0], along[:, 0] ** 2 + along[:, 1] ** 2
        taken[whose[area <= _ROUNDING * size]] = False
        keep = taken[whose]
        rims = np.stack((whole, side), axis=1)[keep]
        gone = taken[owner]
        row, side = np.nonzero(cavities.inner & gone[:, None])
        lost = np.stack((cavity[row], side), axis=1)
        apex = (self._vertex_count + np.cumsum(taken) - 1)[whose[keep]]
        slots = self._grown(points[taken], cavity[gone], len(apex))
        self._fill(slots, apex, first[keep], second[keep], self._neighbours[rims[:, 0], rims[:, 1]])
        return Growth(taken, slots, rims, lost)

    def _kept_apart(self, count: int, owner: IntArray, cavity: IntArray, outside: IntArray) -> BoolArray:
        """Which points go in: none that do so earlier have one of their triangles, or one beside them, in a cavity."""
        taken = np.zeros(count, dtype=np.bool_)
        while len(owner):
            # No neighbour (-1) picks the last entry, which is no cavity's.
            earliest = np.full(self._triangle_count + 1, count)
            np.minimum.at(earliest, cavity, owner)
            settled = np.ones(count, dtype=np.bool_)
            settled[owner[(earliest[cavity] < owner) | (earliest[outside] < owner[:, None]).any(axis=1)]] = False
            going = settled[owner]
            taken[owner[going]] = True
            claimed = np.zeros(self._triangle_count + 1, dtype=np.bool_)
            claimed[cavity[going]] = True
            settled[owner[claimed[cavity] | claimed[outside].any(axis=1)]] = True
            left = ~settled[owner]
            owner, cavity, outside = owner[left], cavity[left], outside[left]
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
        by_begin, by_end = (np.argsort(apex * self._vertex_count + end) for end in (first, second))
        beside = np.empty((len(slots), 3), dtype=np.int64)
        beside[:, 0] = beyond
        beside[by_end, 1] = slots[by_begin]
        beside[by_begin, 2] = slots[by_end]
        self._neighbours[slots] = beside
        some = beyond >= 0
        beyond, first, second = beyond[some], first[some], second[some]
        zeroth, next_, _ = self._triangles[beyond].T
        side = np.where((next_ != first) & (next_ != second), 1, 2)
        side[(zeroth != first) & (zeroth != second)] = 0
        self._neighbours[beyond, side] = slots[some]

    def _depth(self, triangles: IntArray, points: FloatArray) -> FloatArray:
        """How deep each point lies in the circumcircle of the triangle beside it: above 0 inside by more than rounding.

        The determinant of the lifted corners, against the sum of the sizes of its terms.
        """
        corners = [self._vertices[ends] - points for ends in self._triangles[triangles].T]
        # Columns, not rows of two or three: sums along short rows are slow.
        a, b, c = ((np.ascontiguousarray(corner[:, 0]), np.ascontiguousarray(corner[:, 1])) for corner in corners)
        terms = sizes = np.zeros(len(points))
        for (ux, uy), (vx, vy), (wx, wy) in ((a, b, c), (b, c, a), (c, a, b)):
            lifted, plus, minus = ux * ux + uy * uy, vx * wy, vy * wx
            terms = terms + lifted * (plus - minus)
            sizes = sizes + lifted * (np.abs(plus) + np.abs(minus))
        depth: FloatArray = terms - _ROUNDING * sizes
        return depth


def with_room(array: _Array, rows: int) -> _Array:
    """The array, or one of twice the size that begins with it, so that growing costs little in the long run."""
    if rows <= len(array):
        return array
    larger = np.empty((2 * rows, *array.shape[1:]), dtype=array.dtype)
    larger[: len(array)] = array
    return larger
