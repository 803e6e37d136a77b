"""Map features as GPX 1.1: points as waypoints, lines as tracks; it knows no areas.

Elevations of GPX count from the sea, which nobody has asked here: heights above the ground stand in the descriptions.
"""

from collections.abc import Sequence
from typing import Final
from xml.etree import ElementTree as ET

import shapely

from mission.interchange.map_features import DIGITS, MapFeature, as_text, within_the_map
from mission.interchange.xml_text import xml_document, xml_text

_NAMESPACE: Final = "http://www.topografix.com/GPX/1/1"
_CREATOR: Final = "ltl-mission"


def gpx(name: str, features: Sequence[MapFeature]) -> bytes:
    """A GPX document of the features that are points or lines."""
    root = ET.Element("gpx", xmlns=_NAMESPACE, version="1.1", creator=_CREATOR)
    _text(ET.SubElement(root, "metadata"), "name", name)
    for feature in features:
        if feature.geometry.geom_type == "Point":
            _described(_place(root, "wpt", feature.geometry), feature)
    for feature in features:
        if feature.geometry.geom_type == "LineString":
            track = _described(ET.SubElement(root, "trk"), feature)
            for part in shapely.get_parts(within_the_map(feature.geometry)):
                segment = ET.SubElement(track, "trkseg")
                for corner in shapely.points(shapely.get_coordinates(part)):
                    _place(segment, "trkpt", corner)
    return xml_document(root)


def _place(parent: ET.Element, name: str, point: shapely.Point) -> ET.Element:
    inside = within_the_map(point)
    return ET.SubElement(parent, name, lat=f"{inside.y:.{DIGITS}f}", lon=f"{inside.x:.{DIGITS}f}")


def _described(element: ET.Element, feature: MapFeature) -> ET.Element:
    _text(element, "name", feature.name)
    above = "" if feature.height_m is None else f"{feature.height_m:g} m above the take-off"
    told = [above, *(f"{key}: {as_text(value)}" for key, value in feature.properties.items())]
    _text(element, "desc", ", ".join(filter(None, told)))
    _text(element, "type", feature.kind)
    return element


def _text(parent: ET.Element, name: str, text: str) -> None:
    ET.SubElement(parent, name).text = xml_text(text)
