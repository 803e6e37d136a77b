"""The shapes that a coverage is made from, near their origin and made ready: parts, arms, what sees what."""

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
import shapely

from mission.coverage.middles import arms, middle_lines
from mission.coverage.ways import Network
from mission.errors import GeometryError
from mission.geometry.arrays import FloatArray

INSET: Final = 1.0 / 400.0
"""Of the spacing: how far within the ground lanes and ways are, between half of it and five halves."""
MOST_LINES: Final = 2_000
_BESIDE: Final = 20.0
_EXCESS: Final = INSET / 100.0


@dataclass(frozen=True, eq=False)
class Area:
    """The shapes, near their origin.

    Attributes:
        parts: Connected polygons of the ground, a little smaller than given.
        region: What is to be covered.
        reachable: What is to be covered: the region, within half a spacing of the ground.
        free: A little smaller than given, and the parts.
        spacing_m: Of the lanes.
    """

    parts: tuple[shapely.Polygon, ...]
    region: shapely.Geometry
    reachable: shapely.Geometry
    free: shapely.Geometry
    spacing_m: float

    @cached_property
    def ground(self) -> shapely.Geometry:
        """All parts."""
        return shapely.MultiPolygon(self.parts)

    @cached_property
    def grounds(self) -> list[Network]:
        """What sees what on each part."""
        return [Network(part, _EXCESS * self.spacing_m) for part in self.parts]

    @cached_property
    def everywhere(self) -> Network:
        """What sees what in free space."""
        return Network(self.free, _EXCESS * self.spacing_m)

    def in_free(self, place_m: FloatArray) -> FloatArray:
        """The place that is nearest in free space, shape (2,).

        Raises:
            GeometryError: It is farther than free space was made smaller.
        """
        place = shapely.points(place_m)
        nearest: FloatArray = shapely.get_coordinates(shapely.shortest_line(self.free, place))[0]
        if np.linalg.norm(nearest - place_m) > _BESIDE * INSET * self.spacing_m:
            raise GeometryError("the place that ways lead from, or to, is not in free space")
        return nearest

    @cached_property
    def arms(self) -> list[list[list[FloatArray]]]:
        """Of each part, and of each of its arms, the middle lines that lie in it."""
        return [[self._middles(arm) for arm in shapely.get_parts(narrow)] for narrow in self._narrow]

    def _middles(self, arm: shapely.Polygon) -> list[FloatArray]:
        return [
            line
            for line in middle_lines(arm, self.spacing_m)
            if len(line) > 1 and shapely.covers(self.ground, shapely.linestrings(line))
        ]

    @cached_property
    def _narrow(self) -> list[shapely.Geometry]:
        return [arms(part, self.region, self.spacing_m) for part in self.parts]

    @cached_property
    def fields(self) -> list[tuple[int, shapely.Polygon, shapely.Geometry]]:
        """What is swept: polygons without arms, each with the number of its part and what is to be covered from it."""
        reach = self.spacing_m / 2.0
        return [
            (number, field, shapely.intersection(self.reachable, shapely.buffer(field, reach)))
            for number, (part, narrow) in enumerate(zip(self.parts, self._narrow, strict=True))
            for field in (shapely.get_parts(shapely.difference(part, narrow)) if not narrow.is_empty else [part])
            if shapely.area(field) > 0.0
        ]


def area_of(region: shapely.Geometry, ground: shapely.Geometry, free: shapely.Geometry, spacing_m: float) -> Area:
    """Make shapes ready.

    Raises:
        GeometryError: There is no ground, it is not in free space, or it has too many lanes.
    """
    left, low, right, high = shapely.bounds(ground)
    if np.hypot(right - left, high - low) > MOST_LINES * spacing_m:
        raise GeometryError(
            f"more than {MOST_LINES} lanes: a spacing of {spacing_m:.4g} m is too narrow for the region"
        )
    outside = shapely.difference(ground, shapely.buffer(free, _EXCESS * spacing_m, join_style="mitre"))
    if not outside.is_empty:
        x, y = shapely.get_coordinates(shapely.point_on_surface(outside))[0]
        raise GeometryError(f"lanes would leave free space near ({x:.2f}, {y:.2f})")
    parts = tuple(shapely.get_parts(_inset(ground, spacing_m)))
    if not parts:
        raise GeometryError("no lane fits into the region: nothing of it is left by the clearance and the tube")
    reachable = shapely.intersection(region, shapely.buffer(shapely.MultiPolygon(parts), spacing_m / 2.0))
    return Area(parts, region, reachable, shapely.union_all([_inset(free, spacing_m), *parts]), spacing_m)


def _inset(shape: shapely.Geometry, spacing_m: float) -> shapely.Geometry:
    """Each part a little smaller, with fewer corners: what is made in it survives rounding, and arcs are cheap."""
    parts = []
    for part in shapely.get_parts(shape):
        for finer in (1.0, 0.1, 0.01):
            margin = finer * INSET * spacing_m
            smaller = shapely.simplify(shapely.buffer(part, -1.5 * margin, join_style="mitre"), margin)
            if not smaller.is_empty:
                parts.extend(shapely.get_parts(smaller))
                break
    return shapely.MultiPolygon(parts)
