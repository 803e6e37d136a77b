"""Plain data that fits the schema, as the frozen values of ``model.py``; defaults come from the schema."""

import math
from typing import Any, Literal

from mission.geometry.refinement import SMALLEST_ANGLE_DEG
from mission.spec.battery import battery_of
from mission.spec.covers import cover_of
from mission.spec.heading import heading_of
from mission.spec.model import (
    CORRIDOR,
    FIELD,
    SUFFIX_DECIDES,
    TRAJECTORY,
    UNTIL_STOPPED,
    AreaShape,
    BoundaryDomain,
    CircleShape,
    Cost,
    Extension,
    Flight,
    Limits,
    MissionSpec,
    NamedAutomaton,
    NodesDomain,
    Origin,
    Point,
    PointShape,
    PolygonShape,
    PolygonsShape,
    Refinement,
    Region,
    RegionKind,
    Search,
    Semantics,
    Smoothing,
    Start,
    StripShape,
    TriangleShape,
)
from mission.spec.motion import motion_of
from mission.spec.schema import default_of
from mission.spec.tasks import task_of
from mission.spec.tube import margins_of

Data = dict[str, Any]


def mission_of(data: Data, name: str, automaton: NamedAutomaton | None) -> MissionSpec:
    """The mission of a whole file; ``name`` is used where the file gives none, ``automaton`` is the one it names."""
    start, origin, laps = data["start"], data.get("origin"), _given(data, "mission", "laps")
    suffix = _given(data, "search", "suffix_weight")
    return MissionSpec(
        name=data.get("name", name),
        description=data.get("description", ""),
        domain=domain_of(data["domain"]),
        regions=tuple(region_of(key, value) for key, value in data["regions"].items()),
        formula=data.get("mission", {}).get("formula", ""),
        semantics=Semantics(_given(data, "mission", "semantics")),
        run=int(_given(data, "mission", "run")),
        start=Start(point_of(start["position_m"]), point_of(_given(data, "start", "velocity_m_s"))),
        origin=Origin(float(origin["latitude_deg"]), float(origin["longitude_deg"])) if origin else None,
        flight=Flight(
            laps=UNTIL_STOPPED if laps == UNTIL_STOPPED else int(laps),
            speed_m_s=float(data.get("flight", {}).get("speed_m_s", _given(data, "limits", "speed_m_s"))),
            altitude_m=_measure(data, "flight", "altitude_m"),
            final_stay_s=_measure(data, "flight", "final_stay_s"),
            time_constant_s=_measure(data, "flight", "time_constant_s"),
            disturbance_m_s2=_measure(data, "flight", "disturbance_m_s2"),
            margins=margins_of(data.get("flight", {})),
            guidance=FIELD if _given(data, "flight", "guidance") == FIELD else TRAJECTORY,
            heading=heading_of(data.get("flight", {}).get("heading")),
            replan=bool(_given(data, "flight", "replan")),
            longest_s=None if (longest_s := data.get("flight", {}).get("longest_s")) is None else float(longest_s),
        ),
        smoothing=_smoothing(data),
        search=Search(
            cost=_cost(data),
            prefix_weight=int(_given(data, "search", "prefix_weight")),
            suffix_weight=None if suffix == SUFFIX_DECIDES else int(suffix),
        ),
        limits=Limits(
            speed_m_s=_measure(data, "limits", "speed_m_s"),
            acceleration_m_s2=_measure(data, "limits", "acceleration_m_s2"),
            tilt_rad=math.radians(_measure(data, "limits", "tilt_deg")),
            jerk_m_s3=_measure(data, "limits", "jerk_m_s3"),
            yaw_rate_rad_s=math.radians(_measure(data, "limits", "yaw_rate_deg_s")),
        ),
        tasks=tuple(task_of(task) for task in data.get("tasks", [])),
        automaton=automaton,
        battery=battery_of(data.get("battery")),
    )


