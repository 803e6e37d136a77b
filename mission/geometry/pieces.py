"""The segments of an arrangement while a mesh is refined: cut into pieces, some with a vertex in their way."""

from typing import Final

import numpy as np

from mission.geometry.arrangement import Arrangement
from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.geometry.delaunay import Cavities, with_room
from mission.geometry.triangulation import edge_keys

_SHARP: Final = np.pi / 3.0 - 1e-9
_ROUNDING: Final = 1e-9
_ALIKE: Final = 1e-6  # radii of cuts on one circle


class Pieces:
    """Pieces of segments, S of them; arrays that grow.

    Attributes:
        ends: Shape (S, 2), vertices of the mesh.
        beside: Shape (S,), a triangle that each is an edge of; -1 where it is none.
        encroached: Shape (S,), whether it is no edge or a vertex beside it lies in its diametral circle.
    """

    def __init__(self, arrangement: Arrangement, offset: int) -> None:
        """Begin with whole segments.

        Args:
            arrangement: The segments.
            offset: How many vertices of the mesh come before those of the arrangement.
        """
        self._given = arrangement.segments + offset
        self._owner = np.arange(len(self._given))
        self._lies_on = np.full(offset + len(arrangement.vertices_m), -1)
        self._sharp: BoolArray = np.append(np.zeros(offset, dtype=np.bool_), _sharp_vertices(arrangement))
        self.ends: IntArray = self._given.copy()
        self.beside = np.full(len(self.ends), -1)
        self.encroached: BoolArray = np.ones(len(self.ends), dtype=np.bool_)
        self._sides: IntArray = np.empty((0, 3), dtype=np.int64)  # of each triangle the pieces among its edges, or -1

    def look(self, triangles: IntArray, corners: IntArray, lost: IntArray, vertices: FloatArray) -> None:
        """Take note of new triangles, and of edges that are gone.

        Args:
            triangles: Their indices, shape (T,).
            corners: Their vertices, shape (T, 3).
            lost: Edges, shape (L, 2).
            vertices: All vertices, shape (V, 2).
        """
        order, keys = self._sorted(len(vertices))
        found, _ = self._find(lost, order, keys, len(vertices))
        self.beside[found], self.encroached[found] = -1, True
        edges = np.stack((np.roll(corners, -1, axis=1), np.roll(corners, -2, axis=1)), axis=-1).reshape(-1, 2)
        found, at = self._find(edges, order, keys, len(vertices))
        self._sides = with_room(self._sides, int(triangles.max()) + 1)
        sides = np.full((len(triangles), 3), -1)
        sides.reshape(-1)[at] = found
        self._sides[triangles] = sides
        seen = vertices[corners.reshape(-1)[at]]
        begins, ends = vertices[self.ends[found, 0]], vertices[self.ends[found, 1]]
        inside = ((begins - seen) * (ends - seen)).sum(axis=1) < -_ROUNDING * ((ends - begins) ** 2).sum(axis=1)
        fresh = self.beside[found] < 0
        self.encroached[found[fresh]] = False
        self.beside[found] = triangles[at // 3]
        self.encroached[found[inside]] = True

    def cuts(self, which: IntArray, vertices: FloatArray) -> FloatArray:
        """Where pieces are cut: in the middle, or on a circle about the one end that is sharp; shape (N, 2).

        The radii of these circles are powers of two, so that all pieces that meet in one end are cut alike.
        """
        first, second = self.ends[which].T
        begins, ends = vertices[first], vertices[second]
        lengths = np.linalg.norm(ends - begins, axis=1)
        shell = np.exp2(np.round(np.log2(lengths / 2.0))) / lengths
        share = np.where(self._sharp[first] & ~self._sharp[second], shell, 0.5)
        share = np.where(self._sharp[second] & ~self._sharp[first], 1.0 - shell, share)[:, None]
        points: FloatArray = (1.0 - share) * begins + share * ends
        return points

    def cut(self, which: IntArray, vertices: int) -> None:
        """Cut pieces at the last vertices of a mesh of so many."""
        number = vertices - len(which) + np.arange(len(which))
        self.grow(len(which))
        self._lies_on[number] = self._owner[which]
        rest = np.stack((number, self.ends[which, 1]), axis=1)
        self.ends[which, 1] = number
        self.beside[which], self.encroached[which] = -1, True
        self.ends = np.concatenate((self.ends, rest))
        self._owner = np.concatenate((self._owner, self._owner[which]))
        self.beside = np.concatenate((self.beside, np.full(len(which), -1)))
        self.encroached = np.concatenate((self.encroached, np.ones(len(which), dtype=np.bool_)))

    def grow(self, count: int) -> None:
        """Take note of new vertices that cut no piece, or none yet."""
        self._lies_on = np.concatenate((self._lies_on, np.full(count, -1)))
        self._sharp = np.concatenate((self._sharp, np.zeros(count, dtype=np.bool_)))

    def admit(self, points: FloatArray, cavities: Cavities, vertices: FloatArray) -> BoolArray:
        """Which points lie in no piece's diametral circle, shape (P,); pieces in whose circles others lie are marked.

        A piece with a point in its circle is an edge of that point's cavity: the circle's half on either side lies
        within the circumcircle of the triangle there.
        """
        piece = self._sides[cavities.triangle]
        row, _ = np.nonzero(piece >= 0)
        piece, owner = piece[piece >= 0], cavities.owner[row]
        begins, ends, seen = vertices[self.ends[piece, 0]], vertices[self.ends[piece, 1]], points[owner]
        inside = ((begins - seen) * (ends - seen)).sum(axis=1) < -_ROUNDING * ((ends - begins) ** 2).sum(axis=1)
        self.encroached[piece[inside]] = True
        free = np.ones(len(points), dtype=np.bool_)
        free[owner[inside]] = False
        return free

    def excuse(self, turned: IntArray, vertices: FloatArray) -> BoolArray:
        """Which thin triangles a sharp angle of the outlines makes so, shape (N,).

        Args:
            turned: Shape (N, 3): vertices, beginning with the one opposite the shortest edge.
            vertices: All vertices, shape (V, 2).
        """
        order, keys = self._sorted(len(vertices))
        apex, first, second = turned.T
        # The angle at the apex is that of two pieces.
        excused: BoolArray = self._sharp[apex].copy()
        for end in (first, second):
            _, at = self._find(np.stack((apex, end), axis=1), order, keys, len(vertices))
            beside = np.zeros(len(turned), dtype=np.bool_)
            beside[at] = True
            excused &= beside
        # The shortest edge joins two cuts on one circle about a vertex where two segments meet.
        one, other = self._lies_on[first], self._lies_on[second]
        both = np.flatnonzero((one >= 0) & (other >= 0) & (one != other))
        ends, others = self._given[one[both]], self._given[other[both]]
        shared = (ends[:, :, None] == others[:, None, :]).any(axis=2)
        hub = np.where(shared[:, 0], ends[:, 0], ends[:, 1])
        to_first, to_second = (np.linalg.norm(vertices[end[both]] - vertices[hub], axis=1) for end in (first, second))
        alike = np.abs(to_first - to_second) <= _ALIKE * to_first
        excused[both] |= shared.any(axis=1) & self._sharp[hub] & alike
        return excused

    def _sorted(self, vertices: int) -> tuple[IntArray, IntArray]:
        keys = edge_keys(self.ends, vertices)
        order = np.argsort(keys)
        return order, keys[order]

    @staticmethod
    def _find(edges: IntArray, order: IntArray, keys: IntArray, vertices: int) -> tuple[IntArray, IntArray]:
        """Which edges are pieces: the pieces, and where they stand among the edges."""
        wanted = edge_keys(edges, vertices)
        place = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
        at = np.flatnonzero(keys[place] == wanted)
        return order[place[at]], at


def _sharp_vertices(arrangement: Arrangement) -> BoolArray:
    """Where two segments meet at less than 60 degrees, shape (V,)."""
    vertices = arrangement.vertices_m
    spokes = np.concatenate((arrangement.segments, arrangement.segments[:, ::-1]))
    x, y = (vertices[spokes[:, 1]] - vertices[spokes[:, 0]]).T
    bearings = np.arctan2(y, x)
    order = np.lexsort((bearings, spokes[:, 0]))
    hub, bearings = spokes[order, 0], bearings[order]
    begins = np.flatnonzero(np.append(True, hub[1:] != hub[:-1]))
    following = np.arange(1, len(hub) + 1)
    following[np.append(begins[1:], len(hub)) - 1] = begins
    gaps = np.mod(bearings[following] - bearings, 2.0 * np.pi)
    sharp = np.zeros(len(vertices), dtype=np.bool_)
    sharp[hub[(gaps < _SHARP) & (following != np.arange(len(hub)))]] = True
    return sharp
