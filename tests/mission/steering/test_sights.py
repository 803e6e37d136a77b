"""Corners that may be seen: all that shapely sees are found, and not many others."""

from itertools import product

import numpy as np
import pytest
import shapely

from mission.geometry.arrays import FloatArray
from mission.steering.free_space import FreeSpace

SIDE = 60.0


def stars(seed: int) -> shapely.Geometry:
    """A square without stars and boxes, of which some overlap, or lie in one line with others."""
    rng = np.random.default_rng(seed)
    blocked = [
        shapely.box(x, y, x + 4.0, y + 4.0)
        for x, y in product((8.0, 12.0, 30.0), (10.0, 20.0, 24.0))
        if rng.random() < 0.6
    ]
    for _ in range(12):
        angles = np.sort(rng.uniform(0.0, 2.0 * np.pi, 7))
        ring = rng.uniform(1.0, 6.0, (7, 1)) * np.stack((np.cos(angles), np.sin(angles)), axis=1)
        blocked.append(shapely.make_valid(shapely.Polygon(rng.uniform(0.0, SIDE, 2) + ring)))
    free = shapely.difference(shapely.box(0.0, 0.0, SIDE, SIDE), shapely.union_all(blocked))
    return shapely.buffer(free, -0.01, join_style="mitre")  # no gap of no width, through which only rounding leads


def seen(free: shapely.Geometry, begins: FloatArray, ends: FloatArray) -> set[tuple[int, int]]:
    """Which of all pairs are joined by a straight way in free space that is longer than nothing."""
    room = shapely.buffer(free, 1e-9, join_style="mitre")
    shapely.prepare(room)
    pairs = np.stack(np.broadcast_arrays(begins[:, None], ends[None]), axis=2)
    free_ways = shapely.covers(room, shapely.linestrings(pairs))
    free_ways &= np.hypot(*np.moveaxis(pairs[:, :, 0] - pairs[:, :, 1], 2, 0)) > 0.0
    return set(zip(*(each.tolist() for each in np.nonzero(free_ways)), strict=True))


@pytest.mark.parametrize("seed", range(8))
def test_all_corners_to_bend_at_that_are_seen_are_found_once(seed: int) -> None:
    free = stars(seed)
    space = FreeSpace(free)
    corners = space.corners_m
    numbers = np.arange(len(corners))
    index, other = space.seen_from_corners(numbers)
    found = set(zip(index.tolist(), other.tolist(), strict=True))
    assert len(found) == len(index)
    true = {pair for pair in seen(free, corners, corners) if bends(free, corners, pair)}
    assert true <= found
    assert len(found) < 2.5 * len(true)


def test_what_is_seen_does_not_depend_on_what_was_looked_from_before() -> None:
    free = stars(3)
    space, other = FreeSpace(free), FreeSpace(free)
    numbers = np.arange(len(space.corners_m))
    whole = space.seen_from_corners(numbers)
    other.look_from(numbers[::3])
    for some in (numbers[5:20], numbers[::3], numbers):
        index, seen = other.seen_from_corners(some)
        wanted = np.isin(whole[0], some)
        assert some[index].tolist() == whole[0][wanted].tolist()
        assert seen.tolist() == whole[1][wanted].tolist()


@pytest.mark.parametrize("seed", range(8))
def test_from_places_anywhere_all_corners_to_bend_at_are_found(seed: int) -> None:
    free = stars(seed)
    space, rng = FreeSpace(free), np.random.default_rng(seed)
    rims = shapely.get_coordinates(free)
    middles = 0.5 * (rims[1:] + rims[:-1])
    places = np.concatenate((rng.uniform(0.0, SIDE, (60, 2)), rims[::3], middles[::3], rims[::4] + 1e-7))
    places = places[shapely.covers(free, shapely.points(places))]
    (one, other_one), (two, other_two) = space.seen_from_places([places[:40], places[40:]])
    index, other = np.append(one, two + 40), np.append(other_one, other_two)
    found = set(zip(index.tolist(), other.tolist(), strict=True))
    assert len(found) == len(index)
    ends = np.concatenate((places, space.corners_m))
    pairs = seen(free, places, space.corners_m)
    true = {pair for pair in pairs if bends(free, ends, (pair[0], len(places) + pair[1]), both=False)}
    assert true <= found


def bends(free: shapely.Geometry, points: FloatArray, pair: tuple[int, int], *, both: bool = True) -> bool:
    """Whether a way may bend at its end (or at both): beyond it, it goes on in free space, if only by a little."""
    begin, end = points[list(pair)]
    onward = (end - begin) / np.hypot(*(end - begin)) * 1e-4
    on = [end + onward] + ([begin - onward] if both else [])
    return all(shapely.distance(free, shapely.Point(place)) == 0.0 for place in on)
