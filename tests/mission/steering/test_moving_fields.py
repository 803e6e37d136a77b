"""Fields in moving triangles, against maps that are solved for, flows that are stepped, and dense samples."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from mission.geometry.arrays import FloatArray
from mission.geometry.moving import MovingPartition
from mission.steering.facet_control import affine_fields, exit_margins, exit_velocities, stay_margins, stay_velocities
from mission.steering.flow import flow
from mission.steering.moving_fields import MovingFields
from tests.support.drawn_cases import tried
from tests.support.moving_meshes import shaken

SEEDS = st.integers(0, 10_000)
DENSE_S = np.unique(np.concatenate((np.linspace(0.0, 8.0, 65), [2.0, 3.0, 7.0])))


def unfolded(seed: int) -> MovingPartition:
    moving = shaken(seed, 0.5)
    assume(moving.first_flat() is None)
    return moving


def fields_of(moving: MovingPartition, control: int) -> MovingFields:
    """The field of a control in each triangle, at 2 m/s."""
    mesh = moving.fixed
    velocities = exit_velocities(mesh, 2.0)[:, control - 1] if control else stay_velocities(mesh, 2.0)
    return MovingFields(moving, np.arange(mesh.size), velocities)


class Carried:
    """The affine map of one triangle, solved for from three corners, and what it makes of a field."""

    def __init__(self, moving: MovingPartition, triangle: int, velocities: FloatArray) -> None:
        self.moving, self.vertices = moving, moving.fixed.triangles[triangle]
        self.before = np.column_stack((moving.fixed.corners_m[triangle], np.ones(3)))
        self.F, self.g = affine_fields(moving.fixed.corners_m[triangle], velocities)

    def map(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """A and b of x -> A x + b that takes the fixed corners to values (3, 2)."""
        solved = np.linalg.solve(self.before, values)
        return solved[:2].T, solved[2]

    def velocity(self, time_s: float, x: FloatArray) -> FloatArray:
        a, b = self.map(self.moving.vertices_at(time_s)[self.vertices])
        a_dot, b_dot = self.map(self.moving.velocities_at(time_s)[self.vertices])
        xi = np.linalg.solve(a, x - b)
        return np.asarray(a @ (self.F @ xi + self.g) + a_dot @ xi + b_dot)

    def flown(self, start: FloatArray, until_s: float) -> tuple[FloatArray, FloatArray]:
        """Times and places of the flow in space, stepped from instant to instant."""
        times, places = [0.0], [start]
        instants = [t for t in self.moving.times_s.tolist() if 0.0 < t < until_s]
        for begin, end in zip([0.0, *instants], [*instants, until_s], strict=True):
            within = np.linspace(begin, end, 30)

            def rate(t: float, x: FloatArray, last: float = end) -> FloatArray:
                return self.velocity(min(t, np.nextafter(last, 0.0)), x)

            found = solve_ivp(rate, (begin, end), places[-1], t_eval=within, rtol=1e-9, atol=1e-10)
            times += within.tolist()
            places += list(found.y.T)
        return np.array(times), np.array(places)


@tried(20)
@given(seed=SEEDS, control=st.integers(0, 3))
def test_the_flow_in_space_is_the_image_of_the_fixed_one_and_does_what_its_control_says(
    seed: int, control: int
) -> None:
    moving, rng = unfolded(seed), np.random.default_rng(seed)
    triangle = int(rng.integers(moving.fixed.size))
    carried = Carried(moving, triangle, fields_of(moving, control).velocities_m_s[triangle])
    start = rng.dirichlet(np.ones(3)) @ moving.fixed.corners_m[triangle]
    times, places = carried.flown(start, 8.0)
    then = np.stack([moving.vertices_at(t)[moving.fixed.triangles[triangle]] for t in times])
    shares = np.stack(
        [np.linalg.solve(np.vstack((c.T, np.ones(3))), (*x, 1.0)) for c, x in zip(then, places, strict=True)]
    )
    fixed = moving.fixed.barycentric(np.full(len(times), triangle), flow(carried.F, carried.g, np.array(start), times))
    inside = (fixed > -1.0).all(axis=1)
    assert np.abs(shares - fixed)[inside].max() < 1e-5
    if control == 0:
        assert shares.min() > -1e-9
        return
    out = np.flatnonzero(shares.min(axis=1) < 0.0)
    assert len(out)  # in 8 s at 2 m/s
    assert shares[out[0]].argmin() == control - 1
    assert (np.diff(shares[: out[0] + 1, control - 1]) <= 1e-12).all()


@tried(30)
@given(seed=SEEDS, control=st.integers(0, 3))
def test_vertex_velocities_are_those_of_the_map_and_coordinates_change_alike(seed: int, control: int) -> None:
    moving, rng = unfolded(seed), np.random.default_rng(seed)
    fields, time_s = fields_of(moving, control), float(rng.uniform(0.0, 8.0))
    found = fields.vertex_velocities(time_s)
    normals, heights = moving.at(time_s).normals, moving.at(time_s).heights_m
    own = found - moving.velocities_at(time_s)[moving.fixed.triangles]
    # By the shape that the moving triangle has then.
    rates = -np.einsum("njx,nix->nji", normals, own) / heights[..., None]
    assert np.abs(rates - fields.coordinate_rates).max() < 1e-9
    for triangle in range(moving.fixed.size):
        carried = Carried(moving, triangle, fields.velocities_m_s[triangle])
        for corner, velocity in zip(moving.vertices_at(time_s)[carried.vertices], found[triangle], strict=True):
            assert np.abs(carried.velocity(time_s, corner) - velocity).max() < 1e-9


@tried(30)
@given(seed=SEEDS, control=st.integers(0, 3))
def test_rates_across_moving_facets_keep_within_bounds_that_are_attained(seed: int, control: int) -> None:
    moving = unfolded(seed)
    fields = fields_of(moving, control)
    least, largest = fields.facet_rates
    seen = []
    for time_s in DENSE_S.tolist():
        own = fields.vertex_velocities(time_s) - moving.velocities_at(time_s)[moving.fixed.triangles]
        seen.append(np.einsum("njx,nix->nji", moving.at(time_s).normals, own))
    dense = np.stack(seen)
    assert (least <= dense.min(axis=0) + 1e-9).all()
    assert (largest >= dense.max(axis=0) - 1e-9).all()
    assert np.abs(dense.min(axis=0) - least).max() < 0.02
    assert np.abs(dense.max(axis=0) - largest).max() < 0.02


@tried(30)
@given(seed=SEEDS, control=st.integers(0, 3))
def test_margins_are_strict_at_every_instant_and_the_least_of_all(seed: int, control: int) -> None:
    moving = unfolded(seed)
    fields, every = fields_of(moving, control), np.arange(moving.fixed.size)
    margins = fields.margins(np.full(moving.fixed.size, control))
    assert (margins > 0.0).all()
    dense = []
    for time_s in DENSE_S.tolist():
        then = moving.at(time_s)
        own = fields.vertex_velocities(time_s) - moving.velocities_at(time_s)[moving.fixed.triangles]
        if control:
            every_exit = np.repeat(own[:, None], 3, axis=1)
            dense.append(exit_margins(then, every_exit)[every, control - 1].min(axis=1))
        else:
            dense.append(stay_margins(then, own).min(axis=(1, 2)))
    least = np.min(dense, axis=0)
    assert (margins <= least + 1e-9).all()
    assert (least - margins).max() < 0.02


@tried(30)
@given(seed=SEEDS, control=st.integers(0, 3), limit=st.sampled_from([0.4, 1.0, 2.1, 5.0]))
def test_speeds_in_space_are_bounded_and_fields_are_slowed_down_as_little_as_that_takes(
    seed: int, control: int, limit: float
) -> None:
    moving = unfolded(seed)
    fields = fields_of(moving, control)
    ends = np.append(moving.times_s[1:], 9.0)
    factors, speeds = fields.factors(limit), fields.speeds_m_s
    for k, (begin, end) in enumerate(zip(moving.times_s, ends, strict=True)):
        within = np.linspace(begin, end, 9)
        within[-1] = np.nextafter(end, 0.0)
        dense = np.max([np.linalg.norm(fields.vertex_velocities(t), axis=2).max(axis=1) for t in within], axis=0)
        assert speeds[k] == pytest.approx(dense, rel=1e-9)
        drifts = np.linalg.norm(moving.velocities_at(begin)[moving.fixed.triangles], axis=2).max(axis=1)
        assert ((factors[k] == 0.0) == (drifts >= limit)).all()
        slowed = MovingFields(moving, fields.triangles, factors[k, :, None, None] * fields.velocities_m_s)
        fast, some = slowed.speeds_m_s[k], factors[k] > 0.0
        assert (fast[some] <= limit * (1.0 + 1e-9)).all()
        assert fast[some & (factors[k] < 1.0)] == pytest.approx(limit, rel=1e-9)
