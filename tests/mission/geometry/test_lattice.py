"""Lattices of equilateral triangles that fill a domain."""

import numpy as np
import pytest
import shapely

from mission.geometry.lattice import lattice

FIELD = shapely.box(3.0, 7.0, 103.0, 87.0)


def test_points_lie_in_the_domain_as_far_apart_as_asked_for_and_leave_no_gap() -> None:
    domain = FIELD - shapely.box(40.0, 30.0, 60.0, 50.0)
    points = lattice(domain, 4.0)
    assert shapely.intersects_xy(domain.buffer(1e-9), *points.T).all()
    apart = np.linalg.norm(points[:, None] - points, axis=-1) + np.where(np.eye(len(points)), np.inf, 0.0)
    assert apart.min(axis=1) == pytest.approx(4.0)
    assert len(points) == pytest.approx(domain.area / (4.0**2 * np.sqrt(0.75)), rel=0.1)


def test_a_long_and_narrow_domain_has_the_points_of_its_area() -> None:
    river = shapely.LineString([(0.0, 0.0), (40_000.0, 40_000.0)]).buffer(50.0)
    points = lattice(river, 40.0)
    assert len(points) == pytest.approx(river.area / (40.0**2 * np.sqrt(0.75)), rel=0.05)


def test_a_domain_between_two_rows_has_points_of_one_or_none() -> None:
    assert len(lattice(shapely.box(0.0, 0.0, 10.0, 1.0), 5.0)) == 3
    assert len(lattice(shapely.box(0.0, 0.0, 1.0, 1.0), 5.0)) == 1


def test_rows_between_islands_are_empty() -> None:
    islands = shapely.MultiPolygon([shapely.box(0.0, 0.0, 10.0, 10.0), shapely.box(0.0, 30.0, 10.0, 40.0)])
    heights = lattice(islands, 2.0)[:, 1]
    assert ((heights <= 10.0) | (heights >= 30.0)).all()
    assert (heights >= 30.0).any()
