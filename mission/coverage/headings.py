"""Headings worth trying: turns and cells are fewest along some edge of what is covered."""

from typing import Final

import numpy as np
import shapely

from mission.geometry.arrays import FloatArray

_GRID_DEG: Final = 15.0
_ALIKE_DEG: Final = 1.0
_MOST_EDGES: Final = 16


def candidates(parts: tuple[shapely.Polygon, ...]) -> tuple[float, ...]:
    """Headings clockwise from north, 0 <= heading < 180: of the longest edges of the hull and the parts, and a grid."""
    shapes = (shapely.convex_hull(shapely.MultiPolygon(parts)), *parts)
    steps = np.concatenate([_steps(ring) for shape in shapes for ring in shapely.get_rings(shape)])
    headings = np.degrees(np.arctan2(steps[:, 0], steps[:, 1])) % 180.0
    order = np.argsort(-np.hypot(*steps.T), kind="stable")
    found: list[float] = []
    for heading in headings[order]:
        if len(found) == _MOST_EDGES:
            break
        if all(_apart(heading, other) > _ALIKE_DEG for other in found):
            found.append(float(heading))
    grid = np.arange(0.0, 180.0, _GRID_DEG)
    return (
        *found,
        *(float(heading) for heading in grid if all(_apart(heading, other) > _ALIKE_DEG for other in found)),
    )


def _steps(ring: shapely.LinearRing) -> FloatArray:
    steps: FloatArray = np.diff(shapely.get_coordinates(ring), axis=0)
    return steps


def _apart(one: float, other: float) -> float:
    apart = abs(one - other) % 180.0
    return min(apart, 180.0 - apart)
