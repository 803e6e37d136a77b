"""Rounded polylines: smooth, near their corners, within their bounds, and flown within the limits."""

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.steering.enclosure import enclose, insert_knots
from mission.steering.grid import Limits
from mission.steering.joined import JoinedCurve, curve_from_json
from mission.steering.rounded import RoundedPolyline
from mission.steering.timing import time_law
from mission.steering.trajectory import Leg, Trajectory
from tests.support.drawn_cases import tried


def rounded(seed: int, corners: int) -> RoundedPolyline:
    """Random corners, some of them reversals, rounded as wide as fits or narrower."""
    rng = np.random.default_rng(seed)
    steps = rng.normal(size=(corners - 1, 2)) * rng.uniform(0.5, 30.0, size=(corners - 1, 1))
    for i in np.flatnonzero(rng.random(corners - 2) < 0.2):
        steps[i + 1] = -steps[i] * rng.uniform(0.3, 2.0)
    points = np.concatenate((np.zeros((1, 2)), np.cumsum(steps, axis=0)))
    lengths = np.hypot(*steps.T)
    reaches = np.minimum(lengths[:-1], lengths[1:]) / 2.0 * rng.choice([1.0, 0.5, 0.1], size=corners - 2)
    return RoundedPolyline(points, reaches, rng.uniform(0.5, 12.0))


polylines = st.builds(rounded, st.integers(0, 10**6), st.integers(2, 12))


@given(polylines)
@tried(60)
def test_it_is_twice_continuously_differentiable_along_its_polyline(curve: RoundedPolyline) -> None:
    s = np.linspace(0.0, curve.duration_s, 5001)
    position, slope, bend = curve.jet(s)
    np.testing.assert_array_equal(position[0], curve.corners_m[0])
    assert np.abs(position[-1] - curve.corners_m[-1]).max() < 1e-9 * (1.0 + np.abs(curve.corners_m).max())
    step = s[1]
    # Integrals by the trapezoidal rule of a Lipschitz function: off by no more than its Lipschitz constant says.
    rise = np.cumsum((slope[1:] + slope[:-1]) * step / 2.0, axis=0)
    scale = max(1.0, np.abs(bend).max())
    assert np.abs(position[1:] - position[0] - rise).max() <= scale * step * curve.duration_s
    steep = 8.0 * scale / max(1e-3, float(curve.reaches_m.min(initial=1.0)) / curve.speed_m_s)
    assert np.abs(np.diff(bend, axis=0)).max() <= steep * step
    assert np.linalg.norm(slope, axis=1).max() <= curve.speed_m_s * (1.0 + 1e-12)


@given(polylines)
@tried(40)
def test_it_passes_its_corners_at_the_stated_distance_and_time(curve: RoundedPolyline) -> None:
    passed = curve.position(curve.corners_s)
    off = np.hypot(*(passed - curve.corners_m).T)
    np.testing.assert_allclose(off[1:-1], curve.off_corners_m, atol=1e-9 * (1.0 + np.abs(curve.corners_m).max()))
    s = np.linspace(0.0, curve.duration_s, 20001)
    steps = np.hypot(*np.diff(curve.position(s), axis=0).T)
    assert curve.length_m == pytest.approx(steps.sum(), rel=1e-4)


@given(polylines, st.integers(0, 10**6), st.sampled_from([1, 2, 3]))
@tried(60)
def test_bounds_between_any_knots_hold_and_are_the_least(curve: RoundedPolyline, seed: int, order: int) -> None:
    rng = np.random.default_rng(seed)
    knots = np.sort(np.concatenate(([0.0, curve.duration_s], rng.uniform(0.0, curve.duration_s, size=12))))
    bounds = curve.norm_bounds(knots, order)
    for low, high, bound in zip(knots[:-1], knots[1:], bounds.tolist(), strict=True):
        corners = curve.knots_s[(curve.knots_s > low) & (curve.knots_s < high)]
        s = np.concatenate((np.linspace(low, high, 801), curve.corners_s, corners))
        s = s[(s >= low) & (s <= high)]
        largest = float(np.linalg.norm(curve.derivative(s, order), axis=1).max())
        assert largest <= bound
        crosses = bool(len(corners))
        # At the ends of blends samples of the third derivative are those of one side only.
        assert bound <= largest * (1.0 + 1e-3) + 1e-9 or (order != 2 and crosses)


