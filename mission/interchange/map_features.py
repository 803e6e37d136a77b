"""Things to draw on a map, as values: what all formats for maps have in common."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import shapely

from mission.geometry.arrays import FloatArray

Json = str | int | float | bool | None | list["Json"] | dict[str, "Json"]

DIGITS = 9
"""Digits of a degree: a tenth of a millimetre."""

_TURN, _HALF = 360.0, 180.0
_OF_SEVERAL = {"Point": shapely.MultiPoint, "LineString": shapely.MultiLineString, "Polygon": shapely.MultiPolygon}


@dataclass(frozen=True, eq=False)
class MapFeature:
    """One thing on a map.

    Attributes:
        name: What it is called.
        kind: What it is: the kind of a region, or ``path``, ``triangle`` and the like.
        group: The heading that it stands under.
        geometry: Points, lines or polygons, longitude and latitude in degrees; longitudes may go on beyond 180.
        colour: ``#RRGGBB``.
        height_m: How high above the ground it is, or a polygon reaches; None where it lies on the ground.
        filled: Whether a polygon is more than its outline.
        properties: More about it.
    """

    name: str
    kind: str
    group: str
    geometry: shapely.Geometry
    colour: str
    height_m: float | None = None
    filled: bool = True
    properties: Mapping[str, Json] = field(default_factory=dict)


def as_text(value: Json) -> str:
    """A property for formats that have text only."""
    return " ".join(map(as_text, value)) if isinstance(value, list) else str(value)


def within_the_map(geometry: shapely.Geometry) -> shapely.Geometry:
    """The same with longitudes from -180 to 180, cut where it crosses the antimeridian (RFC 7946, 3.1.9)."""
    west, _, east, _ = geometry.bounds
    turns = range(math.floor((west + _HALF) / _TURN), math.ceil((east - _HALF) / _TURN) + 1)
    if turns == range(1):
        return geometry
    maps = [shapely.transform(geometry, lambda places, by=turn: places - (_TURN * by, 0.0)) for turn in turns]
    cut = shapely.intersection(maps, shapely.box(-_HALF, -90.0, _HALF, 90.0))
    kind = geometry.geom_type.removeprefix("Multi")
    parts = [part for part in shapely.get_parts(cut) if part.geom_type == kind]
    return parts[0] if len(parts) == 1 else _OF_SEVERAL[kind](parts)


def continuous(degrees: FloatArray) -> FloatArray:
    """Longitudes and latitudes, shape (P, 2), that nowhere leap from one side of the antimeridian to the other."""
    # Whole turns, so that what was equal stays equal: rings are closed.
    turns = np.cumsum(np.round(np.diff(degrees[:, 0], prepend=degrees[:1, 0]) / _TURN))
    return np.stack((degrees[:, 0] - _TURN * turns, degrees[:, 1]), axis=1)
