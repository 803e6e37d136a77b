"""A conforming Delaunay mesh of an arrangement, refined until no triangle is too thin or too large.

Delaunay refinement after Ruppert ("A Delaunay refinement algorithm for quality 2-dimensional mesh generation", 1995): a
segment with a vertex in its diametral circle is cut in two; a triangle whose circumradius is too large against its
shortest edge gets a vertex at its off-centre (Üngör, "Off-centers: a new type of Steiner points", 2004), unless that
lies in the diametral circle of a segment, which is cut instead. Segments that meet at an angle below 60 degrees are cut
on circles about their common vertex, and a thin triangle between two such cuts stays (Miller, Pav and Walkington, "When
and why Delaunay refinement algorithms work", 2005): there the outlines themselves are that sharp.
"""

from typing import Final

import numpy as np
import shapely

from mission.errors import GeometryError
from mission.geometry.arrangement import Arrangement
from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.geometry.delaunay import Growth, Triangulation, with_room
from mission.geometry.faces import FacedMesh, faces_of
from mission.geometry.gaps import Gap, narrowest_gap
from mission.geometry.lattice import lattice
from mission.geometry.pieces import Pieces
from mission.geometry.slimness import Slimness

MOST_VERTICES: Final = 200_000
SMALLEST_ANGLE_DEG: Final = 20.0
"""By default; up to 20.7 degrees refinement is proved to end."""

_EARLY: Final = 20
"""From this part of the most vertices on it is asked whether narrow gaps will need too many."""

_ROUNDING: Final = 1e-9
_MANY: Final = 0.1  # of the vertices: from so many cuts on, to triangulate anew takes less time
_LATTICE: Final = 0.85  # of the longest edge: a lattice as wide as that would leave gaps beside outlines
_GOLDEN: Final = 0.6180339887498949


def refined(
    arrangement: Arrangement,
    domain: shapely.Geometry,
    *,
    smallest_angle_deg: float = SMALLEST_ANGLE_DEG,
    largest_m: float = np.inf,
) -> FacedMesh:
    """Refine an arrangement's Delaunay triangulation.

    The vertices are those of the arrangement, in its order, then those that were added. No angle in the domain is below
    the least but between segments that meet at a smaller one or beside them, and no edge is longer than the largest.

    Args:
        arrangement: Its segments come out as edges, or as chains of edges.
        domain: The part of the plane to mesh; its rim is among the segments.
        smallest_angle_deg: The least angle, above 0 and at most 30.
        largest_m: The longest edge.

    Raises:
        GeometryError: The mesh would have more than ``MOST_VERTICES``, or no triangle lies in the domain.
    """
    if largest_m < finest_m(domain.area):
        raise GeometryError(f"with edges of {largest_m:g} m the mesh would have more than {MOST_VERTICES:,} vertices")
    # Far from the origin the digits would not do: whole metres go off, and come back exactly.
    origin_m = np.floor(arrangement.vertices_m.min(axis=0))
    near = Arrangement(arrangement.vertices_m - origin_m, arrangement.segments)
    domain = shapely.transform(domain, lambda places: places - origin_m)
    work = _Refinement(near, domain, 0.5 / np.sin(np.radians(smallest_angle_deg)), largest_m)
    # Segments first: where one is missing, a vertex for a triangle may fall beside it, and cuts would crowd there.
    limit = MOST_VERTICES // _EARLY
    while work.cut_segments() or work.fill() or work.mend_triangles():
        if len(work.mesh.vertices) > limit:
            gap = narrowest_gap(near, domain, smallest_angle_deg)
            if limit == MOST_VERTICES or (gap and gap.vertices > MOST_VERTICES):
                raise GeometryError(_too_many(gap, work.mesh.vertices[-1], origin_m))
            limit = MOST_VERTICES
    return faces_of(work.mesh, work.pieces.sides[: len(work.mesh.triangles)] >= 0, domain, origin_m)


def finest_m(area_m2: float) -> float:
    """With longest edges below this, any mesh of such an area has more than ``MOST_VERTICES``."""
    # A triangle has at most the area of the equilateral one, and a mesh about half as many vertices as triangles.
    return float(np.sqrt(area_m2 / (MOST_VERTICES * np.sqrt(0.75))))


def _too_many(gap: Gap | None, last_m: FloatArray, origin_m: FloatArray) -> str:
    """What to say of a mesh with too many vertices, the last of which is given."""
    most = f"the mesh would have more than {MOST_VERTICES:,} vertices"
    if gap is None or _EARLY * gap.vertices < MOST_VERTICES:
        x, y = last_m + origin_m
        return f"{most}, the last near ({x:.2f}, {y:.2f})"
    x, y = gap.middle_m + origin_m
    wide_m = 3.0 * gap.width_m * gap.vertices / MOST_VERTICES
    return f"{most}: outlines run {gap.width_m:.2g} m apart, as near ({x:.2f}, {y:.2f}); {wide_m:.2g} m would do"


