"""Point location and segment walks against brute force over all triangles."""

import itertools

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from mission.geometry.arrangement import arranged
from mission.geometry.arrays import FloatArray
from mission.geometry.location import Locator
from mission.geometry.refinement import refined
from mission.geometry.rings import ring_edges
from mission.geometry.simplices import Partition
from mission.geometry.triangulation import triangulate_nodes
from tests.support.domains import PAPER_NODES, random_nodes
from tests.support.drawn_cases import tried

seeds = st.integers(0, 10_000)
PAPER = Locator(triangulate_nodes(PAPER_NODES))
GRID = Locator(triangulate_nodes(np.array([(float(x), float(y)) for x in range(6) for y in range(6)])))
lattice = st.tuples(st.integers(-2, 12), st.integers(-2, 12)).map(lambda p: (p[0] / 2, p[1] / 2))


def shares(partition: Partition, point: tuple[float, float]) -> FloatArray:
    """Smallest barycentric coordinate of a point in each triangle."""
    smallest: FloatArray = partition.barycentric(np.arange(partition.size), np.tile(point, (partition.size, 1))).min(
        axis=1
    )
    return smallest


@given(seeds, st.integers(4, 60))
@tried(40)
def test_location_agrees_with_brute_force(seed: int, count: int) -> None:
    partition = triangulate_nodes(random_nodes(seed, count))
    points = np.random.default_rng(seed + 1).uniform((-20.0, -20.0), (170.0, 120.0), (50, 2))
    found = Locator(partition).triangle_at(points)
    for point, triangle in zip(points, found, strict=True):
        inside = shares(partition, tuple(point))
        assert triangle == (int(np.argmax(inside)) if inside.max() >= 0 else -1)


@given(seeds, st.integers(4, 40))
@tried(40)
def test_vertices_and_points_on_edges_belong_to_the_lowest_index(seed: int, count: int) -> None:
    partition = triangulate_nodes(random_nodes(seed, count))
    locator = Locator(partition)
    at_vertices = locator.triangle_at(partition.vertices_m)
    for vertex, triangle in enumerate(at_vertices):
        assert triangle == np.flatnonzero((partition.triangles == vertex).any(axis=1))[0]
    middles = (partition.corners_m + np.roll(partition.corners_m, 1, axis=1)) / 2
    assert (locator.triangle_at(middles.reshape(-1, 2)) >= 0).all()


@given(lattice)
@tried(100)
def test_points_of_a_lattice_belong_to_the_lowest_index(point: tuple[float, float]) -> None:
    inside = np.flatnonzero(shares(GRID.partition, point) >= 0)
    assert GRID.triangle_at(np.array([point]))[0] == (inside[0] if len(inside) else -1)
    assert GRID.triangles_touching(point).tolist() == inside.tolist()


def test_points_outside_and_not_finite() -> None:
    points = np.array([(-1.0, 5.0), (np.nan, 5.0), (5.0, np.inf), (0.0, 0.0), (-1e-12, 5.0), (11.0, 9.5)])
    assert PAPER.triangle_at(points).tolist() == [-1, -1, -1, 1, 1, 0]
    assert PAPER.triangle_at(np.empty((0, 2))).tolist() == []


def test_paper_path_crosses_the_papers_triangles() -> None:
    walk = PAPER.crossed((11.0, 9.5), (11.0, 4.5))
    assert [triangle for triangle, _ in walk] == [0, 8]
    assert walk[0][1] == 0.0
    assert walk[1][1] == pytest.approx(17 / 70)  # the facet from (8, 7) to (15, 10)


