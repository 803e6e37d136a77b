"""GPX (1.0 and 1.1) as receivers and map programs write it: marks, routes and tracks.

It knows no areas. A track or a route that comes back to where it began without crossing itself is the outline of one,
as somebody walked round it; any other is a way that was flown or walked, and no part of a mission.
"""

import math
from collections.abc import Iterator, Sequence
from typing import Final

import shapely

from mission.interchange.features import (
    OF_A_FLIGHT,
    PATH,
    TAKE_OFF,
    Drawing,
    Feature,
    Point,
    Polygon,
    Role,
    Spot,
    broken,
)
from mission.interchange.rings import LEAST_CORNERS, number, without_repeats
from mission.interchange.roles import role_of
from mission.interchange.xml_tree import Element

_CLOSED: Final = 0.03
"""How near to its begin the end of an outline is, of its length: receivers are some metres off."""


def drawing_of_gpx(tree: Element) -> Drawing:
    """The marks of a GPX text, the outlines that were walked, and the first way that is none.

    Args:
        tree: Above the outermost element.

    Raises:
        SpecError: A place in it is none, with its line.
    """
    root = tree.children[0]
    features: list[Feature] = []
    route: tuple[Point, ...] = ()
    start: Point | None = None
    remarks = []
    for mark in root.all("wpt"):
        if mark.value("type") == TAKE_OFF:
            start = _place(mark)
        if mark.value("type") not in OF_A_FLIGHT:
            features.append(_feature(mark, Spot(_place(mark))))
    for way, points in _ways(root):
        name = way.value("name") or f"line {way.line}"
        outline = _outline(points) if way.value("type") != PATH else None
        if outline is not None:
            features.append(_feature(way, outline))
        elif not route:
            route = points
        else:
            remarks.append(f"{name[:60]!r} is left out: it bounds nothing, and another one is taken for the flight")
    if start is not None:
        features.append(Feature("home", (Spot(start),), Role.HOME, "the take-off"))
    return Drawing("GPX", tuple(features), remarks=tuple(remarks), route=route)


def _ways(root: Element) -> Iterator[tuple[Element, tuple[Point, ...]]]:
    """Routes and tracks with their points; the segments of a track follow each other."""
    for way in root.all("rte", "trk"):
        parts = [way.all("rtept"), *(segment.all("trkpt") for segment in way.all("trkseg"))]
        points = tuple(without_repeats([_place(each) for part in parts for each in part]))
        if points:
            yield way, points


def _feature(element: Element, shape: Spot | Polygon) -> Feature:
    name = element.value("name")
    role, reason = role_of({"type": element.value("type")}, name, ())
    return Feature(name, (shape,), role, reason)


def _outline(points: Sequence[Point]) -> Polygon | None:
    """What a way goes round, if it comes back to its begin and does not cross itself."""
    if len(points) <= LEAST_CORNERS:
        return None
    east = math.cos(math.radians(points[0][1]))
    line = shapely.LineString([(east * longitude, latitude) for longitude, latitude in points])
    ring = shapely.Polygon(line)
    apart = math.dist(line.coords[0], line.coords[-1])
    if apart > _CLOSED * line.length or not ring.is_valid or ring.area == 0.0:
        return None
    return Polygon(tuple(points[:-1] if points[0] == points[-1] else points))


def _place(element: Element) -> Point:
    try:
        values = [number(float(element.attributes.get(key, ""))) for key in ("lon", "lat")]
    except ValueError:
        values = []
    if len(values) < 2 or values[0] is None or values[1] is None:  # noqa: PLR2004 - a place has two
        raise broken(f"<{element.name}> has no latitude and longitude", "write lat and lon", line=element.line)
    return values[0], values[1]
