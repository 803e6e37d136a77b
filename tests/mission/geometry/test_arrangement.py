"""Outlines that nearly meet, cross, or run along each other, as vertices and segments."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from mission.geometry.arrangement import Arrangement, arranged
from mission.geometry.rings import edge_crossings, ring_edges
from tests.support.drawn_cases import tried

TOLERANCE_M = 0.01
SQUARE = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])


def lines(arrangement: Arrangement) -> list[list[tuple[float, float]]]:
    return [sorted(map(tuple, pair)) for pair in arrangement.vertices_m[arrangement.segments].tolist()]


def test_one_outline_stays_as_it_is() -> None:
    found = arranged(ring_edges(SQUARE), TOLERANCE_M)
    assert found.vertices_m.tolist() == SQUARE.tolist()
    assert len(found.segments) == 4


def test_outlines_that_cross_share_vertices_there() -> None:
    found = arranged(np.concatenate((ring_edges(SQUARE), ring_edges(SQUARE + 5.0))), TOLERANCE_M)
    assert {(10.0, 5.0), (5.0, 10.0)} < set(map(tuple, found.vertices_m.tolist()))
    assert len(found.segments) == 12


@pytest.mark.parametrize("apart_m", [0.0, 1e-9, 1e-6, 1e-3, 9e-3, -1e-9, -1e-6, -1e-3, -9e-3])
def test_neighbours_that_nearly_share_an_edge_share_it(apart_m: float) -> None:
    beside = SQUARE + np.array([10.0 + apart_m, 0.0])
    found = arranged(np.concatenate((ring_edges(SQUARE), ring_edges(beside))), TOLERANCE_M)
    assert (len(found.vertices_m), len(found.segments)) == (6, 7)


def test_a_corner_beside_an_edge_is_on_it() -> None:
    beside = np.array([[10.004, 3.0], [15.0, 3.0], [15.0, 7.0], [9.997, 7.0]])
    found = arranged(np.concatenate((ring_edges(SQUARE), ring_edges(beside))), TOLERANCE_M)
    assert (len(found.vertices_m), len(found.segments)) == (8, 9)
    assert [(10.0, 0.0), (10.004, 3.0)] in lines(found)
    assert [(9.997, 7.0), (10.004, 3.0)] in lines(found)


@tried(60)
@given(st.integers(0, 10**6), st.integers(2, 8), st.sampled_from([1.0, 0.05]))
def test_whatever_is_drawn_segments_meet_at_vertices_only_and_stay_where_they_were(
    seed: int, count: int, grid_m: float
) -> None:
    chance = np.random.default_rng(seed)
    rings = [
        np.round(chance.uniform(0.0, 20.0, size=(int(chance.integers(3, 7)), 2)) / grid_m) * grid_m
        + chance.normal(scale=0.003, size=2)
        for _ in range(count)
    ]
    edges = np.concatenate([ring_edges(ring) for ring in rings])
    edges = edges[np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1) > 0.0]
    found = arranged(edges, TOLERANCE_M)
    assert not len(cKDTree(found.vertices_m).query_pairs(TOLERANCE_M))
    pieces = found.vertices_m[found.segments]
    assert not len(edge_crossings(pieces, TOLERANCE_M)[0])
    drawn, kept = shapely.MultiLineString(list(edges)), shapely.MultiLineString(list(pieces))
    assert shapely.hausdorff_distance(drawn, kept, densify=0.1) < 5.0 * TOLERANCE_M
