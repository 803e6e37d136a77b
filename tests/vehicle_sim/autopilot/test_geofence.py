"""The geometry of fences against shapely, an independent oracle."""

from math import cos, inf, pi, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import Point
from shapely.geometry import Polygon as Ring

from vehicle_sim.autopilot.geofence import Circle, LocalFence, Polygon
from vehicle_sim.geodesy import geodetic_at, ned_offset_m
from vehicle_sim.signals import Geodetic

ORIGIN = Geodetic(47.397742, 8.545594, 488.0)
Corners = list[tuple[float, float]]


def place(north: float, east: float) -> Geodetic:
    return geodetic_at(ORIGIN, (north, east, 0.0))


def polygon(corners: Corners, *, contains: bool = True) -> Polygon:
    return Polygon(contains, tuple(place(*corner) for corner in corners))


SQUARE: Corners = [(0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (0.0, 20.0)]


@st.composite
def stars(draw: st.DrawFn) -> Corners:
    """A simple polygon, rarely convex: one corner in each of several directions from a centre."""
    count = draw(st.integers(3, 12))
    radii = draw(st.lists(st.floats(2.0, 60.0), min_size=count, max_size=count))
    north, east = draw(st.floats(-30.0, 30.0)), draw(st.floats(-30.0, 30.0))
    turns = [2.0 * pi * (i + 0.4 * draw(st.floats(0.0, 1.0))) / count for i in range(count)]
    return [(north + r * cos(turn), east + r * sin(turn)) for r, turn in zip(radii, turns, strict=True)]


POINTS = st.tuples(st.floats(-100.0, 100.0), st.floats(-100.0, 100.0))


@given(corners=stars(), point=POINTS, contains=st.booleans())
def test_a_polygons_signed_distance(corners: Corners, point: tuple[float, float], *, contains: bool) -> None:
    ring = Ring(corners)
    distance = ring.exterior.distance(Point(point))
    expected = -distance if ring.contains(Point(point)) == contains else distance
    excess = LocalFence([polygon(corners, contains=contains)], ORIGIN).excess_m(*point)
    # Vertices travel over the earth and back.
    assert excess == pytest.approx(expected, abs=1e-5)


@given(shapes=st.lists(st.tuples(stars(), st.booleans()), min_size=1, max_size=4), point=POINTS)
def test_areas_together(shapes: list[tuple[Corners, bool]], point: tuple[float, float]) -> None:
    fence = LocalFence([polygon(corners, contains=contains) for corners, contains in shapes], ORIGIN)
    inside = [Ring(corners).contains(Point(point)) for corners, _ in shapes]
    borders = min(Ring(corners).exterior.distance(Point(point)) for corners, _ in shapes)
    if borders < 1e-4:
        return
    allowed = all(was == contains for was, (_, contains) in zip(inside, shapes, strict=True))
    assert (fence.excess_m(*point) < 0.0) == allowed
    nearest = fence.nearest_m(*point)
    assert np.hypot(nearest[:, 0], nearest[:, 1]).min() == pytest.approx(borders, abs=1e-5)
    held = [was for was, (_, contains) in zip(inside, shapes, strict=True) if contains]
    kept_out = [was for was, (_, contains) in zip(inside, shapes, strict=True) if not contains]
    in_union = (any(held) or not held) and not any(kept_out)
    assert (fence.excess_m(*point, is_union=True) < 0.0) == in_union


@given(shapes=st.lists(stars(), min_size=1, max_size=3), a=POINTS, b=POINTS, is_union=st.booleans())
def test_no_point_is_nearer_to_a_breach_than_it_says(
    shapes: list[Corners], a: tuple[float, float], b: tuple[float, float], *, is_union: bool
) -> None:
    circle = Circle(contains=False, centre=place(10.0, -15.0), radius_m=12.0)
    fence = LocalFence([*(polygon(corners) for corners in shapes), circle], ORIGIN)
    there, here = fence.excess_m(*a, is_union=is_union), fence.excess_m(*b, is_union=is_union)
    assert abs(there - here) <= np.hypot(a[0] - b[0], a[1] - b[1]) + 1e-9


@given(point=POINTS, radius=st.floats(1.0, 80.0), contains=st.booleans())
def test_circles(point: tuple[float, float], radius: float, *, contains: bool) -> None:
    fence = LocalFence([Circle(contains, place(5.0, 7.0), radius)], ORIGIN)
    outside = np.hypot(point[0] - 5.0, point[1] - 7.0) - radius
    assert fence.excess_m(*point) == pytest.approx(outside if contains else -outside, abs=1e-5)
    (offset,) = fence.nearest_m(*point)
    assert np.hypot(*offset) == pytest.approx(abs(outside), abs=1e-5)
    rim = np.hypot(point[0] + offset[0] - 5.0, point[1] + offset[1] - 7.0)
    assert rim == pytest.approx(radius, abs=1e-5)


def test_the_centre_of_a_circle_and_edges_without_length_are_no_trouble() -> None:
    centred = LocalFence([Circle(contains=True, centre=ORIGIN, radius_m=9.0)], ORIGIN)
    assert centred.excess_m(0.0, 0.0) == pytest.approx(-9.0)
    assert np.hypot(*centred.nearest_m(0.0, 0.0)[0]) == pytest.approx(9.0)
    doubled = LocalFence([polygon([SQUARE[0], *SQUARE, SQUARE[-1]])], ORIGIN)
    assert doubled.excess_m(5.0, 10.0) == pytest.approx(-5.0, abs=1e-5)


def test_no_areas_forbid_nothing() -> None:
    assert LocalFence([], ORIGIN).excess_m(1e6, 1e6) == -inf


def test_the_frame_is_that_of_the_origin() -> None:
    elsewhere = geodetic_at(ORIGIN, (100.0, -40.0, 0.0))
    fence = LocalFence([polygon(SQUARE)], elsewhere)
    north, east, _ = ned_offset_m(elsewhere, place(10.0, 10.0))
    assert fence.excess_m(north, east) == pytest.approx(-10.0, abs=1e-3)
