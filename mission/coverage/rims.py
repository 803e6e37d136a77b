"""Lanes of their own along rims: what the lines of a sweep leave out, covered piece by piece.

Lines end where the ground does. Between the ends of two lines a slanted rim has a corner that is farther than half a
spacing from both, and so has a hole's side that runs along the lines, a bay, a tip. Each such piece gets the shortest
of some straight lanes that cover most of it, until nothing is left.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely

from mission.geometry.arrays import BoolArray, FloatArray

_SHORTEST: Final = 0.05
"""Of the spacing: a lane is no shorter, where the ground admits it."""
_STEP: Final = 0.1
"""Of the spacing: distance of the points that stand for a piece's outline."""
_SHORT: Final = 2.0
_SCRAP: Final = 1e-3
"""Of the spacing's square: an area that is not worth a lane."""
MOST_LANES: Final = 5_000


def swath(lanes_m: FloatArray, radius_m: float) -> shapely.Geometry:
    """All that is within a distance of lanes, shape (n, 2, 2), or little less: arcs are polygons."""
    return shapely.union_all(shapely.buffer(shapely.linestrings(lanes_m), radius_m, quad_segs=16))


def rim_lanes(
    ground: shapely.Geometry,
    reachable: shapely.Geometry,
    lanes_m: FloatArray,
    *,
    along: FloatArray,
    spacing_m: float,
    tolerance_m: float,
) -> FloatArray:
    """Lanes for what others leave out.

    Args:
        ground: Where lanes may lie.
        reachable: What is to be covered; nowhere farther than half a spacing from the ground.
        lanes_m: Shape (n, 2, 2), those there are.
        along: Unit vector of their heading, shape (2,).
        spacing_m: Their spacing.
        tolerance_m: A piece that has no point farther than this beyond half a spacing from a lane is left alone.

    Returns:
        Lanes, shape (m, 2, 2).
    """
    reach = spacing_m / 2.0
    rest = shapely.get_parts(shapely.difference(reachable, swath(lanes_m, reach)))
    far = shapely.difference(reachable, swath(lanes_m, reach + tolerance_m))
    pieces = list(rest[shapely.intersects(rest, far)])
    rim = shapely.boundary(ground)
    edges = np.concatenate([_edges(ring) for ring in shapely.get_parts(rim)])
    tree = shapely.STRtree(shapely.linestrings(edges))
    found: list[FloatArray] = []
    while pieces and len(found) < MOST_LANES:
        piece = pieces.pop()
        near = edges[np.sort(tree.query(piece, predicate="dwithin", distance=reach))]
        lane = _best(piece, ground, near, along, spacing_m)
        found.append(lane)
        line = shapely.linestrings(lane)
        for left in shapely.get_parts(shapely.difference(piece, shapely.buffer(line, reach, quad_segs=16))):
            beyond = shapely.difference(left, shapely.buffer(line, reach + max(tolerance_m, 0.01 * reach)))
            if not beyond.is_empty and not shapely.intersection(left, far).is_empty:
                pieces.append(left)
    return np.array(found).reshape(-1, 2, 2)


def needless(reachable: shapely.Geometry, lanes_m: FloatArray, spacing_m: float) -> BoolArray:
    """Short lanes whose swath the others cover, so far as it can be reached, shape (n,); the shortest go first."""
    lengths = np.linalg.norm(lanes_m[:, 1] - lanes_m[:, 0], axis=1)
    swaths = shapely.buffer(shapely.linestrings(lanes_m), spacing_m / 2.0, quad_segs=16)
    tree = shapely.STRtree(swaths)
    gone = np.zeros(len(lanes_m), dtype=np.bool_)
    for lane in np.argsort(lengths, kind="stable")[: int((lengths < _SHORT * spacing_m).sum())]:
        gone[lane] = True
        beside = tree.query(swaths[lane], predicate="intersects")
        others = shapely.union_all(swaths[beside[~gone[beside]]])
        missing = shapely.difference(shapely.intersection(reachable, swaths[lane]), others)
        gone[lane] = missing.area <= _SCRAP * spacing_m**2
    return gone


