"""The closed-form vertex velocities against the paper's conditions and against its optimisation."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import LinearConstraint, minimize

from mission.geometry.simplices import Partition
from mission.steering.facet_control import (
    affine_fields,
    exit_margins,
    exit_rates,
    exit_velocities,
    stay_equilibria,
    stay_margins,
    stay_velocities,
)
from tests.support.drawn_cases import tried
from tests.support.triangles import shares, single, triangles

EQUILATERAL = single(np.array([[0.0, 0.0], [2.0, 0.0], [1.0, np.sqrt(3.0)]]))


def test_velocities_of_an_equilateral_triangle_by_hand() -> None:
    out = exit_velocities(EQUILATERAL, 3.0)[0, 0]  # out through the facet opposite the first vertex
    half = np.sqrt(0.75)
    np.testing.assert_allclose(out, 3.0 * np.array([[half, 0.5], [0.5, half], [1.0, 0.0]]), atol=1e-12)
    stay = stay_velocities(EQUILATERAL, 3.0)[0]
    np.testing.assert_allclose(stay, 3.0 * np.array([[half, 0.5], [-half, 0.5], [0.0, -1.0]]), atol=1e-12)


@tried(150)
@given(partition=triangles(), speed=st.floats(0.01, 20.0))
def test_every_condition_holds_with_a_margin_and_every_speed_is_c(partition: Partition, speed: float) -> None:
    out, stay = exit_velocities(partition, speed), stay_velocities(partition, speed)
    np.testing.assert_allclose(np.linalg.norm(out, axis=-1), speed, rtol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(stay, axis=-1), speed, rtol=1e-12)
    assert exit_margins(partition, out).min() > 0.01 * speed
    assert exit_rates(partition, out).min() > 0.01 * speed
    assert stay_margins(partition, stay).min() > 0.01 * speed


@tried(150)
@given(partition=triangles(), at=shares(), facet=st.integers(0, 2))
def test_the_field_is_the_interpolation_of_the_vertex_velocities(
    partition: Partition, at: np.ndarray, facet: int
) -> None:
    corners, velocities = partition.corners_m[0], exit_velocities(partition, 1.0)[0, facet]
    F, g = affine_fields(corners, velocities)
    scale = 1.0 + np.abs(F).sum() * np.abs(corners).max()
    np.testing.assert_allclose(F @ (at @ corners) + g, at @ velocities, atol=1e-12 * scale)


@tried(150)
@given(partition=triangles(), speed=st.sampled_from([0.05, 1.0, 15.0]))
def test_a_stay_field_has_one_stable_equilibrium_inside(partition: Partition, speed: float) -> None:
    F, g = affine_fields(partition.corners_m, stay_velocities(partition, speed))
    point = stay_equilibria(partition)
    assert partition.barycentric(np.array([0]), point).min() > 0.0
    size = float(partition.edge_lengths_m.max() + np.abs(partition.corners_m).max())
    np.testing.assert_allclose(point[0], -np.linalg.solve(F[0], g[0]), atol=1e-10 * size)
    assert np.linalg.eigvals(F[0]).real.max() < 0.0


def test_the_equilibrium_of_a_right_triangle_by_hand() -> None:
    partition = single(np.array([[0.0, 0.0], [4.0, 0.0], [0.0, 3.0]]))
    # cos(alpha / 2) from cos(alpha) = 0, 4/5 and 3/5.
    weights = np.sqrt(0.5 * (1.0 + np.array([0.0, 0.8, 0.6])))
    expected = np.array([4.0 * weights[1], 3.0 * weights[2]]) / weights.sum()
    np.testing.assert_allclose(stay_equilibria(partition)[0], expected, rtol=1e-12)


def conditions(partition: Partition, facet: int) -> np.ndarray:
    """Rows of Eq. 18 (row 5 as it stands there) for the exit through one facet, unit normals, B = I."""
    j, k, l = facet, (facet + 1) % 3, (facet + 2) % 3  # noqa: E741 - the paper's indices
    n = partition.normals[0]
    rows = np.zeros((7, 3, 2))
    rows[0, j], rows[1, j], rows[2, j] = -n[k], -n[l], -n[k] - n[l]
    rows[3, k], rows[4, k] = n[j], -n[l]
    rows[5, l], rows[6, l] = n[j], -n[k]
    return rows.reshape(7, 6)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("facet", range(3))
def test_the_papers_optimisation_finds_nothing_better(seed: int, facet: int) -> None:
    rng = np.random.default_rng(seed)
    corners = rng.uniform(0.0, 10.0, (3, 2))
    if np.cross(np.append(corners[1] - corners[0], 0), np.append(corners[2] - corners[0], 0))[2] < 0:
        corners = corners[::-1]
    partition, speed = single(corners), 0.05
    C = conditions(partition, facet)

    def cost(u: np.ndarray) -> float:
        return float(((speed - np.linalg.norm(u.reshape(3, 2), axis=1)) ** 2).sum()) / speed**2

    ours = exit_velocities(partition, speed)[0, facet].ravel()
    assert cost(ours) < 1e-24
    assert (C @ ours).min() > 0.01 * speed
    np.testing.assert_allclose(
        np.sort(C @ ours), np.sort(exit_margins(partition, exit_velocities(partition, speed))[0, facet])
    )
    start = ours + rng.normal(0.0, 0.3 * speed, 6)
    found = minimize(cost, start, constraints=LinearConstraint(C / speed, 0.0, np.inf), method="SLSQP")
    assert found.fun > -1e-15
    assert found.fun < 1e-6  # the optimum of Eq. 19 is zero: the conditions are cones
    # Of all unit directions in the cone of a vertex the bisector keeps the largest least margin to its two edges.
    for vertex in range(3):
        rows = C.reshape(7, 3, 2)[:, vertex]
        rows = rows[np.linalg.norm(rows, axis=1) > 0][:2]
        angles = np.linspace(0.0, 2.0 * np.pi, 3601)
        directions = speed * np.column_stack((np.cos(angles), np.sin(angles)))
        best = (directions @ rows.T).min(axis=1).max()
        assert (rows @ ours.reshape(3, 2)[vertex]).min() > best - 1e-5 * speed
