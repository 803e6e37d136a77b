"""Positions as files have them, checked: numbers that are finite, rings that have corners."""

import math
from collections.abc import Callable, Sequence
from typing import Any, Final

from mission.errors import SpecError
from mission.interchange.features import Line, Point, Polygon

MOST_POSITIONS: Final = 200_000
"""As many positions a file may have; a mission of more outlines could not be meshed in reasonable time."""

LEAST_CORNERS: Final = 3

Refuse = Callable[[str], SpecError]
"""From what is wrong to the refusal that says where."""


def number(value: Any) -> float | None:  # noqa: ANN401 - any JSON value
    """A finite number as float, None for anything else (a truth value, too)."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        return float(value) if math.isfinite(value) else None
    except OverflowError:
        return None


def polygon(outline: Sequence[Point], holes: Sequence[Sequence[Point]], refuse: Refuse) -> Polygon:
    """A polygon of rings that may be closed and may repeat corners in a row.

    Raises:
        SpecError: A ring has fewer than three corners.
    """
    return Polygon(_ring(outline, refuse), tuple(_ring(hole, refuse) for hole in holes))


def line(points: Sequence[Point], width_m: float | None, refuse: Refuse) -> Line:
    """A line.

    Raises:
        SpecError: It has fewer than two different points.
    """
    distinct = without_repeats(points)
    if len(distinct) < LEAST_CORNERS - 1:
        raise refuse("the line has fewer than 2 different points")
    return Line(tuple(distinct), width_m)


def line_or_ring(points: Sequence[Point], width_m: float | None, refuse: Refuse) -> Line | Polygon:
    """A line, or the polygon that it draws where it comes back to its begin: so outlines are drawn, too.

    Raises:
        SpecError: It has fewer than two different points.
    """
    drawn = line(points, width_m, refuse)
    closed = len(drawn.points) > LEAST_CORNERS and drawn.points[0] == drawn.points[-1]
    return Polygon(drawn.points[:-1]) if closed else drawn


def _ring(points: Sequence[Point], refuse: Refuse) -> tuple[Point, ...]:
    corners = without_repeats(points)
    if len(corners) > 1 and corners[0] == corners[-1]:
        corners.pop()
    if len(corners) < LEAST_CORNERS:
        raise refuse(f"the ring has {len(corners)} different corners, a polygon has at least {LEAST_CORNERS}")
    return tuple(corners)


def without_repeats(points: Sequence[Point]) -> list[Point]:
    """The points without those that are equal to the one before."""
    return [point for i, point in enumerate(points) if i == 0 or point != points[i - 1]]
