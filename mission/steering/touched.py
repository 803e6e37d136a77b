"""Which triangles the tube round a curve may touch, piece by piece: of a domain that stands, and of one that moves.

In one that moves each piece has its time, and the tube may touch a triangle wherever that is meanwhile. Between two
instants of the mesh the corners of a triangle move straight, so it stays in the hull of where they are at both ends.
Where no normal of a facet at either end, no axis and not the normal of the chord separates that hull from the swept
square, both count as touching: no contact is missed, and as pieces become short none is made up.
"""

from collections.abc import Callable
from functools import cached_property
from typing import Final, Protocol

import numpy as np
import shapely

from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.geometry.moving import MovingPartition, hulls_of
from mission.geometry.simplices import Partition
from mission.steering.enclosure import (
    ROUNDING,
    Contacts,
    ContactSearch,
    Enclosure,
    RegionDistance,
    clearance,
    split,
)
from mission.steering.joined import JoinedCurve

_CLOSE: Final = 0.99  # of the distance at a knot, what a bound should come to
_ROUNDS: Final = 8
_NEAREST: Final = 32  # chords that are looked at first

Timing = Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]
"""From when to when a flight may be between places (K,) and later places (K,) of its curve, s."""


class Touched(Protocol):
    """Contacts of the tube round a curve."""

    def pieces(self, enclosure: Enclosure) -> Contacts:
        """At the start, during each piece and at the end: K + 2 of them."""
        ...

    def knots(self, enclosure: Enclosure) -> Contacts:
        """At each knot: K + 1 of them."""
        ...

    def end(self, enclosure: Enclosure, half_m: float) -> Contacts:
        """Of a square of that half width at the end, from then on: one."""
        ...

    def clearance_m(self, curve: JoinedCurve, enclosure: Enclosure) -> float | None:
        """A lower bound of the distance of the curve itself to what is restricted; None where nothing is."""
        ...