def _edges(ring: shapely.Geometry) -> FloatArray:
    corners = shapely.get_coordinates(ring)
    return np.stack((corners[:-1], corners[1:]), axis=1)


def _best(
    piece: shapely.Polygon, ground: shapely.Geometry, near: FloatArray, along: FloatArray, spacing_m: float
) -> FloatArray:
    """The lane that covers most of a piece for its length, shape (2, 2): along a rim nearby, or along the heading."""
    outline = shapely.get_coordinates(shapely.segmentize(piece, _STEP * spacing_m))
    middle = shapely.get_coordinates(shapely.centroid(piece))[0]
    steps = near[:, 1] - near[:, 0]
    lengths = np.linalg.norm(steps, axis=1)
    rims = zip(near[:, 0], steps / lengths[:, None], lengths, strict=True)
    lines = [_Line(begin, unit, 0.0, length) for begin, unit, length in rims]
    lines.append(_Line(middle, along, -np.inf, np.inf))
    candidates = [lane for line in lines for lane in _needed(outline, ground, line, spacing_m)]
    shapes = shapely.linestrings(np.array([*candidates, _nearest(piece, ground, along, spacing_m)]))
    covered = shapely.area(shapely.intersection(piece, shapely.buffer(shapes, spacing_m / 2.0, quad_segs=16)))
    worth = covered / (shapely.length(shapes) + spacing_m / 2.0)
    best: FloatArray = shapely.get_coordinates(shapes[int(np.argmax(worth))])
    return best


@dataclass(frozen=True, eq=False)
class _Line:
    """A line that a lane may lie on: a place, a unit vector, and how far before and after it; infinite where cut."""

    origin: FloatArray
    unit: FloatArray
    first: float
    last: float


def _needed(outline: FloatArray, ground: shapely.Geometry, line: _Line, spacing_m: float) -> list[FloatArray]:
    """The shortest pieces of a line, on the ground, that cover what it can cover."""
    reach = spacing_m / 2.0
    place = (outline - line.origin) @ line.unit
    aside = (outline - line.origin) @ np.array([-line.unit[1], line.unit[0]])
    place, aside = place[np.abs(aside) < reach], aside[np.abs(aside) < reach]
    if not len(place):
        return []
    room = np.sqrt(reach**2 - aside**2)
    begin, end = (place + room).min(), (place - room).max()
    grown = max(0.0, (_SHORTEST * spacing_m - (end - begin)) / 2.0) if end > begin else _SHORTEST * spacing_m / 2.0
    if begin > end:
        begin = end = (begin + end) / 2.0
    begin, end = np.clip([begin - grown, end + grown], line.first, line.last)
    lane: FloatArray = line.origin + np.array([[begin], [end]]) * line.unit
    if np.isfinite(line.last):  # an edge of the ground: no cutting, which would be lost in rounding
        return [lane] if end > begin else []
    parts = shapely.get_parts(shapely.intersection(shapely.linestrings(lane), ground))
    return [shapely.get_coordinates(part)[[0, -1]] for part in parts if shapely.length(part) > 0.0]


def _nearest(piece: shapely.Polygon, ground: shapely.Geometry, along: FloatArray, spacing_m: float) -> FloatArray:
    """A short lane through the place on the ground that is nearest to a piece, shape (2, 2)."""
    place = shapely.get_coordinates(shapely.shortest_line(ground, piece))[0]
    half = _SHORTEST * spacing_m / 2.0
    short = shapely.intersection(shapely.linestrings([place - half * along, place + half * along]), ground)
    parts = [part for part in shapely.get_parts(short) if shapely.length(part) > 0.0]
    if parts:
        lane: FloatArray = shapely.get_coordinates(parts[0])[[0, -1]]
        return lane
    beside = shapely.intersection(ground, shapely.buffer(shapely.points(place), half))
    return np.array([place, shapely.get_coordinates(shapely.point_on_surface(beside))[0]])
