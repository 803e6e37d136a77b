"""Text files of ArduPilot's ground stations: waypoints and fences in the form ``QGC WPL 110``, and older fences.

``QGC WPL`` has a line for each item: index, current, frame, command, four parameters, latitude, longitude, altitude,
autocontinue. The older form of a fence is a line ``latitude longitude`` for each point: the point to return to first,
then the corners, of which the last repeats the first. Rally points have lines that begin with ``RALLY``.
"""

from dataclasses import dataclass
from typing import Final

from mission.interchange.commands import (
    CIRCLE,
    FLOWN_THROUGH,
    POLYGON,
    RALLY_POINT,
    RETURN_POINT,
    SPEED,
    TAKEOFF,
    WAYPOINT,
    fenced,
)
from mission.interchange.features import Drawing, Feature, Point, Role, Spot, broken
from mission.interchange.rings import number, polygon

_COLUMNS: Final = 12
_ABSOLUTE: Final = 0
_LEAST_FENCE: Final = 4


@dataclass(frozen=True)
class _Item:
    line: int
    index: int
    frame: int
    command: int
    params: tuple[float, ...]
    at: Point
    altitude_m: float


def drawing_of_waypoints(text: str) -> Drawing:
    """The features of a file in the form ``QGC WPL 110``.

    Raises:
        SpecError: A line is no item, or a fence's polygon has not as many corners as it says.
    """
    items = [_item(line, row) for row, line in _rows(text)[1:]]
    features: list[Feature] = []
    waypoints: list[Point] = []
    altitudes: list[float] = []
    speeds: list[float] = []
    remarks: list[str] = []
    pending = list(reversed(items))
    while pending:
        item = pending.pop()
        feature = _feature(item, pending, len(features) + 1)
        if feature:
            features.append(feature)
        elif item.command in FLOWN_THROUGH and item.at != (0.0, 0.0):
            waypoints.append(item.at)
        elif item.command >= RETURN_POINT:
            remarks.append(f"line {item.line} is left out: nothing is known of a fence by command {item.command}")
        if item.command == SPEED:
            speeds.append(item.params[1])
        if item.command in FLOWN_THROUGH | {TAKEOFF} and item.frame != _ABSOLUTE:
            altitudes.append(item.altitude_m)
    return Drawing(
        "waypoint file",
        tuple(features),
        remarks=tuple(remarks),
        altitude_m=max((altitude for altitude in altitudes if altitude > 0.0), default=None),
        speed_m_s=max((speed for speed in speeds if speed > 0.0), default=None),
        route=tuple(waypoints),
    )


def _feature(item: _Item, pending: list[_Item], count: int) -> Feature | None:
    """The part of a fence, or the place, that begins with an item; None for what is flown."""
    if item.command in POLYGON:
        return _fence_polygon(item, pending, count)
    if item.command in CIRCLE:
        if item.params[0] <= 0.0:
            raise broken("the radius of the circle is not positive", line=item.line)
        name, role, reason = fenced("circle", CIRCLE[item.command], count)
        return Feature(name, (Spot(item.at, item.params[0]),), role, reason)
    if item.command == RALLY_POINT:
        return Feature(f"rally_{count}", (Spot(item.at),), Role.HOME, "a rally point")
    if item.command == RETURN_POINT:
        return Feature("return_point", (Spot(item.at),), Role.HOME, "the fence's return point")
    if item.command == WAYPOINT and item.index == 0 and item.frame == _ABSOLUTE:
        return Feature("home", (Spot(item.at),), Role.HOME, "the first line, home")
    return None


def drawing_of_fence(text: str) -> Drawing:
    """The features of an older fence file, or one of rally points.

    Raises:
        SpecError: A line has no position, or the corners are fewer than three.
    """
    rally: list[Point] = []
    points: list[Point] = []
    for row, line in _rows(text):
        words = line.split()
        mine = rally if words[0].upper() == "RALLY" else points
        values = _numbers(words[1:3] if mine is rally else words[:2], row)
        mine.append(_place(values[0], values[1], row))
    features = [Feature(f"rally_{i + 1}", (Spot(place),), Role.HOME, "a rally point") for i, place in enumerate(rally)]
    if points:
        if len(points) < _LEAST_FENCE:
            raise broken("a fence has a return point and at least three corners", "", line=len(text.splitlines()))
        name, role, reason = fenced("polygon", Role.BOUNDARY, 1)
        shape = polygon(points[1:], [], lambda message: broken(message, line=2))
        features.append(Feature(name, (shape,), role, reason))
        features.append(Feature("return_point", (Spot(points[0]),), Role.HOME, "the fence's return point"))
    return Drawing("fence file", tuple(features))


def is_fence(text: str) -> bool:
    """Whether the first line of a text is two numbers, or a rally point."""
    rows = _rows(text[:1000])
    words = rows[0][1].split() if rows else []
    try:
        return bool(words) and (words[0].upper() == "RALLY" or [float(word) for word in words[:2]] != [])
    except ValueError:
        return False


def _rows(text: str) -> list[tuple[int, str]]:
    """Lines with their numbers, without those that are empty or comments."""
    rows = [(row, line.strip()) for row, line in enumerate(text.splitlines(), start=1)]
    return [(row, line) for row, line in rows if line and not line.startswith("#")]


def _item(line: str, row: int) -> _Item:
    words = line.split("\t") if "\t" in line else line.split()
    if len(words) < _COLUMNS - 1:
        raise broken(f"an item has {_COLUMNS} columns, this one has {len(words)}", line=row)
    values = _numbers(words[: _COLUMNS - 1], row)
    index, _, frame, command = (int(value) for value in values[:4])
    at = _place(values[8], values[9], row) if values[8] or values[9] else (0.0, 0.0)
    return _Item(row, index, frame, command, tuple(values[4:8]), at, values[10])


def _fence_polygon(first: _Item, pending: list[_Item], count: int) -> Feature:
    """The polygon that begins with an item; its other corners are taken from those that follow."""
    corners = int(first.params[0])
    taken = [first]
    while len(taken) < corners and pending and pending[-1].command == first.command:
        taken.append(pending.pop())
    if len(taken) != corners:
        message = f"the polygon says that it has {corners} corners, {len(taken)} follow"
        raise broken(message, "the file may have been cut off", line=first.line)
    name, role, reason = fenced("polygon", POLYGON[first.command], count)
    shape = polygon([item.at for item in taken], [], lambda message: broken(message, line=first.line))
    return Feature(name, (shape,), role, reason)


def _numbers(words: list[str], row: int) -> list[float]:
    try:
        values = [number(float(word)) for word in words]
    except ValueError:
        values = [None]
    if len(values) < 2 or None in values:  # noqa: PLR2004 - latitude and longitude
        raise broken(f"expected numbers, found {' '.join(words)[:60]!r}", line=row)
    return [value for value in values if value is not None]


def _place(latitude: float, longitude: float, row: int) -> Point:
    if abs(latitude) > 90.0 or abs(longitude) > 180.0:  # noqa: PLR2004 - the globe
        raise broken(f"latitude {latitude} and longitude {longitude} are no place on Earth", line=row)
    return longitude, latitude
