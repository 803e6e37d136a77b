"""Long ways: turns that are alike are looked at once, and flown as if each had been looked at by itself."""

import numpy as np
import pytest

from mission.geometry.arrays import FloatArray
from mission.steering.excerpt import excerpt_of
from mission.steering.grid import Limits, Slow, grid_of
from mission.steering.rounded import RoundedPolyline
from mission.steering.strain import strain
from mission.steering.timing import time_law

LIMITS = Limits(speed_m_s=5.0, acceleration_m_s2=2.5, jerk_m_s3=4.0)
EVERYWHERE = Slow(0.0, 1e9, 1.0)


def lanes(begins: FloatArray, ends: FloatArray) -> RoundedPolyline:
    """Lanes 4 m apart between two heights each, the first flown upwards, at 5 m/s."""
    count = len(begins)
    heights = np.where(np.arange(count)[:, None] % 2 == 0, np.stack((begins, ends), 1), np.stack((ends, begins), 1))
    places = np.stack((4.0 * np.arange(count).repeat(2), heights.ravel()), axis=1)
    return RoundedPolyline(places, np.full(2 * count - 2, 4.0 / 3.0), 5.0)


def level(count: int) -> RoundedPolyline:
    return lanes(np.zeros(count), np.full(count, 90.0))


def test_turns_that_are_alike_are_of_one_kind() -> None:
    # Wherever they are, to the left or to the right, and however long the lanes: one kind, beside both ends of the way.
    begins = np.zeros(12)
    begins[5:] -= 50.0
    curve = lanes(begins, np.full(12, 90.0))
    excerpt = excerpt_of(curve, curve.sampled(64).knots_s, LIMITS, (EVERYWHERE,))
    assert excerpt.kinds.tolist() == [0, *[1] * 11, 2]
    assert excerpt.knots_s[-1] < 0.05 * curve.duration_s


def test_where_the_vehicle_is_to_be_slow_turns_are_others() -> None:
    curve = level(12)
    slow = Slow(curve.duration_s * 0.3, curve.duration_s * 0.4, 0.5)
    plain, slowed = (
        excerpt_of(curve, curve.sampled(64).knots_s, LIMITS, parts) for parts in ((EVERYWHERE,), (EVERYWHERE, slow))
    )
    assert len(set(plain.kinds.tolist())) < len(set(slowed.kinds.tolist()))


@pytest.mark.parametrize("seed", [0, 1])
def test_a_long_way_takes_as_long_as_if_all_of_it_were_looked_at(monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    steps = np.random.default_rng(seed).choice([0.0, 3.0, 9.0], (2, 10))
    curve = lanes(steps[0].cumsum(), 100.0 + steps[1].cumsum())
    whole = time_law(curve, LIMITS, fastest=1.0)
    monkeypatch.setattr("mission.steering.timing._MOST_KNOTS", 100)
    parts = time_law(curve, LIMITS, fastest=1.0)
    assert parts.duration_s == pytest.approx(whole.duration_s, rel=0.01)
    grid = grid_of(curve, (0.0, curve.duration_s), parts.knots_s, LIMITS, (EVERYWHERE,))
    asked = strain(parts, grid, LIMITS)
    assert asked.speed.max() <= 1.0 + 1e-9
    _, rates, growths = parts.jet(times := np.linspace(0.0, parts.duration_s, 20_000))
    _, slopes, bends = curve.jet(parts.parameter(times))
    pulls = bends * rates[:, None] ** 2 + slopes * growths[:, None]
    assert np.hypot(*pulls.T).max() <= LIMITS.acceleration_m_s2 * (1.0 + 1e-9)
    shakes = np.hypot(*np.diff(pulls, axis=0).T) / np.diff(times)
    assert shakes.max() <= LIMITS.jerk_m_s3 * (1.0 + 1e-6)


def test_a_way_without_straight_parts_is_all_there_is() -> None:
    curve = lanes(np.zeros(12), np.full(12, 9.0))
    excerpt = excerpt_of(curve, curve.sampled(64).knots_s, LIMITS, (EVERYWHERE,))
    assert excerpt.kinds.tolist() == [0]
    assert excerpt.knots_s[-1] == pytest.approx(curve.duration_s)
