"""The fence that guards a flight: it only ever gives way, and it fits into what an autopilot keeps."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from mission.geometry.geodesy import LatLon, curvature_radii_m, enu_offset_m
from mission.plan.fence import Circle, Fence, Rim, corners_of, fence_of
from mission.plan.guarding import Room, frame_share, opened, reach_m, thinned
from tests.support.drawn_cases import tried
from tests.support.small_missions import SMALL, plan_of

FIELD = corners_of(shapely.box(0.0, 0.0, 100.0, 60.0))


def shape(rim: Rim) -> shapely.Polygon:
    return shapely.Point(rim.centre_m).buffer(rim.radius_m, 64) if isinstance(rim, Circle) else shapely.Polygon(rim)


def allowed(fence: Fence) -> shapely.Geometry:
    return shapely.difference(shape(fence.inclusion), shapely.union_all([shape(rim) for rim in fence.exclusions]))


def star(seed: int, corners: int, centre: tuple[float, float], size_m: float) -> Rim:
    """A polygon of that many corners, seen whole from its centre."""
    random = np.random.default_rng(seed)
    turns = 2.0 * np.pi * (np.arange(corners) + 0.8 * random.random(corners)) / corners
    reach = size_m * (0.3 + 0.7 * random.random(corners))
    return np.array(centre) + np.stack((reach * np.cos(turns), reach * np.sin(turns)), axis=1)


fences = st.builds(
    lambda seed, inner, outer: Fence(
        star(seed, outer, (50.0, 30.0), 300.0),
        (
            star(seed + 1, inner, (20.0, 30.0), 15.0),
            Circle((60.0, 30.0), 4.0),
            star(seed + 2, inner, (80.0, 20.0), 9.0),
        ),
    ),
    st.integers(0, 10_000),
    st.integers(3, 40),
    st.integers(8, 40),
)


@given(fences, st.floats(0.0, 3.0))
@tried(40)
def test_an_opened_fence_is_so_much_farther_from_wherever_one_may_be(fence: Fence, by_m: float) -> None:
    far = opened(fence, by_m)
    assert shape(far.inclusion).contains(shape(fence.inclusion).buffer(by_m))
    given_out = shapely.union_all([shape(rim) for rim in fence.exclusions])
    for rim in far.exclusions:
        stays = any(rim is each for each in fence.exclusions)  # for nothing would be left of it
        assert stays or given_out.buffer(1e-6).contains(shape(rim).buffer(by_m))
    # Corners that point inwards recede by five times as much at most, and nothing by more.
    kept_out = shapely.union_all([shape(rim) for rim in far.exclusions])
    for rim in fence.exclusions:
        assert shape(rim).buffer(-5.0 * (by_m + 0.01)).difference(kept_out.buffer(1e-6)).is_empty


def test_an_area_too_thin_to_give_way_stays() -> None:
    wall = corners_of(shapely.box(10.0, 10.0, 10.4, 30.0))
    fence = opened(Fence(FIELD, (wall, Circle((50.0, 30.0), 0.2))), 0.5)
    assert fence.exclusions[0] is wall
    assert fence.exclusions[1] == Circle((50.0, 30.0), 0.2)


@given(fences, st.integers(12, 120))
@tried(40)
def test_a_thinned_fence_lets_one_be_wherever_the_whole_one_does(fence: Fence, most: int) -> None:
    room = Room(most, 0, 1, 1)
    thin = thinned(fence, room)
    if thin is None:
        assert not room.holds(fence)
        return
    assert room.holds(thin)
    assert allowed(fence).difference(allowed(thin).buffer(1e-6)).area < 1e-6
    assert all(shape(rim).is_valid for rim in thin.rims)
    if room.holds(fence):
        assert all(a is b for a, b in zip(fence.rims, thin.rims, strict=True))


def test_the_flattest_corners_go_first_and_corners_that_must_stay_have_no_room() -> None:
    notched = corners_of(shapely.Polygon([(10, 10), (20, 9.9), (30, 10), (30, 30), (10, 30)]))
    (rim,) = (thinned(Fence(FIELD, (notched,)), Room(8, 0, 1, 1)) or Fence(FIELD, ())).exclusions
    assert shape(rim).equals(shapely.box(10.0, 10.0, 30.0, 30.0))
    assert thinned(Fence(FIELD, (corners_of(shapely.box(10.0, 10.0, 30.0, 30.0)),)), Room(6, 0, 1, 1)) is None


def test_room_is_counted_in_the_units_of_each_autopilot() -> None:
    fence = Fence(FIELD, (Circle((50.0, 30.0), 3.0),))
    assert Room(5, 0, 1, 1).holds(fence)
    assert not Room(4, 0, 1, 1).holds(fence)
    assert Room(47, 2, 8, 13).holds(fence)
    assert not Room(46, 2, 8, 13).holds(fence)


@pytest.mark.parametrize("latitude_deg", [0.0, 47.4, -67.0, 89.0])
def test_radii_of_curvature_are_what_small_offsets_say(latitude_deg: float) -> None:
    here, step_deg = LatLon(latitude_deg, 8.0), 1e-3
    _, north_m = enu_offset_m(here, LatLon(latitude_deg + step_deg, 8.0))
    east_m, _ = enu_offset_m(here, LatLon(latitude_deg, 8.0 + step_deg))
    meridian_m, across_m = curvature_radii_m(latitude_deg)
    assert north_m / math.radians(step_deg) == pytest.approx(meridian_m, rel=1e-5)
    assert east_m / math.radians(step_deg) / math.cos(math.radians(latitude_deg)) == pytest.approx(across_m, rel=1e-5)
    # A frame on a sphere takes the offset for what it would be there.
    off = max(abs(meridian_m - 6_371_000.0), abs(across_m - 6_371_000.0)) / 6_371_000.0
    assert frame_share(6_371_000.0, latitude_deg, 0.0) == pytest.approx(off)


def test_how_far_a_fence_reaches_counts_from_the_frame_s_origin() -> None:
    fence = Fence(FIELD, (Circle((50.0, 30.0), 3.0),))
    assert reach_m(fence, (0.0, 0.0)) == pytest.approx(math.hypot(100.0, 60.0))
    assert reach_m(Fence(Circle((50.0, 0.0), 10.0), ()), (-20.0, 40.0)) == pytest.approx(60.0)


@pytest.mark.parametrize(
    ("formula", "kept_out"),
    [
        ("F (goal & F G home)", [(26.0, 22.0)]),
        ("F (goal & F G home) & G !pond", [(26.0, 22.0), (4.0, 22.0)]),
        ("F (goal & F G home) & !F pond & G !shed", [(26.0, 22.0), (4.0, 22.0), (17.0, 24.0)]),
        ("F (goal & F G home) & !pond U goal", [(26.0, 22.0)]),
        ("F (goal & F G home) & G (goal -> G !pond) & G !(pond & shed)", [(26.0, 22.0)]),
    ],
)
def test_out_of_bounds_is_what_is_restricted_and_what_no_flight_may_ever_enter(
    formula: str, kept_out: list[tuple[float, float]]
) -> None:
    """A region that is to be avoided for a time alone is not fenced off, for the flight may lead there."""
    text = SMALL.replace("pond: {kind: restricted", "pond: {kind: area")
    text = text.replace(
        "mission:\n",
        "  shed: {kind: area, polygon: [[17, 24], [20, 24], [20, 27], [17, 27]]}\n"
        "  barn: {kind: restricted, polygon: [[26, 22], [36, 22], [36, 28], [26, 28]]}\nmission:\n",
    )
    text = text.replace("F (goal & F G home) & G !pond", formula)
    fence = fence_of(plan_of(text))
    assert [tuple(shape(rim).bounds[:2]) for rim in fence.exclusions] == kept_out


def test_of_two_regions_that_may_not_be_entered_together_what_they_have_in_common_is_out_of_bounds() -> None:
    text = SMALL.replace("pond: {kind: restricted", "pond: {kind: area").replace(
        "mission:\n", "  shed: {kind: area, polygon: [[10, 20], [20, 20], [20, 25], [10, 25]]}\nmission:\n"
    )
    fence = fence_of(plan_of(text.replace("G !pond", "G !(pond & shed)")))
    (rim,) = fence.exclusions
    assert shape(rim).equals(shapely.box(10.0, 22.0, 14.0, 25.0))
