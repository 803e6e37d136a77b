"""KML (OGC 07-147r2 and Google's extensions) as Google Earth, QGIS and others write it, and KMZ around it.

Read are placemarks with polygons, lines, tracks, points and geometries of several, their folders, styles and extended
data. Links to other files are never followed.
"""

import zipfile
import zlib
from collections.abc import Callable, Iterator
from dataclasses import replace
from io import BytesIO
from typing import Final

from mission.interchange.features import (
    OF_A_FLIGHT,
    PATH,
    TAKE_OFF,
    Drawing,
    Feature,
    Point,
    Shape,
    Spot,
    broken,
    flight_left_out,
)
from mission.interchange.rings import line_or_ring, number, polygon
from mission.interchange.roles import role_of
from mission.interchange.told import as_it_was_drawn, lanes_told, measure, positive, with_flight
from mission.interchange.xml_tree import Element

_CONTAINERS: Final = ("Document", "Folder")
_LINKS: Final = ("NetworkLink", "GroundOverlay", "PhotoOverlay", "ScreenOverlay")
_NAME_KEYS: Final = ("name", "title", "label", "id")
_LEAST_PARTS: Final = 2
_COLOUR: Final = 8
_MOST_NAMED: Final = 3


def drawing_of_kml(tree: Element, kind: str = "KML") -> Drawing:
    """The placemarks of a KML text.

    Args:
        tree: Above the outermost element.
        kind: Of the file, for people.

    Raises:
        SpecError: It is no KML, or a coordinate in it is none, with its line.
    """
    root = tree.children[0]
    if root.name != "kml":
        raise broken(
            f"the outermost element is <{root.name[:40]}>, not <kml> or <gpx>, and no other XML is read", line=root.line
        )
    styles = {f"#{each.attributes['id']}": each for each in _styles(root)}
    features: list[Feature] = []
    remarks: list[str] = []
    left_out = 0
    flight: dict[str, str] = {}
    start: Point | None = None
    for element, folders in _placed(root, ()):
        told = _properties(element) if element.name == "Placemark" else {}
        if told.get("kind") in OF_A_FLIGHT:
            left_out += 1
            flight |= told if told["kind"] == PATH else {}
            place = element.first("Point")
            if told["kind"] == TAKE_OFF and place is not None:
                start = _spot(place, None, []).centre
            continue
        if element.name == "Placemark":
            feature = _feature(element, folders, styles)
            features.extend([feature] if feature else [])
        if element.name != "Placemark" or not feature:
            what = element.value("name") or f"line {element.line}"
            remarks.append(f"the {element.name} {what[:60]!r} has no shape here; links are not followed")
    remarks += flight_left_out(left_out)
    if flight:
        # Walls in a picture of a flight are as high as that, not as what they stand for.
        features = [replace(feature, height_m=None) for feature in features]
    return with_flight(Drawing(kind, tuple(features), remarks=tuple(remarks)), flight, start)


def kml_of_kmz(content: bytes, most_bytes: int) -> tuple[bytes, tuple[str, ...]]:
    """The main KML text of a KMZ archive, ``doc.kml`` or the first that there is, and remarks on the others.

    Args:
        content: The archive.
        most_bytes: As large the text may be.

    Raises:
        SpecError: It is no such archive, or the text is larger.
    """
    try:
        with zipfile.ZipFile(BytesIO(content)) as archive:
            # Files like ._doc.kml are what one system notes about files, for itself.
            names = [
                name
                for name in archive.namelist()
                if name.lower().endswith(".kml") and not name.rpartition("/")[2].startswith("._")
            ]
            if not names:
                raise broken("the archive has no .kml file in it")
            main = next((name for name in names if name.lower() == "doc.kml"), names[0])
            with archive.open(main) as file:
                text = file.read(most_bytes + 1)
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, ValueError, OSError) as error:
        raise broken(f"this is no KMZ archive: {error}", "the file may have been cut off, or need a password") from None
    if len(text) > most_bytes:
        raise broken(f"{main[:60]} in the archive is larger than {most_bytes} bytes")
    others = [f"{name[:60]} in the archive is left out, {main[:60]} is read" for name in names if name != main]
    return text, tuple(others[:_MOST_NAMED]) + (("and so are more",) if len(others) > _MOST_NAMED else ())


def _placed(parent: Element, folders: tuple[str, ...]) -> Iterator[tuple[Element, tuple[str, ...]]]:
    """Placemarks, links and overlays, with the names of the folders that they lie in."""
    # Recursion is safe: the tree's depth is bounded.
    for child in parent.children:
        if child.name in _CONTAINERS:
            yield from _placed(child, (*folders, child.value("name")))
        elif child.name == "Placemark" or child.name in _LINKS:
            yield child, folders


def _styles(parent: Element) -> Iterator[Element]:
    for child in parent.children:
        if child.name in ("Style", "StyleMap") and "id" in child.attributes:
            yield child
        elif child.name in _CONTAINERS:
            yield from _styles(child)


