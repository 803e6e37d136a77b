"""What a square sweeps against the union of its steps, and a way of an hour in no time."""

import time
from itertools import pairwise

import numpy as np
import pytest
import shapely
from shapely import Polygon
from shapely.affinity import translate

from mission.geometry.sweep import SweptSquare


def swept(places: np.ndarray, half_m: float) -> shapely.Geometry:
    """Step by step, from many squares."""
    square = shapely.box(-half_m, -half_m, half_m, half_m)
    return shapely.union_all(
        [
            shapely.union(translate(square, *one), translate(square, *other)).convex_hull
            for one, other in pairwise(places)
        ]
    )


@pytest.mark.parametrize("seed", range(20))
def test_it_is_what_its_steps_sweep(seed: int) -> None:
    rng = np.random.default_rng(seed)
    places = np.cumsum(rng.normal(scale=0.5, size=(30, 2)), axis=0)
    whole, square = swept(places, 0.4), SweptSquare(places, 0.4)
    for _ in range(10):
        triangle = Polygon(rng.normal(scale=3.0, size=(3, 2)))
        assert square.meets(triangle) == whole.intersects(triangle)
        disc = shapely.Point(places.mean(axis=0)).buffer(rng.uniform(0.5, 6.0))
        assert square.stays_in(disc) == disc.covers(whole)


def test_a_way_of_an_hour_in_rounds_is_soon_done() -> None:
    """The loop that flies waits for it. A union of it all takes minutes."""
    angle = np.linspace(0.0, 60.0 * 2.0 * np.pi, 36_000)
    square = SweptSquare(20.0 * np.column_stack([np.cos(angle), np.sin(angle)]), 0.5)
    began_s = time.process_time()
    assert square.meets(shapely.box(19.0, -1.0, 22.0, 1.0))
    assert not square.meets(shapely.box(-10.0, -10.0, 10.0, 10.0))
    assert square.stays_in(shapely.box(-21.0, -21.0, 21.0, 21.0))
    assert time.process_time() - began_s < 2.0
