"""Labels, and what makes a ring of corners a simple polygon."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from mission.geometry.regions import label_triangles
from mission.geometry.rings import edge_crossings, ring_area_m2, ring_edges, ring_fault, ring_faults
from tests.support.drawn_cases import tried


def test_letters_are_the_observations_that_occur() -> None:
    members = {"A": np.array([True, False, True, False]), "B": np.array([True, False, False, False])}
    labelling = label_triangles(4, members)
    assert labelling.letters == (frozenset(), frozenset({"A"}), frozenset({"A", "B"}))
    assert labelling.letter_of.tolist() == [2, 0, 1, 0]
    assert labelling.label(0) == {"A", "B"}
    assert labelling.triangles_of("A").tolist() == [0, 2]
    assert labelling.triangles_of("C").tolist() == []
    assert label_triangles(2, {}).letters == (frozenset(),)


RINGS = (
    ([(0, 0), (4, 0), (4, 4), (0, 4)], ""),
    ([(0, 4), (4, 4), (4, 0), (0, 0)], ""),
    ([(0, 0), (4, 4), (4, 0), (0, 4)], "edges 0-1 and 2-3 cross at (2, 2)"),
    ([(0, 0), (4, 0), (4, 0), (0, 4)], "corners 1 and 2 are the same point"),
    ([(0, 0), (4, 0), (0, 4), (0, 0)], "corners 3 and 0 are the same point"),
    ([(0, 0), (4, 0), (8, 0)], "one line"),
    ([(0, 0), (4, 0), (4, 4), (2, 0)], "touches itself"),
    ([(0, 0), (4, 0), (0, 0)], "corners 2 and 0 are the same point"),
)


@pytest.mark.parametrize(("ring", "words"), RINGS)
def test_ring_faults_are_named(ring: list[tuple[float, float]], words: str) -> None:
    found = ring_fault(np.array(ring, dtype=np.float64), 1e-9)
    assert (words in found) if words else not found


def test_many_rings_are_judged_one_by_one() -> None:
    rings = [np.array(ring, dtype=np.float64) for ring, _ in RINGS]
    assert ring_faults(rings, 1e-9) == [ring_fault(ring, 1e-9) for ring in rings]
    assert ring_faults([], 1e-9) == []


@given(st.integers(0, 10_000), st.integers(3, 9))
@tried(100)
def test_random_rings_are_judged_as_by_shapely(seed: int, corners: int) -> None:
    ring = np.random.default_rng(seed).uniform(0.0, 10.0, (corners, 2))
    assert (ring_fault(ring, 1e-9) == "") == shapely.is_valid(shapely.Polygon(ring))
    if not ring_fault(ring, 1e-9):
        assert abs(ring_area_m2(ring)) == pytest.approx(shapely.Polygon(ring).area)
        assert (ring_area_m2(ring) > 0) == shapely.is_ccw(shapely.LinearRing(ring))


def test_edges_that_touch_do_not_cross() -> None:
    a = ring_edges(np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)]))
    sharing = ring_edges(np.array([(2.0, 0.0), (4.0, 0.0), (4.0, 2.0), (2.0, 1.0)]))
    over = ring_edges(np.array([(1.0, 1.0), (3.0, 1.0), (3.0, 3.0), (1.0, 3.0)]))
    assert not len(edge_crossings(np.concatenate((a, sharing)), 1e-9)[0])
    pairs, points = edge_crossings(np.concatenate((a, over)), 1e-9)
    assert pairs.tolist() == [[1, 4], [2, 7]]
    assert points.tolist() == [[2.0, 1.0], [1.0, 2.0]]
