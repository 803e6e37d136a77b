"""Crossing points against plain geometry, and runs along ways against the letters that they read."""

from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from mission.geometry.arrays import IntArray
from mission.geometry.location import Locator
from mission.geometry.outline_mesh import Outlines
from mission.geometry.triangulation import triangulate_nodes
from mission.planning.crossings import Crossings, Spacing, crossings
from mission.planning.traced import Tracer, stretches
from tests.support.domains import random_nodes
from tests.support.drawn_cases import tried

LETTERS = (frozenset[str](), frozenset({"a"}), frozenset({"b"}))
TOLL = 7


def random_crossings(seed: int, most: int, letters: int = 3) -> tuple[Crossings, Locator, IntArray, int]:
    """Crossing points of a mesh with random letters, and the triangle in which ways begin."""
    rng = np.random.default_rng(seed)
    partition = triangulate_nodes(random_nodes(seed, 14))
    letter_of = rng.integers(0, letters, partition.size)
    first = int(rng.integers(partition.size))
    x, y = partition.incentres_m[first].tolist()
    found = crossings(
        partition,
        letter_of,
        LETTERS,
        beginnings=np.array([first]),
        start_m=(x, y),
        spacing=Spacing(10.0, min(1, most), most),
        unit_m=1e-3,
        tolls=np.full((3, 3), TOLL),
    )
    return found, Locator(partition), letter_of, first


@tried(20)
@given(seed=st.integers(0, 2**32 - 1), most=st.integers(0, 3))
def test_ways_go_straight_through_one_triangle_or_over_an_edge_between_two_letters(seed: int, most: int) -> None:
    found, locator, letter_of, _ = random_crossings(seed, most)
    system, triangles = found.system, shapely.buffer(shapely.polygons(locator.partition.corners_m), 1e-6)
    before, controls = np.nonzero(system.successors[:, 1:] >= 0)
    after, weights = system.successors[before, controls + 1], system.weights[before, controls + 1]
    pieces = np.stack((found.points_m[before], found.points_m[after]), axis=1)
    lengths = np.linalg.norm(pieces[:, 0] - pieces[:, 1], axis=1)
    changes = system.letter_of[before] != system.letter_of[after]
    assert (lengths[changes] == 0.0).all()
    assert (weights[changes] == TOLL).all()
    assert np.array_equal(weights[~changes], np.maximum(1, np.rint(lengths[~changes] * 1e3)))
    piece, triangle = shapely.STRtree(triangles).query(shapely.linestrings(pieces), predicate="covered_by")
    within = np.unique(piece[letter_of[triangle] == system.letter_of[before[piece]]])
    assert set(np.flatnonzero(~changes).tolist()) <= set(within.tolist())
    assert (np.diff(found.points_m[:, 0]) >= 0.0).all()


@pytest.mark.parametrize(("most", "share"), [(1, 1.08), (3, 1.05), (5, 1.015)])
def test_where_nothing_is_in_the_way_ways_are_hardly_longer_than_straight_ones(most: int, share: float) -> None:
    corners = np.array([[0.0, 0.0], [100.0, 0.0], [80.0, 60.0], [0.0, 60.0]])
    square = Locator(triangulate_nodes(corners))
    mesh = Outlines.of(square, np.zeros(2, dtype=np.int64), np.zeros(2, dtype=np.bool_)).mesh(0.0, largest_share=0.1)
    first = Locator(mesh.partition).triangles_touching((20.0, 10.0))
    spacing, tolls = Spacing(1.5, 1, most), np.ones((1, 1), dtype=np.int64)
    found = crossings(
        mesh.partition,
        mesh.class_of,
        LETTERS[:1],
        beginnings=first,
        start_m=(20.0, 10.0),
        spacing=spacing,
        unit_m=1e-3,
        tolls=tolls,
    )
    system = found.system
    rows, controls = np.nonzero(system.successors[:, 1:] >= 0)
    weights = system.weights[rows, controls + 1].astype(np.float64)
    ends = rows.astype(np.int32), system.successors[rows, controls + 1].astype(np.int32)
    graph = csr_array((weights, ends), shape=(system.size, system.size))
    (lengths,) = dijkstra(graph, indices=np.array([found.start])) * 1e-3
    every = np.linalg.norm(found.points_m - found.points_m[found.start], axis=1)
    far = every > 20.0
    straight, lengths = every[far], lengths[far]
    assert (lengths >= straight - 0.02).all()
    assert (lengths <= share * straight + 0.02).all()


@tried(30)
@given(seed=st.integers(0, 2**32 - 1))
def test_a_run_along_a_way_reads_its_letters(seed: int) -> None:
    found, locator, letter_of, first = random_crossings(seed, 2)
    partition, rng = locator.partition, np.random.default_rng(seed)
    states = [found.start]
    for _ in range(12):
        onward = found.system.successors[states[-1]]
        states.append(int(rng.choice(onward[onward >= 0])))
    way = stretches(found.system.letter_of[states], found.points_m[states])
    assert all(stretch.letter != after.letter for stretch, after in pairwise(way))
    anywhere = np.ones(partition.size, dtype=np.bool_)
    tracer = Tracer(partition, locator.tree, letter_of, anywhere, np.ones((partition.size, 3)), near_m=1e-6)
    chain = tracer.chain(way, first)
    assert chain is not None
    assert chain[0] == first
    assert all(after in partition.neighbours[before] for before, after in pairwise(chain))
    letters = letter_of[list(chain)]
    assert letters[np.append(True, np.diff(letters) != 0)].tolist() == [stretch.letter for stretch in way]
    line = shapely.LineString(found.points_m[states])
    assert shapely.distance(shapely.polygons(partition.corners_m[list(chain)]), line).max() < 1e-6
