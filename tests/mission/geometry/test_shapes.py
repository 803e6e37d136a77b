"""Areas: what they contain, how near a polygon is to what is round, and which side it errs on."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from mission.geometry.shapes import (
    CORNER_SHARE,
    DISC_M,
    DISC_SHARE,
    disc,
    grown,
    narrowed,
    rings_of,
    shrunk,
    strip,
    united,
    widened,
    without_straight_corners,
)
from tests.support.drawn_cases import tried

SQUARE = np.array([[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0]])
FAR_M = np.array([432_100.25, 5_678_900.5])
"""An easting and a northing; whole quarters of metres are exact there."""

lengths = st.floats(0.05, 30.0)


@st.composite
def stars(draw: st.DrawFn) -> shapely.Polygon:
    """Polygons of five to twelve corners at random distances from a middle, most of them concave, with a hole."""
    count = draw(st.integers(5, 12))
    radii = np.array(draw(st.lists(st.floats(12.0, 60.0), min_size=count, max_size=count)))
    angles = 2.0 * np.pi * np.arange(count) / count
    ring = radii[:, None] * np.stack((np.cos(angles), np.sin(angles)), axis=1)
    turned = draw(st.booleans())
    hole = 0.1 * ring[::-1] if draw(st.booleans()) else 0.1 * ring
    return united([(ring[::-1] if turned else ring, [hole])])


@tried(40)
@given(stars(), lengths)
def test_a_grown_area_contains_what_is_within_the_distance_and_little_more(area: shapely.Polygon, by_m: float) -> None:
    out = grown(area, by_m)
    assert shapely.is_valid(out)
    assert shapely.difference(shapely.buffer(area, by_m, quad_segs=64), out).area < 1e-6
    most = shapely.buffer(area, by_m * (1.0 + CORNER_SHARE), quad_segs=128)
    assert shapely.difference(out, shapely.buffer(most, 1e-3 * by_m)).area < 1e-6


@tried(40)
@given(stars(), lengths)
def test_a_shrunk_area_is_the_distance_inside_and_loses_little_more(area: shapely.Polygon, by_m: float) -> None:
    within = shrunk(area, by_m)
    assert shapely.is_valid(within)
    assert within.is_empty or shapely.distance(within, area.boundary) > by_m - 1e-6
    assert shapely.difference(within, area).area < 1e-6
    least = shapely.buffer(area, -by_m * (1.0 + CORNER_SHARE), quad_segs=128)
    assert shapely.difference(shapely.buffer(least, -2e-3 * by_m), within).area < 1e-6


def test_straight_rims_move_by_the_distance_exactly() -> None:
    west, south, east, north = grown(united([(SQUARE, [])]), 2.5).bounds
    assert (west, south, east, north) == (-2.5, -2.5, 22.5, 22.5)
    assert shrunk(united([(SQUARE, [])]), 2.5).equals(shapely.box(2.5, 2.5, 17.5, 17.5))
    assert shrunk(united([(SQUARE, [])]), 10.0).is_empty


def test_holes_close_and_parts_meet_where_an_area_grows() -> None:
    court = united([(SQUARE, [SQUARE * 0.4 + 6.0]), (SQUARE + np.array([25.0, 0.0]), [])])
    assert len(rings_of(court)) == 3
    assert len(rings_of(grown(court, 2.0))) == 3
    assert [len(shapely.get_parts(grown(court, by))) for by in (2.4, 2.6)] == [2, 1]
    assert len(rings_of(grown(court, 4.5))) == 1
    assert len(shapely.get_parts(shrunk(grown(court, 2.6), 2.6))) == 2 - 1  # a bridge between the parts is left


@pytest.mark.parametrize("radius_m", [0.5, 12.0, 80.0, 900.0])
def test_a_disc_is_around_the_circle_or_within_it_as_near_as_is_said(radius_m: float) -> None:
    centre = np.array([3.0, -4.0])
    off_m = min(DISC_SHARE * radius_m, DISC_M) + 1e-9
    around, within = disc(centre, radius_m, outside=True), disc(centre, radius_m, outside=False)
    middle = shapely.Point(centre)
    assert shapely.distance(around.boundary, middle) == pytest.approx(radius_m)
    assert shapely.hausdorff_distance(around.boundary, middle) <= radius_m + off_m
    assert shapely.hausdorff_distance(within.boundary, middle) == pytest.approx(radius_m)
    assert shapely.distance(within.boundary, middle) >= radius_m - off_m


def test_a_strip_is_flat_at_its_ends_and_round_at_its_bends() -> None:
    straight = strip(np.array([[0.0, 0.0], [10.0, 0.0]]), 4.0, outside=True)
    assert straight.equals(shapely.box(0.0, -2.0, 10.0, 2.0))
    bent = np.array([[0.0, 0.0], [30.0, 0.0], [30.0, 40.0], [0.0, 20.0]])
    exact = shapely.buffer(shapely.LineString(bent), 2.0, quad_segs=256, cap_style="flat")
    around, within = strip(bent, 4.0, outside=True), strip(bent, 4.0, outside=False)
    assert shapely.difference(exact, around).area < 1e-3
    assert shapely.difference(within, exact).area < 1e-3
    assert around.area - within.area < 1.0


def test_a_strip_with_corners_on_a_straight_line_is_that_of_its_bends() -> None:
    with_more = np.array([[-10.0, 80.0], [30.0, 75.0], [70.0, 70.0], [109.0, 73.0], [148.0, 76.0]])
    line = strip(with_more, 6.0, outside=True)
    assert shapely.symmetric_difference(line, strip(with_more[::2], 6.0, outside=True)).area < 1e-6
    assert shapely.hausdorff_distance(grown(line, 8.0), grown(strip(with_more[::2], 6.0, outside=True), 8.0)) < 1e-6


def test_a_strip_that_ends_where_it_begins_is_a_ring() -> None:
    loop = strip(np.concatenate((SQUARE, SQUARE[:1])), 2.0, outside=True)
    assert len(rings_of(loop)) == 2
    assert not shapely.difference(shapely.buffer(shapely.LinearRing(SQUARE), 1.0, quad_segs=64), loop).area > 1e-9


def test_sound_polygons_keep_their_corners_and_others_are_mended() -> None:
    hole = SQUARE * 0.25 + 5.1
    (rim, inner) = rings_of(united([(SQUARE + 0.1, [hole])]))
    assert np.array_equal(rim, SQUARE + 0.1)
    assert np.array_equal(inner, hole)
    bay = united([(SQUARE, [SQUARE * 0.5 + np.array([5.0, 12.0])])])
    assert bay.area == 320.0
    overlapping = united([(SQUARE, []), (SQUARE + 10.0, [])])
    assert (overlapping.geom_type, overlapping.area) == ("Polygon", 700.0)


def test_nothing_is_lost_far_from_the_origin() -> None:
    area = united([(SQUARE, [SQUARE * 0.25 + 5.0])])
    there = united([(SQUARE + FAR_M, [SQUARE * 0.25 + 5.0 + FAR_M])])
    line = np.array([[0.0, 0.0], [30.0, 0.25], [30.0, 40.0]])
    for near, far in [
        (grown(area, 1.7), grown(there, 1.7)),
        (shrunk(area, 1.7), shrunk(there, 1.7)),
        (strip(line, 3.3, outside=True), strip(line + FAR_M, 3.3, outside=True)),
        (disc(np.zeros(2), 33.3, outside=True), disc(FAR_M, 33.3, outside=True)),
    ]:
        back = shapely.transform(far, lambda places: places - FAR_M)
        assert shapely.symmetric_difference(near, back).area < 1e-5
        assert shapely.hausdorff_distance(near, back) < 1e-8


@tried(40)
@given(stars(), lengths, st.integers(0, 2**32))
def test_a_square_meets_or_lies_in_an_area_as_its_middle_lies_in_the_sums(
    area: shapely.Polygon, by_m: float, seed: int
) -> None:
    outer, inner = widened(area, by_m), narrowed(area, by_m)
    places = np.random.default_rng(seed).uniform(-90.0, 90.0, (60, 2))
    for place, meets, lies_in in zip(
        places,
        shapely.contains_xy(outer, places),
        shapely.contains_xy(inner, places),
        strict=True,
    ):
        smaller, larger = (shapely.box(*(place - reach), *(place + reach)) for reach in (by_m - 1e-6, by_m + 1e-6))
        assert shapely.intersects(smaller, area) <= meets <= shapely.intersects(larger, area)
        assert shapely.covers(area, larger) <= lies_in <= shapely.covers(area, smaller)


def test_corners_on_straight_edges_go_and_others_stay() -> None:
    ring = [(0.0, 0.0), (5.0, 0.0), (9.0, 0.0), (10.0, 0.0), (10.0, 10.0), (5.0, 10.01), (0.0, 10.0)]
    (kept,) = rings_of(without_straight_corners(shapely.Polygon(ring), 1e-6))
    assert len(kept) == 5
