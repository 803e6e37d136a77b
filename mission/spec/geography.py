"""Missions on the Earth: latitudes and longitudes of a mission file in the metres of the mission's plane.

All works on the plain data of the file and leaves what a file in metres has, so that whatever comes after knows of
metres alone. Paths stay the same: findings stand where the file has its corners.
"""

import re
from collections.abc import Callable, Iterator
from typing import Any, Final

import numpy as np

from mission.decimals import decimal
from mission.errors import GeometryError
from mission.geometry.arrays import FloatArray
from mission.geometry.geodesy import PLANE_M, LatLon
from mission.geometry.places import enu_offsets_m, places_at_offsets
from mission.spec.finding import Finding, Path
from mission.spec.scale import pair

Data = dict[str, Any]

DEGREES: Final = "latitude_longitude"

_WITH_POINTS: Final = ("polygon", "polygons", "holes", "line", "centre", "at")
"""Keys of shapes whose values are points, or lists or mappings of them."""

_PLACE: Final = re.compile(r"\((-?[0-9.]+(?:e-?[0-9]+)?), (-?[0-9.]+(?:e-?[0-9]+)?)\)")
_DIGITS: Final = 7  # a centimetre

_POLE_DEG: Final = 89.9
_AROUND_DEG: Final = 180.0
_LARGEST: Final = 1e9
"""Larger numbers are a fault of their own."""


def in_degrees(data: Any) -> bool:  # noqa: ANN401 - any JSON value
    """Whether the corners of a mission are latitudes and longitudes."""
    domain = data.get("domain") if isinstance(data, dict) else None
    return isinstance(domain, dict) and domain.get("corners") == DEGREES


def origin_of(data: Data) -> LatLon | None:
    """The origin that a mission gives, None where it gives none that is sound."""
    origin = data.get("origin")
    try:
        return LatLon(float(origin["latitude_deg"]), float(origin["longitude_deg"])) if origin else None
    except (GeometryError, KeyError, TypeError, ValueError):
        return None


def middle_of(places_deg: FloatArray) -> LatLon:
    """The middle of the box around places, shape (N, 2), latitudes first; also across the antimeridian."""
    latitudes, longitudes = places_deg.T
    # Seen from the first, a box of less than half the globe is in one piece.
    beside = (longitudes - longitudes[0] + 180.0) % 360.0 - 180.0
    longitude = longitudes[0] + 0.5 * (beside.min() + beside.max())
    latitude = 0.5 * (latitudes.min() + latitudes.max())
    return LatLon(round(float(latitude), 7), round(float((longitude + 180.0) % 360.0 - 180.0), 7))


def in_metres(data: Data) -> tuple[Data, list[Finding]]:
    """The data of a mission in degrees as those of one in metres, or as they are and what is wrong with the degrees.

    Without an origin, the middle of the boundary, or of the nodes, is one.
    """
    lists = [found for path, value in _shapes(data) for found in _lists(value, path)]
    findings = [finding for path, places in lists for finding in _off_the_globe(path, places)]
    origin = origin_of(data)
    drawn = [places for path, places in lists if path[0] == "domain"]
    if findings or not (origin or ("origin" not in data and drawn)):
        return data, findings
    if origin is None:
        origin = middle_of(np.concatenate(drawn))
        data = {**data, "origin": {"latitude_deg": origin.latitude_deg, "longitude_deg": origin.longitude_deg}}
    findings = [finding for path, places in lists for finding in beyond_the_plane(origin, places, path)]
    return (data if findings else _converted(data, lambda places: enu_offsets_m(origin, places)[0])), findings


def told_in_degrees(text: str, origin: LatLon) -> str:
    """A message with its places, ``(12.5, -3)`` in metres from an origin, as latitudes and longitudes."""

    def told(found: re.Match[str]) -> str:
        if abs(float(found[1])) + abs(float(found[2])) > PLANE_M:
            return found[0]
        (place,) = places_at_offsets(origin, np.array([[float(found[1]), float(found[2])]])).tolist()
        return pair(np.round(place, _DIGITS))

    return _PLACE.sub(told, text)


def beyond_the_plane(origin: LatLon, places_deg: FloatArray, path: Path) -> Iterator[Finding]:
    """The place that lies farther from the origin than a mission may reach, of those in a list of a path, if one does.

    Args:
        origin: Of the mission.
        places_deg: Latitudes and longitudes, shape (N, 2).
        path: Of the list; of the place itself where there is only one.
    """
    _, apart = enu_offsets_m(origin, places_deg)
    worst = int(np.argmax(apart))
    if apart[worst] <= PLANE_M:
        return
    place = places_deg[worst]
    message = (
        f"{pair(place)} is {apart[worst] / 1000.0:.0f} km from the origin; the plane of a mission ends at "
        f"{PLANE_M / 1000.0:.0f} km"
    )
    hint = "move the origin there, or make several missions of it"
    if abs(place[1]) <= _POLE_DEG and enu_offsets_m(origin, places_deg[:, ::-1])[1].max() <= PLANE_M:
        hint = f"write the latitude first, {pair(place[::-1])}"
    yield Finding(path if len(places_deg) == 1 else (*path, worst), message, hint)


