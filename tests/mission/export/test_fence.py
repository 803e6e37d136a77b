"""Geofences: one polygon to stay in, polygons to stay out of, none with holes."""

import pytest
import shapely

from mission.export.fence import Fence, fence_around, fence_of, rally_points
from mission.plan import FlightPlan
from tests.support.small_missions import SMALL, plan_of

FIELD = shapely.box(0.0, 0.0, 100.0, 60.0)


def allowed(fence: Fence) -> shapely.Geometry:
    """Where the autopilot lets the vehicle be."""
    out = shapely.union_all([shapely.Polygon(ring) for ring in fence.exclusions_m])
    return shapely.difference(shapely.Polygon(fence.inclusion_m), out)


def ring(outer: float, inner: float) -> shapely.Polygon:
    return shapely.Point(50.0, 30.0).buffer(outer).difference(shapely.Point(50.0, 30.0).buffer(inner))


def test_the_boundary_is_stayed_in_and_what_is_restricted_out_of() -> None:
    house = shapely.box(40.0, 20.0, 60.0, 40.0)
    fence = fence_around((5.0, 5.0), FIELD, [house])
    assert allowed(fence).equals(FIELD.difference(house))
    assert shapely.is_ccw(shapely.linearrings(fence.inclusion_m))


def test_a_hole_of_the_domain_is_stayed_out_of() -> None:
    lake = shapely.box(70.0, 10.0, 90.0, 30.0)
    fence = fence_around((5.0, 5.0), FIELD.difference(lake), [])
    assert allowed(fence).equals(FIELD.difference(lake))


def test_of_several_parts_of_a_domain_it_is_the_one_that_is_flown_in() -> None:
    """An autopilot may want the vehicle to be in all polygons to stay in, and in two that are apart nobody can be."""
    other = shapely.box(200.0, 0.0, 300.0, 60.0)
    fence = fence_around((250.0, 5.0), shapely.union(FIELD, other), [shapely.box(40.0, 20.0, 60.0, 40.0)])
    assert allowed(fence).equals(other)
    assert not fence.exclusions_m


def test_what_encloses_the_flight_is_where_the_inclusion_ends() -> None:
    fence = fence_around((50.0, 30.0), FIELD, [ring(25.0, 15.0), shapely.box(45.0, 35.0, 50.0, 40.0)])
    within = shapely.Point(50.0, 30.0).buffer(15.0).difference(shapely.box(45.0, 35.0, 50.0, 40.0))
    assert allowed(fence).symmetric_difference(within).area < 1e-9
    assert len(fence.exclusions_m) == 1


def test_a_yard_that_cannot_be_entered_is_stayed_out_of_with_its_wall() -> None:
    fence = fence_around((5.0, 5.0), FIELD, [ring(25.0, 15.0)])
    assert allowed(fence).symmetric_difference(FIELD.difference(shapely.Point(50.0, 30.0).buffer(25.0))).area < 1e-9


def test_a_region_of_several_parts_is_several_areas() -> None:
    rows = shapely.MultiPolygon([shapely.box(20.0, 10.0, 30.0, 50.0), shapely.box(60.0, 10.0, 70.0, 50.0)])
    assert len(fence_around((5.0, 5.0), FIELD, [rows]).exclusions_m) == 2


@pytest.fixture(scope="module")
def plan() -> FlightPlan:
    return plan_of(SMALL)


def test_the_fence_of_a_plan_has_the_corners_that_were_drawn(plan: FlightPlan) -> None:
    fence = fence_of(plan)
    assert len(fence.inclusion_m) == 4
    (pond,) = fence.exclusions_m
    assert shapely.Polygon(pond).equals(shapely.box(4.0, 22.0, 14.0, 28.0))
    assert len(pond) == 4


def test_one_comes_back_to_where_the_flight_ends_or_else_to_the_middle_of_a_home(plan: FlightPlan) -> None:
    (end,) = rally_points(plan)
    assert end == pytest.approx(tuple(plan.curve.position([plan.curve.duration_s])[0]))
    _, middle = rally_points(plan_of(SMALL.replace("pond: {kind: restricted", "pond: {kind: home")))
    assert shapely.box(4.0, 22.0, 14.0, 28.0).boundary.distance(shapely.Point(middle)) == pytest.approx(3.0, abs=0.05)
