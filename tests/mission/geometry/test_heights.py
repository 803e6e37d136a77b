"""Heights of triangles whose corners move: against dense samples, and where they are known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.geometry.arrays import FloatArray
from mission.geometry.heights import height_bounds
from tests.support.drawn_cases import tried

TURNED = np.array([[0.0, 0.0], [4.0, 0.0], [0.0, 3.0]])


def heights(corners: FloatArray) -> FloatArray:
    """Of each corner, by its distance from the line through the two others."""
    found = []
    for j in range(3):
        a, b = corners[..., (j + 1) % 3, :], corners[..., (j + 2) % 3, :]
        along = (b - a) / np.linalg.norm(b - a, axis=-1, keepdims=True)
        off = corners[..., j, :] - a
        found.append(along[..., 0] * off[..., 1] - along[..., 1] * off[..., 0])
    return np.stack(found, axis=-1)


@tried(60)
@given(seed=st.integers(0, 10_000), most_m=st.sampled_from([0.1, 1.0, 4.0]))
def test_no_height_lies_beyond_its_bounds_and_both_are_attained(seed: int, most_m: float) -> None:
    rng = np.random.default_rng(seed)
    before = rng.uniform(0.0, 5.0, (20, 3, 2))
    after = before + rng.uniform(-most_m, most_m, before.shape)
    u = np.linspace(0.0, 1.0, 2001)[:, None, None, None]
    dense = heights(before + u * (after - before))  # (U, 20, 3)
    whole = dense.min(axis=(0, 2)) > 0.05  # the others fold
    least, largest = height_bounds(before[whole], after[whole])
    assert least.shape == largest.shape == (whole.sum(), 3)
    least_seen, largest_seen = dense.min(axis=0)[whole], dense.max(axis=0)[whole]
    assert (least <= least_seen + 1e-12).all()
    assert (largest >= largest_seen - 1e-12).all()
    assert (least_seen - least).max(initial=0.0) < 1e-4
    assert (largest - largest_seen).max(initial=0.0) < 1e-4


@pytest.mark.parametrize("shift", [[0.0, 0.0], [7.0, -3.0]])
def test_a_triangle_that_only_shifts_keeps_its_heights(shift: list[float]) -> None:
    least, largest = height_bounds(TURNED, TURNED + shift)
    assert least == pytest.approx([2.4, 4.0, 3.0])
    assert largest == pytest.approx([2.4, 4.0, 3.0])


def test_a_height_that_turns_on_the_way_is_found() -> None:
    """The corner at the left is farthest from the facet at the right where that stands upright, after a third."""
    before = np.array([[1.0, 2.0], [-2.0, 0.0], [2.0, 0.0]])
    after = np.array([[4.0, 2.0], [-2.0, 0.0], [2.0, 0.0]])
    least, largest = height_bounds(before, after)
    assert least == pytest.approx([2.0, 8.0 / np.hypot(2.0, 2.0), 8.0 / np.hypot(6.0, 2.0)])
    assert largest == pytest.approx([2.0, 4.0, 8.0 / np.hypot(3.0, 2.0)])