def far_from_origin(data: Any) -> Finding | None:  # noqa: ANN401 - any JSON value
    """Of a domain in metres that lies beyond the plane of its origin, as eastings and northings do; None of others."""
    if not isinstance(data, dict) or in_degrees(data) or origin_of(data) is None:
        return None
    try:
        drawn = [found for path, value in _shapes(data) for found in _lists(value, path) if path[0] == "domain"]
    except OverflowError:
        return None  # no number for an array, and a fault of its own
    reach = max((float(np.hypot(*places.T).max()) for _, places in drawn), default=0.0)
    if not PLANE_M < reach < np.inf:
        return None
    points = np.concatenate([places for _, places in drawn])
    zero = np.floor(points.min(axis=0))
    message = (
        f"the domain reaches {reach / 1000.0:.0f} km from the origin; the plane of a mission ends at "
        f"{PLANE_M / 1000.0:.0f} km"
    )
    hint = (
        f"if these are eastings and northings, leave `origin` out; or let it be the place at {pair(zero)} and subtract "
        f"that from every point of the file, {pair(points[0])} is then {pair(points[0] - zero)}"
    )
    return Finding(drawn[0][0], message, hint)


def _shapes(data: Data) -> Iterator[tuple[Path, Any]]:
    """Whatever has points, with its path."""
    domain, regions, start = (data.get(key) for key in ("domain", "regions", "start"))
    for key in ("boundary", "nodes"):
        if isinstance(domain, dict) and key in domain:
            yield ("domain", key), domain[key]
    for name, region in regions.items() if isinstance(regions, dict) else ():
        yield ("regions", name), region
    if isinstance(start, dict):
        yield ("start", "position_m"), start.get("position_m")


def _lists(value: Any, path: Path) -> Iterator[tuple[Path, FloatArray]]:  # noqa: ANN401 - any JSON value
    """Every list of points, and every point that stands alone, as arrays of shape (N, 2)."""
    if isinstance(value, dict):
        for key in _WITH_POINTS:
            yield from _lists(value.get(key), (*path, key))
    elif _is_point(value) or (isinstance(value, list) and value and all(map(_is_point, value))):
        yield path, np.array(value, dtype=np.float64).reshape(-1, 2)
    elif isinstance(value, list):
        for i, item in enumerate(value):
            yield from _lists(item, (*path, i))


def _is_point(value: Any) -> bool:  # noqa: ANN401 - any JSON value
    return (
        isinstance(value, list)
        and len(value) == 2  # noqa: PLR2004 - the plane
        and all(type(each) in (int, float) and abs(each) <= _LARGEST for each in value)
    )


def _off_the_globe(path: Path, places: FloatArray) -> Iterator[Finding]:
    """The first of a list of places that is none on Earth, or too near to a pole to have a plane."""
    off = np.flatnonzero((np.abs(places) > (_POLE_DEG, _AROUND_DEG)).any(axis=1))
    if len(off):
        place = places[off[0]]
        message = f"{pair(place)} is no latitude, {decimal(-_POLE_DEG)} to {decimal(_POLE_DEG)}, and longitude"
        swapped = abs(place[1]) <= _POLE_DEG and abs(place[0]) <= _AROUND_DEG
        hint = f"write the latitude first, {pair(place[::-1])}" if swapped else "write [latitude, longitude] in degrees"
        yield Finding(path if len(places) == 1 else (*path, int(off[0])), message, hint)


def _converted(data: Data, metres: Callable[[FloatArray], FloatArray]) -> Data:
    def value_of(value: Any) -> Any:  # noqa: ANN401 - any JSON value
        if isinstance(value, dict):
            return {key: value_of(each) if key in _WITH_POINTS else each for key, each in value.items()}
        if _is_point(value):
            return metres(np.array([value], dtype=np.float64))[0].tolist()
        if isinstance(value, list) and value and all(map(_is_point, value)):
            return metres(np.array(value, dtype=np.float64)).tolist()
        return [value_of(item) for item in value] if isinstance(value, list) else value

    domain = {key: value_of(value) if key in ("boundary", "nodes") else value for key, value in data["domain"].items()}
    changed = {**data, "domain": {key: value for key, value in domain.items() if key != "corners"}}
    if isinstance(data.get("regions"), dict):
        changed["regions"] = {name: value_of(region) for name, region in data["regions"].items()}
    if isinstance(data.get("start"), dict) and "position_m" in data["start"]:
        changed["start"] = {**data["start"], "position_m": value_of(data["start"]["position_m"])}
    return changed