def _by_pieces(enclosure: Enclosure, tube_m: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Starts, ends and half widths of the swept squares of ``Touched.pieces``."""
    points = enclosure.points_m
    starts = np.concatenate((points[:1], points[:-1], points[-1:]))
    ends = np.concatenate((points[:1], points[1:], points[-1:]))
    return starts, ends, tube_m + np.concatenate(([0.0], enclosure.remainder_m, [0.0]))


class StillTouched:
    """Of a domain that stands.

    Args:
        partition: The domain.
        restricted: Shape (M,), triangles that must never be met.
        tube_m: Half width of the tube.
    """

    def __init__(self, partition: Partition, restricted: BoolArray, tube_m: float) -> None:
        self._search, self._tube_m = ContactSearch(partition), tube_m
        self._distance = RegionDistance(partition, restricted) if restricted.any() else None

    def pieces(self, enclosure: Enclosure) -> Contacts:
        """As in ``Touched``."""
        return self._search.contacts(*_by_pieces(enclosure, self._tube_m))

    def knots(self, enclosure: Enclosure) -> Contacts:
        """As in ``Touched``."""
        points = enclosure.points_m
        return self._search.contacts(points, points, np.full(len(points), self._tube_m))

    def end(self, enclosure: Enclosure, half_m: float) -> Contacts:
        """As in ``Touched``."""
        end_m = enclosure.points_m[-1:]
        return self._search.contacts(end_m, end_m, np.array([half_m]))

    def clearance_m(self, curve: JoinedCurve, enclosure: Enclosure) -> float | None:
        """As in ``Touched``."""
        return None if self._distance is None else clearance(curve, enclosure, self._distance)


class MovingTouched:
    """Of a domain that moves.

    Args:
        moving: The domain.
        restricted: Shape (M,), triangles that must never be met.
        tube_m: Half width of the tube.
        timing: When the flight is where.
    """

    def __init__(self, moving: MovingPartition, restricted: BoolArray, tube_m: float, timing: Timing) -> None:
        self._moving, self._restricted, self._tube_m, self._timing = moving, restricted, tube_m, timing
        self._slack_m = ROUNDING * float(np.abs(moving.fixed.vertices_m).max(initial=1.0))
        self._rim = moving.fixed.neighbours < 0

    def pieces(self, enclosure: Enclosure) -> Contacts:
        """As in ``Touched``."""
        knots = enclosure.knots_s
        begins, ends = self._timing(knots[:-1], knots[1:])
        begins = np.concatenate(([0.0], begins, begins[-1:] if len(begins) else [0.0]))
        begins[-1] = self._timing(knots[-1:], knots[-1:])[0][0]
        return self._contacts(*_by_pieces(enclosure, self._tube_m), begins, np.concatenate(([0.0], ends, [np.inf])))

    def knots(self, enclosure: Enclosure) -> Contacts:
        """As in ``Touched``."""
        points, widths = enclosure.points_m, np.full(len(enclosure.points_m), self._tube_m)
        return self._contacts(points, points, widths, *self._timing(enclosure.knots_s, enclosure.knots_s))

    def end(self, enclosure: Enclosure, half_m: float) -> Contacts:
        """As in ``Touched``."""
        last = enclosure.knots_s[-1:]
        return self.rest(enclosure.points_m[-1:], half_m, self._timing(last, last)[0])

    def rest(self, place_m: FloatArray, half_m: float, from_s: FloatArray) -> Contacts:
        """Of a square of some half width round a place (1, 2), from a time (1,) on: one."""
        return self._contacts(place_m, place_m, np.array([half_m]), from_s, np.array([np.inf]))

    def clearance_m(self, curve: JoinedCurve, enclosure: Enclosure) -> float | None:
        """As in ``Touched``."""
        if not self._restricted.any():
            return None
        bound = 0.0
        for _ in range(_ROUNDS):
            points, knots = enclosure.points_m, enclosure.knots_s
            reached = self._distances_m(points, points, *self._timing(knots, knots)).min()
            begins, ends = self._timing(knots[:-1], knots[1:])
            within_m = reached + enclosure.remainder_m.max()
            lower = self._distances_m(points[:-1], points[1:], begins, ends, within_m) - enclosure.remainder_m
            bound = max(bound, float(lower.min()))
            loose = lower < _CLOSE * reached
            if not loose.any():
                break
            enclosure = split(curve, enclosure, loose, 2)
        return max(0.0, bound - self._slack_m)

    def _distances_m(
        self,
        starts_m: FloatArray,
        ends_m: FloatArray,
        begins_s: FloatArray,
        ends_s: FloatArray,
        within_m: float | None = None,
    ) -> FloatArray:
        """Lower bounds of how far chords (K, 2) are from what is restricted while they are flown, shape (K,).

        They are exact up to a distance, by default that of the one that is nearest.
        """
        chords = shapely.linestrings(np.stack((starts_m, ends_m), axis=1))
        least: FloatArray = shapely.distance(chords, self._everywhere)
        nearest = np.argsort(least, kind="stable")
        if within_m is None:
            within_m = float(self._exactly(chords, nearest[:_NEAREST], begins_s, ends_s).min())
        near = nearest[least[nearest] <= within_m]
        least[near] = self._exactly(chords, near, begins_s, ends_s)
        return least

    def _exactly(self, chords: np.ndarray, which: IntArray, begins_s: FloatArray, ends_s: FloatArray) -> FloatArray:
        """The distances of some chords (n,), by their numbers, shape (n,)."""
        closed, least = np.flatnonzero(self._restricted), np.full(len(which), np.inf)
        for rows, low_s, high_s in self._parted(begins_s[which], ends_s[which]):
            own, triangles = np.repeat(rows, len(closed)), np.tile(closed, len(rows))
            corners = self._swept(np.repeat(low_s, len(closed)), np.repeat(high_s, len(closed)), triangles)
            np.minimum.at(least, own, shapely.distance(chords[which[own]], hulls_of(corners)))
        return least

    @cached_property
    def _everywhere(self) -> shapely.Geometry:
        """All places at which something restricted is at some time."""
        corners = self._moving.places_m[:, self._moving.fixed.triangles[self._restricted]]
        both = np.concatenate((corners[:-1], corners[1:]), axis=2) if len(corners) > 1 else corners
        return shapely.union_all(hulls_of(both.reshape(-1, both.shape[2], 2)))

    def _contacts(
        self,
        starts_m: FloatArray,
        ends_m: FloatArray,
        half_widths_m: FloatArray,
        begins_s: FloatArray,
        ends_s: FloatArray,
    ) -> Contacts:
        """Contacts of squares that are swept along chords, (K, 2) both, in their times (K,)."""
        widths, size = half_widths_m + self._slack_m, self._moving.fixed.size
        found, outside = [], np.ones(len(widths), dtype=np.bool_)
        for number, (which, low_s, high_s) in enumerate(self._parted(begins_s, ends_s)):
            p, q = starts_m[which], ends_m[which]
            low, high = np.minimum(p, q) - widths[which, None], np.maximum(p, q) + widths[which, None]
            rows, triangles = self._trees[number].query(shapely.box(*low.T, *high.T))
            pieces = which[rows]
            p, q, width = starts_m[pieces], ends_m[pieces], widths[pieces]
            corners = self._swept(low_s[rows], high_s[rows], triangles)
            touching, depths = _meet(p, q, width, corners)
            found.append(np.stack((pieces, triangles), axis=1)[touching])
            found[-1] = np.column_stack((found[-1], depths[touching]))
            outside[pieces[touching]] = False
        pairs = np.concatenate(found)
        numbers, first = np.unique((pairs[:, 0] * size + pairs[:, 1]).astype(np.int64), return_index=True)
        pieces, triangles = np.divmod(numbers, size)
        outside |= self._beyond(starts_m, ends_m, widths)
        return Contacts(pieces, triangles, pairs[first, 2], outside)

    def _beyond(self, starts_m: FloatArray, ends_m: FloatArray, widths_m: FloatArray) -> BoolArray:
        """Which swept squares (K,) may reach beyond the domain, whose boundary stands."""
        return self._still.contacts(starts_m, ends_m, widths_m).outside

    @cached_property
    def _still(self) -> ContactSearch:
        return ContactSearch(self._moving.fixed)

    def _parted(self, begins_s: FloatArray, ends_s: FloatArray) -> list[tuple[IntArray, FloatArray, FloatArray]]:
        """For each time between two instants of the mesh, and the time after them: what is flown then, and when."""
        edges = np.append(self._moving.times_s, np.inf)
        parts = []
        for begin, end in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
            which = np.flatnonzero((ends_s >= begin) & (begins_s <= end))
            parts.append((which, np.clip(begins_s[which], begin, end), np.clip(ends_s[which], begin, end)))
        return parts

    def _swept(self, low_s: FloatArray, high_s: FloatArray, triangles: IntArray) -> FloatArray:
        """The corners of triangles (C,) at two times, shape (C, 6, 2)."""
        last_s = self._moving.last_s  # after which they stand
        ends = (self._moving.corners_at(np.minimum(times, last_s), triangles) for times in (low_s, high_s))
        return np.concatenate(tuple(ends), axis=1)

    @cached_property
    def _trees(self) -> list[shapely.STRtree]:
        """Of boxes round the triangles in each of these times."""
        corners = self._moving.places_m[:, self._moving.fixed.triangles]  # (K, M, 3, 2)
        low, high = corners.min(axis=2), corners.max(axis=2)
        low = np.concatenate((np.minimum(low[:-1], low[1:]), low[-1:]))
        high = np.concatenate((np.maximum(high[:-1], high[1:]), high[-1:]))
        return [shapely.STRtree(shapely.box(*a.T, *b.T)) for a, b in zip(low, high, strict=True)]


def _meet(p: FloatArray, q: FloatArray, width: FloatArray, corners_m: FloatArray) -> tuple[BoolArray, FloatArray]:
    """Whether squares swept from p to q, (C, 2) both, may meet hulls of two triangles each, (C, 6, 2).

    And how deep p lies in the first of these two; negative outside.
    """
    first = corners_m[:, :3]
    sides = np.concatenate([np.roll(each, -1, axis=1) - each for each in (first, corners_m[:, 3:])], axis=1)
    axes = np.concatenate(
        (
            np.stack((sides[..., 1], -sides[..., 0]), axis=-1),
            np.stack((p[:, 1] - q[:, 1], q[:, 0] - p[:, 0]), axis=1)[:, None],
            np.broadcast_to(np.eye(2), (len(p), 2, 2)),
        ),
        axis=1,
    )
    heights = np.einsum("cai,cvi->cav", axes, corners_m)
    ends = np.stack([np.einsum("cai,ci->ca", axes, end) for end in (p, q)], axis=2)
    spread = width[:, None] * np.abs(axes).sum(axis=2)
    apart = (ends.min(axis=2) - spread > heights.max(axis=2)) | (ends.max(axis=2) + spread < heights.min(axis=2))
    lengths = np.maximum(np.hypot(sides[:, :3, 0], sides[:, :3, 1]), np.finfo(np.float64).tiny)
    depths = ((heights[:, :3, :3].max(axis=2) - ends[:, :3, 0]) / lengths).min(axis=1)
    return ~apart.any(axis=1), depths
