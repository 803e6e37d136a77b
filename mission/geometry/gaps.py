"""Narrow gaps: where outlines run beside each other, a mesh has to be as fine as they are near.

The triangles between two segments are about as large as the gap is wide, and grow from there in proportion to their
distance. So the vertices of a mesh are about as many as the integral, along all segments, of one over the distance to
the nearest segment that they do not meet (Ruppert's local feature size, integrated along the outlines).
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray

from mission.geometry.arrangement import Arrangement
from mission.geometry.arrays import FloatArray

GeometryArray = NDArray[np.object_]

_NARROW: Final = 1.0 / 64.0  # of a segment's length: wider gaps take no more than a few vertices each
_PARTS: Final = 8
_SHARE: Final = 0.5  # of the integral: meshes have had from 0.55 to 1.0 of it at 20 degrees
_MEASURED_AT: Final = np.tan(np.radians(20.0))


@dataclass(frozen=True, eq=False)
class Gap:
    """The gap between outlines that takes most vertices.

    Attributes:
        width_m: How wide it is.
        middle_m: A place in its middle, shape (2,).
        vertices: About how many a mesh needs for all narrow gaps, at least.
    """

    width_m: float
    middle_m: FloatArray
    vertices: int


def narrowest_gap(arrangement: Arrangement, domain: shapely.Geometry, smallest_angle_deg: float) -> Gap | None:
    """The gap that asks most of a mesh; None where all are wide against the segments beside them.

    Args:
        arrangement: Segments that meet at vertices only.
        domain: The part of the plane that is meshed.
        smallest_angle_deg: The least angle of a triangle.
    """
    vertices, segments = arrangement.vertices_m, arrangement.segments
    lines = shapely.linestrings(vertices[segments])
    near_m = _NARROW * shapely.length(lines)
    one, other = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=near_m)
    strange = (segments[one][:, :, None] != segments[other][:, None, :]).all(axis=(1, 2))
    order = np.flatnonzero(strange)[np.argsort(one[strange], kind="stable")]
    one, other = one[order], other[order]
    if not len(one):
        return None
    which, begins, group = np.unique(one, return_index=True, return_inverse=True)
    shares = np.linspace(0.0, 1.0, _PARTS + 1)[:, None]
    ends = vertices[segments[which], None]
    places = shapely.points((1.0 - shares) * ends[:, 0] + shares * ends[:, 1])
    away_m = shapely.distance(places[group], lines[other, None])
    width_m = np.minimum.reduceat(away_m, begins)
    pair, at = np.nonzero(away_m == width_m[group])
    nearest = np.empty(width_m.shape, dtype=np.int64)
    nearest[group[pair], at] = pair
    middles_m = _middles(places, lines[other[nearest]])
    in_domain = shapely.contains_xy(domain, middles_m[..., 0], middles_m[..., 1])
    width_m[~in_domain | (width_m > near_m[which, None])] = np.inf
    # A corner that points at a segment is near one place of it only: of two places, the one farther off counts.
    widths_m = np.maximum(width_m[:, :-1], width_m[:, 1:])
    needed = shapely.length(lines[which])[:, None] / _PARTS / widths_m
    if not needed.any():
        return None
    row, part = np.unravel_index(int(np.argmax(needed)), needed.shape)
    share = _SHARE * np.tan(np.radians(smallest_angle_deg)) / _MEASURED_AT
    return Gap(float(widths_m[row, part]), middles_m[row, part : part + 2].mean(axis=0), int(share * needed.sum()))


def _middles(places: GeometryArray, lines: GeometryArray) -> FloatArray:
    """Halfway from places to the lines beside them, shape (..., 2)."""
    between = shapely.line_interpolate_point(shapely.shortest_line(places, lines), 0.5, normalized=True)
    return np.stack((shapely.get_x(between), shapely.get_y(between)), axis=-1)
