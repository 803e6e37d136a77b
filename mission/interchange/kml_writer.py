"""Map features as KML 2.2 in three dimensions, and as KMZ, its archive; Google Earth shows both.

What has a height stands on the ground like a curtain or a wall: the path, and what is not to be entered. All else lies
on the ground. Colours are aabbggrr (https://developers.google.com/kml/documentation/kmlreference#colorstyle).
"""

import io
import zipfile
from collections.abc import Sequence
from itertools import groupby
from typing import Final
from xml.etree import ElementTree as ET

import shapely

from mission.interchange.map_features import DIGITS, MapFeature, as_text, within_the_map
from mission.interchange.xml_text import xml_document, xml_text

_NAMESPACE: Final = "http://www.opengis.net/kml/2.2"
_OPAQUE, _CURTAIN, _WALL, _GROUND, _HOLLOW = "ff", "50", "70", "60", "00"
_LINE_WIDTH: Final = "3"
_FIRST_DAY_OF_ZIP: Final = (1980, 1, 1, 0, 0, 0)


def kml(name: str, features: Sequence[MapFeature]) -> bytes:
    """A document with a folder for each group of features in a row."""
    root = ET.Element("kml", xmlns=_NAMESPACE)
    document = ET.SubElement(root, "Document")
    _text(document, "name", name)
    kinds = {feature.kind: feature for feature in features}
    for kind, feature in kinds.items():
        document.append(_style(kind, feature))
    for group, members in groupby(features, key=lambda feature: feature.group):
        folder = ET.SubElement(document, "Folder")
        _text(folder, "name", group)
        for feature in members:
            folder.append(_placemark(feature))
    return xml_document(root)


def kmz(name: str, features: Sequence[MapFeature]) -> bytes:
    """The same in an archive, the same bytes for the same features."""
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w") as file:
        entry = zipfile.ZipInfo("doc.kml", _FIRST_DAY_OF_ZIP)
        entry.compress_type = zipfile.ZIP_DEFLATED
        file.writestr(entry, kml(name, features))
    return archive.getvalue()


def _style(kind: str, feature: MapFeature) -> ET.Element:
    style = ET.Element("Style", id=kind)
    red, green, blue = (feature.colour[i : i + 2] for i in (1, 3, 5))
    of_area = feature.geometry.geom_type.endswith("Polygon")
    fill = _HOLLOW if not feature.filled else _GROUND if feature.height_m is None else _WALL if of_area else _CURTAIN
    for element, alpha, width in (
        ("IconStyle", _OPAQUE, ""),
        ("LineStyle", _OPAQUE, _LINE_WIDTH),
        ("PolyStyle", fill, ""),
    ):
        part = ET.SubElement(style, element)
        _text(part, "color", (alpha + blue + green + red).lower())
        if width:
            _text(part, "width", width)
    return style


def _placemark(feature: MapFeature) -> ET.Element:
    placemark = ET.Element("Placemark")
    _text(placemark, "name", feature.name)
    _text(placemark, "styleUrl", f"#{feature.kind}")
    told = {"kind": feature.kind, **feature.properties}
    data = ET.SubElement(placemark, "ExtendedData")
    for key, value in told.items():
        _text(ET.SubElement(data, "Data", name=key), "value", as_text(value))
    geometry = within_the_map(feature.geometry)
    parts = shapely.get_parts(geometry)
    holder = ET.SubElement(placemark, "MultiGeometry") if len(parts) > 1 else placemark
    for part in parts:
        holder.append(_geometry(part, feature.height_m))
    return placemark


def _geometry(part: shapely.Geometry, height_m: float | None) -> ET.Element:
    element = ET.Element(part.geom_type)
    if height_m is not None:
        _text(element, "extrude", "1")
    elif part.geom_type != "Point":
        _text(element, "tessellate", "1")
    _text(element, "altitudeMode", "clampToGround" if height_m is None else "relativeToGround")
    if isinstance(part, shapely.Polygon):
        for name, ring in [("outerBoundaryIs", part.exterior), *(("innerBoundaryIs", hole) for hole in part.interiors)]:
            _coordinates(ET.SubElement(ET.SubElement(element, name), "LinearRing"), ring, height_m)
    else:
        _coordinates(element, part, height_m)
    return element


def _coordinates(parent: ET.Element, line: shapely.Geometry, height_m: float | None) -> None:
    height = "" if height_m is None else f",{height_m:g}"
    places = shapely.get_coordinates(line).tolist()
    _text(parent, "coordinates", " ".join(f"{east:.{DIGITS}f},{north:.{DIGITS}f}{height}" for east, north in places))


def _text(parent: ET.Element, name: str, text: str) -> None:
    ET.SubElement(parent, name).text = xml_text(text)
