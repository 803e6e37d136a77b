"""Corners of polylines are rounded where there is room; small steps are left out; times are those of the curve."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from mission.geometry.arrays import FloatArray
from mission.steering.rounding import rounded_within
from tests.support.drawn_cases import tried

ROOM = shapely.box(-100.0, -100.0, 100.0, 100.0)


def crooked(seed: int, count: int) -> FloatArray:
    """A random walk with steps of very different lengths, some of no length, some back and forth."""
    rng = np.random.default_rng(seed)
    steps = rng.normal(size=(count, 2)) * 10.0 ** rng.uniform(-2.0, 1.0, size=(count, 1))
    steps[1:][rng.random(count - 1) < 0.15] = 0.0
    for i in np.flatnonzero(rng.random(count - 1) < 0.15):
        steps[i + 1] = -steps[i]
    return np.concatenate((np.zeros((1, 2)), np.cumsum(steps, axis=0)))


lines = st.builds(crooked, st.integers(0, 10**6), st.integers(3, 30))


@given(lines, st.floats(0.0, 0.5), st.floats(0.1, 4.0))
@tried(80)
def test_the_curve_is_near_the_line_at_the_stated_times(line: FloatArray, tolerance: float, widest: float) -> None:
    room = ROOM.buffer(100.0)
    curve, passed_s = rounded_within(
        line, room, tolerance_m=tolerance, widest_m=np.full(len(line), widest), speed_m_s=2.0
    )
    assert (np.diff(passed_s) >= 0.0).all()
    assert passed_s[0] == 0.0
    assert passed_s[-1] == pytest.approx(curve.duration_s)
    np.testing.assert_array_equal(curve.corners_m[[0, -1]], line[[0, -1]])
    polyline = shapely.LineString(curve.corners_m)
    extent = float(np.ptp(line, axis=0).max())
    assert shapely.distance(shapely.points(line), polyline).max() <= tolerance + 2e-6 * extent
    # Where the line goes to and fro along a straight part, the curve does not: corners are those that it has itself.
    at_corners = np.array([curve.position([s])[0] for s in curve.corners_s])
    for corner, near in zip(curve.corners_m, at_corners, strict=True):
        times = passed_s[(line == corner).all(axis=1)]
        assert np.hypot(*(curve.position(times) - near).T).min() <= 1e-9 * (1.0 + extent)


def test_blends_stay_in_the_room_that_there_is() -> None:
    """Round the corner of a house: the blend on its side is narrow, the one on the free side as wide as asked."""
    room = ROOM.difference(shapely.box(1.0, 1.0, 30.0, 30.0))
    line = np.array([[0.9, 40.0], [0.9, 0.9], [40.0, 0.9], [40.0, -30.0]])
    curve, _ = rounded_within(line, room, tolerance_m=0.0, widest_m=np.full(4, 5.0), speed_m_s=3.0)
    assert curve.reaches_m[1] == 5.0
    assert 0.1 < curve.reaches_m[0] < 1.0
    assert room.covers(shapely.LineString(curve.position(np.linspace(0.0, curve.duration_s, 20_001))))


def test_a_step_is_left_out_only_where_there_is_room_without_it() -> None:
    line = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 0.2], [20.0, 0.2], [20.0, 30.0]])
    wall = shapely.box(9.0, 0.05, 10.0, 5.0)
    widest = np.full(5, 2.0)
    free, _ = rounded_within(line, ROOM, tolerance_m=0.3, widest_m=widest, speed_m_s=1.0)
    blocked, passed_s = rounded_within(line, ROOM.difference(wall), tolerance_m=0.3, widest_m=widest, speed_m_s=1.0)
    assert len(free.corners_m) == 3
    assert len(blocked.corners_m) > 3
    assert blocked.position(passed_s[[1]])[0] == pytest.approx([10.0, 0.0], abs=0.2)


def test_a_line_of_one_place_is_none() -> None:
    with pytest.raises(ValueError, match="two points"):
        rounded_within(np.ones((3, 2)), ROOM, tolerance_m=0.1, widest_m=np.ones(3), speed_m_s=1.0)
