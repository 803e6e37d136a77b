"""Lanes of their own along rims: what the lines of a sweep leave out, covered piece by piece.

Lines end where the ground does. Between the ends of two lines a slanted rim has a corner that is farther than half a
spacing from both, and so has a hole's side that runs along the lines, a bay, a tip. Each such piece gets the best of
some straight lanes, the shortest that cover all that they can: along the rim nearby, across its middle along the
heading, and a short one where the ground comes nearest to it; and again what is left of it, until nothing is.
"""

from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray

from mission.geometry.arrays import BoolArray, FloatArray, IntArray

Shapes = NDArray[np.object_]
_SHORTEST: Final = 0.05
"""Of the spacing: a lane is no shorter, where the ground admits it."""
_STEP: Final = 0.1
"""Of the spacing: distance of the points that stand for a piece's outline."""
_SHORT: Final = 2.0
"""Spacings: lanes that are shorter may be needless."""
_ON_THE_WAY: Final = 2.0
"""What a lane along the rim is worth more: turns run there, so that it is on the way, and all but free."""
_BRIDGED: Final = 0.5
"""Of the spacing: a gap between two lanes along an edge that is flown as part of one."""
_SCRAP: Final = 1e-3
"""Of the spacing's square: an area that is not worth a lane."""
_MOST_ROUNDS: Final = 20
_ARC: Final = 16
_RIM, _ACROSS, _NEAREST = range(3)


def swath(lanes_m: FloatArray, radius_m: float) -> shapely.Geometry:
    """All that is within a distance of lanes, shape (n, 2, 2), or little less: arcs are polygons."""
    return shapely.union_all(shapely.buffer(shapely.linestrings(lanes_m), radius_m, quad_segs=_ARC))


def rim_lanes(
    ground: shapely.Geometry,
    reachable: shapely.Geometry,
    lanes_m: FloatArray,
    *,
    along: FloatArray,
    spacing_m: float,
    tolerance_m: float,
    spared: float,
    left: float,
) -> FloatArray:
    """Lanes for what others leave out.

    Args:
        ground: Where lanes may lie.
        reachable: What is to be covered; nowhere farther than half a spacing from the ground.
        lanes_m: Shape (n, 2, 2), those there are.
        along: Unit vector of their heading, shape (2,).
        spacing_m: Their spacing.
        tolerance_m: On the ground no place is left farther than this beyond half a spacing from a lane.
        spared: Of all that is to be covered, the share that may be left, where it is not on the ground.
        left: Likewise, wherever it is.

    Returns:
        Lanes, shape (m, 2, 2).
    """
    reach = spacing_m / 2.0
    pieces = _pieces(shapely.difference(reachable, swath(lanes_m, reach)))
    far = shapely.difference(shapely.intersection(reachable, ground), swath(lanes_m, reach + tolerance_m))
    areas = shapely.area(pieces)
    must = shapely.intersects(pieces, far)
    order = np.lexsort((areas, must))  # those that must be covered last, the others by their size
    most = np.where(must[order], left, max(spared, left)) * reachable.area
    pieces = pieces[order[np.cumsum(areas[order]) > most]]
    edges = np.concatenate([_edges(ring) for part in shapely.get_parts(ground) for ring in shapely.get_rings(part)])
    found, on_edge = [np.empty((0, 2, 2))], [np.empty(0, dtype=np.int64)]
    for _ in range(_MOST_ROUNDS):
        if not len(pieces):
            break
        lanes, beside = _best(pieces, ground, edges, along, spacing_m)
        found.append(lanes)
        on_edge.append(beside)
        lines = shapely.linestrings(lanes)
        pieces = _pieces(shapely.difference(pieces, shapely.buffer(lines, reach, quad_segs=_ARC)))
        pieces = pieces[shapely.area(pieces) > _SCRAP * spacing_m**2]
    return _merged(np.concatenate(found), np.concatenate(on_edge), edges, _BRIDGED * spacing_m)


def _pieces(shape: shapely.Geometry | Shapes) -> Shapes:
    """Polygons that are left of shapes; made valid, as thin ones are not always."""
    parts = shapely.get_parts(shapely.make_valid(shapely.get_parts(shape)))
    kept: Shapes = parts[shapely.area(parts) > 0.0]
    return kept


def _merged(lanes: FloatArray, on_edge: IntArray, edges: FloatArray, gap_m: float) -> FloatArray:
    """Lanes along one edge that overlap, or nearly meet, made one; on_edge is -1 for those along none."""
    merged = [lanes[on_edge < 0]]
    for edge in np.unique(on_edge[on_edge >= 0]):
        origin, step = edges[edge, 0], edges[edge, 1] - edges[edge, 0]
        unit = step / np.linalg.norm(step)
        places = np.sort((lanes[on_edge == edge] - origin) @ unit, axis=1)
        begins, ends = places[np.argsort(places[:, 0], kind="stable")].T
        reached = np.maximum.accumulate(ends)
        first = np.concatenate(([True], begins[1:] > reached[:-1] + gap_m))
        last = np.concatenate((first[1:], [True]))
        merged.append(origin + np.stack((begins[first], reached[last]), axis=1)[..., None] * unit)
    return np.concatenate(merged)


