"""Covering regions: complete but for what the ground forbids, inside, no lane twice, and about as long as must be."""

from itertools import pairwise, permutations, product

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from scipy.ndimage import distance_transform_edt

from mission.coverage.area import INSET
from mission.coverage.coverage import Coverage
from mission.coverage.covering import SPARED, TOLERANCE, cover
from mission.coverage.pace import Pace
from mission.coverage.sequence import MOST_ALONE
from mission.errors import GeometryError
from tests.support.drawn_cases import tried

PACE = Pace(speed_m_s=5.0, acceleration_m_s2=2.5, jerk_m_s3=4.0, reach_m=2.0)
AWAY = np.array([-60.0, -60.0])


def covered(
    region: shapely.Geometry, *, spacing_m: float, aside_m: float = 0.5, heading_deg: float | None = None
) -> Coverage:
    """A region in the middle of much free space, its holes forbidden."""
    return cover(
        region,
        shapely.buffer(region, -aside_m),
        free_of(region, aside_m),
        spacing_m=spacing_m,
        entry_m=AWAY,
        pace=PACE,
        heading_deg=heading_deg,
    )


def free_of(region: shapely.Geometry, aside_m: float) -> shapely.Geometry:
    holes = [shapely.Polygon(ring) for part in shapely.get_parts(region) for ring in part.interiors]
    forbidden = shapely.difference(shapely.union_all(holes), region)
    return shapely.difference(shapely.box(-100.0, -100.0, 250.0, 250.0), shapely.buffer(forbidden, aside_m))


def distances_m(places: np.ndarray, lanes: np.ndarray) -> np.ndarray:
    """From each place to the nearest of the lanes."""
    steps = lanes[:, 1] - lanes[:, 0]
    share = ((places[:, None] - lanes[:, 0]) * steps).sum(axis=2) / (steps**2).sum(axis=1)
    nearest = lanes[:, 0] + np.clip(share, 0.0, 1.0)[..., None] * steps
    found: np.ndarray = np.linalg.norm(places[:, None] - nearest, axis=2).min(axis=1)
    return found


def left_out(
    region: shapely.Geometry, ground: shapely.Geometry, lanes: np.ndarray, reach_m: float
) -> tuple[float, float]:
    """Of a grid of places: how far the farthest on the ground is from a lane, and the share of the reachable beyond."""
    left, low, right, high = shapely.bounds(region)
    step = np.hypot(right - left, high - low) / 150.0
    x, y = np.meshgrid(np.arange(left, right + step, step), np.arange(low, high + step, step))
    on_ground = shapely.contains_xy(ground, x, y)
    # The ground comes no nearer than its places of the grid are: none is called reachable that is not.
    reachable = (distance_transform_edt(~on_ground) * step <= reach_m) & shapely.contains_xy(region, x, y)
    distances = distances_m(np.stack((x[reachable], y[reachable]), axis=1), lanes)
    return float(distances[on_ground[reachable]].max()), float((distances > reach_m * (1.0 + 6.0 * INSET)).mean())


def assert_sound(
    coverage: Coverage, region: shapely.Geometry, ground: shapely.Geometry, free: shapely.Geometry, spacing_m: float
) -> None:
    lanes = shapely.linestrings(coverage.lanes_m)
    assert shapely.covers(ground, lanes).all()
    ways = shapely.linestrings([pair for way in (*coverage.ways_m, coverage.approach_m) for pair in pairwise(way)])
    assert shapely.covers(free, ways[shapely.length(ways) > 0.0]).all()
    most = spacing_m * (0.5 + TOLERANCE + 3.0 * INSET)
    worst_m, share = left_out(region, ground, coverage.lanes_m, spacing_m / 2.0)
    assert worst_m <= most
    assert share <= 2.0 * SPARED
    tree = shapely.STRtree(lanes)
    beside, thin = tree.query(shapely.buffer(lanes, 1e-4 * spacing_m, cap_style="flat"), predicate="intersects")
    twice = shapely.intersection(shapely.buffer(lanes[beside], 1e-4 * spacing_m, cap_style="flat"), lanes[thin])
    assert shapely.length(twice)[beside != thin].max(initial=0.0) < 0.05 * spacing_m
    # The whole is one line, whose pieces are the lanes and the ways in turn.
    assert len(coverage.ways_m) == len(coverage.lanes_m) - 1
    assert len(coverage.line_m) == len(coverage.on_lane) + 1
    pieces = np.linalg.norm(np.diff(coverage.line_m, axis=0), axis=1)
    assert pieces[coverage.on_lane].sum() == pytest.approx(coverage.lanes_length_m)
    assert pieces[~coverage.on_lane].sum() == pytest.approx(coverage.ways_length_m)
    assert coverage.approach_m[-1].tolist() == coverage.line_m[0].tolist() == coverage.lanes_m[0, 0].tolist()


