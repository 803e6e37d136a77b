"""Curved arrows between round nodes, as plain arrays: drawn a hundred at a time."""

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection

from mission.geometry.arrays import FloatArray

SAMPLES = 17


def bowed(start: FloatArray, end: FloatArray, bow: float) -> FloatArray:
    """A parabola from one point to another that swings out to its right by ``bow`` of its length; shape (S, 2)."""
    t = np.linspace(0.0, 1.0, SAMPLES)[:, None]
    way = end - start
    aside = np.array([way[1], -way[0]])
    curve: FloatArray = start + t * way + 4.0 * bow * t * (1.0 - t) * aside
    return curve


def between_discs(curve: FloatArray, start_radius: float, end_radius: float) -> FloatArray:
    """The part of a polyline outside the discs around its two ends; its ends lie on their rims."""
    first = np.hypot(*(curve - curve[0]).T) > start_radius
    last = np.hypot(*(curve - curve[-1]).T) > end_radius
    if not first.any() or not last.any():
        return curve[:0]
    i = int(np.argmax(first))
    j = len(curve) - 1 - int(np.argmax(last[::-1]))
    if i > j:
        return curve[:0]
    head = _on_rim(curve[i - 1], curve[i], curve[0], start_radius) if i > 0 else curve[0]
    tail = _on_rim(curve[j + 1], curve[j], curve[-1], end_radius) if j + 1 < len(curve) else curve[-1]
    return np.concatenate(([head], curve[i : j + 1], [tail]))


def draw_arrows(
    axes: Axes, curves: Sequence[FloatArray], *, colour: str, width: float, head: float, dashed: bool = False
) -> None:
    """Draw polylines with arrowheads at their ends.

    Args:
        axes: Where.
        curves: Each of shape (S, 2), at least two points.
        colour: Of lines and heads.
        width: Of the lines, points.
        head: Length of the heads, in the unit of the axes.
        dashed: Whether the lines are.
    """
    axes.add_collection(
        LineCollection(
            list(curves), colors=colour, linewidths=width, linestyles="dashed" if dashed else "solid", zorder=2
        )
    )
    heads = []
    for curve in curves:
        back = curve[max(0, _index_before(curve, head))]
        ahead = (curve[-1] - back) / max(float(np.hypot(*(curve[-1] - back))), 1e-12) * head
        aside = 0.38 * np.array([-ahead[1], ahead[0]])
        heads.append(np.array([curve[-1], curve[-1] - ahead + aside, curve[-1] - ahead - aside]))
    axes.add_collection(PolyCollection(heads, facecolors=colour, edgecolors=colour, linewidths=0.3, zorder=2.1))


def _on_rim(inside: FloatArray, outside: FloatArray, centre: FloatArray, radius: float) -> FloatArray:
    """Where the segment from a point in a disc to one outside leaves it."""
    way, from_centre = outside - inside, inside - centre
    a, b = float(way @ way), float(way @ from_centre)
    c = float(from_centre @ from_centre) - radius**2
    t = (-b + math.sqrt(max(0.0, b * b - a * c))) / a if a > 0.0 else 0.0
    point: FloatArray = inside + min(1.0, max(0.0, t)) * way
    return point


def _index_before(curve: FloatArray, distance: float) -> int:
    """Index of the last sample that is at least ``distance`` from the end."""
    far = np.hypot(*(curve - curve[-1]).T) >= distance
    return len(curve) - 1 - int(np.argmax(far[::-1])) if far.any() else 0