def needless(reachable: shapely.Geometry, lanes_m: FloatArray, spacing_m: float) -> BoolArray:
    """Short lanes whose swath the others cover, so far as it can be reached, shape (n,); the shortest go first."""
    lengths = np.linalg.norm(lanes_m[:, 1] - lanes_m[:, 0], axis=1)
    swaths = shapely.buffer(shapely.linestrings(lanes_m), spacing_m / 2.0, quad_segs=_ARC)
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
    pieces: Shapes,
    ground: shapely.Geometry,
    edges: FloatArray,
    along: FloatArray,
    spacing_m: float,
) -> tuple[FloatArray, IntArray]:
    """Of each piece, N of them, the lane that covers most of it for its length, (N, 2, 2); its edge, or -1, (N,)."""
    tree = shapely.STRtree(shapely.linestrings(edges))
    piece, edge = tree.query(pieces, predicate="dwithin", distance=spacing_m / 2.0)
    steps = edges[edge, 1] - edges[edge, 0]
    lengths = np.linalg.norm(steps, axis=1)
    middles = shapely.get_coordinates(shapely.centroid(pieces))
    whole = np.arange(len(pieces))
    owner = np.concatenate((piece, whole))
    origin = np.concatenate((edges[edge, 0], middles))
    unit = np.concatenate((steps / lengths[:, None], np.broadcast_to(along, middles.shape)))
    begin, end = _needed(pieces, owner, origin, unit, spacing_m)
    rims = len(piece)
    begin[:rims], end[:rims] = np.clip(begin[:rims], 0.0, lengths), np.clip(end[:rims], 0.0, lengths)
    kept = begin < end
    lanes = origin[:, None] + np.stack((begin, end), axis=1)[..., None] * unit[:, None]
    rim, across = kept & (np.arange(len(kept)) < rims), kept & (np.arange(len(kept)) >= rims)
    on_ground, owner_across = _cut(lanes[across], owner[across], ground)
    lanes = np.concatenate((lanes[rim], on_ground, _nearest(pieces, ground, spacing_m)))
    owner = np.concatenate((owner[rim], owner_across, whole))
    kind = np.repeat([_RIM, _ACROSS, _NEAREST], [rim.sum(), len(on_ground), len(whole)])
    on_edge = np.concatenate((edge[rim[:rims]], np.full(len(lanes) - rim.sum(), -1)))
    shapes = shapely.linestrings(lanes)
    swaths = shapely.buffer(shapes, spacing_m / 2.0, quad_segs=_ARC)
    covered = shapely.area(shapely.intersection(pieces[owner], swaths))
    worth = covered / (shapely.length(shapes) + spacing_m / 2.0)
    worth *= np.array([_ON_THE_WAY, 1.0, 1.0 / _ON_THE_WAY])[kind]
    order = np.lexsort((-worth, owner))
    best = order[np.searchsorted(owner[order], whole)]
    return lanes[best], on_edge[best]


def _needed(
    pieces: Shapes,
    owner: IntArray,
    origin: FloatArray,
    unit: FloatArray,
    spacing_m: float,
) -> tuple[FloatArray, FloatArray]:
    """Where along lines the shortest lanes begin and end that cover all that they can of their pieces, shapes (L,).

    A lane that covers nothing ends before it begins.
    """
    # Of their rings, as polygons that are all but lines would be made valid first, and so none.
    rings = shapely.segmentize(shapely.boundary(pieces), _STEP * spacing_m)
    outline, of_piece = shapely.get_coordinates(rings, return_index=True)
    first = np.searchsorted(of_piece, np.arange(len(pieces) + 1))
    count = np.diff(first)[owner]
    line = np.arange(len(owner)).repeat(count)
    start = np.cumsum(count) - count
    offsets = outline[first[owner].repeat(count) + np.arange(len(line)) - start.repeat(count)] - origin[line]
    place = (offsets * unit[line]).sum(axis=1)
    squares = (spacing_m / 2.0) ** 2 - (offsets**2).sum(axis=1) + place**2
    room = np.sqrt(np.maximum(squares, 0.0))
    begin = np.minimum.reduceat(np.where(squares >= 0.0, place + room, np.inf), start)
    end = np.maximum.reduceat(np.where(squares >= 0.0, place - room, -np.inf), start)
    useless = ~np.isfinite(begin)
    begin, end = np.where(useless, 0.0, begin), np.where(useless, 0.0, end)
    half = np.maximum((end - begin) / 2.0, _SHORTEST * spacing_m / 2.0)
    middle = (begin + end) / 2.0
    return np.where(useless, 1.0, middle - half), np.where(useless, 0.0, middle + half)


def _cut(lanes: FloatArray, owner: IntArray, ground: shapely.Geometry) -> tuple[FloatArray, IntArray]:
    """The parts of lanes that lie on the ground, and whose they are."""
    parts, lane = shapely.get_parts(shapely.intersection(shapely.linestrings(lanes), ground), return_index=True)
    long = shapely.length(parts) > 0.0
    ends = [shapely.get_coordinates(part)[[0, -1]] for part in parts[long]]
    return np.array(ends).reshape(-1, 2, 2), owner[lane[long]]


def _nearest(pieces: Shapes, ground: shapely.Geometry, spacing_m: float) -> FloatArray:
    """Short lanes from the places on the ground that are nearest to pieces, shape (N, 2, 2)."""
    places = shapely.get_coordinates(shapely.shortest_line(ground, pieces))[::2]
    beside = shapely.intersection(ground, shapely.buffer(shapely.points(places), _SHORTEST * spacing_m / 2.0))
    inner = shapely.get_coordinates(shapely.point_on_surface(beside))
    return np.stack((places, inner), axis=1)
