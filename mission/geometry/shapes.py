"""Areas of the plane: polygons with holes and of several parts, discs, strips; and what lies near them or well inside.

ENU, metres. An area with a curved rim is a polygon here, and its corners say on which side it errs: one that is
``outside`` contains what it stands for, the other lies in it. All is computed about a whole metre near the area:
nothing is lost far from the origin.
"""

from collections.abc import Iterable, Sequence
from typing import Final, TypeAlias

import numpy as np
import shapely

from mission.geometry.arrays import FloatArray

DISC_SHARE: Final = 0.01
"""The rim of a disc is at most this part of the radius, and ``DISC_M``, from the circle."""
DISC_M: Final = 0.25
CORNER_SHARE: Final = 1.0 / np.cos(np.pi / 12.0) - 1.0
"""What is within a distance of an area is at most this part of the distance, 3.6 %, larger than that, at corners."""

_CORNER_TURN: Final = np.pi / 6.0
_NOTHING_M2: Final = 1e-9

Area: TypeAlias = "shapely.Polygon | shapely.MultiPolygon"
Part = tuple[FloatArray, Sequence[FloatArray]]
"""Corners of a ring, shape (K, 2), and of the rings of its holes."""


def united(parts: Iterable[Part]) -> Area:
    """Polygons without their holes, together; where they are sound as they are, corners stay the same to the last bit.

    Holes may touch or cross the rim of their polygon, and parts each other. The area may be empty.
    """
    drawn = list(parts)
    whole = shapely.MultiPolygon([(ring, list(holes)) for ring, holes in drawn])
    if not shapely.is_valid(whole):
        cut = [
            shapely.difference(shapely.Polygon(ring), shapely.union_all([shapely.Polygon(hole) for hole in holes]))
            for ring, holes in drawn
        ]
        return polygonal(shapely.union_all(cut))
    return whole.geoms[0] if len(drawn) == 1 else whole


def disc(centre_m: FloatArray, radius_m: float, *, outside: bool) -> shapely.Polygon:
    """A circle as a regular polygon around it, or with its corners on it."""
    share = min(DISC_SHARE, DISC_M / radius_m)
    # A corner of the polygon around, or the middle of an edge of the one within, is off by this part of the radius.
    half = np.arccos(1.0 / (1.0 + share)) if outside else np.arccos(1.0 - share)
    corners = 4 * int(np.ceil(np.pi / (4.0 * half)))
    angles = 2.0 * np.pi * np.arange(corners) / corners
    reach = radius_m / np.cos(np.pi / corners) if outside else radius_m
    return shapely.Polygon(centre_m + reach * np.stack((np.cos(angles), np.sin(angles)), axis=1))


def strip(line_m: FloatArray, width_m: float, *, outside: bool) -> Area:
    """What lies beside a line, by half the width on each side: flat at the ends, round at the bends.

    Args:
        line_m: Shape (K, 2), no two corners in a row the same; one that ends where it begins has no ends.
        width_m: From one side to the other.
        outside: Whether bends reach around the arc, or end within it.
    """
    origin, line = _near(line_m)
    closed = len(line) > 2 and bool((line[0] == line[-1]).all())  # noqa: PLR2004 - a ring
    line = line[:-1] if closed else line
    sides = [_beside(path, 0.5 * width_m, closed=closed, outside=outside) for path in (line, line[::-1])]
    return _moved(polygonal(shapely.union_all(np.concatenate(sides))), origin)


def grown(area: Area, by_m: float) -> Area:
    """An area with all that is within a distance of it, and at corners at most ``CORNER_SHARE`` of it more."""
    if by_m <= 0.0 or area.is_empty:
        return area
    origin, _ = _near(shapely.get_coordinates(area))
    near = _moved(area, -origin)
    return _moved(polygonal(shapely.union_all([near, *_rim(near, by_m, inwards=False)])), origin)


def shrunk(area: Area, by_m: float) -> Area:
    """What of an area is at least a distance inside it, but for ``CORNER_SHARE`` of it at corners; may be empty."""
    if by_m <= 0.0 or area.is_empty:
        return area
    origin, _ = _near(shapely.get_coordinates(area))
    near = _moved(area, -origin)
    return _moved(polygonal(shapely.difference(near, shapely.union_all(_rim(near, by_m, inwards=True)))), origin)


def widened(area: Area, by_m: float) -> Area:
    """All places whose square, reaching ``by_m`` on each axis, meets an area: its Minkowski sum with the square."""
    if by_m <= 0.0 or area.is_empty:
        return area
    return polygonal(shapely.union_all([area, *_bordered(area, by_m)]))


