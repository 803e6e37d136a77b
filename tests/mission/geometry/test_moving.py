"""Triangles that move: their maps, against exact arithmetic and dense samples; and meshes that go along."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.errors import GeometryError
from mission.geometry.carrying import carried_along
from mission.geometry.location import Locator
from mission.geometry.moving import FLATTEST, MovingPartition
from mission.geometry.triangulation import triangulate_nodes
from tests.support.drawn_cases import tried
from tests.support.moving_meshes import shaken, some_mesh


@tried(40)
@given(seed=st.integers(0, 10_000))
def test_each_triangle_is_the_image_of_a_fixed_one(seed: int) -> None:
    moving, rng = shaken(seed, 0.3), np.random.default_rng(seed)
    if moving.first_flat() is not None:
        return
    times, places = rng.uniform(0.0, 9.0, 30), rng.uniform(0.0, 20.0, (30, 2))
    fixed = moving.pulled_back(times, places)
    triangles = Locator(moving.fixed).triangle_at(fixed)
    assert np.abs(moving.carried(times, fixed, triangles) - places).max() < 1e-9
    for time_s, place, triangle in zip(times, places, triangles, strict=True):
        then = moving.at(time_s)
        assert then.barycentric(np.array([triangle]), place[None]).min() > -1e-9
        assert np.abs(moving.vertices_at(time_s) - then.vertices_m).max() == 0.0


def test_what_lies_outside_is_its_own_image_and_after_the_last_instant_all_stand() -> None:
    moving = shaken(3, 0.3)
    outside = np.array([[-5.0, 3.0], [25.0, 30.0]])
    assert (moving.pulled_back(np.array([1.0, 4.0]), outside) == outside).all()
    assert (moving.vertices_at(7.0) == moving.vertices_at(70.0)).all()
    assert not moving.velocities_at(7.0).any()
    late = 0.5 * (moving.vertices_at(2.0) + moving.vertices_at(3.0))
    assert np.abs(moving.vertices_at(2.5) - late).max() < 1e-12
    assert np.abs(moving.vertices_at(2.0) + moving.velocities_at(2.0) - moving.vertices_at(3.0)).max() < 1e-12


@tried(30)
@given(seed=st.integers(0, 10_000), most_m=st.sampled_from([0.3, 1.0, 3.0]))
def test_the_first_triangle_that_folds_is_found_exactly(seed: int, most_m: float) -> None:
    moving = shaken(seed, most_m)
    flat, dense = moving.first_flat(), np.linspace(0.0, 7.0, 281)

    def flatness(time_s: float) -> np.ndarray:
        corners = moving.vertices_at(time_s)[moving.fixed.triangles]
        edges = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
        doubled = edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]
        return np.asarray(doubled / (edges**2).sum(axis=2).max(axis=1))

    seen = [time_s for time_s in dense.tolist() if flatness(time_s).min() < FLATTEST]
    if flat is None:
        assert not seen
        return
    assert abs(flatness(flat.time_s)[flat.triangle] - FLATTEST) < 1e-6 or flat.time_s == 0.0
    assert all(flat.time_s <= time_s + 1e-9 for time_s in seen)


def test_vertices_of_the_boundary_do_not_move() -> None:
    mesh = some_mesh(1)
    places = np.stack((mesh.vertices_m, mesh.vertices_m + 0.1))
    with pytest.raises(GeometryError, match="boundary stay"):
        MovingPartition(mesh, np.array([0.0, 1.0]), places)
    with pytest.raises(GeometryError, match="ascend"):
        MovingPartition(mesh, np.array([0.0, 0.0]), np.stack((mesh.vertices_m,) * 2))


def test_a_mesh_goes_along_farther_than_its_edges_are_long() -> None:
    xs, ys = np.meshgrid(np.linspace(0.0, 20.0, 9), np.linspace(0.0, 20.0, 9))
    mesh = triangulate_nodes(np.stack((xs.ravel(), ys.ravel()), axis=1) + 0.0)
    middle = int(np.argmin(np.linalg.norm(mesh.vertices_m - [5.0, 10.0], axis=1)))
    moved = np.arange(len(mesh.vertices_m)) == middle
    places = np.repeat(mesh.vertices_m[None], 2, axis=0)
    places[1, middle] += [7.5, 0.0]  # three edges
    moving = carried_along(mesh, np.array([0.0, 10.0]), moved, places)
    assert moving.first_flat() is None
    assert np.abs(moving.vertices_at(5.0)[middle] - [8.75, 10.0]).max() < 1e-12
    alone = MovingPartition(mesh, np.array([0.0, 10.0]), places)
    assert alone.first_flat() is not None


def test_who_is_not_moved_stays_where_nothing_is() -> None:
    mesh = some_mesh(5)
    nobody = np.zeros(len(mesh.vertices_m), dtype=np.bool_)
    places = np.repeat(mesh.vertices_m[None], 3, axis=0)
    moving = carried_along(mesh, np.array([0.0, 1.0, 4.0]), nobody, places)
    assert not moving.moves.any()
    assert moving.fastest_m_s == 0.0
