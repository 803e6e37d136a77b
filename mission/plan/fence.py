"""What a plan keeps the vehicle in and out of, in the terms of an autopilot's geofence: polygons without holes.

A vehicle is to stay inside the polygons of inclusion and outside of those of exclusion. Several polygons of inclusion
mean to one autopilot to stay in each, to another one to stay in some: there is one here.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import shapely
from shapely.geometry.polygon import orient
from shapely.ops import polylabel

from mission.geometry.arrays import BoolArray, FloatArray
from mission.geometry.geodesy import LatLon
from mission.geometry.places import places_at_offsets
from mission.interchange.autopilot_plan import FenceCircle, FencePolygon
from mission.logic.automata.rabin import DEAD
from mission.plan.flight_plan import FlightPlan
from mission.spec.areas import clearance_of
from mission.spec.model import BoundaryDomain, CircleShape, Point, RegionKind

_STRAIGHT_M = 1e-3
"""Vertices of the mesh on a straight outline are no corners of it, for all that rounding did to them."""

_NEAR_THE_MIDDLE = 0.01  # of an area's size


@dataclass(frozen=True)
class Circle:
    """A circle, ENU in the domain."""

    centre_m: Point
    radius_m: float


Rim = FloatArray | Circle
"""Corners of a polygon, shape (K, 2), counter-clockwise, the last one joined to the first; or a circle."""


class Fenced(NamedTuple):
    """An area as the mesh has it, and the circle that it stands for, if it was drawn as one."""

    area: shapely.Geometry
    circle: Circle | None = None


@dataclass(frozen=True, eq=False)
class Fence:
    """A geofence, ENU in the domain.

    Attributes:
        inclusion: Where the vehicle is to stay.
        exclusions: What it is to stay out of; they may overlap each other and the rim of the inclusion.
    """

    inclusion: Rim
    exclusions: tuple[Rim, ...]

    @property
    def rims(self) -> tuple[Rim, ...]:
        """All of them, the inclusion first."""
        return (self.inclusion, *self.exclusions)

    def distance_m(self, line: shapely.LineString) -> float:
        """How far a line is from the fence at its nearest."""
        return min(_distance_m(rim, line) for rim in self.rims)


def domain_shape(plan: FlightPlan) -> shapely.Geometry:
    """The domain of a plan."""
    return _outlined(plan.partition.corners_m)


def region_shape(plan: FlightPlan, name: str) -> shapely.Geometry:
    """The part of the domain that a region of a plan takes up, its clearance included; empty where none is left."""
    return _outlined(plan.partition.corners_m[plan.labelling.triangles_of(name)])


def drifts(plan: FlightPlan) -> BoolArray:
    """The triangles that move at some time, shape (M,)."""
    if plan.moving is None:
        return np.zeros(plan.partition.size, dtype=np.bool_)
    return np.asarray(plan.moving.moves[plan.partition.triangles].any(axis=1))


def shunned(plan: FlightPlan) -> BoolArray:
    """Where no flight that satisfies a plan is ever, beside what is restricted, shape (M,)."""
    never = (plan.deterministic.targets == DEAD).all(axis=0)
    never[plan.labelling.letter_of[plan.run.states[0]]] = False  # where the flight begins need not be read
    return np.asarray(never[plan.labelling.letter_of] & ~plan.restricted)


def fence_of(plan: FlightPlan) -> Fence:
    """The geofence of a plan: its domain, out of what is restricted, and out of where no flight that satisfies it is.

    The last is what the mission's own automaton never reads, from none of its states, such as the regions of ``G !K``
    or what two regions of ``G !(a & b)`` have in common. What is only to be avoided for a time is no part, nor is what
    moves: a fence stands.
    """
    domain, stands = plan.spec.domain, ~drifts(plan)
    around = _circle(domain.boundary, -domain.clearance_m) if isinstance(domain, BoundaryDomain) else None
    restricted = [
        Fenced(region_shape(plan, region.name), _circle(region.shape, clearance_of(region, domain)))
        for region in plan.spec.regions
        if region.forbidden and stands[plan.labelling.triangles_of(region.name)].all()
    ]
    never = shunned(plan) & stands
    shapes = [Fenced(_outlined(plan.partition.corners_m[never]))] if never.any() else []
    return fence_around(plan.start_m, Fenced(domain_shape(plan), around), [*restricted, *shapes])


def placed(fence: Fence, origin: LatLon, shift_m: Point = (0.0, 0.0)) -> tuple[FencePolygon | FenceCircle, ...]:
    """A fence on Earth, the inclusion first.

    Args:
        fence: The fence.
        origin: A place.
        shift_m: Where the domain's (0, 0) lies, seen from there, east and north.
    """

    def places(points_m: FloatArray) -> tuple[LatLon, ...]:
        return tuple(LatLon(*place) for place in places_at_offsets(origin, points_m + np.array(shift_m)).tolist())

    areas: list[FencePolygon | FenceCircle] = []
    for number, rim in enumerate(fence.rims):
        if isinstance(rim, Circle):
            areas.append(FenceCircle(number == 0, places(np.array([rim.centre_m]))[0], rim.radius_m))
        else:
            areas.append(FencePolygon(number == 0, places(rim)))
    return tuple(areas)


def fence_around(start_m: Point, domain: Fenced, restricted: Sequence[Fenced]) -> Fence:
    """The geofence of a flight from a place: in that part of the domain, and out of what is restricted.

    What encloses the flight cannot be a polygon to stay out of: there the inclusion ends at it. Holes of other
    restricted areas are out of reach, and no part of the fence.
    """
    start, circle = shapely.Point(start_m), domain.circle
    inside = _part_around(start, domain.area)
    exclusions = [Fenced(shapely.Polygon(hole)) for hole in inside.interiors]
    for fenced in restricted:
        for part in shapely.get_parts(fenced.area):
            around = next((hole for hole in map(shapely.Polygon, part.interiors) if hole.contains(start)), None)
            if around is None:
                exclusions.append(Fenced(shapely.Polygon(part.exterior), fenced.circle))
            else:
                inside, circle = _part_around(start, inside.intersection(around)), None
    outline = shapely.Polygon(inside.exterior)
    reached = [fenced for fenced in exclusions if fenced.area.intersection(outline).area > 0.0]
    # A circle that something cuts in two is one circle.
    circles = dict.fromkeys(fenced.circle for fenced in reached if fenced.circle is not None)
    polygons = [corners_of(fenced.area) for fenced in reached if fenced.circle is None]
    return Fence(corners_of(outline) if circle is None else circle, (*polygons, *circles))


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


def corners_of(area: shapely.Polygon) -> FloatArray:
    """The corners of an area's outline, shape (K, 2), counter-clockwise, each once."""
    corners: FloatArray = shapely.get_coordinates(orient(area).exterior)[:-1]
    return corners


