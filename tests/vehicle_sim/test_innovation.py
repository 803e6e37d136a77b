"""The gate's quadratic form against the inverse that defines it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vehicle_sim.estimator.innovation import normalised_square


@given(st.integers(1, 4), st.integers(0, 2**32 - 1), st.floats(1e-3, 1e3))
def test_it_is_the_square_by_the_inverse_of_the_covariance(rows: int, seed: int, size: float) -> None:
    random = np.random.default_rng(seed)
    factor = size * (random.normal(size=(rows, rows)) + 3.0 * np.eye(rows))
    covariance, innovation = factor @ factor.T, size * random.normal(size=rows)
    expected = float(innovation @ np.linalg.inv(covariance) @ innovation)
    tolerance = 1e-12 * float(np.linalg.cond(covariance))
    assert normalised_square(innovation.tolist(), covariance.tolist()) == pytest.approx(expected, rel=1e-9 + tolerance)


def test_what_was_given_stays_as_it_was() -> None:
    innovation, covariance = [1.0, 2.0], [[2.0, 1.0], [1.0, 3.0]]
    assert normalised_square(innovation, covariance) == pytest.approx(1.4)
    assert (innovation, covariance) == ([1.0, 2.0], [[2.0, 1.0], [1.0, 3.0]])
