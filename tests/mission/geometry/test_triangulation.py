"""Triangulations of nodes: the paper's numbering, Euler's formula, areas, and edges that are in them or missing."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import Delaunay

from mission.errors import GeometryError
from mission.geometry.arrays import FloatArray
from mission.geometry.rings import ring_edges
from mission.geometry.simplices import Partition
from mission.geometry.triangulation import EdgesInMesh, slivers, triangulate_nodes
from tests.support.domains import PAPER_NODES, PAPER_TRIANGLES, random_nodes
from tests.support.drawn_cases import tried

seeds = st.integers(0, 10_000)


def symmetric(partition: Partition) -> bool:
    """Whether each neighbour across a facet has that facet, and the triangle across it, too."""
    for i, (triangle, row) in enumerate(zip(partition.triangles, partition.neighbours, strict=True)):
        for j, other in enumerate(row):
            shared = {int(triangle[j - 2]), int(triangle[j - 1])}
            holders = [k for k, t in enumerate(partition.triangles) if shared <= {int(v) for v in t}]
            if set(holders) != ({i} if other < 0 else {i, int(other)}):
                return False
    return True


def square_grid(count: int, angle: float, shift: float) -> FloatArray:
    xs, ys = np.meshgrid(np.arange(float(count)), np.arange(float(count)))
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    grid: FloatArray = np.stack((xs.ravel(), ys.ravel()), axis=1) @ turn.T * 3.7 + shift
    return grid


def test_paper_domain_has_the_papers_numbering() -> None:
    partition = triangulate_nodes(PAPER_NODES)
    assert partition.triangles.tolist() == PAPER_TRIANGLES
    assert partition.triangles[3].tolist() == [7, 4, 1]
    assert partition.neighbours.tolist() == Delaunay(PAPER_NODES).neighbors.tolist()


@given(seeds, st.integers(4, 40))
@tried(60)
def test_euler_neighbours_and_areas_of_random_nodes(seed: int, count: int) -> None:
    nodes = random_nodes(seed, count)
    partition = triangulate_nodes(nodes)
    hull = shapely.MultiPoint(nodes).convex_hull
    rim = int((partition.neighbours < 0).sum())
    edges = (3 * partition.size + rim) // 2
    assert len(nodes) - edges + partition.size == 1
    assert partition.areas_m2.sum() == pytest.approx(hull.area, rel=1e-12)
    assert symmetric(partition)


@given(st.integers(2, 8), st.floats(0.0, 3.2), st.floats(-1000.0, 1000.0))
@tried(60)
def test_turned_grids_have_no_triangles_of_rounding_height(count: int, angle: float, shift: float) -> None:
    nodes = square_grid(count, angle, shift)
    partition = triangulate_nodes(nodes)
    assert partition.size == 2 * (count - 1) ** 2
    assert partition.areas_m2.sum() == pytest.approx((3.7 * (count - 1)) ** 2, rel=1e-9)
    assert symmetric(partition)
    assert not len(slivers(partition))


def test_nodes_in_line_or_too_few_or_not_finite_are_refused() -> None:
    with pytest.raises(GeometryError, match="one line"):
        triangulate_nodes(np.array([(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)]))
    with pytest.raises(GeometryError, match="one line"):
        triangulate_nodes(np.array([(0.0, 0.0), (0.1, 0.3), (0.2, 0.6), (0.7, 2.1)]))
    with pytest.raises(GeometryError, match="2 nodes"):
        triangulate_nodes(np.array([(0.0, 0.0), (1.0, 1.0)]))
    with pytest.raises(GeometryError, match="finite"):
        triangulate_nodes(np.array([(0.0, 0.0), (1.0, math.nan), (2.0, 2.0)]))


def test_slivers_are_found() -> None:
    partition = triangulate_nodes(np.array([(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (5.0, 4.9999)]))
    assert [partition.triangles[i].tolist() for i in slivers(partition)] != []
    assert not len(slivers(triangulate_nodes(PAPER_NODES)))


SQUARE = np.array([(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)])


def test_a_vertex_on_an_edge_splits_it() -> None:
    ring = np.array([(0.0, 0.0), (9.0, 3.0), (6.0, 12.0), (-3.0, 9.0)])
    # A third of the way along a slanting side, so that they are not exactly on it.
    inner = np.array([(3.0, 1.0), (2.0, 5.0), (0.1 * 3 / 0.1 * 2, 2.0)])
    chain = EdgesInMesh.of(triangulate_nodes(np.concatenate((ring, inner))), ring_edges(ring))
    assert chain.edge_of.tolist().count(0) == 3
    assert not len(chain.missing)


def test_an_edge_that_does_not_come_out_is_named() -> None:
    thin = np.array([(1.0, 5.0), (9.0, 5.0), (9.0, 9.0), (1.0, 9.0)])
    mesh = triangulate_nodes(np.concatenate((SQUARE, thin, [(5.0, 5.1), (5.0, 4.9)])))
    assert EdgesInMesh.of(mesh, ring_edges(thin)).missing.tolist() == [0]
    with pytest.raises(GeometryError, match="no vertex"):
        EdgesInMesh.of(mesh, ring_edges(thin + 0.5))
    with pytest.raises(GeometryError, match="no vertex"):
        EdgesInMesh.of(mesh, ring_edges(np.array([(0.0, 0.0), (4.0, 0.0), (10.0, 10.0)])))
