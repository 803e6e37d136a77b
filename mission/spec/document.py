"""A mission as the plain data that its file holds; the opposite of ``values``."""

import math
from dataclasses import asdict
from typing import Any, Final

from mission.spec.covers import cover_data
from mission.spec.heading import heading_data
from mission.spec.model import (
    CORRIDOR,
    SUFFIX_DECIDES,
    AreaShape,
    BoundaryDomain,
    CircleShape,
    MissionSpec,
    NodesDomain,
    PointShape,
    PolygonShape,
    PolygonsShape,
    Region,
    TriangleShape,
)
from mission.spec.motion import motion_data
from mission.spec.tasks import task_data

_CLEARANCES: Final = ("clearance_m", "restricted_clearance_m")


def document_of(spec: MissionSpec) -> dict[str, Any]:
    """Data that, written as YAML or JSON, is a mission file of the same mission."""
    domain = spec.domain
    flight = asdict(spec.flight)
    laps = flight.pop("laps")
    flight["tube"] = flight.pop("margins")
    del flight["heading"]
    if spec.flight.heading is not None:
        flight["heading"] = heading_data(spec.flight.heading)
    if spec.flight.longest_s is None:
        del flight["longest_s"]
    document: dict[str, Any] = {
        "name": spec.name,
        "description": spec.description,
        "domain": (
            {
                "boundary": _boundary(domain.boundary),
                "mesh": _mesh(domain),
                **{key: value for key in _CLEARANCES if (value := getattr(domain, key))},
            }
            if isinstance(domain, BoundaryDomain)
            else _nodes(domain)
        ),
        "regions": {region.name: _region(region) for region in spec.regions},
        "mission": {"semantics": spec.semantics.value, "run": spec.run, "laps": laps},
        "start": {"position_m": list(spec.start.position_m), "velocity_m_s": list(spec.start.velocity_m_s)},
        "flight": flight,
        "search": {
            "cost": spec.search.cost.value,
            "prefix_weight": spec.search.prefix_weight,
            "suffix_weight": SUFFIX_DECIDES if spec.search.suffix_weight is None else spec.search.suffix_weight,
        },
        "smoothing": spec.smoothing
        if spec.smoothing == CORRIDOR
        else {"extension": spec.smoothing.extension.value, "frequencies": spec.smoothing.frequencies},
        "limits": {
            "speed_m_s": spec.limits.speed_m_s,
            "acceleration_m_s2": spec.limits.acceleration_m_s2,
            "jerk_m_s3": spec.limits.jerk_m_s3,
            "tilt_deg": math.degrees(spec.limits.tilt_rad),
            "yaw_rate_deg_s": math.degrees(spec.limits.yaw_rate_rad_s),
        },
    }
    if spec.formula:
        document["mission"]["formula"] = spec.formula
    if spec.automaton is not None:
        document["mission"]["automaton"] = spec.automaton.file
    if spec.tasks:
        document["tasks"] = [task_data(task) for task in spec.tasks]
    if spec.battery is not None:
        document["battery"] = {key: value for key, value in asdict(spec.battery).items() if value is not None}
    if spec.origin is not None:
        document["origin"] = {"latitude_deg": spec.origin.latitude_deg, "longitude_deg": spec.origin.longitude_deg}
    return document


def _mesh(domain: BoundaryDomain) -> dict[str, Any]:
    wanted = domain.refinement
    largest = {"largest_m": wanted.largest_m} if math.isfinite(wanted.largest_m) else {}
    return {"smallest_angle_deg": wanted.smallest_angle_deg, **largest}


def _nodes(domain: NodesDomain) -> dict[str, Any]:
    motions = [{"nodes": list(nodes), **motion_data(motion)} for nodes, motion in domain.motions]
    return {"nodes": _pairs(domain.nodes_m), **({"motions": motions} if motions else {})}


def _boundary(shape: AreaShape) -> list[list[float]] | dict[str, Any]:
    if isinstance(shape, PolygonShape) and not shape.holes_m:
        return _pairs(shape.corners_m)
    return _area(shape)


def _region(region: Region) -> dict[str, Any]:
    shape: dict[str, Any]
    if isinstance(region.shape, TriangleShape):
        shape = {"triangle": list(region.shape.nodes)}
    elif isinstance(region.shape, PointShape):
        shape = {"at": list(region.shape.point_m)}
    else:
        shape = _area(region.shape)
    clearance = {} if region.clearance_m is None else {"clearance_m": region.clearance_m}
    speed = {} if region.speed_m_s is None else {"speed_m_s": region.speed_m_s}
    cover = {} if region.cover is None else {"cover": cover_data(region.cover)}
    active = {} if region.active_s is None else {"active_s": [t if math.isfinite(t) else None for t in region.active_s]}
    motion = {} if region.motion is None else {"motion": motion_data(region.motion)}
    own = {"kind": region.kind.value, "loiter_s": region.loiter_s}
    return {**own, **shape, **clearance, **speed, **cover, **active, **motion}


def _area(shape: AreaShape) -> dict[str, Any]:
    if isinstance(shape, PolygonShape):
        holes = {"holes": [_pairs(hole) for hole in shape.holes_m]} if shape.holes_m else {}
        return {"polygon": _pairs(shape.corners_m), **holes}
    if isinstance(shape, PolygonsShape):
        return {"polygons": [_area(part) for part in shape.parts]}
    if isinstance(shape, CircleShape):
        return {"centre": list(shape.centre_m), "radius_m": shape.radius_m}
    return {"line": _pairs(shape.line_m), "width_m": shape.width_m}


def _pairs(points: tuple[tuple[float, float], ...]) -> list[list[float]]:
    return [list(point) for point in points]