def drawn(seed: int) -> shapely.Geometry:
    """A field with bays and holes, at random; one part or several."""
    chance = np.random.default_rng(seed)
    turns = np.sort(chance.uniform(0.0, 2.0 * np.pi, chance.integers(3, 12)))
    radii = chance.uniform(20.0, 75.0, len(turns))
    field = shapely.make_valid(
        shapely.Polygon(75.0 + radii[:, None] * np.stack((np.cos(turns), np.sin(turns)), axis=1))
    )
    for _ in range(chance.integers(0, 4)):
        corners = chance.uniform(20.0, 130.0, 2) + chance.uniform(-15.0, 15.0, (3, 2))
        field = shapely.difference(field, shapely.buffer(shapely.Polygon(corners), chance.choice([0.0, 3.0])))
    return shapely.MultiPolygon(
        [part for part in shapely.get_parts(field) if part.geom_type == "Polygon" and part.area > 1.0]
    )


@tried(12)
@given(st.integers(0, 10**6), st.floats(4.0, 15.0), st.floats(0.2, 2.0), st.none() | st.floats(0.0, 360.0))
def test_whatever_the_region_is_it_is_covered(
    seed: int, spacing_m: float, aside_m: float, heading_deg: float | None
) -> None:
    region = drawn(seed)
    ground = shapely.buffer(region, -aside_m)
    if ground.is_empty:
        return
    free = free_of(region, aside_m / 2.0)
    coverage = cover(region, ground, free, spacing_m=spacing_m, entry_m=AWAY, pace=PACE, heading_deg=heading_deg)
    assert_sound(coverage, region, ground, free, spacing_m)


@pytest.mark.parametrize(
    "corners",
    [
        [(0, 0), (120, 0), (120, 80), (0, 80)],
        [(0, 0), (100, 10), (130, 70), (60, 120), (-10, 60)],
        [(0, 0), (120, 20), (40, 110)],
    ],
)
def test_lanes_of_a_convex_field_are_about_as_long_as_its_area_asks_for(corners: list[tuple[float, float]]) -> None:
    region, spacing_m = shapely.Polygon(corners), 4.0
    coverage = covered(region, spacing_m=spacing_m)
    assert coverage.lanes_length_m <= 1.03 * region.area / spacing_m + spacing_m * len(coverage.lanes_m)
    assert coverage.ways_length_m <= 0.25 * coverage.lanes_length_m
    assert coverage.exact


def test_a_rectangle_is_flown_along_its_longer_side_from_the_corner_at_hand() -> None:
    coverage = covered(shapely.box(0.0, 0.0, 120.0, 40.0), spacing_m=8.0)
    assert coverage.heading_deg == pytest.approx(90.0)
    assert coverage.lanes_m.shape == (5, 2, 2)
    np.testing.assert_allclose(coverage.lanes_m[0], [[0.5, 4.0], [119.5, 4.0]], atol=8.0 * 3.0 * INSET)
    np.testing.assert_allclose(coverage.lanes_m[:, 0, 1], [4.0, 12.0, 20.0, 28.0, 36.0], atol=1e-6)
    # The way to the side along the rim, four times.
    assert coverage.ways_length_m == pytest.approx(32.0)
    assert coverage.cell_of.tolist() == [0] * 5