def test_walks_leave_the_domain_and_come_back() -> None:
    bent = np.array([(0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (2.0, 1.0), (2.0, 0.5), (1.0, 0.5), (1.0, 1.0), (0.0, 1.0)])
    locator = Locator(refined(arranged(ring_edges(bent), 1e-6), shapely.Polygon(bent)).partition)
    walk = locator.crossed((-1.0, 0.75), (4.0, 0.75))
    outside = [fraction for triangle, fraction in walk if triangle < 0]
    assert outside == pytest.approx([0.0, 0.4, 0.8])
    assert walk[0][0] == walk[-1][0] == -1
    assert locator.crossed((-1.0, 2.0), (4.0, 2.0)) == ((-1, 0.0),)
    assert locator.crossed((5.0, 5.0), (5.0, 5.0)) == ((-1, 0.0),)


def test_walks_through_a_corner_skip_what_is_only_touched() -> None:
    # (2, 2) is a corner of several triangles of the grid; its diagonal neighbours are all that is entered.
    walk = GRID.crossed((1.25, 1.5), (2.75, 2.5))
    for (triangle, entry), leave in zip(walk, [*(f for _, f in walk[1:]), 1.0], strict=True):
        assert leave > entry
        middle = np.array((1.25, 1.5)) + (entry + leave) / 2 * np.array((1.5, 1.0))
        assert triangle == GRID.triangle_at(middle[None])[0]


def test_walks_along_edges_take_the_lower_index() -> None:
    walk = GRID.crossed((1.0, 2.0), (4.0, 2.0))
    assert [fraction for _, fraction in walk] == pytest.approx([0.0, 1 / 3, 2 / 3])
    for triangle, fraction in walk:
        beside = np.flatnonzero(shares(GRID.partition, (1.5 + 3 * fraction, 2.0)) >= 0)
        assert len(beside) == 2
        assert triangle == beside[0]


@given(lattice, lattice, st.integers(-1, GRID.partition.size - 1))
@tried(150)
def test_a_walk_does_not_depend_on_the_triangle_that_is_looked_into_first(
    p: tuple[float, float], q: tuple[float, float], likely: int
) -> None:
    assert GRID.crossed(p, q, likely=likely) == GRID.crossed(p, q)
    middle = ((p[0] + q[0]) / 2, (p[1] + q[1]) / 2)
    (here, _), *_ = GRID.crossed(middle, middle)
    nearby = (middle[0] + 1e-3, middle[1] + 2e-3)
    assert GRID.crossed(middle, nearby, likely=here) == GRID.crossed(middle, nearby)


@given(lattice, lattice)
@tried(150)
def test_each_part_of_a_walk_lies_where_it_says(p: tuple[float, float], q: tuple[float, float]) -> None:
    walk = GRID.crossed(p, q)
    entries = [fraction for _, fraction in walk]
    assert entries[0] == 0.0
    assert entries == sorted(set(entries))
    assert all(a != b for (a, _), (b, _) in itertools.pairwise(walk))
    for (triangle, entry), leave in zip(walk, [*entries[1:], 1.0], strict=True):
        middle = np.array(p) + (entry + leave) / 2 * (np.array(q) - np.array(p))
        inside = shares(GRID.partition, tuple(middle))
        assert inside[triangle] >= -1e-12 if triangle >= 0 else inside.max() < 0


@given(seeds)
@tried(40)
def test_walks_there_and_back_are_mirrored(seed: int) -> None:
    locator = Locator(triangulate_nodes(random_nodes(seed, 30)))
    p, q = (tuple(float(x) for x in row) for row in random_nodes(seed + 7, 2))
    there, back = locator.crossed((p[0], p[1]), (q[0], q[1])), locator.crossed((q[0], q[1]), (p[0], p[1]))
    assert [t for t, _ in there] == [t for t, _ in reversed(back)]
    assert [f for _, f in there][1:] == pytest.approx([1 - f for _, f in reversed(back)][:-1])


@given(seeds)
@tried(10)
def test_segments_straight_over_a_facet_meet_these_two_triangles_alone(seed: int) -> None:
    locator, rng = Locator(triangulate_nodes(random_nodes(seed, 30))), np.random.default_rng(seed)
    p = rng.uniform((-5.0, -5.0), (155.0, 105.0), (60, 2))
    q = p + rng.uniform(-12.0, 12.0, p.shape)
    here, there = locator.triangle_at(p), locator.triangle_at(q)
    over = locator.straight_over(here, there, p, q)
    walks = [locator.crossed((a[0], a[1]), (b[0], b[1])) for a, b in zip(p.tolist(), q.tolist(), strict=True)]
    straight = [
        tuple(t for t, _ in walk) == (a, b) and -1 not in (a, b) for walk, a, b in zip(walks, here, there, strict=True)
    ]
    assert over.tolist() == straight  # in general position


def test_segments_along_a_facet_or_through_a_corner_are_not_seen_to_go_straight_over() -> None:
    p = np.array([[1.25, 1.5], [1.0, 2.0], [0.2, 0.2], [0.5, 0.5], [-0.5, 0.25]])
    q = np.array([[2.75, 2.5], [4.0, 2.0], [0.2, 0.2], [0.5, 0.5], [0.25, 0.25]])
    assert not GRID.straight_over(GRID.triangle_at(p), GRID.triangle_at(q), p, q).any()


def test_a_hundred_thousand_triangles_are_no_trouble() -> None:
    partition = triangulate_nodes(np.random.default_rng(3).uniform(0.0, 1000.0, (50_000, 2)))
    points = np.random.default_rng(4).uniform(0.0, 1000.0, (100_000, 2))
    locator = Locator(partition)
    found = locator.triangle_at(points)
    held = found >= 0
    assert held.mean() > 0.99
    assert partition.barycentric(found[held], points[held]).min() >= -1e-9
