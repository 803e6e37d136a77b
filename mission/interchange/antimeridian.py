"""Areas that a file has in two parts because they cross the antimeridian (RFC 7946, 3.1.9), as one again."""

import math
from dataclasses import replace
from typing import Final

import numpy as np
import shapely

from mission.geometry.arrays import FloatArray
from mission.interchange.features import Drawing, Feature, Line, Point, Polygon, Shape, points_of

_TURN, _HALF = 360.0, 180.0
_SIDES: Final = {-_HALF, _HALF}


def joined(drawing: Drawing) -> Drawing:
    """A drawing in degrees, its parts that meet at the antimeridian joined there; longitudes stay from -180 to 180.

    Two parts with the antimeridian as an edge of both would keep a gap there in metres, which rounding is enough for.
    """
    return replace(
        drawing,
        features=tuple(_joined(_on_the_map(feature)) for feature in drawing.features),
        route=_turned(drawing.route),
        start=drawing.start and _turned((drawing.start,))[0],
    )


def _on_the_map(feature: Feature) -> Feature:
    """A feature whose longitudes do not go on beyond 180."""
    if all(abs(longitude) <= _HALF for shape in feature.shapes for longitude, _ in points_of(shape)):
        return feature
    return replace(feature, shapes=tuple(map(_shape_on_the_map, feature.shapes)))


def _shape_on_the_map(shape: Shape) -> Shape:
    if isinstance(shape, Polygon):
        return Polygon(_turned(shape.outline), tuple(map(_turned, shape.holes)))
    if isinstance(shape, Line):
        return replace(shape, points=_turned(shape.points))
    return replace(shape, centre=_turned((shape.centre,))[0])


def _turned(points: tuple[Point, ...]) -> tuple[Point, ...]:
    return tuple((x - math.copysign(_TURN, x) if abs(x) > _HALF else x, y) for x, y in points)


def _joined(feature: Feature) -> Feature:
    polygons = [shape for shape in feature.shapes if isinstance(shape, Polygon)]
    if {longitude for polygon in polygons for longitude, _ in polygon.outline} & _SIDES != _SIDES:
        return feature
    areas = [shapely.Polygon(_eastward(each.outline), [*map(_eastward, each.holes)]) for each in polygons]
    if not all(area.is_valid for area in areas):
        return feature  # which is refused, with the place
    others = tuple(shape for shape in feature.shapes if not isinstance(shape, Polygon))
    whole = shapely.get_parts(shapely.union_all(areas))
    return replace(feature, shapes=(*map(_polygon, whole), *others))


def _eastward(ring: tuple[Point, ...]) -> FloatArray:
    """Corners, shape (K, 2), their longitudes from 0 to 360."""
    places = np.array(ring, dtype=np.float64)
    return np.stack((np.where(places[:, 0] < 0.0, places[:, 0] + _TURN, places[:, 0]), places[:, 1]), axis=1)


def _polygon(area: shapely.Polygon) -> Polygon:
    return Polygon(_corners(area.exterior), tuple(map(_corners, area.interiors)))


def _corners(ring: shapely.LinearRing) -> tuple[Point, ...]:
    places = shapely.get_coordinates(ring)[:-1].tolist()
    return tuple((x - _TURN if x > _HALF else x, y) for x, y in places)
