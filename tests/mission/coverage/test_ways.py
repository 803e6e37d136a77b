"""Shortest ways, beside those of a graph in which everything sees everything."""

import heapq

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from mission.coverage.ways import Network

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


@settings(max_examples=12)
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
    ways = Network(area, SLACK_M).ways(points, np.ones((len(points), len(points)), dtype=np.bool_))
    np.testing.assert_allclose(ways.lengths_m[0], lengths_by_hand(area, points), rtol=1e-6)
    np.testing.assert_allclose(ways.lengths_m, ways.lengths_m.T)
    for end in np.flatnonzero(np.isfinite(ways.lengths_m[0, 1:])) + 1:
        line = ways.line_m(0, int(end))
        assert line[0].tolist() == points[0].tolist()
        assert line[-1].tolist() == points[end].tolist()
        assert np.linalg.norm(np.diff(line, axis=0), axis=1).sum() == pytest.approx(ways.lengths_m[0, end], abs=1e-6)
        assert area.buffer(2.0 * SLACK_M).covers(shapely.LineString(line))


def test_a_way_leaves_towards_its_first_bend() -> None:
    area = shapely.box(0.0, 0.0, 30.0, 30.0).difference(shapely.box(10.0, 0.0, 20.0, 20.0))
    ways = Network(area, SLACK_M).ways(np.array([[0.0, 20.0], [30.0, 20.0], [5.0, 25.0]]), ~np.eye(3, dtype=np.bool_))
    assert ways.lengths_m[0, 1] == pytest.approx(30.0)
    np.testing.assert_allclose(ways.leaving[0, 1], [1.0, 0.0])
    np.testing.assert_allclose(ways.leaving[1, 0], [-1.0, 0.0])
    np.testing.assert_allclose(ways.leaving[2, 0], [-np.sqrt(0.5), -np.sqrt(0.5)])


def test_parts_that_do_not_meet_have_no_way() -> None:
    area = shapely.MultiPolygon([shapely.box(0.0, 0.0, 10.0, 10.0), shapely.box(20.0, 0.0, 30.0, 10.0)])
    ways = Network(area, SLACK_M).ways(np.array([[1.0, 1.0], [21.0, 1.0]]), ~np.eye(2, dtype=np.bool_))
    assert np.isinf(ways.lengths_m[0, 1])
