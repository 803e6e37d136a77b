"""Polynomials by control points against numpy's, at many places."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mission.geometry.arrays import FloatArray
from mission.geometry.bernstein import composed, derivative, halved, of_powers, part, raised, times
from tests.support.drawn_cases import tried

U = np.linspace(0.0, 1.0, 9)


def drawn(seed: int, degree: int, values: int = 2) -> tuple[FloatArray, FloatArray]:
    """Coefficients of three polynomials, and their control points."""
    powers = np.random.default_rng(seed).normal(size=(3, degree + 1, values))
    return powers, of_powers(powers, degree)


def at(control: FloatArray, u: FloatArray = U) -> FloatArray:
    """Values (K, P, d) at places, by de Casteljau's scheme one place at a time."""
    found = []
    for place in u.tolist():
        here = control
        while here.shape[1] > 1:
            here = here[:, :-1] * (1.0 - place) + here[:, 1:] * place
        found.append(here[:, 0])
    return np.stack(found, axis=1)


def by_powers(powers: FloatArray, u: FloatArray = U) -> FloatArray:
    return np.asarray(np.einsum("kid,ip->kpd", powers, u ** np.arange(powers.shape[1])[:, None]))


@given(st.integers(0, 10_000), st.integers(1, 7), st.integers(1, 4))
@tried(20)
def test_sums_products_and_compositions_are_those_of_the_values(seed: int, degree: int, other: int) -> None:
    powers, control = drawn(seed, degree)
    np.testing.assert_allclose(at(control), by_powers(powers), atol=1e-9)
    np.testing.assert_allclose(at(raised(control, degree + other)), by_powers(powers), atol=1e-9)
    _, factor = drawn(seed + 1, other, 1)
    np.testing.assert_allclose(at(times(control, factor)), at(control) * at(factor), atol=1e-9)
    inner = np.sort(np.random.default_rng(seed).uniform(size=(3, other + 1, 1)), axis=1)
    for k, places in enumerate(at(inner)[..., 0]):
        np.testing.assert_allclose(at(composed(control, inner))[k], at(control, places)[k], atol=1e-9)


@given(st.integers(0, 10_000), st.integers(2, 7), st.floats(0.0, 1.0), st.floats(0.0, 1.0))
@tried(20)
def test_parts_and_derivatives_are_those_of_the_whole(seed: int, degree: int, one: float, other: float) -> None:
    powers, control = drawn(seed, degree)
    low, high = min(one, other), max(one, other)
    cut = part(control, np.full(3, low), np.full(3, high))
    np.testing.assert_allclose(at(cut), by_powers(powers, low + (high - low) * U), atol=1e-8)
    np.testing.assert_allclose(at(halved(control))[1::2], by_powers(powers, 0.5 + 0.5 * U), atol=1e-9)
    sloped = powers[:, 1:] * np.arange(1, degree + 1)[None, :, None] / 4.0
    np.testing.assert_allclose(at(derivative(control, np.full(3, 4.0), 1)), by_powers(sloped), atol=1e-9)
