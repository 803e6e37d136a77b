"""Splines of Bézier pieces: against numpy's polynomials, and their bounds against dense samples."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.steering.bezier import BezierCurve, derivative_points
from mission.steering.joined import JoinedCurve, curve_from_json


def random_spline(seed: int, pieces: int) -> BezierCurve:
    """A spline whose pieces continue position and first two derivatives of the one before; elsewhere at random."""
    rng = np.random.default_rng(seed)
    lasts = rng.uniform(0.2, 3.0, pieces)
    controls = rng.normal(0.0, 10.0, (pieces, 6, 2))
    for before, after in zip(range(pieces - 1), range(1, pieces), strict=True):
        ratio = lasts[after] / lasts[before]
        end = controls[before]
        slope = (end[5] - end[4]) * ratio
        bend = (end[5] - 2 * end[4] + end[3]) * ratio**2
        controls[after, 0] = end[5]
        controls[after, 1] = end[5] + slope
        controls[after, 2] = bend + 2 * controls[after, 1] - controls[after, 0]
    return BezierCurve(np.concatenate(([0.0], np.cumsum(lasts))), controls)


def by_de_casteljau(curve: BezierCurve, s: float) -> np.ndarray:
    piece = min(int(np.searchsorted(curve.knots_s, s, side="right")) - 1, len(curve.controls_m) - 1)
    u = (s - curve.knots_s[piece]) / (curve.knots_s[piece + 1] - curve.knots_s[piece])
    points = np.array(curve.controls_m[piece])
    while len(points) > 1:
        points = (1.0 - u) * points[:-1] + u * points[1:]
    return np.asarray(points[0])


@given(st.integers(0, 10_000), st.integers(1, 6))
def test_positions_are_those_of_de_casteljau(seed: int, pieces: int) -> None:
    curve = random_spline(seed, pieces)
    for s in np.linspace(0.0, curve.duration_s, 23):
        assert curve.position([s])[0] == pytest.approx(by_de_casteljau(curve, float(s)), abs=1e-9)


@given(st.integers(0, 10_000), st.integers(1, 6), st.integers(1, 4))
def test_derivatives_are_those_of_differences(seed: int, pieces: int, order: int) -> None:
    curve = random_spline(seed, pieces)
    middles = 0.5 * (curve.knots_s[:-1] + curve.knots_s[1:])
    step = 1e-5
    before, after = (curve.derivative(middles + side * step, order - 1) for side in (-1, 1))
    scale = 1.0 + np.abs(curve.derivative(middles, order)).max() + np.abs(curve.derivative(middles, order - 1)).max()
    assert curve.derivative(middles, order) == pytest.approx((after - before) / (2 * step), abs=1e-4 * scale)


@given(st.integers(0, 10_000), st.integers(1, 6), st.integers(1, 3), st.integers(1, 40))
def test_no_sample_exceeds_the_bound_of_its_cell(seed: int, pieces: int, order: int, cells: int) -> None:
    curve = random_spline(seed, pieces)
    knots = np.linspace(0.0, curve.duration_s, cells + 1)
    bounds = curve.norm_bounds(knots, order)
    for low, high, bound in zip(knots[:-1], knots[1:], bounds, strict=True):
        norms = np.linalg.norm(curve.derivative(np.linspace(low, high, 50), order), axis=1)
        assert norms.max() <= bound


def test_bounds_close_in_on_the_values() -> None:
    curve = random_spline(3, 4)
    knots = curve.sampled(4000).knots_s
    norms = np.linalg.norm(curve.derivative(0.5 * (knots[:-1] + knots[1:]), 2), axis=1)
    assert (curve.norm_bounds(knots, 2) <= norms + 0.01 * norms.max()).all()


@given(st.integers(0, 10_000), st.integers(1, 5))
def test_length_is_that_of_a_fine_polyline(seed: int, pieces: int) -> None:
    curve = random_spline(seed, pieces)
    points = curve.position(np.linspace(0.0, curve.duration_s, 20_001))
    polyline = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    assert curve.length_m == pytest.approx(polyline, rel=5e-3)


def test_first_and_second_derivative_are_continuous() -> None:
    curve = random_spline(5, 5)
    for order in (1, 2):
        points = derivative_points(curve.controls_m, np.diff(curve.knots_s), order)
        assert points[1:, 0] == pytest.approx(points[:-1, -1], rel=1e-9, abs=1e-9)


def test_a_curve_comes_back_from_its_file_bit_by_bit() -> None:
    curve = random_spline(8, 3)
    again = curve_from_json(curve.to_json())
    assert isinstance(again, BezierCurve)
    assert np.array_equal(again.controls_m, curve.controls_m)
    assert np.array_equal(again.knots_s, curve.knots_s)


def test_what_is_not_a_spline_is_refused() -> None:
    curve = random_spline(8, 3)
    controls, knots = np.array(curve.controls_m), np.array(curve.knots_s)
    bent = controls.copy()
    bent[1, 2] += 1.0
    torn = controls.copy()
    torn[1, 0] += 1e-3
    for wrong_knots, wrong, why in (
        (knots, bent, "order 2 jumps"),
        (knots, torn, "begins where"),
        (knots[:-1], controls, "one knot more"),
        (knots[::-1], controls, "ascend"),
        (knots, controls[:, :5], "six control points"),
        (knots, controls * np.nan, "finite"),
    ):
        with pytest.raises(ValueError, match=why):
            BezierCurve(wrong_knots, wrong)


@pytest.mark.parametrize(("begin", "end"), [(0, 4), (0, 1), (1, 3), (2, 4)])
def test_bounds_of_a_part_of_joined_splines_are_those_of_the_whole(begin: int, end: int) -> None:
    splines = [random_spline(1, 1), random_spline(2, 1), random_spline(3, 2)]
    for number in (1, 2):
        moved = splines[number - 1].controls_m[-1, -1] - splines[number].controls_m[0, 0]
        splines[number] = BezierCurve(splines[number].knots_s, splines[number].controls_m + moved)
    joined = JoinedCurve(tuple(splines))
    ends = np.concatenate((joined.joints_s, [0.5 * joined.joints_s[-1]]))
    knots = np.unique(np.concatenate((np.linspace(0.0, joined.duration_s, 41), ends)))
    span = np.linspace(0.0, joined.duration_s, 5)[[begin, end]]
    inside = np.flatnonzero((knots >= span[0]) & (knots <= span[1]))
    part = joined.norm_bounds(knots[inside], 2)
    assert part == pytest.approx(joined.norm_bounds(knots, 2)[inside[0] : inside[-1]])
