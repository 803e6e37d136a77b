"""What was really covered: the region within half a spacing of where the vehicle was, from positions and their times.

Not every position counts. A vehicle that crosses a field on its way somewhere takes no photographs: where lanes are
known, ``on_lanes`` tells the positions that lie on them; where images are, their places alone may count. Nor is the
vehicle known to have been between two positions that are far apart in time.
"""

from collections.abc import Iterable
from typing import Final

import numpy as np
import shapely

from mission.geometry.arrays import BoolArray, FloatArray

ARC_ERROR: Final = 1.3e-3
"""Of half a spacing: the rim of a swath is no farther from the true one. Arcs are made polygons that lie inside, by
3e-4, and tracks are simplified by 1e-3."""
_QUARTER: Final = 32
_BEND: Final = 1e-3


def on_lanes(positions_m: FloatArray, lanes_m: FloatArray, aside_m: float) -> BoolArray:
    """Whether positions, shape (n, 2), are within a distance of lanes, shape (m, 2, 2); shape (n,)."""
    tree = shapely.STRtree(shapely.linestrings(lanes_m))
    near, _ = tree.query(shapely.points(positions_m), predicate="dwithin", distance=aside_m)
    found = np.zeros(len(positions_m), dtype=np.bool_)
    found[near] = True
    return found


def swath(
    positions_m: FloatArray,
    times_s: FloatArray,
    *,
    spacing_m: float,
    longest_gap_s: float,
    counts: BoolArray | None = None,
) -> shapely.Geometry:
    """All within half a spacing of the positions and of the straight lines between those that follow each other.

    Args:
        positions_m: Shape (n, 2), in the order of time.
        times_s: Shape (n,), never decreasing.
        spacing_m: Distance of lanes.
        longest_gap_s: Positions that are farther apart in time are not joined.
        counts: Shape (n,), whether each position counts; positions between which one does not are not joined.
    """
    taken = np.flatnonzero(np.ones(len(positions_m), dtype=np.bool_) if counts is None else counts)
    if not len(taken):
        return shapely.Polygon()
    broken = (np.diff(taken) > 1) | (np.diff(times_s[taken]) > longest_gap_s)
    tracks = np.split(positions_m[taken], np.flatnonzero(broken) + 1)
    return swath_of(tracks, spacing_m)


def swath_of(tracks_m: Iterable[FloatArray], spacing_m: float) -> shapely.Geometry:
    """All within half a spacing of tracks, each of shape (k, 2), k >= 1."""
    lines = [shapely.linestrings(track) if len(track) > 1 else shapely.points(track[0]) for track in tracks_m]
    radius_m = spacing_m / 2.0
    return shapely.union_all(shapely.buffer(shapely.simplify(lines, _BEND * radius_m), radius_m, quad_segs=_QUARTER))


def uncovered(region: shapely.Geometry, swath_m: shapely.Geometry) -> shapely.Geometry:
    """What of a region a swath leaves out: polygons, for pictures."""
    return shapely.difference(region, swath_m)


def covered_share(region: shapely.Geometry, swath_m: shapely.Geometry) -> float:
    """The part of a region's area that a swath covers, between 0 and 1."""
    return float(np.clip(1.0 - uncovered(region, swath_m).area / region.area, 0.0, 1.0))
