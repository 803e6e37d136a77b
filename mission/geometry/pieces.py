"""The segments of an arrangement while a mesh is refined: cut into pieces, some of them due to be cut."""

from typing import Final

import numpy as np

from mission.geometry.arrangement import Arrangement
from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.geometry.delaunay import Cavities, Growth, Triangulation, with_room
from mission.geometry.triangulation import edge_keys, facet_keys

_SHARP: Final = np.pi / 3.0 - 1e-9
_ROUNDING: Final = 1e-9
_ALIKE: Final = 1e-6  # radii of cuts on one circle


class Pieces:
    """Pieces of segments, S of them; arrays that grow.

    Attributes:
        ends: Shape (S, 2), vertices of the mesh.
        beside: Shape (S,), a triangle that each is an edge of; -1 where it is none.
        due: Shape (S,), whether it is to be cut: it is no edge, or too long, or has a vertex in its diametral circle.
    """

    def __init__(self, arrangement: Arrangement, mesh: Triangulation, largest_m: float) -> None:
        """Begin with whole segments.

        Args:
            arrangement: The segments.
            mesh: The triangulation of its vertices.
            largest_m: The longest piece.
        """
        self._largest_m = largest_m
        self.ends: IntArray = arrangement.segments + mesh.CORNERS
        self._given, self._owner = self.ends.copy(), np.arange(len(self.ends))
        self._sharp: BoolArray = np.append(np.zeros(mesh.CORNERS, dtype=np.bool_), _sharp_vertices(arrangement))
        self._halves = np.full((len(mesh.vertices), 2), -1)  # the pieces that end and begin in a cut, before later cuts
        self.begin_again(mesh)

    def begin_again(self, mesh: Triangulation) -> None:
        """Find the pieces in a mesh whose triangles have got other indices."""
        self.beside = np.full(len(self.ends), -1)
        self.due: BoolArray = np.ones(len(self.ends), dtype=np.bool_)
        self.sides: IntArray = self._among_sides(mesh)
        self._note(np.arange(len(mesh.triangles)), mesh)

    def look(self, growth: Growth, mesh: Triangulation) -> None:
        """Take note of new triangles, and of edges that are gone."""
        missing = self.sides[growth.lost[:, 0], growth.lost[:, 1]]
        missing = missing[missing >= 0]
        self.beside[missing], self.due[missing] = -1, True
        # Every new edge ends in a new vertex, so it is a piece only where that vertex cut one.
        apex, first, second = mesh.triangles[growth.triangles].T
        sides = np.full((len(apex), 3), -1)
        sides[:, 0] = self.sides[growth.rims[:, 0], growth.rims[:, 1]]
        cutting = np.flatnonzero(self._halves[apex, 0] >= 0)
        for end in (0, 1):
            half = self._halves[apex[cutting], end]
            other = self.ends[half, end]
            for side, corner in ((1, second[cutting]), (2, first[cutting])):
                met = other == corner
                sides[cutting[met], side] = half[met]
        self.sides = with_room(self.sides, len(mesh.triangles))
        self.sides[growth.triangles] = sides
        self._note(growth.triangles, mesh)

    def _among_sides(self, mesh: Triangulation) -> IntArray:
        """Of each triangle the pieces that its sides are, shape (M, 3); -1 for none."""
        keys = edge_keys(self.ends, len(mesh.vertices))
        order = np.argsort(keys)
        wanted = facet_keys(mesh.triangles, len(mesh.vertices))
        place = order[np.minimum(np.searchsorted(keys, wanted, sorter=order), len(keys) - 1)]
        sides: IntArray = np.where(keys[place] == wanted, place, -1)
        return sides

    def _note(self, triangles: IntArray, mesh: Triangulation) -> None:
        """Which pieces are sides of triangles, and which of these see a corner in their diametral circles."""
        row, side = np.nonzero(self.sides[triangles] >= 0)
        triangle = triangles[row]
        found, seen = self.sides[triangle, side], mesh.vertices[mesh.triangles[triangle, side]]
        ends = mesh.vertices[self.ends[found]]
        short = np.hypot(*(ends[:, 1] - ends[:, 0]).T) <= self._largest_m
        self.due[found[short & (self.beside[found] < 0)]] = False
        self.beside[found] = triangle
        self.due[found[self._see(found, seen, mesh.vertices)]] = True

    def _see(self, which: IntArray, points: FloatArray, vertices: FloatArray) -> BoolArray:
        """Whether each point lies in the diametral circle of the piece beside it."""
        begins, ends = vertices[self.ends[which, 0]], vertices[self.ends[which, 1]]
        length, before, after = (ends - begins).T, (begins - points).T, (ends - points).T
        inside: BoolArray = before[0] * after[0] + before[1] * after[1] < -_ROUNDING * (length[0] ** 2 + length[1] ** 2)
        return inside

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
        number, fresh = vertices - len(which) + np.arange(len(which)), len(self.ends) + np.arange(len(which))
        self.grow(len(which))
        self._halves[number] = np.stack((which, fresh), axis=1)
        rest = np.stack((number, self.ends[which, 1]), axis=1)
        self.ends[which, 1] = number
        self.beside[which], self.due[which] = -1, True
        self.ends = np.concatenate((self.ends, rest))
        self._owner = np.concatenate((self._owner, self._owner[which]))
        self.beside = np.concatenate((self.beside, np.full(len(which), -1)))
        self.due = np.concatenate((self.due, np.ones(len(which), dtype=np.bool_)))

    def grow(self, count: int) -> None:
        """Take note of new vertices that cut no piece, or none yet."""
        self._halves = np.concatenate((self._halves, np.full((count, 2), -1)))
        self._sharp = np.concatenate((self._sharp, np.zeros(count, dtype=np.bool_)))

    def admit(self, points: FloatArray, cavities: Cavities, vertices: FloatArray) -> BoolArray:
        """Which points lie in no piece's diametral circle, shape (P,); pieces in whose circles others lie are marked.

        A piece with a point in its circle is an edge of that point's cavity: the circle's half on either side lies
        within the circumcircle of the triangle there.
        """
        sides = self.sides[cavities.triangle]
        row, side = np.nonzero(sides >= 0)
        piece, owner = sides[row, side], cavities.owner[row]
        inside = self._see(piece, points[owner], vertices)
        self.due[piece[inside]] = True
        free = np.ones(len(points), dtype=np.bool_)
        free[owner[inside]] = False
        return free

    def excuse(self, triangles: IntArray, apexes: IntArray, mesh: Triangulation) -> BoolArray:
        """Which thin triangles a sharp angle of the outlines makes so, shape (N,).

        Args:
            triangles: Shape (N,), their indices.
            apexes: Shape (N,), which of the corners is the one opposite the shortest side, 0 to 2.
            mesh: The triangles.
        """
        vertices = mesh.vertices
        apex, first, second = (mesh.triangles[triangles, (apexes + turn) % 3] for turn in range(3))
        # The angle at the apex is that of two pieces.
        excused: BoolArray = self._sharp[apex].copy()
        for turn in (1, 2):
            excused &= self.sides[triangles, (apexes + turn) % 3] >= 0
        # The shortest edge joins two cuts on one circle about a vertex where two segments meet.
        one, other = self._halves[first, 0], self._halves[second, 0]
        both = np.flatnonzero((one >= 0) & (other >= 0))
        one, other = self._owner[one[both]], self._owner[other[both]]
        both, one, other = both[one != other], one[one != other], other[one != other]
        ends, others = self._given[one], self._given[other]
        shared = (ends[:, :, None] == others[:, None, :]).any(axis=2)
        hub = np.where(shared[:, 0], ends[:, 0], ends[:, 1])
        to_first, to_second = (np.linalg.norm(vertices[end[both]] - vertices[hub], axis=1) for end in (first, second))
        alike = np.abs(to_first - to_second) <= _ALIKE * to_first
        excused[both] |= shared.any(axis=1) & self._sharp[hub] & alike
        return excused


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
