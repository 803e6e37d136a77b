"""Geofences: one polygon to stay in, polygons to stay out of, none with holes."""

import numpy as np
import pytest
import shapely

from mission.export.drawings import areas
from mission.export.placed_plan import placed_plan
from mission.export.uploads import autopilot_plan
from mission.geometry.geodesy import LatLon
from mission.interchange.autopilot_plan import FenceCircle
from mission.interchange.geojson_writer import geojson
from mission.interchange.reading import read_drawing
from mission.plan import FlightPlan
from mission.plan.fence import Circle, Fence, Fenced, fence_around, fence_of, rally_points
from tests.support.small_missions import FLOWN_BRISKLY, SMALL, plan_of

FIELD = shapely.box(0.0, 0.0, 100.0, 60.0)


def allowed(fence: Fence) -> shapely.Geometry:
    """Where the autopilot lets the vehicle be."""
    out = shapely.union_all([shapely.Polygon(ring) for ring in fence.exclusions])
    return shapely.difference(shapely.Polygon(fence.inclusion), out)


def ring(outer: float, inner: float) -> shapely.Polygon:
    return shapely.Point(50.0, 30.0).buffer(outer).difference(shapely.Point(50.0, 30.0).buffer(inner))


def test_the_boundary_is_stayed_in_and_what_is_restricted_out_of() -> None:
    house = shapely.box(40.0, 20.0, 60.0, 40.0)
    fence = fence_around((5.0, 5.0), Fenced(FIELD), [Fenced(house)])
    assert allowed(fence).equals(FIELD.difference(house))
    assert shapely.is_ccw(shapely.linearrings(fence.inclusion))


def test_a_hole_of_the_domain_is_stayed_out_of() -> None:
    lake = shapely.box(70.0, 10.0, 90.0, 30.0)
    fence = fence_around((5.0, 5.0), Fenced(FIELD.difference(lake)), [])
    assert allowed(fence).equals(FIELD.difference(lake))


def test_of_several_parts_of_a_domain_it_is_the_one_that_is_flown_in() -> None:
    """An autopilot may want the vehicle to be in all polygons to stay in, and in two that are apart nobody can be."""
    other = shapely.box(200.0, 0.0, 300.0, 60.0)
    fence = fence_around(
        (250.0, 5.0), Fenced(shapely.union(FIELD, other)), [Fenced(shapely.box(40.0, 20.0, 60.0, 40.0))]
    )
    assert allowed(fence).equals(other)
    assert not fence.exclusions


def test_what_encloses_the_flight_is_where_the_inclusion_ends() -> None:
    fence = fence_around(
        (50.0, 30.0), Fenced(FIELD), [Fenced(ring(25.0, 15.0)), Fenced(shapely.box(45.0, 35.0, 50.0, 40.0))]
    )
    within = shapely.Point(50.0, 30.0).buffer(15.0).difference(shapely.box(45.0, 35.0, 50.0, 40.0))
    assert allowed(fence).symmetric_difference(within).area < 1e-9
    assert len(fence.exclusions) == 1


def test_a_yard_that_cannot_be_entered_is_stayed_out_of_with_its_wall() -> None:
    fence = fence_around((5.0, 5.0), Fenced(FIELD), [Fenced(ring(25.0, 15.0))])
    assert allowed(fence).symmetric_difference(FIELD.difference(shapely.Point(50.0, 30.0).buffer(25.0))).area < 1e-9


def test_a_region_of_several_parts_is_several_areas() -> None:
    rows = shapely.MultiPolygon([shapely.box(20.0, 10.0, 30.0, 50.0), shapely.box(60.0, 10.0, 70.0, 50.0)])
    assert len(fence_around((5.0, 5.0), Fenced(FIELD), [Fenced(rows)]).exclusions) == 2


@pytest.fixture(scope="module")
def plan() -> FlightPlan:
    return plan_of(SMALL)


def test_the_fence_of_a_plan_has_the_corners_that_were_drawn(plan: FlightPlan) -> None:
    fence = fence_of(plan)
    (pond,) = fence.exclusions
    assert shapely.Polygon(pond).equals(shapely.box(4.0, 22.0, 14.0, 28.0))
    assert [len(rim) for rim in (fence.inclusion, pond) if not isinstance(rim, Circle)] == [4, 4]


def test_one_comes_back_to_where_the_flight_ends_or_else_to_the_middle_of_a_home(plan: FlightPlan) -> None:
    (end,) = rally_points(plan)
    assert end == pytest.approx(tuple(plan.curve.position([plan.curve.duration_s])[0]))
    _, middle = rally_points(plan_of(SMALL.replace("pond: {kind: restricted", "pond: {kind: home")))
    assert shapely.box(4.0, 22.0, 14.0, 28.0).boundary.distance(shapely.Point(middle)) == pytest.approx(3.0, abs=0.05)


ROUND = (
    """
domain:
  boundary: {centre: [0, 0], radius_m: 40}
  clearance_m: 1
  restricted_clearance_m: 2
regions:
  home: {kind: home, polygon: [[-30, -5], [-20, -5], [-20, 5], [-30, 5]]}
  goal: {kind: survey, polygon: [[20, -5], [30, -5], [30, 5], [20, 5]]}
  mast: {kind: restricted, centre: [0, 10], radius_m: 3}
  yard:
    kind: restricted
    polygon: [[-12, -20], [12, -20], [12, -8], [-12, -8]]
    holes: [[[-8, -17], [8, -17], [0, -11]]]
mission: {formula: F (goal & F G home)}
start: {position_m: [-25, 0]}
"""
    + FLOWN_BRISKLY
)


def test_circles_stay_circles_with_their_clearance() -> None:
    plan = plan_of(ROUND)
    fence = fence_of(plan)
    assert fence.inclusion == Circle((0.0, 0.0), 39.0)
    yard, mast = fence.exclusions
    assert mast == Circle((0.0, 10.0), 5.0)
    # The hole in the yard cannot be reached, and is out of bounds with it.
    assert not isinstance(yard, Circle)
    assert shapely.Polygon(yard).contains(shapely.box(-12.0, -20.0, 12.0, -8.0))
    line = shapely.LineString(plan.curve.position(np.linspace(0.0, plan.curve.duration_s, 2001)))
    rims = [shapely.Point(0, 0).buffer(39.0, 256), shapely.Point(0, 10).buffer(5.0, 256), shapely.Polygon(yard)]
    nearest = min(float(rim.exterior.distance(line)) for rim in rims)
    assert fence.distance_m(line) == pytest.approx(nearest, abs=0.01)
    placed = placed_plan(plan, LatLon(47.0, 8.0), 0.1)
    circles = [area for area in autopilot_plan(placed, "ardupilot").fence if isinstance(area, FenceCircle)]
    assert [(area.inclusion, area.radius_m) for area in circles] == [(True, 39.0), (False, 5.0)]


def test_maps_show_what_is_drawn_and_where_the_clearance_ends() -> None:
    placed = placed_plan(plan_of(ROUND), LatLon(47.0, 8.0), 0.1)
    shown = {feature.name: feature for feature in areas(placed)}
    assert shown["yard"].properties == {"clearance_m": 2.0}
    assert len(shown["yard"].geometry.interiors) == 1
    assert shown["yard: clearance"].geometry.contains(shown["yard"].geometry)
    assert shown["boundary"].geometry.contains(shown["boundary: clearance"].geometry)
    assert "goal: clearance" not in shown
    assert [feature.name for feature in read_drawing(geojson("", list(shown.values()))).features] == [
        "boundary",
        "home",
        "goal",
        "mast",
        "yard",
    ]
