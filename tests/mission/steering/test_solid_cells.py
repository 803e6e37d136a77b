"""Cells that lie in what is in the way: what they tell of straight ways is true, and they tell most of it."""

import numpy as np
import pytest
import shapely

from mission.geometry.arrays import FloatArray
from mission.geometry.shapes import rings_of
from mission.steering.solid_cells import SolidCells


def cells_of(free: shapely.Polygon) -> SolidCells:
    rings = rings_of(free)
    begins, ends = np.concatenate(rings), np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    return SolidCells(begins, ends, np.repeat(np.arange(len(rings)), list(map(len, rings))), np.arange(len(rings)) > 0)


def town(chance: np.random.Generator, side: int) -> shapely.Polygon:
    """A square with a turned triangle or a notched square on each plot."""
    holes = []
    for column in range(side):
        for row in range(side):
            corners = int(chance.integers(3, 7))
            bearings = chance.uniform(0.0, 6.3) + np.arange(corners) * 2.0 * np.pi / corners
            far = chance.uniform(1.0, 4.5, (corners, 1))
            holes.append(5.0 + 10.0 * np.array([column, row]) + far * np.stack((np.cos(bearings), np.sin(bearings)), 1))
    rim = 10.0 * side * np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    return shapely.Polygon(rim, [hole for hole in holes if shapely.Polygon(hole).is_valid])


def free_places(chance: np.random.Generator, free: shapely.Polygon, count: int) -> FloatArray:
    places = chance.uniform(free.bounds[0], free.bounds[2], (count, 2))
    found: FloatArray = places[shapely.contains_xy(free, *places.T)]
    return found


@pytest.mark.parametrize("seed", range(4))
def test_ways_that_meet_solid_cells_are_not_free_and_cross_the_ring_that_is_named(seed: int) -> None:
    chance = np.random.default_rng(seed)
    free = town(chance, 8)
    begins, ends = (free_places(chance, free, 900)[:400] for _ in range(2))
    ways = shapely.linestrings(np.stack((begins, ends), axis=1))
    index, ring = cells_of(free).met(begins, ends)
    holes = np.array([None, *(shapely.Polygon(ring) for ring in free.interiors)])
    assert (index[1:] > index[:-1]).all()
    assert shapely.intersects(holes[ring], ways[index]).all()
    # Holes are a few cells wide here, and many of the other ways only cut a corner.
    assert len(index) > 0.25 * np.count_nonzero(~shapely.covers(free, ways))


def test_an_island_in_a_lake_is_free() -> None:
    lake = shapely.Polygon([(0, 0), (100, 0), (100, 100), (0, 100)], [[(20, 20), (80, 20), (80, 80), (20, 80)]])
    island = shapely.box(40, 40, 60, 60)
    rings = [*rings_of(lake), *rings_of(island)]
    begins, ends = np.concatenate(rings), np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    cells = SolidCells(begins, ends, np.repeat([0, 1, 2], 4), np.array([False, True, False]))
    index, ring = cells.met(np.array([[45.0, 50.0], [10.0, 50.0]]), np.array([[55.0, 51.0], [50.0, 51.0]]))
    assert index.tolist() == [1]
    assert ring.tolist() == [1]