def test_a_wanted_heading_is_kept_and_a_wanted_exit_reached() -> None:
    region = shapely.box(0.0, 0.0, 60.0, 40.0)
    coverage = cover(
        region,
        shapely.buffer(region, -0.5),
        free_of(region, 0.0),
        spacing_m=8.0,
        entry_m=(-10.0, -10.0),
        exit_m=(-10.0, 50.0),
        heading_deg=380.0,
        pace=PACE,
    )
    assert coverage.heading_deg == pytest.approx(20.0)
    assert coverage.leaving_m[0].tolist() == coverage.lanes_m[-1, 1].tolist()
    assert coverage.leaving_m[-1].tolist() == [-10.0, 50.0]
    long = coverage.cell_of >= 0
    steps = coverage.lanes_m[long, 1] - coverage.lanes_m[long, 0]
    np.testing.assert_allclose(np.degrees(np.arctan2(steps[:, 0], steps[:, 1])) % 180.0, 20.0)


def test_a_region_narrower_than_the_spacing_gets_one_lane_along_its_middle() -> None:
    coverage = covered(shapely.box(0.0, 0.0, 100.0, 6.0), spacing_m=8.0)
    assert coverage.lanes_m.shape == (1, 2, 2)
    np.testing.assert_allclose(coverage.lanes_m[0, :, 1], 3.0)
    assert coverage.ways_m == ()


def test_a_bent_strip_gets_lanes_along_its_middle_one_after_the_other() -> None:
    middle = shapely.LineString([(0.0, 0.0), (40.0, 10.0), (70.0, 40.0), (75.0, 80.0)])
    region = shapely.buffer(middle, 2.5, cap_style="flat")
    coverage = covered(region, spacing_m=8.0)
    assert_sound(coverage, region, shapely.buffer(region, -0.5), free_of(region, 0.0), 8.0)
    assert shapely.distance(shapely.linestrings(coverage.lanes_m), middle).max() < 1e-6
    assert distances_m(shapely.get_coordinates(middle), coverage.lanes_m).max() < 1.0
    assert coverage.ways_length_m == pytest.approx(0.0, abs=1e-6)
    assert coverage.lanes_length_m == pytest.approx(middle.length, rel=0.02)


def test_a_road_that_forks_and_one_that_goes_round_are_covered() -> None:
    stem = shapely.buffer(shapely.LineString([(0.0, 0.0), (80.0, 0.0)]), 3.0, cap_style="flat")
    branch = shapely.buffer(shapely.LineString([(40.0, 0.0), (50.0, 60.0)]), 3.0, cap_style="flat")
    ring = shapely.difference(shapely.buffer(shapely.Point(40.0, 40.0), 30.0), shapely.Point(40.0, 40.0).buffer(25.0))
    for region, most_m in [(shapely.union_all([stem, branch]), 145.0), (ring, 2.0 * np.pi * 28.5)]:
        coverage = covered(region, spacing_m=8.0)
        assert_sound(coverage, region, shapely.buffer(region, -0.5), free_of(region, 0.25), 8.0)
        assert coverage.lanes_length_m <= most_m


def test_a_part_that_is_too_small_for_a_line_of_the_sweep_is_visited() -> None:
    region = shapely.MultiPolygon([shapely.box(0.0, 0.0, 60.0, 40.0), shapely.box(70.0, 0.0, 71.2, 1.2)])
    coverage = covered(region, spacing_m=8.0)
    assert_sound(coverage, region, shapely.buffer(region, -0.5), free_of(region, 0.0), 8.0)
    assert np.linalg.norm(coverage.lanes_m - [70.6, 0.6], axis=2).min() < 0.2


