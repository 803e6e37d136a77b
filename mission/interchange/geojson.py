"""GeoJSON (RFC 7946) as QGIS, geojson.io and others write it; also its older form with a ``crs``."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any, Final

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
from mission.interchange.json_text import Json, member, point, points
from mission.interchange.rings import line_or_ring, polygon
from mission.interchange.roles import role_of
from mission.interchange.told import as_it_was_drawn, lanes_told, measure, positive, told_by, with_flight

_DEPTH: Final = 8
_WGS_84: Final = ("CRS84", "EPSG::4326", "EPSG:4326", "4979", "WGS84", "WGS 84")
_NAME_KEYS: Final = ("name", "title", "label", "id", "fid")


def drawing_of_geojson(data: Json, *, in_metres: bool | None = None) -> Drawing:
    """The features of a GeoJSON value: a collection, a feature, or a geometry alone.

    Args:
        data: The value.
        in_metres: Whether coordinates are metres; None tells it from them: wider than a degree, and outside the globe
            or about 0, 0, where there is only sea. Nobody flies over an area of a degree, which is a hundred
            kilometres, or in one of a metre.

    Raises:
        SpecError: Something in it is no GeoJSON, with its path.
    """
    if not in_metres:
        _check_system(data.get("crs"))
    kind, layer = data.get("type"), data.get("name")
    remarks: list[str] = []
    features, left_out = [], 0
    flight: dict[str, str] = {}
    start: Point | None = None
    if kind == "FeatureCollection":
        entries = [(each, f"features[{i}]") for i, each in enumerate(member(data, "features", list, ""))]
    else:
        entries = [(data if kind == "Feature" else {"geometry": data, "properties": None}, "")]
    for value, path in entries:
        if not isinstance(value, dict):
            raise broken("expected a feature", path=path)
        told = told_by(value.get("properties"))
        if told.get("kind") in OF_A_FLIGHT:
            left_out += 1
            flight |= told if told["kind"] == PATH else {}
            if told["kind"] == TAKE_OFF:
                start = point(member(value.get("geometry"), "coordinates", list, f"{path}.geometry"), path)
            continue
        feature = _feature(value, path, layer if isinstance(layer, str) else "")
        if feature:
            features.append(feature)
        else:
            remarks.append(f"{path or 'the feature'} has no geometry")
    remarks += flight_left_out(left_out)
    drawing = with_flight(Drawing("GeoJSON", tuple(features), remarks=tuple(remarks)), flight, start)
    return replace(drawing, in_degrees=not (_in_metres(drawing.points()) if in_metres is None else in_metres))


def _feature(value: dict[str, Json], path: str, layer: str) -> Feature | None:
    told = told_by(value.get("properties"))
    lower = {key.lower(): text for key, text in told.items()} | {"id": str(value.get("id") or told.get("id") or "")}
    geometry = value.get("geometry")
    if geometry is None:
        return None
    shapes = tuple(_shapes(geometry, f"{path}.geometry" if path else "geometry", measure(lower, "width"), 0))
    if not shapes:
        return None
    name = next((lower[key] for key in _NAME_KEYS if lower.get(key)), "")
    role, reason = role_of(told, name, [layer], fill=lower.get("fill", "").lstrip("#"))
    radius_m = measure(lower, "radius")
    shapes = tuple(Spot(shape.centre, radius_m) if isinstance(shape, Spot) else shape for shape in shapes)
    return Feature(
        name,
        as_it_was_drawn(shapes, lower),
        role,
        reason,
        measure(lower, "height"),
        lanes_told(lower),
        positive(lower, "clearance_m") or 0.0,
        positive(lower, "loiter_s") or 0.0,
    )


def _shapes(geometry: Json, path: str, width_m: float | None, depth: int) -> Iterator[Shape]:
    kind = member(geometry, "type", str, path)
    if kind == "GeometryCollection" and depth < _DEPTH:
        for i, each in enumerate(member(geometry, "geometries", list, path)):
            yield from _shapes(each, f"{path}.geometries[{i}]", width_m, depth + 1)
        return
    reader = _READERS.get(kind.removeprefix("Multi"))
    if reader is None:
        raise broken(f"`{kind[:40]}` is no kind of geometry", path=path)
    coordinates = member(geometry, "coordinates", list, path)
    inner = f"{path}.coordinates"
    several = kind.startswith("Multi")
    for i, part in enumerate(coordinates if several else [coordinates]):
        if part != []:  # empty coordinates are no geometry, says the standard
            yield reader(part, f"{inner}[{i}]" if several else inner, width_m)


def _polygon(value: Json, path: str, _: float | None) -> Shape:
    if not isinstance(value, list):
        raise broken("expected the rings of a polygon", path=path)
    rings = [points(ring, f"{path}[{i}]") for i, ring in enumerate(value)]
    return polygon(rings[0], rings[1:], lambda message: broken(message, path=path))


def _line(value: Json, path: str, width_m: float | None) -> Shape:
    return line_or_ring(points(value, path), width_m, lambda message: broken(message, path=path))


_READERS: Final[dict[str, Callable[[Json, str, float | None], Shape]]] = {
    "Polygon": _polygon,
    "LineString": _line,
    "Point": lambda value, path, _: Spot(point(value, path)),
}


def _check_system(system: Any) -> None:  # noqa: ANN401 - any JSON value
    """Refuse a coordinate reference system that is named and is not WGS 84."""
    properties = system.get("properties") if isinstance(system, dict) else None
    name = properties.get("name") if isinstance(properties, dict) else None
    if isinstance(name, str) and not any(known in name for known in _WGS_84):
        raise broken(
            f"the coordinates are in {name[:60]}, not in WGS 84",
            "save the file in EPSG:4326 (WGS 84)",
            path="crs.properties.name",
        )


def _in_metres(points: list[Point]) -> bool:
    if not points:
        return False
    west, east = min(x for x, _ in points), max(x for x, _ in points)
    south, north = min(y for _, y in points), max(y for _, y in points)
    outside = max(-west, east) > 180.0 or max(-south, north) > 90.0  # noqa: PLR2004 - the globe
    wide = max(east - west, north - south) > 1.0
    return wide and (outside or (west <= 0.0 <= east and south <= 0.0 <= north))
