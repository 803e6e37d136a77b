"""The exact flow against scipy's matrix exponential and an integrator; exits against the geometry."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from mission.geometry.simplices import Partition
from mission.steering.facet_control import affine_fields, exit_velocities, stay_velocities
from mission.steering.flow import exit_time, flow, flow_with_velocity, settling_time
from tests.support.drawn_cases import tried
from tests.support.triangles import shares, triangles

FIELDS = {
    "zero": np.zeros((2, 2)),
    "singular": np.array([[1.0, 2.0], [2.0, 4.0]]),
    "nilpotent": np.array([[0.0, 1.0], [0.0, 0.0]]),
    "defective": np.array([[-0.5, 1.0], [0.0, -0.5]]),
    "nearly defective": np.array([[-0.5, 1.0], [1e-14, -0.5]]),
    "rotation": np.array([[0.0, -3.0], [3.0, 0.0]]),
    "stiff": np.array([[-40.0, 0.0], [0.0, -0.01]]),
    "saddle": np.array([[1.0, 0.3], [0.2, -2.0]]),
}


def exponential(F: np.ndarray, g: np.ndarray, x0: np.ndarray, t: float) -> np.ndarray:
    augmented = np.zeros((3, 3))
    augmented[:2, :2], augmented[:2, 2] = F, g
    return np.asarray((expm(augmented * t) @ np.append(x0, 1.0))[:2])


@pytest.mark.parametrize("name", FIELDS)
@pytest.mark.parametrize("t", [-0.2, 0.0, 1e-9, 0.3, 4.0])
def test_flow_is_the_matrix_exponential(name: str, t: float) -> None:
    F, g, x0 = FIELDS[name], np.array([0.3, -1.2]), np.array([2.0, 5.0])
    expected = exponential(F, g, x0, t)
    np.testing.assert_allclose(flow(F, g, x0, [t])[0], expected, rtol=1e-11, atol=1e-11)


@tried(150)
@given(seed=st.integers(0, 2**32 - 1), scale=st.floats(-4.0, 1.0), t=st.floats(0.0, 3.0))
def test_flow_of_random_fields(seed: int, scale: float, t: float) -> None:
    rng = np.random.default_rng(seed)
    F, g, x0 = 10.0**scale * rng.normal(size=(2, 2)), rng.normal(size=2), rng.normal(size=2)
    expected = exponential(F, g, x0, t)
    np.testing.assert_allclose(flow(F, g, x0, [t])[0], expected, rtol=1e-9, atol=1e-10)
    position, velocity = flow_with_velocity(F, g, x0, [t])
    np.testing.assert_allclose(velocity[0], F @ position[0] + g, rtol=1e-8, atol=1e-8)


def test_flow_agrees_with_an_integrator() -> None:
    F, g, x0 = FIELDS["saddle"], np.array([0.1, 0.4]), np.array([-1.0, 2.0])
    times = np.linspace(0.0, 2.0, 9)
    ours = flow(F, g, x0, times)
    reference = solve_ivp(lambda _, x: F @ x + g, (0.0, 2.0), x0, t_eval=times, rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose(ours, reference.y.T, rtol=1e-8)


@tried(200)
@given(partition=triangles(), at=shares(), facet=st.integers(0, 2), speed=st.sampled_from([0.05, 4.0]))
def test_the_flow_leaves_by_its_facet_only(partition: Partition, at: np.ndarray, facet: int, speed: float) -> None:
    corners = partition.corners_m[0]
    F, g = affine_fields(corners, exit_velocities(partition, speed)[0, facet])
    start = at @ corners
    time, leaving = exit_time(F, g, corners, facet, start)
    size = float(partition.edge_lengths_m.max())
    here = partition.barycentric(np.array([0]), leaving[None])[0]
    assert abs(here[facet]) < 1e-9
    assert here.min() > -1e-9
    on_the_way = partition.barycentric(np.zeros(33, dtype=np.int64), flow(F, g, start, np.linspace(0.0, time, 33)))
    assert on_the_way.min() > -1e-9
    assert np.diff(on_the_way[:, facet]).max() <= 1e-12  # ever nearer to the exit
    np.testing.assert_allclose(flow(F, g, start, [time])[0], leaving, atol=1e-9 * size)


def test_a_field_that_does_not_lead_out_is_refused() -> None:
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    with pytest.raises(ValueError, match="does not lead out"):
        exit_time(np.zeros((2, 2)), np.array([-1.0, 0.0]), corners, 0, [0.2, 0.2])


@tried(100)
@given(partition=triangles(), at=shares())
def test_a_stay_settles_and_never_leaves(partition: Partition, at: np.ndarray) -> None:
    corners = partition.corners_m[0]
    F, g = affine_fields(corners, stay_velocities(partition, 1.0)[0])
    radius = 0.25 * float(partition.inradii_m[0])
    time = settling_time(F, g, at @ corners, radius)
    centre = -np.linalg.solve(F, g)
    times = np.linspace(0.0, 4.0 * time + 1.0, 50)
    positions = flow(F, g, at @ corners, times)
    assert partition.barycentric(np.zeros(50, dtype=np.int64), positions).min() > -1e-9
    distance = float(np.hypot(*(flow(F, g, at @ corners, [time])[0] - centre)))
    assert distance <= radius * (1.0 + 1e-6)
    with pytest.raises(ValueError, match="no stable equilibrium"):
        settling_time(-F, -g, at @ corners, radius)
