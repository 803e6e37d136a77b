"""Rings: closed polygons as arrays of corners, shape (K, 2), the last corner joined to the first.

Edge ``i`` of a ring runs from corner ``i`` to corner ``i + 1``.
"""

from collections.abc import Sequence

import numpy as np
import shapely

from mission.decimals import decimal
from mission.geometry.arrays import BoolArray, FloatArray, IntArray

MOST_CROSSINGS = 1_000
_AT_ONCE = 256
"""Edges searched at once: all pairs of a hedgehog of thousands of edges would not fit into memory."""


def ring_edges(ring_m: FloatArray) -> FloatArray:
    """The edges of a ring, shape (K, 2, 2): edge, end, xy."""
    ring = np.asarray(ring_m, dtype=np.float64)
    return np.stack((ring, np.roll(ring, -1, axis=0)), axis=1)


def ring_area_m2(ring_m: FloatArray) -> float:
    """Signed area of a ring, positive where it is counter-clockwise."""
    # About its first corner: far from the origin the shoelace sum would cancel.
    x, y = (np.asarray(ring_m, dtype=np.float64) - ring_m[0]).T
    return float(0.5 * (x * np.roll(y, -1) - y * np.roll(x, -1)).sum())


def edge_crossings(edges_m: FloatArray, tolerance_m: float) -> tuple[IntArray, FloatArray]:
    """Pairs of edges that cross: each has its ends on both sides of the other, all farther from it than the tolerance.

    Edges that only touch, share an end or run along each other do not cross: a triangulation can have them both.

    Args:
        edges_m: Shape (E, 2, 2): edge, end, xy; none of length 0.
        tolerance_m: Distance below which an end counts as lying on the other edge's line.

    Returns:
        The pairs, shape (C, 2), lower index first and sorted; and where they cross, shape (C, 2). Where there are more
        than ``MOST_CROSSINGS``, the search ends early.
    """
    lines = shapely.linestrings(edges_m)
    tree = shapely.STRtree(lines)
    found, places, count = [np.empty((0, 2), dtype=np.int64)], [np.empty((0, 2))], 0
    for begin in range(0, len(lines), _AT_ONCE):
        first, second = tree.query(lines[begin : begin + _AT_ONCE], predicate="intersects")
        pairs = np.stack((first + begin, second), axis=1)[first + begin < second]
        crosses, points = _proper_crossings(edges_m[pairs[:, 0]], edges_m[pairs[:, 1]], tolerance_m)
        order = np.lexsort((pairs[crosses, 1], pairs[crosses, 0]))
        found.append(pairs[crosses][order])
        places.append(points[order])
        count += len(order)
        if count > MOST_CROSSINGS:
            break
    return np.concatenate(found), np.concatenate(places)


def _proper_crossings(a: FloatArray, b: FloatArray, tolerance_m: float) -> tuple[BoolArray, FloatArray]:
    """Which edges cross the edge beside them, shape (C,), and where those that do cross."""
    of_b, of_a = _line_distances(a, b), _line_distances(b, a)
    apart = (np.abs(of_b) > tolerance_m).all(axis=1) & (np.abs(of_a) > tolerance_m).all(axis=1)
    crosses: BoolArray = apart & (of_b[:, 0] * of_b[:, 1] < 0) & (of_a[:, 0] * of_a[:, 1] < 0)
    share = (of_a[crosses, 0] / (of_a[crosses, 0] - of_a[crosses, 1]))[:, None]
    points: FloatArray = (1.0 - share) * a[crosses, 0] + share * a[crosses, 1]
    return crosses, points


def _line_distances(lines: FloatArray, edges: FloatArray) -> FloatArray:
    """Signed distances of both ends of each edge from the line beside it, shape (C, 2)."""
    direction = lines[:, 1] - lines[:, 0]
    offsets = edges - lines[:, :1]
    crosses = direction[:, None, 0] * offsets[..., 1] - direction[:, None, 1] * offsets[..., 0]
    distances: FloatArray = crosses / np.linalg.norm(direction, axis=1)[:, None]
    return distances


def ring_fault(ring_m: FloatArray, tolerance_m: float) -> str:
    """What makes a ring no simple polygon, in words with its corners counted from 0; empty where it is one."""
    return ring_faults([ring_m], tolerance_m)[0]


def ring_faults(rings_m: Sequence[FloatArray], tolerance_m: float) -> list[str]:
    """The same of many rings, each of three corners at least."""
    if not rings_m:
        return []
    counts = np.array([len(ring) for ring in rings_m])
    corners, first, end = np.concatenate(rings_m).astype(np.float64), np.cumsum(counts) - counts, np.cumsum(counts)
    following = np.arange(len(corners)) + 1
    following[end - 1] = first
    lengths = np.linalg.norm(corners[following] - corners, axis=1)
    closed = np.insert(corners, end, corners[first], axis=0)
    polygons = shapely.polygons(shapely.linearrings(closed, indices=np.repeat(np.arange(len(counts)), counts + 1)))
    simple = shapely.is_valid(polygons)
    extents = np.maximum.reduceat(corners, first) - np.minimum.reduceat(corners, first)
    flat = shapely.area(polygons) <= tolerance_m * extents.max(axis=1)
    sound = simple & ~flat & (np.minimum.reduceat(lengths, first) > tolerance_m)
    faults = [""] * len(rings_m)
    for at in np.flatnonzero(~sound).tolist():
        here = slice(first[at], end[at])
        faults[at] = _fault_of(corners[here], lengths[here], tolerance_m, simple=simple[at], flat=flat[at])
    return faults


def _fault_of(ring_m: FloatArray, lengths_m: FloatArray, tolerance_m: float, *, simple: bool, flat: bool) -> str:
    """What is wrong with a ring that is not sound."""
    corners = len(ring_m)
    short = np.flatnonzero(lengths_m <= tolerance_m)
    if len(short):
        return f"corners {short[0]} and {(short[0] + 1) % corners} are the same point"
    if not simple:
        pairs, points = edge_crossings(ring_edges(ring_m), tolerance_m)
        if len(pairs):
            (i, j), (x, y) = pairs[0], points[0]
            return (
                f"its edges {i}-{(i + 1) % corners} and {j}-{(j + 1) % corners} cross at ({decimal(x)}, {decimal(y)})"
            )
    return "its corners all lie on one line" if flat else "it touches itself"
