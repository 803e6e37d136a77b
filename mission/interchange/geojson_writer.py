"""Map features as GeoJSON (RFC 7946), with the colours of simplestyle, which geojson.io and GitHub show."""

import json
from collections.abc import Sequence
from typing import Any, Final

import numpy as np
import shapely
from shapely.geometry.polygon import orient

from mission.interchange.map_features import DIGITS, MapFeature, within_the_map

_FILL: Final = 0.3


def geojson(name: str, features: Sequence[MapFeature]) -> bytes:
    """A feature collection; polygons are counter-clockwise, places in longitude and latitude."""
    document = {"type": "FeatureCollection", "name": name, "features": [_feature(each) for each in features]}
    return (json.dumps(document, allow_nan=False) + "\n").encode()


def _feature(feature: MapFeature) -> dict[str, Any]:
    geometry = shapely.transform(within_the_map(feature.geometry), lambda places: np.round(places, DIGITS))
    if isinstance(geometry, shapely.Polygon):
        geometry = orient(geometry)
    elif isinstance(geometry, shapely.MultiPolygon):
        geometry = shapely.MultiPolygon([orient(part) for part in geometry.geoms])
    told: dict[str, Any] = {"name": feature.name, "kind": feature.kind, **feature.properties}
    if isinstance(geometry, shapely.Polygon | shapely.MultiPolygon):
        # How high it is drawn elsewhere says nothing of how high it is.
        told |= {"stroke": feature.colour, "fill": feature.colour, "fill-opacity": _FILL if feature.filled else 0.0}
    else:
        told["stroke" if geometry.geom_type.endswith("LineString") else "marker-color"] = feature.colour
        told |= {} if feature.height_m is None else {"height_m": feature.height_m}
    return {
        "type": "Feature",
        "properties": told,
        "geometry": shapely.geometry.mapping(geometry),
    }
