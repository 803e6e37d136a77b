"""A file's bytes as a drawing, by what is in it: its name says nothing."""

from dataclasses import replace
from typing import Any, Final

from mission.errors import SpecError
from mission.interchange.antimeridian import joined
from mission.interchange.features import Drawing, broken
from mission.interchange.geojson import drawing_of_geojson
from mission.interchange.gpx import drawing_of_gpx
from mission.interchange.json_text import decoded_json
from mission.interchange.kml import drawing_of_kml, kml_of_kmz
from mission.interchange.plan_file import drawing_of_plan
from mission.interchange.rings import MOST_POSITIONS
from mission.interchange.rings_file import RINGS, drawing_of_rings
from mission.interchange.waypoints import drawing_of_fence, drawing_of_waypoints, is_fence
from mission.interchange.xml_tree import xml_tree

MAX_BYTES: Final = 1 << 24
"""The size of a file, and of what a KMZ archive holds."""

FORMATS: Final = "GeoJSON, KML, KMZ, GPX, a QGroundControl plan, and waypoints or fences of ArduPilot's ground stations"


def read_drawing(content: bytes, source: str = "", *, in_metres: bool | None = None) -> Drawing:
    """What a file draws.

    Args:
        content: Its bytes.
        source: Where they come from, for messages.
        in_metres: Whether coordinates of GeoJSON are metres; None tells it from them.

    Raises:
        SpecError: It is of no format that is known, too large, or broken; with the place of the fault.
    """
    try:
        return _read(content, in_metres=in_metres)
    except SpecError as error:
        raise SpecError(error.faults, source) from None


def _read(content: bytes, *, in_metres: bool | None) -> Drawing:
    if len(content) > MAX_BYTES:
        raise broken(f"the file is larger than {MAX_BYTES} bytes", "save what the mission needs alone")
    start = content[:1000].removeprefix(b"\xef\xbb\xbf").lstrip()
    if content.startswith(b"PK\x03\x04"):
        text, remarks = kml_of_kmz(content, MAX_BYTES)
        drawing = drawing_of_kml(xml_tree(text), "KMZ")
        drawing = replace(drawing, remarks=remarks + drawing.remarks)
    elif start.startswith(b"<") or content.startswith((b"\xff\xfe", b"\xfe\xff")):
        tree = xml_tree(content)
        drawing = drawing_of_gpx(tree) if tree.children[0].name == "gpx" else drawing_of_kml(tree)
    elif start.startswith((b"{", b"[")):
        drawing = _of_json(decoded_json(content), in_metres=in_metres)
    else:
        drawing = _of_text(content)
    if not drawing.features and not drawing.route:
        raise broken("the file draws nothing: no polygon, line or point is in it", "; ".join(drawing.remarks[:3]))
    points = drawing.points()
    if len(points) > MOST_POSITIONS:
        raise broken(f"the file has {len(points)} positions, more than {MOST_POSITIONS}", "simplify its outlines")
    if drawing.in_degrees:
        for longitude, latitude in points:
            if not _is_on_earth(longitude, latitude):
                swapped = all(_is_on_earth(north, east) for east, north in points)
                why = ": they are the other way round here" if swapped else ""
                hint = f"degrees are expected, the longitude first in GeoJSON and KML{why}"
                raise broken(f"longitude {longitude}, latitude {latitude} is no place on Earth", hint)
    return joined(drawing) if drawing.in_degrees else drawing


def _is_on_earth(longitude: float, latitude: float) -> bool:
    """Whether this is a place; beyond the antimeridian, longitudes may go on."""
    return abs(longitude) <= 360.0 and abs(latitude) <= 90.0  # noqa: PLR2004 - the globe


def _of_json(data: Any, *, in_metres: bool | None) -> Drawing:  # noqa: ANN401 - any JSON value
    if isinstance(data, dict) and data.get("fileType") == "Plan":
        return drawing_of_plan(data)
    if isinstance(data, dict) and isinstance(data.get("type"), str):
        return drawing_of_geojson(data, in_metres=in_metres)
    raise broken("this JSON is neither GeoJSON nor a QGroundControl plan", f"read are {FORMATS}")


def _of_text(content: bytes) -> Drawing:
    text = content.decode("utf-8-sig", "replace")
    if text.startswith("QGC WPL"):
        return drawing_of_waypoints(text)
    if is_fence(text):
        return drawing_of_fence(text)
    if RINGS.search(text):
        return drawing_of_rings(text)
    raise broken("the file is of no format that is known", f"read are {FORMATS}")