class _Refinement:
    """A mesh under way: the triangulation, the pieces of segments, and what is still to be mended of both."""

    def __init__(self, arrangement: Arrangement, domain: shapely.Geometry, ratio: float, largest_m: float) -> None:
        self.mesh = Triangulation(arrangement.vertices_m)
        self.pieces = Pieces(arrangement, self.mesh, largest_m)
        self._domain, self._ratio, self._largest_m = domain, ratio, largest_m
        shapely.prepare(domain)
        self._filling: FloatArray = np.empty((0, 2))
        if np.isfinite(largest_m):
            self._filling = lattice(domain, _LATTICE * largest_m)
        self._bad: BoolArray = np.zeros(0, dtype=np.bool_)
        self._size: FloatArray = np.zeros(0)
        self._judge(np.arange(len(self.mesh.triangles)))

    def cut_segments(self) -> bool:
        """Cut pieces with a vertex in their diametral circles, as many as keep apart; False where there is none."""
        wanted = np.flatnonzero(self.pieces.due)
        if not len(wanted):
            return False
        points = self.pieces.cuts(wanted, self.mesh.vertices)
        if len(wanted) > _MANY * len(self.mesh.vertices):
            self.mesh.begin_again(points)
            self.pieces.cut(wanted, len(self.mesh.vertices))
            self._look_at_all()
            return True
        seeds = self.pieces.beside[wanted]
        hidden = seeds < 0
        if hidden.any():
            seeds[hidden] = self.mesh.conflicting(points[hidden])
        growth = self.mesh.insert(points, self.mesh.cavities(points, seeds))
        self.pieces.cut(wanted[growth.taken], len(self.mesh.vertices))
        self._look(growth)
        return True

    def fill(self) -> bool:
        """Once, put in a lattice that is as fine as the longest edge asks for; False where there is none left to do."""
        points, self._filling = self._filling, self._filling[:0]
        if not len(points):
            return False
        # Farther from pieces than half their length, none lies in the diametral circle of one.
        pieces = shapely.STRtree(shapely.linestrings(self.mesh.vertices[self.pieces.ends]))
        near, _ = pieces.query(shapely.points(points), predicate="dwithin", distance=self._largest_m / 2.0)
        points = np.delete(points, near, axis=0)
        self.mesh.begin_again(points)
        self.pieces.grow(len(points))
        self._look_at_all()
        return True

    def mend_triangles(self) -> bool:
        """Put vertices into bad triangles, as many as keep apart, or mark pieces in their way; False where none is."""
        bad = np.flatnonzero(self._bad[: len(self.mesh.triangles)])
        if not len(bad):
            return False
        bad = self._apart(bad)
        points = Slimness.of(self.mesh.vertices, self.mesh.triangles[bad]).off_centres(self._ratio)
        cavities = self.mesh.cavities(points, bad)
        free = self.pieces.admit(points, cavities, self.mesh.vertices)
        growth = self.mesh.insert(points[free], cavities.of(free))
        self.pieces.grow(int(growth.taken.sum()))
        self._look(growth)
        return True

    def _apart(self, bad: IntArray) -> IntArray:
        """As many of the bad triangles as are three steps apart, the smaller, the sooner, in that order.

        Cavities of triangles that are nearer overlap more often than not.
        """
        bad = bad[np.lexsort((np.mod(bad * _GOLDEN, 1.0), np.floor(np.log2(self._size[bad]))))]
        beside, none = self.mesh.neighbours, len(bad)
        near = np.concatenate((beside[bad], beside[beside[bad]].reshape(-1, 9)), axis=1)
        # No neighbour (-1) picks the last entry.
        rank = np.full(len(beside) + 1, none)
        left, chosen = np.arange(none), np.zeros(none, dtype=np.bool_)
        while len(left):
            rank[bad[left]] = left
            first = rank[near[left]].min(axis=1) >= left
            chosen[left[first]] = True
            rank[bad[left]] = none
            rank[bad[left[first]]] = -1
            left = left[~first]
            left = left[rank[near[left]].min(axis=1) >= 0]
        return bad[chosen]

    def _look(self, growth: Growth) -> None:
        """Judge triangles that are new, and the pieces beside them."""
        if len(growth.triangles):
            self.pieces.look(growth, self.mesh)
            self._judge(growth.triangles)

    def _look_at_all(self) -> None:
        """Judge everything, once triangles have got other indices."""
        self.pieces.begin_again(self.mesh)
        self._judge(np.arange(len(self.mesh.triangles)))

    def _judge(self, triangles: IntArray) -> None:
        """Which triangles are bad: too thin, or too large, and in the domain."""
        vertices, corners = self.mesh.vertices, self.mesh.triangles[triangles]
        shapes = Slimness.of(vertices, corners)
        bad = shapes.radius > self._ratio * shapes.shortest * (1.0 + _ROUNDING)
        bad[bad] = ~self.pieces.excuse(triangles[bad], shapes.apex[bad], self.mesh)
        bad |= shapes.longest > self._largest_m
        bad[bad] = shapely.contains_xy(self._domain, *vertices[corners[bad]].mean(axis=1).T)
        self._size = with_room(self._size, len(self.mesh.triangles))
        self._size[triangles] = shapes.shortest
        self._bad = with_room(self._bad, len(self.mesh.triangles))
        self._bad[triangles] = bad
