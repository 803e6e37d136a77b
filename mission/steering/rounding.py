"""Rounds the corners of a polyline as widely as the room round each admits."""

from typing import Final

import numpy as np
import shapely

from mission.geometry.arrays import FloatArray, IntArray
from mission.geometry.straightening import straightened
from mission.steering.rounded import RoundedPolyline

_HALVINGS: Final = 8
_MEETING: Final = 1e-12  # of the way between two corners: blends that leave less straight meet
_BRIEF: Final = 1e-3
_LESS: Final = 0.99
_SAMPLES: Final = 9  # of a blend; whether all of it has room is for the proof to say
_APART: Final = 1e-6  # of the extent: corners that are nearer to each other are one


def rounded_within(
    line_m: FloatArray, room: shapely.Geometry, *, tolerance_m: float, widest_m: FloatArray, speed_m_s: float
) -> tuple[RoundedPolyline, FloatArray]:
    """Round the corners of a polyline, each as widely as asked, as its neighbours admit and as there is room.

    Small steps to the side, for which a vehicle would have to stop, are left out first where there is room.

    Args:
        line_m: Shape (p, 2), in the room.
        room: Polygon or MultiPolygon that blends do not leave, as far as wide ones and ever narrower ones are tried.
        tolerance_m: How far beside the curve's corners and straight parts points of the line may lie.
        widest_m: Shape (p,), the largest reach at each point of the line.
        speed_m_s: Of the curve, positive.

    Returns:
        The curve, and the parameter at which it passes each point of the line, shape (p,), ascending.

    Raises:
        ValueError: All points are one.
    """
    shapely.prepare(room)
    kept = _kept(line_m, room, tolerance_m)
    corners, widest = line_m[kept], widest_m[kept]
    steps = np.diff(corners, axis=0)
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    reaches = np.minimum(widest[1:-1], np.minimum(lengths[:-1], lengths[1:]) / 2.0)
    for _ in range(_HALVINGS):
        curve = RoundedPolyline(corners, reaches, speed_m_s)
        blends = curve.knots_s[1:-1].reshape(-1, 2)
        s = blends[:, :1] + np.linspace(0.0, 1.0, _SAMPLES) * (blends[:, 1:] - blends[:, :1])
        tight = ~shapely.covers(room, shapely.linestrings(curve.position(s.ravel()).reshape(*s.shape, 2)))
        if not tight.any():
            break
        reaches = np.where(tight, reaches / 2.0, reaches)
    # Where blends nearly meet, rounding would say more of the moment between them than the curve does.
    around = np.concatenate(([0.0], reaches, [0.0]))
    left = (lengths - around[:-1] - around[1:]) / lengths
    brief = (left > _MEETING) & (left < _BRIEF)
    curve = RoundedPolyline(corners, np.where(brief[:-1] | brief[1:], _LESS * reaches, reaches), speed_m_s)
    # Points that were left out are passed where they are nearest.
    piece = np.clip(np.searchsorted(kept, np.arange(len(line_m)), side="right") - 1, 0, len(steps) - 1)
    along = ((line_m - corners[piece]) * steps[piece]).sum(axis=1) / lengths[piece]
    passed_s = curve.corners_s[piece] + np.clip(along, 0.0, lengths[piece]) / speed_m_s
    return curve, np.maximum.accumulate(passed_s)


def _kept(line_m: FloatArray, room: shapely.Geometry, tolerance_m: float) -> IntArray:
    """Indices of the points that stay, both ends among them."""
    apart_m = _APART * float(np.ptp(line_m, axis=0).max(initial=0.0))
    steps = np.diff(line_m, axis=0)
    distinct = np.flatnonzero(np.concatenate(([True], np.hypot(steps[:, 0], steps[:, 1]) > apart_m)))
    if len(distinct) < 2:  # noqa: PLR2004 - a line has two ends
        raise ValueError("a line has two points that differ")

    def admits(begin: FloatArray, end: FloatArray) -> bool:
        # Ends in one place are no piece of a line.
        return bool(np.hypot(*(end - begin)) > apart_m and room.covers(shapely.linestrings(np.stack((begin, end)))))

    return distinct[straightened(line_m[distinct], tolerance_m, admits)[0]]