def narrowed(area: Area, by_m: float) -> Area:
    """All places whose square, reaching ``by_m`` on each axis, lies in an area as a whole; may be empty."""
    if by_m <= 0.0 or area.is_empty:
        return area
    found = []
    for part in shapely.get_parts(area):
        filled = shapely.Polygon(part.exterior)
        within = shapely.difference(filled, shapely.union_all(_bordered(filled, by_m)))
        holes = shapely.polygons(shapely.get_rings(part)[1:])
        hulls = shapely.convex_hull(holes)
        solid = np.isclose(shapely.area(hulls), shapely.area(holes), rtol=1e-12, atol=0.0)
        kept_out = [shapely.union_all([hole, *_bordered(hole, by_m)]) for hole in holes[~solid]]
        kept_out.extend(_hulls(hulls[solid], by_m))
        found.append(shapely.difference(within, shapely.union_all(kept_out)))
    return polygonal(shapely.union_all(found))


def without_straight_corners(area: Area, tolerance_m: float) -> Area:
    """An area without the corners that lie on the line of their neighbours."""
    rings, part_of = shapely.get_rings(shapely.get_parts(area), return_index=True)
    corners, ring = shapely.get_coordinates(rings, return_index=True)
    once = np.append(ring[1:] == ring[:-1], False)  # the last corner of a ring is its first
    corners, ring = corners[once], ring[once]
    first = np.searchsorted(ring, np.arange(len(rings)))
    last = np.append(first[1:], len(ring)) - 1
    following, preceding = np.arange(len(ring)) + 1, np.arange(len(ring)) - 1
    following[last], preceding[first] = first, last
    before, after = corners[preceding], corners[following]
    along, offset = after - before, corners - before
    apart = np.abs(along[:, 0] * offset[:, 1] - along[:, 1] * offset[:, 0])
    forward = (offset * (after - corners)).sum(axis=1) > 0.0
    kept = ~(forward & (apart <= tolerance_m * np.hypot(*along.T)))
    bent = shapely.linearrings(corners[kept], indices=ring[kept])
    return _joined_parts(shapely.polygons(bent, indices=part_of))


def rings_of(area: Area) -> list[FloatArray]:
    """The rings of an area, each shape (K, 2) and not closed: of each part the rim, then its holes."""
    return [
        shapely.get_coordinates(ring)[:-1]
        for part in shapely.get_parts(area)
        for ring in (part.exterior, *part.interiors)
    ]


def edges_of(areas: Iterable[Area]) -> FloatArray:
    """The edges of all rings of some areas, shape (E, 2, 2): edge, end, xy."""
    rings = shapely.get_rings(shapely.get_parts(list(areas)))
    corners, ring = shapely.get_coordinates(rings, return_index=True)
    edges: FloatArray = np.stack((corners[:-1], corners[1:]), axis=1)[ring[:-1] == ring[1:]]
    return edges


def edges_within(edges_m: FloatArray, area: Area) -> FloatArray:
    """The parts of edges, shape (E, 2, 2), that lie within an area, shape (P, 2, 2)."""
    whole = shapely.linestrings(edges_m)
    shapely.prepare(area)
    cut = ~shapely.contains_properly(area, whole)
    whole[cut] = shapely.intersection(whole[cut], area)
    parts = shapely.get_parts(whole)
    lines = parts[(shapely.get_type_id(parts) == shapely.GeometryType.LINESTRING) & (shapely.length(parts) > 0.0)]
    ends: FloatArray = shapely.get_coordinates(lines).reshape(-1, 2, 2)
    return ends


def polygonal(shape: shapely.Geometry) -> Area:
    """What of a shape is an area, without the parts and holes that rounding leaves."""
    parts = shapely.get_parts(shape)
    parts = parts[shapely.get_type_id(parts) == shapely.GeometryType.POLYGON]
    parts = parts[shapely.area(parts) > _NOTHING_M2]
    rings, part_of = shapely.get_rings(parts, return_index=True)
    is_hole = np.append(False, part_of[1:] == part_of[:-1])  # a part's first ring is its outside
    kept = ~is_hole | (shapely.area(shapely.polygons(rings)) > _NOTHING_M2)
    return _joined_parts(parts if kept.all() else shapely.polygons(rings[kept], indices=part_of[kept]))