@pytest.mark.parametrize(("spacing_m", "most"), [(5.0, 0.1), (4.0, 0.1), (3.3, 0.1)])
def test_the_sides_of_a_ring_are_flown_along_whatever_the_heading(spacing_m: float, most: float) -> None:
    region = shapely.difference(shapely.box(0.0, 0.0, 100.0, 100.0), shapely.box(10.0, 10.0, 90.0, 90.0))
    coverage = covered(region, spacing_m=spacing_m, aside_m=1.5)
    assert_sound(coverage, region, shapely.buffer(region, -1.5), free_of(region, 0.75), spacing_m)
    steps = coverage.lanes_m[:, 1] - coverage.lanes_m[:, 0]
    assert np.median(np.linalg.norm(steps, axis=1)) > 75.0
    assert coverage.ways_length_m <= most * coverage.lanes_length_m


def cost_s(lanes: np.ndarray) -> float:
    """Of lanes one after the other, straight from each to the next: ways between them count a quarter more."""
    places = np.concatenate(([AWAY], lanes.reshape(-1, 2)))
    steps = np.diff(places, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    units = steps / lengths[:, None]
    cosines = np.concatenate(([np.nan], (units[:-1] * units[1:]).sum(axis=1)))
    links = PACE.link_s(lengths[::2], cosines[::2], cosines[1::2])
    return float(links.sum() + 0.25 * lengths[2::2].sum() / PACE.speed_m_s)


def test_few_lanes_are_flown_in_the_best_of_all_orders() -> None:
    region = shapely.MultiPolygon([shapely.box(0.0, 0.0, 40.0, 24.0), shapely.box(50.0, 9.0, 78.0, 22.0)])
    coverage = covered(region, spacing_m=8.0, heading_deg=90.0)
    count = len(coverage.lanes_m)
    assert count == 5 <= MOST_ALONE
    assert coverage.exact
    least = min(
        cost_s(np.array([coverage.lanes_m[lane][::turn] for lane, turn in zip(order, turns, strict=True)]))
        for order in permutations(range(count))
        for turns in product((1, -1), repeat=count)
    )
    assert cost_s(coverage.lanes_m) == pytest.approx(least, abs=1e-3)


def test_the_side_of_a_hole_along_the_lanes_has_a_lane_where_the_others_are_too_far() -> None:
    hole = [(30.0, 33.0), (90.0, 33.0), (90.0, 47.0), (30.0, 47.0)]
    region = shapely.Polygon([(0.0, 0.0), (120.0, 0.0), (120.0, 80.0), (0.0, 80.0)], [hole])
    coverage = covered(region, spacing_m=8.0, heading_deg=90.0)
    assert_sound(coverage, region, shapely.buffer(region, -0.5), free_of(region, 0.0), 8.0)
    own = coverage.lanes_m[coverage.cell_of < 0]
    assert np.ptp(own[..., 1], axis=1).max() < 8.0 * INSET
    assert np.linalg.norm(own[:, 1] - own[:, 0], axis=1).max() > 50.0


def test_parts_are_joined_through_free_space_and_never_through_what_is_forbidden() -> None:
    region = shapely.MultiPolygon([shapely.box(0.0, 0.0, 60.0, 10.0), shapely.box(0.0, 30.0, 60.0, 40.0)])
    ground, wall = shapely.buffer(region, -0.5), shapely.box(-20.0, 18.0, 50.0, 22.0)
    free = shapely.difference(shapely.box(-50.0, -50.0, 100.0, 100.0), wall)
    coverage = cover(region, ground, free, spacing_m=5.0, entry_m=(-10.0, 0.0), pace=PACE)
    assert_sound(coverage, region, ground, free, 5.0)
    outside_m = [shapely.difference(shapely.LineString(way), ground).length for way in coverage.ways_m]
    assert np.count_nonzero(outside_m) == 1


def test_far_from_the_origin_it_is_the_same() -> None:
    region, offset = drawn(5), np.array([4.5e5, 5.4e6])
    moved = shapely.transform(region, lambda xy: xy + offset)
    ground = shapely.buffer(region, -1.0)
    here = cover(region, ground, ground, spacing_m=8.0, entry_m=ground.representative_point().coords[0], pace=PACE)
    ground = shapely.transform(ground, lambda xy: xy + offset)
    there = cover(moved, ground, ground, spacing_m=8.0, entry_m=here.approach_m[0] + offset, pace=PACE)
    assert there.cell_of.tolist() == here.cell_of.tolist()
    np.testing.assert_allclose(there.lanes_m - offset, here.lanes_m, atol=1e-5)


def test_what_cannot_be_covered_is_refused() -> None:
    region = shapely.box(0.0, 0.0, 60.0, 40.0)
    ground = shapely.buffer(region, -1.0)
    two = shapely.MultiPolygon([shapely.box(1.0, 1.0, 20.0, 39.0), shapely.box(40.0, 1.0, 59.0, 39.0)])
    for shapes, spacing_m, said in [
        ((region, shapely.Polygon(), ground), 8.0, "no lane fits"),
        ((region, ground, shapely.box(0.0, 0.0, 30.0, 40.0)), 8.0, "leave free space"),
        ((region, ground, ground), 0.01, "more than"),
        ((region, two, two), 8.0, "no way leads"),
    ]:
        with pytest.raises(GeometryError, match=said):
            cover(*shapes, spacing_m=spacing_m, entry_m=(2.0, 2.0), pace=PACE)


def test_ways_lead_from_a_place_on_the_very_rim_and_from_none_outside() -> None:
    region = shapely.box(0.0, 0.0, 60.0, 40.0)
    ground = shapely.buffer(region, -1.0)
    coverage = cover(region, ground, ground, spacing_m=8.0, entry_m=(1.0, 1.0), exit_m=(59.0, 39.0), pace=PACE)
    assert (coverage.approach_m[0].tolist(), coverage.leaving_m[-1].tolist()) == ([1.0, 1.0], [59.0, 39.0])
    with pytest.raises(GeometryError, match="not in free space"):
        cover(region, ground, ground, spacing_m=8.0, entry_m=(0.0, 0.0), pace=PACE)


@tried(12)
@given(st.integers(0, 10**6), st.floats(4.0, 15.0), st.floats(0.8, 1.0), st.none() | st.floats(0.0, 360.0))
def test_of_a_region_as_much_is_covered_as_is_asked_for(
    seed: int, spacing_m: float, share: float, heading_deg: float | None
) -> None:
    region = drawn(seed)
    ground = shapely.buffer(region, -0.5)
    if ground.is_empty:
        return
    coverage = cover(
        region,
        ground,
        free_of(region, 0.25),
        spacing_m=spacing_m,
        entry_m=AWAY,
        pace=PACE,
        heading_deg=heading_deg,
        share=share,
    )
    lanes = shapely.linestrings(coverage.lanes_m)
    assert shapely.covers(ground, lanes).all()
    missed = region.area - shapely.intersection(region, shapely.union_all(shapely.buffer(lanes, spacing_m / 2.0))).area
    beyond = region.area - shapely.intersection(region, shapely.buffer(ground, spacing_m / 2.0)).area
    scraps = 5e-3 * spacing_m**2
    assert missed <= max((1.0 - share) * region.area, beyond + 2.0 * SPARED * region.area) + scraps


def test_a_line_is_saved_where_the_share_that_is_asked_for_allows_it() -> None:
    region = shapely.box(0.0, 0.0, 120.0, 40.5)
    ground = shapely.buffer(region, -0.5)
    for share, count in ((1.0, 6), (0.98, 5), (0.78, 4), (0.39, 2)):
        coverage = cover(
            region, ground, ground, spacing_m=8.0, entry_m=(1.0, 1.0), pace=PACE, heading_deg=90.0, share=share
        )
        assert len(coverage.lanes_m) == count
        assert coverage.complete == (share == 1.0)
