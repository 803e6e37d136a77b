"""Passages that a mesh as coarse as the outlines allow leaves one triangle wide are planned and proved all the same.

What is flown is a curve in the free width about a taut path, which does not follow the triangles' middles. So no finer
mesh is needed where the tube fills a passage; ``tests/bench/test_bench_passages.py`` has the rates.
"""

import numpy as np
import pytest
import shapely

from mission.plan import plan_mission
from mission.spec.loader import parse_mission
from tests.support.passages import TUBE_M, passage

WIDTH_M = 1.2  # the tube takes 1 m of it
MIDDLE_M, REACH_M = np.array([60.0, 40.0]), 37.0  # of the passage, and as far as it has two walls


@pytest.mark.parametrize("seed", range(3))
def test_a_passage_little_wider_than_the_tube_is_flown_through_triangles_that_reach_across(seed: int) -> None:
    plan = plan_mission(parse_mission(passage(seed, WIDTH_M)))
    assert plan.certificate.holds
    assert plan.certificate.tube_m == pytest.approx(TUBE_M)
    # Hardly a vertex of the mesh lies between the walls.
    corners = plan.partition.corners_m
    walls = shapely.union_all(shapely.polygons(corners[plan.restricted]))
    vertices = plan.partition.vertices_m
    between = vertices[(np.abs(vertices - MIDDLE_M) < REACH_M).all(axis=1)]
    assert (shapely.distance(walls, shapely.points(between)) < 1e-6).mean() > 0.95