def _smoothing(data: Data) -> Smoothing | Literal["corridor"]:
    if data.get("smoothing", CORRIDOR) == CORRIDOR:
        return CORRIDOR
    frequencies = _given(data, "smoothing", "frequencies")
    return Smoothing(
        Extension(_given(data, "smoothing", "extension")), "auto" if frequencies == "auto" else int(frequencies)
    )


def domain_of(data: Data) -> NodesDomain | BoundaryDomain:
    """The domain section."""
    if "nodes" in data:
        motions = tuple((tuple(map(int, each["nodes"])), motion_of(each)) for each in data.get("motions", []))
        return NodesDomain(_points(data["nodes"]), motions)
    boundary = data["boundary"]
    return BoundaryDomain(
        area_shape(boundary if isinstance(boundary, dict) else {"polygon": boundary}),
        _refinement(data.get("mesh", {})),
        clearance_m=float(data.get("clearance_m", 0.0)),
        restricted_clearance_m=float(data.get("restricted_clearance_m", 0.0)),
    )


def _refinement(data: Data) -> Refinement:
    return Refinement(float(data.get("smallest_angle_deg", SMALLEST_ANGLE_DEG)), float(data.get("largest_m", math.inf)))


def region_of(name: str, data: Data) -> Region:
    """One region; without a kind (of a file that has other faults, too) one to survey."""
    clearance, speed = data.get("clearance_m"), data.get("speed_m_s")
    return Region(
        name,
        RegionKind(data.get("kind", RegionKind.SURVEY)),
        _shape(data),
        loiter_s=float(data.get("loiter_s", 0.0)),
        cover=cover_of(data["cover"]) if "cover" in data else None,
        clearance_m=None if clearance is None else float(clearance),
        speed_m_s=None if speed is None else float(speed),
        active_s=_window(data["active_s"]) if "active_s" in data else None,
        motion=motion_of(data["motion"]) if "motion" in data else None,
    )


def _window(ends: list[float | None]) -> tuple[float, float]:
    begin_s, end_s = ends
    return float(begin_s or 0.0), math.inf if end_s is None else float(end_s)


def point_of(pair: list[float]) -> Point:
    """A pair of numbers."""
    return float(pair[0]), float(pair[1])


def _shape(data: Data) -> TriangleShape | PointShape | AreaShape:
    if "triangle" in data:
        first, second, third = (int(node) for node in data["triangle"])
        return TriangleShape((first, second, third))
    return PointShape(point_of(data["at"])) if "at" in data else area_shape(data)


def area_shape(data: Data) -> AreaShape:
    """The shape that the keys of a region, or of a boundary, draw."""
    if "polygons" in data:
        return PolygonsShape(tuple(_polygon(part) for part in data["polygons"]))
    if "centre" in data:
        return CircleShape(point_of(data["centre"]), float(data["radius_m"]))
    if "line" in data:
        return StripShape(_points(data["line"]), float(data["width_m"]))
    return _polygon(data)


def _polygon(data: Data) -> PolygonShape:
    return PolygonShape(_points(data["polygon"]), tuple(_points(hole) for hole in data.get("holes", [])))


def _points(pairs: list[list[float]]) -> tuple[Point, ...]:
    return tuple(point_of(pair) for pair in pairs)


def _cost(data: Data) -> Cost:
    """What runs and lanes have least of; unsaid, it is time where lanes are flown, whose turns take no metres."""
    covers = any("cover" in region for region in data["regions"].values())
    return Cost(data.get("search", {}).get("cost", Cost.TIME if covers else Cost.DISTANCE))


def _given(data: Data, section: str, key: str) -> Any:  # noqa: ANN401 - any JSON value
    """What the file gives for a key, or its default."""
    return data.get(section, {}).get(key, default_of(section, key))


def _measure(data: Data, section: str, key: str) -> float:
    return float(_given(data, section, key))
