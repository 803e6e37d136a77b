"""A placed plan as what a map shows: regions, triangles with their labels, the path, and where it stands still."""

from collections.abc import Iterator
from typing import Final

import numpy as np
import shapely

from mission.export.fence import domain_shape, region_shape
from mission.export.placed_plan import PlacedPlan
from mission.geometry.arrays import FloatArray
from mission.geometry.places import places_at_offsets
from mission.interchange.map_features import Json, MapFeature, continuous
from mission.report.palette import BLACK, KIND_COLOUR, MESH, PLANNED, SMOOTHED
from mission.spec.model import RegionKind

REGIONS: Final = "Regions"
TRIANGLES: Final = "Triangles"
FLIGHT: Final = "Flight"


def areas(placed: PlacedPlan) -> Iterator[MapFeature]:
    """The boundary and the regions as they are flown, clearances included; what is restricted stands up to the path."""
    plan = placed.plan
    yield MapFeature("boundary", "boundary", REGIONS, _on_earth(placed, domain_shape(plan)), BLACK, filled=False)
    for region in plan.spec.regions:
        shape = region_shape(plan, region.name)
        if not shape.is_empty:
            yield MapFeature(
                name=region.name,
                kind=region.kind.value,
                group=REGIONS,
                geometry=_on_earth(placed, shape),
                colour=KIND_COLOUR[region.kind],
                height_m=plan.trajectory.altitude_m if region.kind is RegionKind.RESTRICTED else None,
                properties={"loiter_s": region.loiter_s} if region.loiter_s else {},
            )


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
    }
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
