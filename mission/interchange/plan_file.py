"""QGroundControl's plans: geofence, survey and corridor items, waypoints, planned home and rally points."""

from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any, Final

from mission.interchange.commands import FLOWN_THROUGH, SPEED, TAKEOFF, fenced, route
from mission.interchange.features import Drawing, Feature, Lanes, Point, Role, Shape, Spot, broken
from mission.interchange.json_text import Json, member, point, points
from mission.interchange.rings import line, number, polygon

_LATITUDE: Final = 4
_ALTITUDE: Final = 6


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
        command, params = item.get("command"), item.get("params")
        values = [number(value) for value in params] if isinstance(params, list) else []
        if command == SPEED and len(values) > 1 and (values[1] or 0.0) > 0.0:
            speed = values[1]
        if command in FLOWN_THROUGH | {TAKEOFF} and len(values) > _ALTITUDE and values[_ALTITUDE] is not None:
            altitudes.append(values[_ALTITUDE] or 0.0)
        if command in FLOWN_THROUGH:
            waypoints.append(point(values[_LATITUDE:_ALTITUDE], f"{path}.params", latitude_first=True))
    features.extend(route(waypoints))
    features.extend(_homes(data, mission))
    return Drawing(
        "QGroundControl plan",
        tuple(features),
        remarks=tuple(remarks),
        altitude_m=max((altitude for altitude in altitudes if altitude > 0.0), default=None),
        speed_m_s=speed if speed and speed > 0.0 else None,
    )


def _fence(fence: Any) -> Iterator[Feature]:  # noqa: ANN401 - any JSON value
    if not isinstance(fence, dict):
        return
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
    camera = item.get("TransectStyleComplexItem", item)
    camera = camera.get("CameraCalc", {}) if isinstance(camera, dict) else {}
    spacing, height = (number(camera.get(key)) for key in ("AdjustedFootprintSide", "DistanceToSurface"))
    if height and height > 0.0:
        altitudes.append(height)
    lanes = Lanes(spacing, number(item.get("angle"))) if spacing and spacing > 0.0 else None

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
    if home is not None:
        place = point(home, "mission.plannedHomePosition", latitude_first=True)
        yield Feature("home", (Spot(place),), Role.HOME, "the planned home")
    rally = data.get("rallyPoints")
    entries = rally.get("points") if isinstance(rally, dict) else None
    for i, each in enumerate(entries or []):
        place = point(each, f"rallyPoints.points[{i}]", latitude_first=True)
        yield Feature(f"rally_{i + 1}", (Spot(place),), Role.HOME, "a rally point")
