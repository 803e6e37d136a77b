"""QGroundControl's plans: geofence, survey and corridor items, waypoints, planned home and rally points."""

from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any, Final

from mission.interchange.commands import FLOWN_THROUGH, SPEED, TAKEOFF, fenced
from mission.interchange.features import Drawing, Feature, Point, Role, Shape, Spot, broken
from mission.interchange.json_text import Json, member, point, points
from mission.interchange.rings import line, number, polygon
from mission.interchange.survey_items import lanes_of

_LATITUDE: Final = 4
_ALTITUDE: Final = 6
_HERE: Final = [0.0, 0.0]
"""In the place of latitude and longitude: where the vehicle is."""


def drawing_of_plan(data: Json) -> Drawing:
    """The features of a ``.plan``.

    Raises:
        SpecError: A position or a polygon in it is none, with its path.
    """
    mission = member(data, "mission", dict, "")
    remarks: list[str] = []
    features = list(_fence(data.get("geoFence")))
    altitudes: list[float] = []
    speed = number(mission.get("hoverSpeed"))
    waypoints: list[Point] = []
    for i, item in enumerate(member(mission, "items", list, "mission")):
        path = f"mission.items[{i}]"
        if member(item, "type", str, path) == "ComplexItem":
            features.extend(_complex(item, path, features, altitudes, remarks))
            continue
        command, values = item.get("command"), _params(item)
        if command == SPEED and len(values) > 1 and (values[1] or 0.0) > 0.0:
            speed = values[1]
        if command in FLOWN_THROUGH | {TAKEOFF} and len(values) > _ALTITUDE and values[_ALTITUDE] is not None:
            altitudes.append(values[_ALTITUDE] or 0.0)
        if command in FLOWN_THROUGH and values[_LATITUDE:_ALTITUDE] != _HERE:
            waypoints.append(point(values[_LATITUDE:_ALTITUDE], f"{path}.params", latitude_first=True))
    features.extend(_homes(data, mission))
    return Drawing(
        "QGroundControl plan",
        tuple(features),
        remarks=tuple(remarks),
        altitude_m=max((altitude for altitude in altitudes if altitude > 0.0), default=None),
        speed_m_s=speed if speed and speed > 0.0 else None,
        route=tuple(waypoints),
    )


def _params(item: dict[str, Any]) -> list[float | None]:
    """The parameters of an item, its place the last three: older versions have this apart, as ``coordinate``."""
    params, place = item.get("params"), item.get("coordinate")
    if not isinstance(params, list):
        params = [item.get(f"param{i}") for i in range(1, _LATITUDE + 1)]
    if len(params) == _LATITUDE and isinstance(place, list):
        params = params + place
    return [number(value) for value in params]


def _fence(fence: Any) -> Iterator[Feature]:  # noqa: ANN401 - any JSON value
    if not isinstance(fence, dict):
        return
    if fence.get("polygon"):
        # The first version of the section has one, to stay inside.
        corners = points(fence["polygon"], "geoFence.polygon", latitude_first=True)
        yield _fenced({}, polygon(corners, [], partial(broken, path="geoFence.polygon")), "polygon", 0)
    for i, each in enumerate(fence.get("polygons") or []):
        path = f"geoFence.polygons[{i}]"
        corners = points(member(each, "polygon", list, path), f"{path}.polygon", latitude_first=True)
        yield _fenced(each, polygon(corners, [], partial(broken, path=path)), "polygon", i)
    for i, each in enumerate(fence.get("circles") or []):
        path = f"geoFence.circles[{i}].circle"
        circle = member(each, "circle", dict, f"geoFence.circles[{i}]")
        radius = number(circle.get("radius"))
        if radius is None or radius <= 0.0:
            raise broken("the radius is no positive number", path=f"{path}.radius")
        centre = point(member(circle, "center", list, path), f"{path}.center", latitude_first=True)
        yield _fenced(each, Spot(centre, radius), "circle", i)


def _fenced(entry: dict[str, Any], shape: Shape, kind: str, index: int) -> Feature:
    inside = entry.get("inclusion") is not False
    name, role, reason = fenced(kind, Role.BOUNDARY if inside else Role.RESTRICTED, index + 1)
    return Feature(name, (shape,), role, reason)


def _complex(
    item: dict[str, Any], path: str, before: Sequence[Feature], altitudes: list[float], remarks: list[str]
) -> Iterator[Feature]:
    kind = member(item, "complexItemType", str, path)
    lanes, height = lanes_of(item)
    altitudes.extend([height] if height else [])

    refuse = partial(broken, path=path)
    if kind in ("survey", "StructureScan"):
        corners = points(member(item, "polygon", list, path), f"{path}.polygon", latitude_first=True)
        shape = polygon(corners, [], refuse)
        if kind == "survey":
            yield Feature(_numbered("survey", before), (shape,), Role.SURVEY, "a survey", lanes=lanes)
        else:
            height_m = number(item.get("StructureHeight"))
            yield Feature(
                _numbered("structure", before), (shape,), Role.RESTRICTED, "a structure that is scanned", height_m
            )
    elif kind == "CorridorScan":
        corners = points(member(item, "polyline", list, path), f"{path}.polyline", latitude_first=True)
        width = number(item.get("CorridorWidth"))
        strip = line(corners, width if width and width > 0.0 else None, refuse)
        yield Feature(_numbered("corridor", before), (strip,), Role.SURVEY, "a corridor scan", lanes=lanes)
    else:
        remarks.append(f"{path} is left out: nothing is known of a {kind[:40]}")


def _numbered(kind: str, before: Sequence[Feature]) -> str:
    return f"{kind}_{1 + sum(feature.name.startswith(kind) for feature in before)}"


def _homes(data: dict[str, Any], mission: dict[str, Any]) -> Iterator[Feature]:
    home = mission.get("plannedHomePosition")
    if isinstance(home, dict):
        home = home.get("coordinate")  # as older versions have it
    if home is not None:
        place = point(home, "mission.plannedHomePosition", latitude_first=True)
        yield Feature("home", (Spot(place),), Role.HOME, "the planned home")
    rally = data.get("rallyPoints")
    entries = rally.get("points") if isinstance(rally, dict) else None
    for i, each in enumerate(entries or []):
        place = point(each, f"rallyPoints.points[{i}]", latitude_first=True)
        yield Feature(f"rally_{i + 1}", (Spot(place),), Role.HOME, "a rally point")
