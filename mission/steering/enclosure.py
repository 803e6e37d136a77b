"""Rigorous enclosures of a curve and of the tube round it, and the triangles that they may touch.

On an interval of length h a curve stays within d = max |r''| h^2 / 8 of the chord between its end points. So the tube,
an axis-aligned square of half width a carried along the curve, stays inside the chord swept by a square of half width
a + d: a convex hexagon. Two convex polygons are disjoint if and only if the normal of one of their edges separates
them, so the tests below are exact for the hexagon, and never miss a triangle that the tube can touch.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import shapely

from mission.geometry.arrays import BoolArray, FloatArray, IntArray, frozen_floats
from mission.geometry.simplices import Partition
from mission.steering.joined import JoinedCurve

# Coordinates carry rounding errors; every enclosure is widened by this part of the domain's size to be safe from them.
ROUNDING = 1e-10


@dataclass(frozen=True, eq=False)
class Enclosure:
    """A curve in pieces: on [knots_s[k], knots_s[k + 1]] it is within ``remainder_m[k]`` of the chord of its ends.

    Attributes:
        knots_s: Shape (K + 1,), ascending, from 0 to T.
        points_m: Shape (K + 1, 2), the curve at the knots.
        bends_m_s2: Shape (K + 1, 2), its second derivative there; where two legs meet, the longer of the two.
        remainder_m: Shape (K,).
    """

    knots_s: FloatArray
    points_m: FloatArray
    bends_m_s2: FloatArray
    remainder_m: FloatArray

    @property
    def reach_m(self) -> FloatArray:
        """How far each piece extends: length of its chord plus the remainder, shape (K,)."""
        steps = np.diff(self.points_m, axis=0)
        return np.asarray(np.hypot(steps[:, 0], steps[:, 1]) + self.remainder_m, dtype=np.float64)


def _enclosure(curve: JoinedCurve, knots: FloatArray, points: FloatArray, bends: FloatArray) -> Enclosure:
    remainder = curve.norm_bounds(knots, 2, bends) * np.diff(knots) ** 2 / 8.0
    return Enclosure(frozen_floats(knots), frozen_floats(points), frozen_floats(bends), frozen_floats(remainder))


def enclose(curve: JoinedCurve, cells: int) -> Enclosure:
    """Enclose each smooth piece of a curve in ``cells`` parts or more, more than it has frequencies.

    Where pieces meet there is a part without length: what the tube touches at that instant alone.
    """
    knots, points, _, bends = curve.sampled(cells)
    twice = np.sort(np.concatenate((np.arange(len(knots)), np.searchsorted(knots, curve.instants_s))))
    return _enclosure(curve, knots[twice], points[twice], bends[twice])


def insert_knots(curve: JoinedCurve, enclosure: Enclosure, knots_s: FloatArray) -> Enclosure:
    """The enclosure with further knots (those that it has already, and those outside [0, T], are left out)."""
    new = np.setdiff1d(knots_s, enclosure.knots_s)
    new = new[(new > 0.0) & (new < curve.duration_s)]
    places = np.searchsorted(enclosure.knots_s, new)
    points, _, bends = curve.jet(new)
    return _enclosure(
        curve,
        np.insert(enclosure.knots_s, places, new),
        np.insert(enclosure.points_m, places, points, axis=0),
        np.insert(enclosure.bends_m_s2, places, bends, axis=0),
    )


def split(curve: JoinedCurve, enclosure: Enclosure, pieces: BoolArray, parts: int) -> Enclosure:
    """Cut the marked pieces (shape (K,)) into ``parts`` equal parts each."""
    starts, widths = enclosure.knots_s[:-1][pieces], np.diff(enclosure.knots_s)[pieces]
    fractions = np.arange(1, parts) / parts
    return insert_knots(curve, enclosure, (starts[:, None] + widths[:, None] * fractions).ravel())


@dataclass(frozen=True, eq=False)
class Contacts:
    """Which triangles each of K swept squares may touch.

    Attributes:
        pieces: Shape (C,), the swept square of each contact, ascending.
        triangles: Shape (C,), its triangle, ascending within a piece.
        depth_m: Shape (C,), how deep the square's first centre lies inside that triangle (negative outside).
        outside: Shape (K,), true where the swept square may reach beyond the domain.
    """

    pieces: IntArray
    triangles: IntArray
    depth_m: FloatArray
    outside: BoolArray

    @cached_property
    def sets(self) -> list[tuple[int, ...]]:
        """The triangles of each piece."""
        bounds = np.searchsorted(self.pieces, np.arange(len(self.outside) + 1)).tolist()
        triangles = self.triangles.tolist()
        return [tuple(triangles[first:last]) for first, last in pairwise(bounds)]

    def centres(self) -> IntArray:
        """The triangle that holds the first centre of each piece, shape (K,); -1 where it touches none."""
        centres = np.full(len(self.outside), -1)
        order = np.argsort(self.depth_m, kind="stable")  # the deepest is written last
        centres[self.pieces[order]] = self.triangles[order]
        return centres

    def marked(self, triangles: BoolArray) -> BoolArray:
        """Which pieces may touch a triangle of the marked ones (shape (M,)); shape (K,)."""
        touched = np.zeros(len(self.outside), dtype=np.bool_)
        touched[self.pieces[triangles[self.triangles]]] = True
        return touched


class ContactSearch:
    """Finds the triangles of one partition that swept squares touch; built once, asked often."""

    def __init__(self, partition: Partition) -> None:
        corners = partition.corners_m
        self._corners = corners
        self._normals = partition.normals
        # Facet j runs through the corner after vertex j.
        self._offsets = np.einsum("mji,mji->mj", partition.normals, np.roll(corners, -1, axis=1))
        self._rim = partition.neighbours < 0
        low, high = corners.min(axis=1), corners.max(axis=1)
        self._tree = shapely.STRtree(shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1]))
        self.slack_m = ROUNDING * float(np.abs(partition.vertices_m).max(initial=1.0))

    def contacts(self, starts_m: FloatArray, ends_m: FloatArray, half_widths_m: FloatArray) -> Contacts:
        """Contacts of squares swept along straight chords.

        Args:
            starts_m: Shape (K, 2), where the centre of each square starts.
            ends_m: Shape (K, 2), where it ends.
            half_widths_m: Shape (K,), half the side of each square.
        """
        widths = half_widths_m + self.slack_m
        low = np.minimum(starts_m, ends_m) - widths[:, None]
        high = np.maximum(starts_m, ends_m) + widths[:, None]
        boxes = shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1])
        pieces, triangles = self._tree.query(boxes)
        # The same test in our own arithmetic costs nothing and owes nothing to the tree's treatment of borders.
        p, q, width = starts_m[pieces], ends_m[pieces], widths[pieces]
        normals, offsets = self._normals[triangles], self._offsets[triangles]
        heights_p = np.einsum("cji,ci->cj", normals, p) - offsets
        heights_q = np.einsum("cji,ci->cj", normals, q) - offsets
        spread = width[:, None] * np.abs(normals).sum(axis=2)
        touching = (np.minimum(heights_p, heights_q) <= spread).all(axis=1)
        touching &= _across(p, q, width, self._corners[triangles])
        on_rim = self._rim[triangles] & (np.maximum(heights_p, heights_q) >= -spread) & touching[:, None]
        reaching, facet = np.nonzero(on_rim)
        outside = np.ones(len(widths), dtype=np.bool_)
        outside[pieces[touching]] = False
        if len(reaching):
            ends = np.stack(
                [self._corners[triangles[reaching], (facet + step) % 3] for step in (1, 2)],
                axis=1,
            )
            meets = (
                _across(p[reaching], q[reaching], width[reaching], ends)
                & (ends.min(axis=1) <= high[pieces[reaching]]).all(axis=1)
                & (ends.max(axis=1) >= low[pieces[reaching]]).all(axis=1)
            )
            outside[pieces[reaching[meets]]] = True
        order = np.lexsort((triangles[touching], pieces[touching]))
        return Contacts(
            pieces[touching][order].astype(np.int64),
            triangles[touching][order].astype(np.int64),
            -heights_p.max(axis=1)[touching][order],
            outside,
        )


def _across(p: FloatArray, q: FloatArray, width: FloatArray, points: FloatArray) -> BoolArray:
    """Whether the normal of the chord fails to separate the swept square from the hull of ``points`` (C, P, 2)."""
    normal = np.stack((p[:, 1] - q[:, 1], q[:, 0] - p[:, 0]), axis=1)
    heights = np.einsum("cpi,ci->cp", points - p[:, None, :], normal)
    spread = width * np.abs(normal).sum(axis=1)
    return np.asarray((heights.min(axis=1) <= spread) & (heights.max(axis=1) >= -spread))


class RegionDistance:
    """Distances to the union of some triangles, marked in an array of shape (M,); at least one."""

    def __init__(self, partition: Partition, marked: BoolArray) -> None:
        self._tree = shapely.STRtree(shapely.polygons(partition.corners_m[marked]))

    def of_chords(self, starts_m: FloatArray, ends_m: FloatArray, *, within_m: float = np.inf) -> FloatArray:
        """Distance in metres of each straight chord, shape (K,); infinite for those that are not within a distance."""
        chords = shapely.linestrings(np.stack((starts_m, ends_m), axis=1))
        most = within_m if np.isfinite(within_m) else None
        (asked, _), distances = self._tree.query_nearest(
            chords, max_distance=most, return_distance=True, all_matches=False
        )
        result = np.full(len(starts_m), np.inf)
        result[asked] = distances
        return result


def clearance(curve: JoinedCurve, enclosure: Enclosure, distance: RegionDistance) -> float:
    """A proved lower bound of the curve's distance to a region, in metres.

    A piece is nowhere nearer than its chord less its remainder. Pieces for which that is more than 1 % nearer than the
    nearest knot are cut in two, until there are none, or for 24 rounds; the bound is sound whenever it stops. What is
    farther away than the nearest knot that is known needs no measuring.
    """
    extent = float(np.abs(enclosure.points_m).max(initial=1.0))
    bound, reached = 0.0, np.inf
    for _ in range(24):
        points, more = enclosure.points_m, 1e-6 * extent
        reached = min(reached, float(distance.of_chords(points, points, within_m=reached + more).min()))
        within = reached + float(enclosure.remainder_m.max()) + more
        lower = distance.of_chords(points[:-1], points[1:], within_m=within) - enclosure.remainder_m
        bound = float(lower.min())
        loose = lower < 0.99 * reached - 1e-6 * extent
        if not loose.any():
            break
        enclosure = split(curve, enclosure, loose, 2)
    return max(0.0, bound - ROUNDING * extent)