def _feature(mark: Element, folders: tuple[str, ...], styles: dict[str, Element]) -> Feature | None:
    told = _properties(mark)
    lower = {key.lower(): text for key, text in told.items()}
    width_m, radius_m = measure(lower, "width"), measure(lower, "radius")
    heights: list[float] = []
    shapes = [
        Spot(shape.centre, radius_m) if isinstance(shape, Spot) else shape for shape in _shapes(mark, width_m, heights)
    ]
    if not shapes:
        return None
    name = mark.value("name") or next((lower[key] for key in _NAME_KEYS if lower.get(key)), "")
    style, fill = _style(mark, styles)
    role, reason = role_of(told, name, folders, style, fill)
    height_m = measure(lower, "height") or max(heights, default=0.0)
    return Feature(
        name,
        as_it_was_drawn(tuple(shapes), lower),
        role,
        reason,
        height_m if height_m > 0.0 else None,
        lanes_told(lower),
        positive(lower, "clearance_m") or 0.0,
        positive(lower, "loiter_s") or 0.0,
    )


def _shapes(parent: Element, width_m: float | None, heights: list[float]) -> Iterator[Shape]:
    for child in parent.children:
        if child.name in ("MultiGeometry", "MultiTrack"):
            yield from _shapes(child, width_m, heights)
        elif child.name in _READERS:
            reaching: list[float] = []
            yield _READERS[child.name](child, width_m, reaching)
            # Of what is clamped to the ground, the third coordinate means nothing.
            heights.extend(reaching if child.value("altitudeMode") in ("relativeToGround", "absolute") else ())


def _polygon(element: Element, _: float | None, heights: list[float]) -> Shape:
    outer = element.first("outerBoundaryIs", "LinearRing")
    if outer is None:
        raise broken("the polygon has no outer boundary", line=element.line)
    inner = [ring for each in element.all("innerBoundaryIs") for ring in each.all("LinearRing")]
    return polygon(
        _coordinates(outer, heights),
        [_coordinates(ring, heights) for ring in inner],
        lambda message: broken(message, line=element.line),
    )


def _line(element: Element, width_m: float | None, heights: list[float]) -> Shape:
    points = _track(element, heights) if element.name == "Track" else _coordinates(element, heights)
    return line_or_ring(points, width_m, lambda message: broken(message, line=element.line))


def _spot(element: Element, _: float | None, heights: list[float]) -> Spot:
    points = _coordinates(element, heights)
    if len(points) != 1:
        raise broken(f"a point has one position, not {len(points)}", line=element.line)
    return Spot(points[0])


_READERS: Final[dict[str, Callable[[Element, float | None, list[float]], Shape]]] = {
    "Polygon": _polygon,
    "LineString": _line,
    "LinearRing": _line,
    "Track": _line,
    "Point": _spot,
}


def _coordinates(parent: Element, heights: list[float]) -> list[Point]:
    """Positions like ``8.54,47.37,12``, with white space between them; some programs put it behind commas, too."""
    element = parent.first("coordinates")
    if element is None:
        raise broken(f"<{parent.name}> has no <coordinates>", line=parent.line)
    tuples = ",".join(part.strip() for part in element.text.split(",")).split()
    return [_position(text.split(","), text, element.line, heights) for text in tuples]


def _track(element: Element, heights: list[float]) -> list[Point]:
    return [_position(each.text.split(), each.text, each.line, heights) for each in element.all("coord")]


def _position(parts: list[str], text: str, line: int, heights: list[float]) -> Point:
    try:
        values = [number(float(part)) for part in parts]
    except ValueError:
        values = []
    if len(values) < _LEAST_PARTS or values[0] is None or values[1] is None:
        raise broken(f"{text.strip()[:40]!r} is no position", "write longitude,latitude", line=line)
    if len(values) > _LEAST_PARTS and values[_LEAST_PARTS] is not None:
        heights.append(values[_LEAST_PARTS] or 0.0)
    return values[0], values[1]


def _properties(mark: Element) -> dict[str, str]:
    """Extended data, both of ``Data`` and of ``SchemaData``."""
    extended = mark.first("ExtendedData")
    if extended is None:
        return {}
    told = {each.attributes.get("name", ""): each.value("value") for each in extended.all("Data")}
    for schema in extended.all("SchemaData"):
        told |= {each.attributes.get("name", ""): each.text.strip() for each in schema.all("SimpleData")}
    return {key: value for key, value in told.items() if value}


def _style(mark: Element, styles: dict[str, Element]) -> tuple[str, str]:
    """Name and fill colour, ``rrggbb``, of a placemark's style, through the map that Google Earth puts before it."""
    name = mark.value("styleUrl")
    style = mark.first("Style") or styles.get(name)
    if style is not None and style.name == "StyleMap":
        pairs = style.all("Pair")
        normal = next((pair for pair in pairs if pair.value("key") == "normal"), None)
        style = (normal.first("Style") or styles.get(normal.value("styleUrl"))) if normal else None
    colour = style.value("PolyStyle", "color") if style is not None else ""
    filled = style is not None and style.value("PolyStyle", "fill") != "0"
    # Alpha, blue, green, red: the other way round than anywhere else.
    fill = colour[6:8] + colour[4:6] + colour[2:4] if filled and len(colour) == _COLOUR else ""
    return name.lstrip("#"), fill