def _outlined(corners_m: FloatArray) -> shapely.Geometry:
    """The union of triangles of the mesh, shape (M, 3, 2), without vertices on straight edges."""
    # The first vertex of a ring is kept, so it must be a corner, as the leftmost one is.
    return shapely.coverage_union_all(shapely.polygons(corners_m)).normalize().simplify(_STRAIGHT_M)


def _circle(shape: object, grown_by_m: float) -> Circle | None:
    """A shape with its clearance, where it is a circle."""
    return Circle(shape.centre_m, shape.radius_m + grown_by_m) if isinstance(shape, CircleShape) else None


def _distance_m(rim: Rim, line: shapely.LineString) -> float:
    if not isinstance(rim, Circle):
        return float(shapely.distance(shapely.LinearRing(rim), line))
    centre = shapely.Point(rim.centre_m)
    nearest = float(shapely.distance(centre, line))
    farthest = float(shapely.distance(centre, shapely.points(shapely.get_coordinates(line))).max())
    return max(nearest - rim.radius_m, rim.radius_m - farthest, 0.0)


def _middle(area: shapely.Geometry) -> shapely.Point:
    """The place that is farthest inside the largest part of an area."""
    largest = max(shapely.get_parts(area), key=lambda part: float(part.area))
    return polylabel(largest, _NEAR_THE_MIDDLE * math.sqrt(largest.area))


def _part_around(place: shapely.Point, area: shapely.Geometry) -> shapely.Polygon:
    return min(shapely.get_parts(area), key=place.distance)
