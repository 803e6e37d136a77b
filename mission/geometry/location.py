"""Which triangle a point lies in, and which ones a segment crosses.

Every decision is taken in exact arithmetic (the predicates of GEOS for points, rational numbers for segments), so
that closed triangles leave no cracks between them: a point on an edge or a vertex lies in all triangles there.
"""

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np
import shapely

from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.geometry.simplices import ROUNDING, Partition

OUTSIDE = -1
"""The triangle of a point outside the domain."""

Place = tuple[float, float]


@dataclass(frozen=True, eq=False)
class Locator:
    """Point location in a partition, through a tree of bounding boxes.

    Points closer to the domain than ``ROUNDING`` of its extent count as lying in the nearest triangle: a point
    computed to lie on a slanting side of the domain would else be outside as often as not.
    """

    partition: Partition

    @cached_property
    def tree(self) -> shapely.STRtree:
        """Of the triangles, as polygons."""
        corners = self.partition.corners_m
        return shapely.STRtree(shapely.polygons(np.concatenate((corners, corners[:, :1]), axis=1)))

    @property
    def closeness_m(self) -> float:
        """Distance below which a point beside the domain counts as inside."""
        return ROUNDING * self.partition.extent_m

    def triangle_at(self, points_m: FloatArray) -> IntArray:
        """The triangle of each point: the lowest index where several meet, -1 outside the domain.

        Args:
            points_m: Shape (P, 2), ENU, metres. A point with a coordinate that is not finite lies outside.

        Returns:
            Shape (P,).
        """
        points = np.asarray(points_m, dtype=np.float64).reshape(-1, 2)
        finite = np.flatnonzero(np.isfinite(points).all(axis=1))
        none = self.partition.size
        lowest = np.full(len(points), none, dtype=np.int64)
        which, triangles = self.tree.query(shapely.points(points[finite]), predicate="intersects")
        np.minimum.at(lowest, finite[which], triangles)
        beside = np.flatnonzero(lowest[finite] == none)
        if len(beside):
            rest = finite[beside]
            which, triangles = self.tree.query_nearest(shapely.points(points[rest]), max_distance=self.closeness_m)
            np.minimum.at(lowest, rest[which], triangles)
        lowest[lowest == none] = OUTSIDE
        return lowest

    def triangles_touching(self, point_m: Place) -> IntArray:
        """All triangles that a point lies in, on the edge of or at a corner of, ascending; within ``closeness_m``."""
        lowest, highest = self._boxes
        near = (lowest <= np.add(point_m, self.closeness_m)) & (highest >= np.subtract(point_m, self.closeness_m))
        found = np.flatnonzero(near.all(axis=1))
        triangles = shapely.polygons(self.partition.corners_m[found])
        touching: IntArray = found[shapely.dwithin(triangles, shapely.Point(point_m), self.closeness_m)]
        return touching

    @cached_property
    def _boxes(self) -> tuple[FloatArray, FloatArray]:
        """The lowest and highest coordinates of each triangle, (M, 2): for few points less work than a tree."""
        corners = self.partition.corners_m
        return corners.min(axis=1), corners.max(axis=1)

    def meeting(self, area: shapely.Geometry) -> IntArray:
        """The triangles that have a point in common with an area, ascending."""
        return np.sort(np.asarray(self.tree.query(area, predicate="intersects"), dtype=np.int64))

    def leaves(self, area: shapely.Geometry) -> bool:
        """Whether an area that has a point in the domain reaches its rim."""
        return bool(len(self.rim.query(area, predicate="intersects")))

    @cached_property
    def rim(self) -> shapely.STRtree:
        """The facets with nothing behind them."""
        triangles, facets = np.nonzero(self.partition.neighbours == OUTSIDE)
        corners = self.partition.corners_m[triangles]
        rows = np.arange(len(triangles))
        ends = np.stack((corners[rows, facets - 2], corners[rows, facets - 1]), axis=1)
        return shapely.STRtree(shapely.linestrings(ends))

    def crossed(self, p_m: Place, q_m: Place, *, likely: int = OUTSIDE) -> tuple[tuple[int, float], ...]:
        """The triangles that the segment from p to q runs through, in order.

        A triangle counts where the segment has a part of positive length in it; one that is only touched, at a
        corner, does not. A part along a common edge belongs to the lower index of the two triangles. A part outside
        the domain is listed as -1, unless its middle is no farther outside than rounding (``closeness_m``); then it
        belongs to the triangle that is nearest there. Where p equals q, the one entry is the triangle there.

        Args:
            p_m: Start, finite.
            q_m: End, finite.
            likely: A triangle to look into before all others are searched; the result does not depend on it.

        Returns:
            Pairs of a triangle and the fraction of the segment at which it is entered; the first fraction is 0.
        """
        # The common case of a monitor, without a search: both ends well inside the triangle of the last report.
        if likely != OUTSIDE and self._well_inside(likely, p_m, q_m):
            return ((likely, 0.0),)
        if tuple(p_m) == tuple(q_m):
            return ((int(self.triangle_at(np.array([p_m]))[0]), 0.0),)
        candidates = np.sort(self.tree.query(shapely.LineString((p_m, q_m)), predicate="intersects"))
        # And without rational numbers: both ends well inside another triangle.
        if len(candidates) == 1 and self._well_inside(int(candidates[0]), p_m, q_m):
            return ((int(candidates[0]), 0.0),)
        parts = self._parts(candidates, p_m, q_m)
        return self._joined(parts, np.array(p_m, dtype=np.float64), np.array(q_m, dtype=np.float64))

    def straight_over(self, here: IntArray, there: IntArray, p_m: FloatArray, q_m: FloatArray) -> BoolArray:
        """Of segments, from p in one triangle to q in another, those that are seen to meet these two alone.

        They are neighbours, the ends are well inside, and the segment meets their facet well between its ends.

        Args:
            here: Shape (N,), the triangles of the starts; -1 outside the domain.
            there: Shape (N,), those of the ends.
            p_m: Shape (N, 2).
            q_m: Shape (N, 2).

        Returns:
            Shape (N,); False says nothing.
        """
        side = self.partition.neighbours[here] == there[:, None]
        found: BoolArray = side.any(axis=1) & (here >= 0) & (there >= 0)
        corners, rows = self.partition.corners_m[here], np.arange(len(here))
        facet = side.argmax(axis=1)
        first, second = corners[rows, facet - 2], corners[rows, facet - 1]
        slack = 2.0 * ROUNDING * np.minimum(self.partition.areas_m2[here], self.partition.areas_m2[there])
        found &= (_turn(p_m, q_m, first) < -slack) & (_turn(p_m, q_m, second) > slack)
        for triangles, places in ((here, p_m), (there, q_m)):
            corners = self.partition.corners_m[triangles]
            for j in range(3):
                found &= _turn(corners[:, j - 2], corners[:, j - 1], places) > slack
        return found

    def _well_inside(self, triangle: int, *points_m: Place) -> bool:
        corners, double_area = self.partition.corners_m[triangle].tolist(), 2.0 * self.partition.areas_m2[triangle]
        for j in range(3):
            (ax, ay), (bx, by) = corners[j - 2], corners[j - 1]
            for x, y in points_m:
                if not (bx - ax) * (y - ay) - (by - ay) * (x - ax) > ROUNDING * double_area:
                    return False
        return True

    def _parts(self, candidates: IntArray, p_m: Place, q_m: Place) -> list[tuple[Fraction, int, Fraction]]:
        """(entry, triangle, exit) of each triangle that holds a part of the segment, in order; edges once."""
        p, q = [tuple(Fraction(float(x)) for x in point) for point in (p_m, q_m)]
        held: dict[Fraction, tuple[int, Fraction]] = {}
        for triangle in candidates.tolist():
            corners = [tuple(Fraction(x) for x in corner) for corner in self.partition.corners_m[triangle].tolist()]
            entry, leave = _clip(corners, p, q)
            # Ascending indices: of the two triangles beside an edge that the segment follows, the lower one stays.
            if entry < leave:
                held.setdefault(entry, (triangle, leave))
        return [(entry, *held[entry]) for entry in sorted(held)]

    def _joined(
        self, parts: list[tuple[Fraction, int, Fraction]], p: FloatArray, q: FloatArray
    ) -> tuple[tuple[int, float], ...]:
        """The parts with what lies between them, equal neighbours in the list merged."""
        walk: list[tuple[int, float]] = []
        reached = Fraction(0)
        for entry, triangle, leave in [*parts, (Fraction(1), OUTSIDE, Fraction(1))]:
            if entry > reached:
                middle = float((entry + reached) / 2)
                between = int(self.triangle_at((1.0 - middle) * p + middle * q)[0])
                walk.append((between, float(reached)))
            if entry < leave:
                walk.append((triangle, float(entry)))
            reached = max(reached, leave)
        return tuple(entered for i, entered in enumerate(walk) if i == 0 or entered[0] != walk[i - 1][0])


def _turn(a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
    """Twice the areas of triangles, each corner (N, 2): above 0 where they are counter-clockwise."""
    (ux, uy), (vx, vy) = (b - a).T, (c - a).T
    areas: FloatArray = ux * vy - uy * vx
    return areas


def _clip(
    corners: list[tuple[Fraction, ...]], p: tuple[Fraction, ...], q: tuple[Fraction, ...]
) -> tuple[Fraction, Fraction]:
    """Fractions at which the segment p-q enters and leaves a counter-clockwise triangle; entry >= exit for none."""
    entry, leave = Fraction(0), Fraction(1)
    for j in range(3):
        (ax, ay), (bx, by) = corners[j - 2], corners[j - 1]
        at_p = (bx - ax) * (p[1] - ay) - (by - ay) * (p[0] - ax)
        at_q = (bx - ax) * (q[1] - ay) - (by - ay) * (q[0] - ax)
        if at_p < 0 and at_q < 0:
            return Fraction(1), Fraction(0)
        if at_p < 0:
            entry = max(entry, at_p / (at_p - at_q))
        elif at_q < 0:
            leave = min(leave, at_p / (at_p - at_q))
    return entry, leave
