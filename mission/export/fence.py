"""What a plan keeps the vehicle in and out of, in the terms of an autopilot's geofence: polygons without holes.

A vehicle is to stay inside the polygons of inclusion and outside of those of exclusion. Several polygons of inclusion
mean to one autopilot to stay in each, to another one to stay in some: there is one here.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import shapely
from shapely.geometry.polygon import orient
from shapely.ops import polylabel

from mission.geometry.arrays import FloatArray
from mission.plan.flight_plan import FlightPlan
from mission.spec.model import Point, RegionKind

_STRAIGHT_M = 1e-3
"""Vertices of the mesh on a straight outline are no corners of it, for all that rounding did to them."""

_NEAR_THE_MIDDLE = 0.01  # of an area's size


@dataclass(frozen=True, eq=False)
class Fence:
    """A geofence, ENU in the domain; corners of shape (K, 2), counter-clockwise, the last one joined to the first.

    Attributes:
        inclusion_m: Where the vehicle is to stay.
        exclusions_m: Polygons that it is to stay out of, which may overlap each other and the rim of the inclusion.
    """

    inclusion_m: FloatArray
    exclusions_m: tuple[FloatArray, ...]


def domain_shape(plan: FlightPlan) -> shapely.Geometry:
    """The domain of a plan."""
    return _outlined(plan.partition.corners_m)


def region_shape(plan: FlightPlan, name: str) -> shapely.Geometry:
    """The part of the domain that a region of a plan takes up, its clearance included; empty where none is left."""
    return _outlined(plan.partition.corners_m[plan.labelling.triangles_of(name)])


def fence_of(plan: FlightPlan) -> Fence:
    """The geofence of a plan: its domain, and out of what is restricted."""
    restricted = [region.name for region in plan.spec.regions if region.kind is RegionKind.RESTRICTED]
    return fence_around(plan.start_m, domain_shape(plan), [region_shape(plan, name) for name in restricted])


def fence_around(start_m: Point, domain: shapely.Geometry, restricted: Sequence[shapely.Geometry]) -> Fence:
    """The geofence of a flight from a place: in that part of the domain, and out of what is restricted.

    What encloses the flight cannot be a polygon to stay out of: there the inclusion ends at it. Holes of other
    restricted areas are out of reach, and no part of the fence.
    """
    start = shapely.Point(start_m)
    inside = _part_around(start, domain)
    exclusions = [shapely.Polygon(hole) for hole in inside.interiors]
    for part in shapely.get_parts(restricted):
        around = next((hole for hole in map(shapely.Polygon, part.interiors) if hole.contains(start)), None)
        if around is None:
            exclusions.append(shapely.Polygon(part.exterior))
        else:
            inside = _part_around(start, inside.intersection(around))
    outline = shapely.Polygon(inside.exterior)
    reached = [area for area in exclusions if area.intersection(outline).area > 0.0]
    return Fence(_corners(outline), tuple(_corners(area) for area in reached))


def rally_points(plan: FlightPlan) -> tuple[Point, ...]:
    """For each region of kind home the place in it to return to: where the flight ends, or else its middle."""
    end = shapely.Point(plan.curve.position([plan.curve.duration_s])[0])
    places = []
    for region in plan.spec.regions:
        if region.kind is RegionKind.HOME:
            shape = region_shape(plan, region.name)
            if not shape.is_empty:
                place = end if shape.contains(end) else _middle(shape)
                places.append((float(place.x), float(place.y)))
    return tuple(places)


def _outlined(corners_m: FloatArray) -> shapely.Geometry:
    """The union of triangles of the mesh, shape (M, 3, 2), without vertices on straight edges."""
    return shapely.coverage_union_all(shapely.polygons(corners_m)).simplify(_STRAIGHT_M)


def _middle(area: shapely.Geometry) -> shapely.Point:
    """The place that is farthest inside the largest part of an area."""
    largest = max(shapely.get_parts(area), key=lambda part: float(part.area))
    return polylabel(largest, _NEAR_THE_MIDDLE * math.sqrt(largest.area))


def _part_around(place: shapely.Point, area: shapely.Geometry) -> shapely.Polygon:
    return min(shapely.get_parts(area), key=place.distance)


def _corners(area: shapely.Polygon) -> FloatArray:
    corners: FloatArray = shapely.get_coordinates(orient(area).exterior)[:-1]
    return corners