def _joined_parts(parts: FloatArray) -> Area:
    return parts[0] if len(parts) == 1 else shapely.MultiPolygon(list(parts))


def _bordered(area: Area, by_m: float) -> FloatArray:
    """The Minkowski sums of the edges of an area with a square, as polygons."""
    edges = edges_of([area])
    swapped = edges[:, 0, 0] > edges[:, 1, 0]
    edges[swapped] = edges[swapped, ::-1]
    (begins, ends), rises = np.moveaxis(edges, 1, 0), edges[:, 1, 1] >= edges[:, 0, 1]
    low, high = np.where(rises[:, None], begins, ends), np.where(rises[:, None], ends, begins)
    lower, upper = np.array([-by_m, -by_m]), np.array([by_m, by_m])
    right, left = np.array([by_m, -by_m]), np.array([-by_m, by_m])
    rising = np.stack((begins + lower, begins + right, ends + right, ends + upper, ends + left, begins + left), axis=1)
    falling = np.stack((begins + lower, low + lower, low + right, ends + upper, high + upper, begins + left), axis=1)
    sums: FloatArray = shapely.polygons(np.where(rises[:, None, None], rising, falling))
    return sums


def _hulls(convex: FloatArray, by_m: float) -> FloatArray:
    """The Minkowski sums of convex polygons with a square."""
    corners, number = shapely.get_coordinates(convex, return_index=True)
    square = by_m * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    clouds = (corners[:, None] + square).reshape(-1, 2)
    sums: FloatArray = shapely.convex_hull(shapely.multipoints(clouds, indices=np.repeat(number, 4)))
    return sums


def _rim(area: Area, width_m: float, *, inwards: bool) -> FloatArray:
    """What lies within a distance of the rim, on one side of it, as polygons that cover it."""
    bands = []
    for part in shapely.get_parts(area):
        for ring, is_hole in [(part.exterior, False), *((hole, True) for hole in part.interiors)]:
            corners = shapely.get_coordinates(ring)[:-1]
            # On the left of a ring is what is not wanted: counter-clockwise, what it encloses.
            backwards = bool(shapely.is_ccw(ring)) != (is_hole == inwards)
            bands.append(_beside(corners[::-1] if backwards else corners, width_m, closed=True))
    return np.concatenate(bands)


def _beside(path: FloatArray, width_m: float, *, closed: bool, outside: bool = True) -> FloatArray:
    """What lies on the right of a path by a width: a rectangle along each edge, and a fan at each bend to the left."""
    begins, ends = (path, np.roll(path, -1, axis=0)) if closed else (path[:-1], path[1:])
    along = ends - begins
    along = along / np.hypot(*along.T)[:, None]
    right = np.stack((along[:, 1], -along[:, 0]), axis=1) * width_m
    pieces = [shapely.polygons(np.stack((begins, ends, ends + right, begins + right), axis=1))]
    before = np.roll(along, 1, axis=0)
    turn = np.arctan2(before[:, 0] * along[:, 1] - before[:, 1] * along[:, 0], (before * along).sum(axis=1))
    turn = turn if closed else np.append(0.0, turn[1:])
    steps = np.maximum(np.ceil(turn / _CORNER_TURN - 1e-9), 1.0).astype(np.int64)
    for count in np.unique(steps[turn > 0.0]).tolist():
        at = np.flatnonzero((steps == count) & (turn > 0.0))
        first, last = np.roll(right, 1, axis=0)[at], right[at]
        # Corners of the fan: at the steps on the arc, or between them where the arc's tangents meet.
        steps_done = np.arange(count) + 0.5 if outside else np.arange(1, count)
        angle = turn[at, None] / count * steps_done
        reach = 1.0 / np.cos(0.5 * turn[at, None] / count) if outside else 1.0
        cos, sin = np.cos(angle) * reach, np.sin(angle) * reach
        arc = np.stack((cos * first[:, :1] - sin * first[:, 1:], sin * first[:, :1] + cos * first[:, 1:]), axis=2)
        fan = np.concatenate((np.zeros((len(at), 1, 2)), first[:, None], arc, last[:, None]), axis=1)
        pieces.append(shapely.polygons(begins[at, None] + fan))
    return np.concatenate(pieces)


def _near(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A whole metre near some points, shape (2,), and the points from there: nothing is rounded."""
    origin = np.floor(np.asarray(points, dtype=np.float64).min(axis=0))
    return origin, points - origin


def _moved(area: Area, by_m: FloatArray) -> Area:
    return shapely.transform(area, lambda places: places + by_m)
