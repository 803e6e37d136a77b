"""Shortest ways, beside those of a graph in which everything sees everything."""

import heapq

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from mission.coverage.ways import Network
from tests.support.drawn_cases import tried

SLACK_M = 1e-6


def lengths_by_hand(area: shapely.Geometry, points: np.ndarray) -> np.ndarray:
    """From the first point to all, through a graph of all corners and all pairs that see each other."""
    nodes = np.concatenate((points, shapely.get_coordinates(area)))
    room = shapely.buffer(area, SLACK_M, join_style="mitre")
    found = np.full(len(nodes), np.inf)
    queue, done = [(0.0, 0)], set()
    while queue:
        length, node = heapq.heappop(queue)
        if node in done:
            continue
        done.add(node)
        found[node] = length
        for other, place in enumerate(nodes):
            if other not in done and room.covers(shapely.LineString([nodes[node], place])):
                heapq.heappush(queue, (length + float(np.linalg.norm(place - nodes[node])), other))
    return found[: len(points)]


@tried(12)
@given(st.integers(0, 10**6))
def test_ways_are_the_shortest(seed: int) -> None:
    chance = np.random.default_rng(seed)
    area = shapely.box(0.0, 0.0, 100.0, 100.0)
    for _ in range(3):
        area = area.difference(shapely.Polygon(chance.uniform(10.0, 90.0, 2) + chance.uniform(-25.0, 25.0, (3, 2))))
    points = chance.uniform(0.0, 100.0, (5, 2))
    points = points[shapely.contains_xy(area, *points.T)]
    if len(points) < 2:
        return
    pairs = np.argwhere(np.ones((len(points), len(points)), dtype=np.bool_))
    ways = Network(area, SLACK_M).ways(points, pairs)
    lengths = ways.lengths_m.reshape(len(points), len(points))
    np.testing.assert_allclose(lengths[0], lengths_by_hand(area, points), rtol=1e-6)
    np.testing.assert_allclose(lengths, lengths.T)
    for pair in np.flatnonzero(np.isfinite(ways.lengths_m) & (pairs[:, 0] != pairs[:, 1])):
        line = ways.line_m(int(pair))
        assert line[[0, -1]].tolist() == points[pairs[pair]].tolist()
        assert np.linalg.norm(np.diff(line, axis=0), axis=1).sum() == pytest.approx(ways.lengths_m[pair], abs=1e-6)
        assert area.buffer(2.0 * SLACK_M).covers(shapely.LineString(line))
        for end, step in enumerate((line[1] - line[0], line[-2] - line[-1])):
            np.testing.assert_allclose(ways.outwards[pair, end], step / np.linalg.norm(step), atol=1e-6)


def test_a_way_leaves_towards_its_first_bend() -> None:
    area = shapely.box(0.0, 0.0, 30.0, 30.0).difference(shapely.box(10.0, 0.0, 20.0, 20.0))
    points = np.array([[0.0, 20.0], [30.0, 20.0], [5.0, 25.0], [5.0, 2.0]])
    ways = Network(area, SLACK_M).ways(points, np.array([[0, 1], [0, 2], [1, 3]]))
    np.testing.assert_allclose(ways.lengths_m, [30.0, np.sqrt(50.0), 20.0 + np.hypot(5.0, 18.0)])
    np.testing.assert_allclose(ways.outwards[0], [[1.0, 0.0], [-1.0, 0.0]])
    np.testing.assert_allclose(ways.outwards[1], np.sqrt(0.5) * np.array([[1.0, 1.0], [-1.0, -1.0]]))
    np.testing.assert_allclose(ways.outwards[2, 1], np.array([5.0, 18.0]) / np.hypot(5.0, 18.0))
    assert ways.line_m(2).tolist() == [[30.0, 20.0], [10.0, 20.0], [5.0, 2.0]]


def test_parts_that_do_not_meet_have_no_way() -> None:
    parts = [shapely.box(0.0, 0.0, 10.0, 10.0), shapely.box(20.0, 0.0, 30.0, 10.0)]
    bent = shapely.difference(parts[1], shapely.box(23.0, 0.0, 27.0, 5.0))
    for area in (shapely.MultiPolygon(parts), shapely.MultiPolygon([parts[0], bent])):
        ways = Network(area, SLACK_M).ways(np.array([[1.0, 1.0], [21.0, 1.0]]), np.array([[0, 1]]))
        assert np.isinf(ways.lengths_m[0])


@pytest.mark.parametrize("thin_m", [1e-9, 0.5 * SLACK_M, 1.9 * SLACK_M, 0.1])
def test_no_way_leads_through_what_is_thinner_than_the_tolerance(thin_m: float) -> None:
    """A spike from below that ends at (5, 8) and a sliver that stands by itself are both gone round."""
    spike = shapely.Polygon([(5.0 - 0.5 * thin_m, 0.0), (5.0 + 0.5 * thin_m, 0.0), (5.0, 8.0)])
    sliver = shapely.box(12.0, 1.0, 12.0 + thin_m, 9.0)
    area = shapely.box(0.0, 0.0, 20.0, 10.0).difference(spike).difference(sliver)
    ways = Network(area, SLACK_M).ways(
        np.array([[1.0, 1.0], [9.0, 1.0], [15.0, 5.0]]), np.array([[0, 1], [1, 2], [0, 2]])
    )
    over = 2.0 * np.hypot(4.0, 7.0)
    round_the_sliver = np.hypot(3.0, 8.0) + np.hypot(3.0 - thin_m, 4.0) + thin_m
    below = np.hypot(3.0, 0.0) + np.hypot(3.0 - thin_m, 4.0) + thin_m
    assert ways.lengths_m[0] == pytest.approx(over, abs=2.0 * thin_m + 1e-4)
    assert ways.lengths_m[1] == pytest.approx(min(round_the_sliver, below), abs=1e-4)
