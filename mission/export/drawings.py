"""A placed plan as what a map shows: regions, triangles with their labels, the path, and where it stands still."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Final

import numpy as np
import shapely

from mission.export.placed_plan import PlacedPlan
from mission.geometry.arrays import FloatArray
from mission.geometry.places import places_at_offsets
from mission.interchange.map_features import DIGITS, Json, MapFeature, continuous
from mission.plan.fence import domain_shape, region_shape
from mission.report.palette import BLACK, KIND_COLOUR, MESH, PLANNED, QUIET, SMOOTHED
from mission.spec.areas import Ground, boundary_ground, region_ground
from mission.spec.covers import cover_data
from mission.spec.heading import heading_data
from mission.spec.model import CORRIDOR, BoundaryDomain, CircleShape, Cover, Point, RegionKind, StripShape
from mission.spec.windows import window_text

REGIONS: Final = "Regions"
TRIANGLES: Final = "Triangles"
FLIGHT: Final = "Flight"


def areas(placed: PlacedPlan) -> Iterator[MapFeature]:
    """The boundary and the regions as they are drawn, and where their clearances end; restricted ones stand up.

    What moves is where it begins, and says how it moves.
    """
    plan, domain = placed.plan, placed.plan.spec.domain
    ground = boundary_ground(domain) if isinstance(domain, BoundaryDomain) else None
    drawn_as = _round(placed, domain.boundary) if isinstance(domain, BoundaryDomain) else {}
    yield from _area(
        placed,
        MapFeature("boundary", "boundary", REGIONS, domain_shape(plan), BLACK, filled=False, properties=drawn_as),
        ground,
    )
    for region in plan.spec.regions:
        shape = region_shape(plan, region.name)
        if not shape.is_empty:
            drawn = MapFeature(
                name=region.name,
                kind=region.kind.value,
                group=REGIONS,
                geometry=shape,
                colour=KIND_COLOUR[region.kind],
                height_m=plan.trajectory.altitude_m if region.kind is RegionKind.RESTRICTED else None,
                properties={
                    **({"loiter_s": region.loiter_s} if region.loiter_s else {}),
                    **({"speed_m_s": region.speed_m_s} if region.speed_m_s is not None else {}),
                    **({"active": window_text(region)} if region.active_s is not None else {}),
                    **({"motion": region.motion.text} if region.motion is not None else {}),
                    **_lanes(region.cover),
                    **_round(placed, region.shape),
                },
            )
            yield from _area(placed, drawn, region_ground(region, domain))


def _lanes(cover: Cover | None) -> dict[str, Json]:
    """How a region is covered, in the words of mission files, the camera's among the others: tables know no deeper."""
    if cover is None:
        return {}
    data = cover_data(cover)
    return {**data.pop("camera", {}), **data}


def _round(placed: PlacedPlan, shape: object) -> dict[str, Json]:
    """What a polygon stands for that is drawn for a circle or a strip."""
    if isinstance(shape, CircleShape):
        (centre,) = _degrees(placed, [shape.centre_m])
        return {"centre": centre, "radius_m": shape.radius_m}
    if isinstance(shape, StripShape):
        return {"line": [*_degrees(placed, shape.line_m)], "width_m": shape.width_m}
    return {}


def _degrees(placed: PlacedPlan, points_m: Sequence[Point]) -> list[Json]:
    """Longitudes and latitudes of points of the domain."""
    places = places_at_offsets(placed.origin, np.array(points_m))[:, ::-1]
    return [list(place) for place in np.round(places, DIGITS).tolist()]


def _area(placed: PlacedPlan, meshed: MapFeature, ground: Ground | None) -> Iterator[MapFeature]:
    """An area as it is drawn, if it is not one of triangles; and as the mesh has it, where it keeps a clearance."""
    told, drawn = meshed.properties, meshed.geometry if ground is None else ground.drawn
    if ground is not None and ground.clearance_m > 0.0:
        told = {**told, "clearance_m": ground.clearance_m}
        kept = _on_earth(placed, meshed.geometry)
        yield MapFeature(f"{meshed.name}: clearance", "clearance", REGIONS, kept, QUIET, filled=False)
    yield replace(meshed, geometry=_on_earth(placed, drawn), properties=told)


def triangles(placed: PlacedPlan) -> Iterator[MapFeature]:
    """The triangles with their labels, and at which places of the run each is passed, counted from 0."""
    plan = placed.plan
    passed: dict[int, list[Json]] = {}
    for number, triangle in enumerate(plan.run.states):
        passed.setdefault(triangle, []).append(number)
    vertices = places_at_offsets(placed.origin, plan.partition.vertices_m)[:, ::-1]
    rings = vertices[plan.partition.triangles]
    for number, (letter, ring) in enumerate(zip(plan.labelling.letter_of.tolist(), rings, strict=True)):
        labels: list[Json] = [*sorted(plan.labelling.letters[letter])]
        told: dict[str, Json] = {"triangle": number, "labels": labels, "run": passed.get(number, [])}
        corners = shapely.Polygon(continuous(ring))
        yield MapFeature(f"T{number}", "triangle", TRIANGLES, corners, MESH, filled=False, properties=told)


def flight(placed: PlacedPlan) -> Iterator[MapFeature]:
    """The path on its straight legs, where it begins and ends, and where the vehicle stands still."""
    plan, route = placed.plan, placed.route
    height_m, line = plan.trajectory.altitude_m, np.array([waypoint.place_m for waypoint in route.once])
    told: dict[str, Json] = {
        "specification": plan.specification,
        "word": placed.word_text,
        "run": [*plan.run.states],
        "prefix_states": len(plan.run.prefix),
        "length_m": round(float(shapely.LineString(line).length), 3),
        "deviation_m": round(route.deviation_m, 3),
        "tube_m": plan.certificate.tube_m,
        "speed_m_s": plan.spec.flight.speed_m_s,
        "altitude_m": height_m,
        "cost": plan.spec.search.cost.value,
    }
    if plan.spec.smoothing == CORRIDOR:
        told["smoothing"] = CORRIDOR
    if heading := plan.spec.flight.heading:
        data = heading_data(heading)
        told["heading"] = data if isinstance(data, str) else ", ".join(f"{key}: {value}" for key, value in data.items())
    if route.lap is not None:
        told["laps"] = "until stopped" if route.laps is None else route.laps
    legs = _on_earth(placed, shapely.LineString(line))
    yield MapFeature("path", "path", FLIGHT, legs, SMOOTHED, height_m, properties=told)
    for name, where in (("take-off", line[0]), ("landing", line[-1])):
        yield MapFeature(name, name, FLIGHT, _on_earth(placed, shapely.Point(where)), PLANNED)
    for waypoint in route.once:
        if waypoint.hold_s > 0.0:
            yield MapFeature(
                name=f"{waypoint.hold_s:g} s",
                kind="stop",
                group=FLIGHT,
                geometry=_on_earth(placed, shapely.Point(waypoint.place_m)),
                colour=PLANNED,
                height_m=height_m,
                properties={"seconds": waypoint.hold_s},
            )


def _on_earth(placed: PlacedPlan, shape: shapely.Geometry) -> shapely.Geometry:
    """A shape of the domain in longitude and latitude."""

    def places(points_m: FloatArray) -> FloatArray:
        return continuous(places_at_offsets(placed.origin, points_m)[:, ::-1])

    return shapely.transform(shape, places)
