"""The growing triangulation against scipy's, which begins anew each time."""

import numpy as np
import pytest
from scipy.spatial import Delaunay

from mission.geometry.delaunay import Triangulation


def put_in(mesh: Triangulation, points: np.ndarray) -> int:
    """Put all points in, however many rounds it takes; return how many it took."""
    rounds = 0
    while len(points):
        growth = mesh.insert(points, mesh.cavities(points, mesh.conflicting(points)))
        assert growth.taken.any()
        points, rounds = points[~growth.taken], rounds + 1
    return rounds


def rows(triangles: np.ndarray) -> set[tuple[int, ...]]:
    return {tuple(sorted(row)) for row in triangles.tolist()}


@pytest.mark.parametrize("seed", range(5))
def test_points_that_go_in_later_give_the_same_triangles(seed: int) -> None:
    chance = np.random.default_rng(seed)
    mesh = Triangulation(chance.uniform(size=(40, 2)))
    assert put_in(mesh, chance.uniform(size=(400, 2))) < 100
    assert len(mesh.vertices) == 444
    assert rows(mesh.triangles) == rows(Delaunay(mesh.vertices).simplices)


def test_neighbours_share_the_edge_that_is_opposite_the_corner() -> None:
    chance = np.random.default_rng(7)
    mesh = Triangulation(chance.uniform(size=(20, 2)))
    put_in(mesh, chance.uniform(size=(200, 2)))
    for number, (corners, beside) in enumerate(zip(mesh.triangles.tolist(), mesh.neighbours.tolist(), strict=True)):
        for side, other in enumerate(beside):
            if other >= 0:
                assert number in mesh.neighbours[other]
                assert set(corners) - {corners[side]} < set(mesh.triangles[other].tolist())
    assert (mesh.neighbours < 0).sum() == 4  # the sides of the square


def test_points_on_a_grid_which_are_all_on_circles_with_others() -> None:
    places = np.stack(np.meshgrid(np.arange(12.0), np.arange(12.0)), axis=-1).reshape(-1, 2)
    mesh = Triangulation(places[::2])
    put_in(mesh, places[1::2])
    corners = mesh.vertices[mesh.triangles]
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas = (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2.0
    assert (areas > 0.0).all()
    assert areas.sum() == pytest.approx(np.ptp(mesh.vertices[:4], axis=0).prod())
    # No vertex lies inside a circumcircle, up to rounding.
    weights = (corners**2).sum(axis=-1)
    x = (weights * (np.roll(corners, -1, axis=1) - np.roll(corners, -2, axis=1))[..., 1]).sum(axis=1) / (4.0 * areas)
    y = (weights * (np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1))[..., 0]).sum(axis=1) / (4.0 * areas)
    centres = np.stack((x, y), axis=1)
    radii = np.linalg.norm(corners[:, 0] - centres, axis=1)
    distances = np.linalg.norm(mesh.vertices[None] - centres[:, None], axis=-1)
    assert (distances >= radii[:, None] * (1.0 - 1e-9)).all()


def test_what_went_in_first_keeps_a_later_point_beside_it_out() -> None:
    mesh = Triangulation(np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]))
    points = np.array([[5.0, 4.0], [5.0, 4.1]])
    growth = mesh.insert(points, mesh.cavities(points, mesh.conflicting(points)))
    assert growth.taken.tolist() == [True, False]
    assert mesh.vertices[-1].tolist() == [5.0, 4.0]
