"""Fourier smoothing: coefficients, ends, derivatives, and bounds that really bound."""

import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from mission.spec.model import Extension
from mission.steering.smoothing import FourierCurve, fit_fourier
from tests.support.curves import paper_path
from tests.support.drawn_cases import tried


def random_curve(seed: int, waves: int, extension: Extension) -> FourierCurve:
    rng = np.random.default_rng(seed)
    decay = np.arange(1, waves + 1)[:, None] ** rng.uniform(0.0, 2.5)
    slope = rng.normal(size=2) if extension is Extension.ODD else np.zeros(2)
    return FourierCurve(
        extension, rng.uniform(0.5, 90.0), rng.normal(size=2), slope, rng.normal(size=(waves, 2)) / decay
    )


curves = st.builds(random_curve, st.integers(0, 10**6), st.integers(1, 40), st.sampled_from(Extension))


@pytest.mark.parametrize("extension", Extension)
@pytest.mark.parametrize("wave", [1, 2, 13, 28])
def test_coefficients_are_the_integrals_of_the_series(extension: Extension, wave: int) -> None:
    path = paper_path()
    curve = fit_fourier(path, 28, extension)
    total = path.duration_s
    start, end = path.position(np.array([0.0, total]))
    rate = wave * math.pi / total

    def integrand(s: float, axis: int) -> float:
        value = float(path.position(np.array([s]))[0, axis])
        if extension is Extension.EVEN:
            return value * math.cos(rate * s)
        return float(value - start[axis] - (end - start)[axis] * s / total) * math.sin(rate * s)

    for axis in (0, 1):
        pieces = [
            quad(integrand, a, b, args=(axis,), epsabs=1e-11, epsrel=1e-12, limit=200)[0]
            for a, b in zip(path.knots_s, path.knots_s[1:], strict=False)
        ]
        assert curve.coefficients_m[wave - 1, axis] == pytest.approx(2.0 / total * math.fsum(pieces), abs=1e-10)


def test_odd_extension_keeps_both_ends_and_even_moves_the_start_by_a_third_of_a_metre() -> None:
    path = paper_path()
    ends = np.array([0.0, path.duration_s])
    odd, even = (fit_fourier(path, 28, extension) for extension in (Extension.ODD, Extension.EVEN))
    assert odd.position(ends) == pytest.approx(path.position(ends), abs=1e-12)
    assert np.linalg.norm(even.position(ends) - path.position(ends), axis=1)[0] == pytest.approx(0.33, abs=0.005)
    assert even.derivative(ends, 1) == pytest.approx(np.zeros((2, 2)), abs=1e-12)


@pytest.mark.parametrize("extension", Extension)
def test_more_waves_follow_the_path_more_closely(extension: Extension) -> None:
    path = paper_path()
    s = np.linspace(0.0, path.duration_s, 2000)
    offs = [
        np.linalg.norm(fit_fourier(path, n, extension).position(s) - path.position(s), axis=1).max()
        for n in (10, 50, 400)
    ]
    assert offs[0] > offs[1] > offs[2]
    assert offs[2] < 0.03


@pytest.mark.parametrize("extension", Extension)
def test_fewer_waves_are_the_first_of_more(extension: Extension) -> None:
    long, short = fit_fourier(paper_path(), 300, extension), fit_fourier(paper_path(), 20, extension)
    assert long.truncated(20).coefficients_m == pytest.approx(short.coefficients_m, abs=1e-11)


@given(curves)
@tried(30)
def test_derivatives_are_those_of_the_position(curve: FourierCurve) -> None:
    s = np.linspace(0.05, 0.95, 7) * curve.duration_s
    step = 1e-4 * curve.duration_s / curve.frequencies
    for order in range(4):
        difference = (curve.derivative(s + step, order) - curve.derivative(s - step, order)) / (2 * step)
        scale = 1.0 + np.abs(curve.coefficients_m).sum() * (curve.frequencies * math.pi / curve.duration_s) ** (
            order + 1
        )
        assert np.abs(difference - curve.derivative(s, order + 1)).max() < 1e-6 * scale
    for order, values in enumerate(curve.jet(s)):
        assert values == pytest.approx(curve.derivative(s, order), rel=1e-9, abs=1e-9)


@given(curves, st.integers(0, 4), st.integers(1, 60))
@tried(40)
def test_grids_hold_the_same_values(curve: FourierCurve, order: int, extra: int) -> None:
    cells = curve.frequencies + extra
    s = np.linspace(0.0, curve.duration_s, cells + 1)
    scale = 1.0 + np.abs(curve.derivative(s, order)).max()
    assert np.abs(curve.on_grid(cells, order) - curve.derivative(s, order)).max() < 1e-10 * scale


@given(curves)
@tried(40)
def test_suprema_bound_the_derivatives_and_are_tight(curve: FourierCurve) -> None:
    s = np.linspace(0.0, curve.duration_s, 4001)
    for order, bound in enumerate(curve.suprema, start=1):
        largest = np.linalg.norm(curve.derivative(s, order), axis=1).max()
        assert largest <= bound <= 1.05 * largest + 1e-12


@given(curves, st.integers(0, 10**6), st.integers(1, 60))
@tried(40)
def test_bounds_hold_between_knots(curve: FourierCurve, seed: int, pieces: int) -> None:
    inner = np.random.default_rng(seed).uniform(0.0, curve.duration_s, pieces - 1)
    knots = np.concatenate(([0.0], np.sort(inner), [curve.duration_s]))
    for order in (1, 2, 3):
        bounds = curve.norm_bounds(knots, order)
        inside = knots[:-1, None] + np.diff(knots)[:, None] * np.linspace(0.0, 1.0, 33)
        norms = np.linalg.norm(curve.derivative(inside.ravel(), order), axis=1).reshape(inside.shape)
        assert (norms.max(axis=1) <= bounds).all()


@given(curves)
@tried(20)
def test_curves_survive_json(curve: FourierCurve) -> None:
    again = FourierCurve.from_json(json.loads(json.dumps(curve.to_json())))
    s = np.linspace(0.0, curve.duration_s, 50)
    assert (again.position(s) == curve.position(s)).all()
    assert again.extension is curve.extension


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"coefficients_m": []}, "at least one row"),
        ({"coefficients_m": [[1.0, 2.0, 3.0]]}, "at least one row"),
        ({"coefficients_m": [[1.0, math.nan]]}, "finite"),
        ({"duration_s": 0.0}, "positive"),
        ({"duration_s": math.inf}, "positive"),
        ({"base_m": [1.0]}, "two numbers"),
    ],
)
def test_what_is_no_curve_is_refused(change: dict[str, object], message: str) -> None:
    good = random_curve(1, 3, Extension.ODD).to_json()
    with pytest.raises(ValueError, match=message):
        FourierCurve.from_json(good | change)


def test_impossible_requests_are_refused() -> None:
    curve = random_curve(1, 5, Extension.EVEN)
    with pytest.raises(ValueError, match="cannot be cut"):
        curve.truncated(6)
    with pytest.raises(ValueError, match="too coarse"):
        curve.on_grid(5, 0)
    with pytest.raises(ValueError, match="at least one frequency"):
        fit_fourier(paper_path(), 0, Extension.ODD)


@given(curves)
@tried(20)
def test_the_length_is_that_of_a_fine_polyline(curve: FourierCurve) -> None:
    points = curve.position(np.linspace(0.0, curve.duration_s, 20_001))
    assert curve.length_m == pytest.approx(np.hypot(*np.diff(points, axis=0).T).sum(), rel=1e-3)
