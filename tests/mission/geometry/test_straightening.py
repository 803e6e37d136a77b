"""Polylines with fewer corners: near the old ones by a measure that heeds the order, decided from its definition."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.geometry.arrays import FloatArray
from mission.geometry.straightening import straightened
from tests.support.drawn_cases import tried

STEP_M = 0.1
COORDINATES = st.integers(-60, 60).map(lambda tenths: tenths / 10.0)


def dense(points: FloatArray) -> FloatArray:
    parts = [points[:1]]
    for a, b in pairwise(points):
        count = max(1, int(np.ceil(np.hypot(*(b - a)) / STEP_M)))
        parts.append(a + (b - a) * (np.arange(1, count + 1) / count)[:, None])
    return np.concatenate(parts)


def may_travel_within(p: FloatArray, q: FloatArray, apart_m: float) -> bool:
    """Whether two travellers can go from point to point, forward only, and never be farther apart than that.

    The discrete Fréchet distance decided (Eiter and Mannila, 1994), a row of the table at a time.
    """
    near = np.hypot(p[:, None, 0] - q[None, :, 0], p[:, None, 1] - q[None, :, 1]) <= apart_m
    reached = np.zeros(len(q), dtype=bool)
    for i, row in enumerate(near):
        came = reached | np.append(i == 0, reached[:-1])
        count = np.cumsum(row & came)
        # Of a stretch of places that are near, all from the first one that is come to.
        reached = row & (count > np.maximum.accumulate(np.where(row, 0, count)))
    return bool(reached[-1])


@tried(40)
@given(st.lists(st.tuples(COORDINATES, COORDINATES), min_size=2, max_size=8), st.sampled_from([0.0, 0.3, 1.0, 4.0]))
def test_both_stay_within_the_bound_that_is_told(corners: list[tuple[float, float]], tolerance_m: float) -> None:
    points = np.array(corners)
    kept, bound_m = straightened(points, tolerance_m)
    assert (kept[0], kept[-1]) == (0, len(points) - 1)
    assert (np.diff(kept) > 0).all()
    assert bound_m <= tolerance_m
    assert may_travel_within(dense(points), dense(points[kept]), bound_m + STEP_M)


def test_what_is_straight_becomes_one_leg() -> None:
    points = np.stack((np.linspace(0.0, 9.0, 50) ** 2, np.zeros(50)), axis=1)
    kept, bound_m = straightened(points, 1e-9)
    assert kept.tolist() == [0, 49]
    assert bound_m < 1e-12


def test_who_turns_back_on_a_line_is_not_on_the_way_there() -> None:
    """The distance from the leg, which is all that the usual measure sees, is 0 throughout."""
    points = np.array([[0.0, 0.0], [6.0, 0.0], [2.0, 0.0], [9.0, 0.0]])
    assert straightened(points, 1.0)[0].tolist() == [0, 1, 2, 3]
    assert straightened(points, 4.0)[0].tolist() == [0, 3]


def test_a_way_back_to_where_it_began_keeps_its_farthest_place() -> None:
    angles = np.linspace(0.0, 2.0 * np.pi, 200)
    circle = 10.0 * np.stack((np.cos(angles), np.sin(angles)), axis=1)
    kept, bound_m = straightened(circle, 0.5)
    # A chord that is 0.5 m inside its arc spans 36 degrees.
    assert 10 <= len(kept) - 1 <= 16
    assert 0.1 < bound_m <= 0.5


@pytest.mark.parametrize("count", [2, 3])
def test_standing_still_is_a_leg_of_no_length(count: int) -> None:
    kept, bound_m = straightened(np.ones((count, 2)), 0.1)
    assert kept.tolist() == [0, count - 1]
    assert bound_m == 0.0