@given(polylines, st.integers(0, 10**6))
@tried(30)
def test_the_enclosure_of_joined_curves_holds(curve: RoundedPolyline, seed: int) -> None:
    back = RoundedPolyline(curve.corners_m[::-1], curve.reaches_m[::-1], curve.speed_m_s)
    whole = JoinedCurve((JoinedCurve((curve, back)), curve))
    rng = np.random.default_rng(seed)
    enclosure = insert_knots(whole, enclose(whole, 16), rng.uniform(0.0, whole.duration_s, size=30))
    assert set(whole.joints_s.tolist()) <= set(enclosure.knots_s.tolist())
    assert whole.starts_s.tolist() == whole.joints_s[[0, 2, 3]].tolist()
    for k in range(len(enclosure.remainder_m)):
        s = np.linspace(enclosure.knots_s[k], enclosure.knots_s[k + 1], 9)
        begin, end = enclosure.points_m[k], enclosure.points_m[k + 1]
        chord = begin + np.linspace(0.0, 1.0, 9)[:, None] * (end - begin)
        off = np.linalg.norm(whole.position(s) - chord, axis=1).max()
        assert off <= enclosure.remainder_m[k] + 1e-9


@given(polylines, st.floats(0.2, 8.0), st.floats(0.3, 3.0))
@tried(30)
def test_limits_are_kept_and_where_curves_join_the_vehicle_rests(
    curve: RoundedPolyline, speed: float, limit: float
) -> None:
    back = RoundedPolyline(curve.corners_m[::-1], curve.reaches_m[::-1], curve.speed_m_s)
    whole = JoinedCurve((curve, back))
    law = time_law(whole, Limits(speed, limit, 2.0 * limit), fastest=1.0)
    t = np.union1d(np.linspace(0.0, law.duration_s, 4001), law.knots_t_s)
    _, velocity, acceleration = Trajectory((Leg(whole, law),), 10.0).state(t)
    assert np.linalg.norm(velocity, axis=1).max() <= min(speed, curve.speed_m_s) * (1 + 1e-9)
    assert np.linalg.norm(acceleration, axis=1).max() <= limit * (1 + 1e-6)
    joint = float(whole.joints_s[1])
    rest = np.abs(law.parameter(t) - joint) < 1e-9 * joint
    assert rest.any()
    assert np.linalg.norm(velocity[rest], axis=1).max() < 1e-3
    # Continuous: no step is longer than the limits admit.
    assert np.linalg.norm(np.diff(velocity, axis=0), axis=1).max() <= limit * np.diff(t).max() * 1.01 + 1e-9


def test_a_long_lane_is_flown_at_full_speed() -> None:
    """400 m at 4 m/s, with 2.5 m/s^2 to reach it: 100 s and one ramp, half of what the jerk takes at each end."""
    curve = RoundedPolyline(np.array([[0.0, 0.0], [400.0, 0.0]]), np.empty(0), 4.0)
    law = time_law(curve, Limits(8.0, 2.5, 5.0), fastest=1.0)
    assert law.duration_s == pytest.approx(100.0 + 1.6 + 0.5, abs=0.1)


def test_joined_curves_are_written_and_read_bit_by_bit() -> None:
    curve = rounded(7, 6)
    whole = JoinedCurve((curve, RoundedPolyline(curve.corners_m[::-1], curve.reaches_m[::-1], 3.0)))
    again = curve_from_json(json.loads(json.dumps(whole.to_json())))
    s = np.linspace(0.0, whole.duration_s, 50)
    np.testing.assert_array_equal(again.position(s), whole.position(s))


@pytest.mark.parametrize(
    ("corners", "reaches", "speed"),
    [
        ([[0.0, 0.0]], [], 1.0),
        ([[0.0, 0.0], [0.0, 0.0]], [], 1.0),
        ([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0]], [0.0], 1.0),
        ([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0]], [4.1], 1.0),
        ([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]], [2.5, 2.5], 1.0),
        ([[0.0, 0.0], [4.0, 0.0]], [], 0.0),
        ([[0.0, 0.0], [4.0, np.nan]], [], 1.0),
    ],
)
def test_what_is_no_rounded_polyline_is_refused(corners: list[list[float]], reaches: list[float], speed: float) -> None:
    with pytest.raises(ValueError, match=r"polyline|rounded|finite|apart"):
        RoundedPolyline(np.array(corners), np.array(reaches), speed)
