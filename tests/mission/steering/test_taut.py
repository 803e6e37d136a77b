"""Taut paths against a plain visibility graph over dense rims, and against lengths that are known."""

from itertools import pairwise

import numpy as np
import pytest
import shapely
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from mission.geometry.arrays import FloatArray
from mission.steering.layered_paths import NoWayError
from mission.steering.taut import Stretch, TautPath, taut_path

FIELD = shapely.box(0.0, 0.0, 100.0, 60.0)
ON_RIM = 80


def field(seed: int, obstacles: int) -> tuple[shapely.Geometry, list[shapely.Polygon], FloatArray]:
    """A field without some convex obstacles that may overlap, three targets in it, and a place to start."""
    rng = np.random.default_rng(seed)
    clouds = rng.uniform((5.0, 5.0), (95.0, 55.0), (obstacles, 1, 2)) + rng.uniform(-6.0, 6.0, (obstacles, 5, 2))
    free = shapely.difference(FIELD, shapely.union_all(shapely.convex_hull(shapely.multipoints(clouds))))
    free = max(shapely.get_parts(free), key=shapely.area)
    targets: list[shapely.Polygon] = []
    while len(targets) < 3:
        corner = rng.uniform((2.0, 2.0), (85.0, 45.0))
        target = shapely.convex_hull(shapely.MultiPoint(corner + rng.uniform(0.0, 10.0, (4, 2))))
        inside = shapely.intersection(free, target)
        if inside.area > 10.0 and isinstance(inside, shapely.Polygon):
            targets.append(inside)
    while True:
        start = rng.uniform((0.0, 0.0), (100.0, 60.0))
        if shapely.contains(free, shapely.Point(start)):
            return free, targets, start


def rim_places(target: shapely.Polygon) -> FloatArray:
    rim = target.exterior
    places = [rim.interpolate(s) for s in np.linspace(0.0, rim.length, ON_RIM, endpoint=False)]
    return np.concatenate((shapely.get_coordinates(places), shapely.get_coordinates(rim)[:-1]))


def brute_force(start: FloatArray, frees: list[shapely.Geometry], layers: list[FloatArray]) -> FloatArray:
    """Lengths from the start to the places of the last layer, over all corners of free space and all places."""
    reached, places = np.zeros(1), np.array([start])
    for free, layer in zip(frees, layers, strict=True):
        nodes = np.concatenate((places, layer, shapely.get_coordinates(free)))
        room = shapely.buffer(free, 1e-7, join_style="mitre")
        shapely.prepare(room)
        one, other = np.triu_indices(len(nodes), 1)
        lengths = np.maximum(np.hypot(*(nodes[one] - nodes[other]).T), 1e-12)
        seen = shapely.covers(room, shapely.linestrings(np.stack((nodes[one], nodes[other]), axis=1)))
        seen |= lengths <= 1e-12
        size = len(nodes)
        graph = csr_array((lengths[seen], (one[seen].astype(np.int32), other[seen].astype(np.int32))), (size, size))
        between = dijkstra(graph, directed=False, indices=np.arange(len(places)))
        found = between[:, len(places) : len(places) + len(layer)]
        reached, places = (reached[:, None] + found).min(axis=0), layer
    return reached


def checked(path: TautPath, stretches: list[Stretch], start: FloatArray) -> None:
    """Each line is free, begins where the one before ends, and ends in its target."""
    for line, after in pairwise(path.lines):
        assert np.allclose(line.points_m[-1], after.points_m[0], atol=1e-9)
    assert np.allclose(path.lines[0].points_m[0], start)
    for line in path.lines:
        assert shapely.distance(stretches[line.stage].target, shapely.Point(line.points_m[-1])) < 1e-6
        if len(line.points_m) > 1:
            assert shapely.covers(shapely.buffer(line.free, 1e-6), shapely.LineString(line.points_m))


@pytest.mark.parametrize(("seed", "obstacles"), [(1, 0), (2, 6), (3, 12), (4, 20), (5, 25)])
def test_a_path_is_as_short_as_one_over_all_corners_and_dense_rims(seed: int, obstacles: int) -> None:
    free, targets, start = field(seed, obstacles)
    stretches = [Stretch(free, target) for target in targets]
    path = taut_path(start, stretches)
    checked(path, stretches, start)
    least = brute_force(start, [free] * 3, [rim_places(target) for target in targets]).min()
    assert path.length_m <= least * (1.0 + 1e-9)
    assert path.length_m >= least * (1.0 - 1e-3)


def jagged(seed: int) -> shapely.Polygon:
    """The largest part of a field among stars that overlap, so that most rims are long and full of pockets."""
    rng = np.random.default_rng(seed)
    stars = []
    for _ in range(14):
        angles = np.sort(rng.uniform(0.0, 2.0 * np.pi, 9))
        ring = rng.uniform(2.0, 12.0, (9, 1)) * np.stack((np.cos(angles), np.sin(angles)), axis=1)
        stars.append(shapely.make_valid(shapely.Polygon(rng.uniform((0.0, 0.0), (100.0, 60.0)) + ring)))
    return max(shapely.get_parts(shapely.difference(FIELD, shapely.union_all(stars))), key=shapely.area)


