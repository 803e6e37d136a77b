"""What follows from a partition, against its definitions."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.errors import GeometryError
from mission.geometry.simplices import Partition
from mission.geometry.triangulation import triangulate_nodes
from tests.support.domains import PAPER_NODES, random_nodes
from tests.support.drawn_cases import tried


@given(st.integers(0, 10_000))
@tried(30)
def test_centres_and_radii_have_their_distances(seed: int) -> None:
    partition = triangulate_nodes(random_nodes(seed, 12))
    to_facets = ((np.roll(partition.corners_m, -1, axis=1) - partition.incentres_m[:, None]) * partition.normals).sum(
        -1
    )
    assert to_facets == pytest.approx(np.tile(partition.inradii_m[:, None], 3))
    heights = ((np.roll(partition.corners_m, -1, axis=1) - partition.corners_m) * partition.normals).sum(-1)
    assert partition.heights_m == pytest.approx(heights)
    # Euler: the squared distance of the centres is R (R - 2 r); with the law of sines R = a / (2 sin alpha).
    sines = 2 * partition.areas_m2 / (partition.edge_lengths_m[:, 1] * partition.edge_lengths_m[:, 2])
    assert partition.circumradii_m == pytest.approx(partition.edge_lengths_m[:, 0] / (2 * sines))
    assert partition.angles_rad.sum(axis=1) == pytest.approx(np.full(partition.size, np.pi))
    assert np.sin(partition.angles_rad[:, 0]) == pytest.approx(sines)


@given(st.integers(0, 10_000))
@tried(30)
def test_barycentric_coordinates_rebuild_their_points(seed: int) -> None:
    partition = triangulate_nodes(random_nodes(seed, 12))
    triangles = np.arange(partition.size)
    points = random_nodes(seed + 1, partition.size)
    shares = partition.barycentric(triangles, points)
    assert shares.sum(axis=1) == pytest.approx(np.ones(partition.size))
    assert (shares[..., None] * partition.corners_m).sum(axis=1) == pytest.approx(points)


def test_normals_point_out_of_the_opposite_facet() -> None:
    partition = triangulate_nodes(PAPER_NODES)
    assert np.linalg.norm(partition.normals, axis=-1) == pytest.approx(np.ones((13, 3)))
    outward = ((partition.corners_m - np.roll(partition.corners_m, -1, axis=1)) * partition.normals).sum(-1)
    assert (outward < 0).all()
    assert partition.extent_m == 15.0


SQUARE = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]


@pytest.mark.parametrize(
    ("vertices", "triangles", "neighbours", "words"),
    [
        (SQUARE, [(0, 2, 1)], [(-1, -1, -1)], "not counter-clockwise"),
        (SQUARE, [(0, 1, 1)], [(-1, -1, -1)], "flat"),
        (SQUARE, [(0, 1, 4)], [(-1, -1, -1)], "outside 0 to 3"),
        (SQUARE, [(0, 1, 2)], [(-1, 1, -1)], "outside -1 to 0"),
        (SQUARE, [(0, 1, 2)], [(-1, -1)], "shape"),
        (SQUARE, [], [], "shape"),
        ([(0.0, 0.0), (1.0, np.nan), (1.0, 1.0)], [(0, 1, 2)], [(-1, -1, -1)], "points of the plane"),
    ],
)
def test_a_partition_is_valid_from_birth(
    vertices: list[tuple[float, float]], triangles: list[list[int]], neighbours: list[list[int]], words: str
) -> None:
    with pytest.raises(GeometryError, match=words):
        Partition(np.array(vertices), np.array(triangles, dtype=np.int64), np.array(neighbours, dtype=np.int64))
