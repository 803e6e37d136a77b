"""What the properties of a feature tell beside its role: measures, lanes, the round shape that a polygon stands for.

The names are those of the keys of a mission file. Values are text, several numbers with white space between them, for
KML knows nothing else.
"""

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Final

from mission.interchange.features import Camera, Drawing, Lanes, Line, Point, Polygon, Shape, Spot
from mission.interchange.map_features import as_text
from mission.interchange.rings import number

_PAIR: Final = 2


def told_by(properties: Any) -> dict[str, str]:  # noqa: ANN401 - any JSON value
    """Properties of GeoJSON as text, without those that are neither text nor numbers nor lists of numbers."""
    if not isinstance(properties, dict):
        return {}
    return {str(key): _text(value) for key, value in properties.items() if isinstance(value, str | int | float | list)}


def measure(told: Mapping[str, str], key: str) -> float | None:
    """A positive length, such as ``width_m`` or ``width``."""
    found = (_positive(told.get(name, "")) for name in (f"{key}_m", key))
    return next((value for value in found if value is not None), None)


def numbers(text: str) -> tuple[float, ...]:
    """Finite numbers with white space or commas between them; none where something else is among them."""
    try:
        values = [number(float(word)) for word in text.replace(",", " ").split()]
    except ValueError:
        return ()
    return tuple(value for value in values if value is not None) if None not in values else ()


def lanes_told(told: Mapping[str, str]) -> Lanes | None:
    """The lanes of a region to survey; None where neither their spacing nor a camera is told."""
    spacing_m, camera = _positive(told.get("spacing_m", "")), camera_told(told)
    if spacing_m is None and camera is None:
        return None
    heading = numbers(told.get("heading_deg", ""))
    return Lanes(spacing_m, heading[0] if len(heading) == 1 else None, camera, _share(told.get("share", "")))


def camera_told(told: Mapping[str, str]) -> Camera | None:
    """The camera of a survey; None where neither its view nor its sensor and lens are told."""
    view, sensor = (_pair(told.get(key, "")) for key in ("field_of_view_deg", "sensor_mm"))
    focal_mm = _positive(told.get("focal_length_mm", ""))
    overlap, sidelap = (_share(told.get(key, "")) for key in ("overlap", "sidelap"))
    if view is not None:
        return Camera(view, overlap=overlap, sidelap=sidelap)
    if sensor is None or focal_mm is None:
        return None
    return Camera(None, sensor, focal_mm, overlap, sidelap)


def with_flight(drawing: Drawing, told: Mapping[str, str], start: Point | None) -> Drawing:
    """A drawing with what an exported path tells of its flight."""
    tube, laps = numbers(told.get("tube_m", "")), told.get("laps", "").replace(" ", "_")
    return replace(
        drawing,
        altitude_m=_positive(told.get("altitude_m", "")),
        speed_m_s=_positive(told.get("speed_m_s", "")),
        start=start,
        formula=told.get("specification", ""),
        laps=laps if re.fullmatch("[1-9][0-9]{0,3}|until_stopped", laps) else "",
        cost=told.get("cost", ""),
        smoothing=told.get("smoothing", ""),
        tube_m=tube[0] if len(tube) == 1 and tube[0] >= 0.0 else None,
    )


def as_it_was_drawn(shapes: tuple[Shape, ...], told: Mapping[str, str]) -> tuple[Shape, ...]:
    """Shapes, of a polygon that stands for a circle or a strip that circle or strip: properties tell of it."""
    if not all(isinstance(shape, Polygon) for shape in shapes):
        return shapes
    centre, radius_m = numbers(told.get("centre", "")), measure(told, "radius")
    if len(centre) == _PAIR and radius_m:
        return (Spot((centre[0], centre[1]), radius_m),)
    line, width_m = numbers(told.get("line", "")), measure(told, "width")
    if len(line) >= 2 * _PAIR and len(line) % _PAIR == 0 and width_m:
        points: tuple[Point, ...] = tuple(zip(line[::2], line[1::2], strict=True))
        return (Line(points, width_m),)
    return shapes


def _text(value: Any) -> str:  # noqa: ANN401 - any JSON value
    if isinstance(value, list):
        return as_text(value)
    return value if isinstance(value, str) else "true" if value is True else "false" if value is False else str(value)


def positive(told: Mapping[str, str], key: str) -> float | None:
    """A positive number under a name."""
    return _positive(told.get(key, ""))


def _positive(text: str) -> float | None:
    values = numbers(text)
    return values[0] if len(values) == 1 and values[0] > 0.0 else None


def _share(text: str) -> float | None:
    values = numbers(text)
    return values[0] if len(values) == 1 and 0.0 <= values[0] <= 1.0 else None


def _pair(text: str) -> Point | None:
    values = numbers(text)
    return (values[0], values[1]) if len(values) == _PAIR and min(values) > 0.0 else None