@pytest.mark.parametrize("seed", [1, 2, 3, 4])
def test_prescribed_places_among_pockets_are_joined_by_shortest_ways(seed: int) -> None:
    free = jagged(seed)
    rng = np.random.default_rng(seed)
    places = rng.uniform((0.0, 0.0), (100.0, 60.0), (400, 2))
    places = places[shapely.contains_xy(free, places)][:4]
    stretches = [Stretch(free, shapely.Point(place)) for place in places[1:]]
    path = taut_path(places[0], stretches)
    checked(path, stretches, places[0])
    least = brute_force(places[0], [free] * 3, [place[None] for place in places[1:]])[0]
    assert path.length_m == pytest.approx(least, rel=1e-9)


@pytest.mark.parametrize("seed", [1])
def test_a_round_is_as_short_as_the_best_over_dense_rims(seed: int) -> None:
    free, targets, start = field(seed, 15)
    stretches = [Stretch(free, target) for target in targets]
    path = taut_path(start, stretches, lap=0, entries=(0, 1, 2))
    checked(path, stretches, start)
    assert path.lap is not None
    lap = path.lines[path.lap :]
    assert np.allclose(lap[0].points_m[0], lap[-1].points_m[-1], atol=1e-9)
    length = sum(line.length_m for line in lap)
    rims = [rim_places(target)[::4] for target in targets]
    rounds = [brute_force(place, [free] * 3, [*rims[:2], place[None]])[0] for place in rims[2][::3]]
    assert length <= min(rounds) * (1.0 + 1e-9)
    assert length >= min(rounds) * (1.0 - 3e-2)


def test_a_path_keeps_to_the_free_space_of_its_stage() -> None:
    wall = shapely.box(49.0, 0.0, 51.0, 50.0)
    open_, shut = FIELD, shapely.difference(FIELD, wall)
    first, second = shapely.box(70.0, 0.0, 80.0, 10.0), shapely.box(10.0, 0.0, 20.0, 10.0)
    path = taut_path(np.array([10.0, 5.0]), [Stretch(open_, first), Stretch(shut, second)])
    checked(path, [Stretch(open_, first), Stretch(shut, second)], np.array([10.0, 5.0]))
    # Straight through the wall that is not yet there, and back over its two upper corners.
    assert path.lines[0].points_m.shape == (2, 2)
    assert path.lines[1].points_m[1:3] == pytest.approx(np.array([[51.0, 50.0], [49.0, 50.0]]))
    least = brute_force(np.array([10.0, 5.0]), [open_, shut], [rim_places(first), rim_places(second)]).min()
    assert least * (1.0 - 1e-3) <= path.length_m <= least * (1.0 + 1e-9)


def test_prescribed_places_are_gone_to_and_gone_on_from() -> None:
    restart = np.array([60.0, 30.0])
    stretches = [Stretch(FIELD, shapely.Point(40.0, 10.0), restart), Stretch(FIELD, shapely.box(60.0, 0.0, 70.0, 10.0))]
    path = taut_path(np.array([10.0, 10.0]), stretches)
    assert [line.length_m for line in path.lines] == pytest.approx([30.0, 20.0])
    assert (path.lines[1].points_m[0] == restart).all()
    lap = taut_path(np.array([10.0, 10.0]), stretches, lap=0)
    assert lap.lap == 1
    assert np.allclose(lap.lines[-1].points_m[-1], lap.lines[1].points_m[0])


def test_where_the_start_lies_in_the_target_nothing_is_flown() -> None:
    path = taut_path(np.array([5.0, 5.0]), [Stretch(FIELD, shapely.box(0.0, 0.0, 10.0, 10.0))])
    assert path.length_m == 0.0


def test_what_is_walled_off_cannot_be_reached() -> None:
    shut = shapely.difference(FIELD, shapely.box(49.0, -1.0, 51.0, 61.0))
    with pytest.raises(NoWayError) as caught:
        taut_path(
            np.array([10.0, 5.0]),
            [Stretch(shut, shapely.box(20.0, 0.0, 30.0, 10.0)), Stretch(shut, shapely.box(70.0, 0.0, 80.0, 10.0))],
        )
    assert caught.value.stage == 1


def test_a_rim_with_very_many_corners_is_gone_round() -> None:
    angles = np.linspace(0.0, 2.0 * np.pi, 500, endpoint=False)
    disc = shapely.Polygon(np.stack((50.0 + 20.0 * np.cos(angles), 30.0 + 20.0 * np.sin(angles)), axis=1))
    free = shapely.difference(FIELD, disc)
    path = taut_path(np.array([10.0, 30.0]), [Stretch(free, shapely.Point(90.0, 30.0))])
    tangent = np.sqrt(40.0**2 - 20.0**2)
    assert path.length_m == pytest.approx(2.0 * tangent + 20.0 * (np.pi - 2.0 * np.arccos(0.5)), rel=1e-4)


def test_from_place_to_place_a_path_is_as_long_as_back() -> None:
    """Both ends are prescribed: no length is to spare for rounding."""
    wall = shapely.Polygon([(0, 28), (70, 25), (73, 26), (75, 30), (74.3, 33), (72, 35), (0, 36)])
    free = shapely.difference(FIELD, wall)
    rng = np.random.default_rng(5)
    for above, below in zip(
        rng.uniform((2, 40), (60, 58), (20, 2)), rng.uniform((2, 2), (60, 22), (20, 2)), strict=True
    ):
        there, back = (
            taut_path(one, [Stretch(free, shapely.Point(other))]).length_m
            for one, other in ((above, below), (below, above))
        )
        assert there == pytest.approx(back, rel=1e-9)
        assert there > np.hypot(*(above - below))
