"""Narrow gaps between outlines: which one asks most of a mesh, and for how many vertices."""

import numpy as np
import pytest
import shapely

from mission.geometry.arrangement import Arrangement, arranged
from mission.geometry.gaps import narrowest_gap
from mission.geometry.refinement import refined
from mission.geometry.rings import ring_edges

AREA = np.array([[0.0, 0.0], [300.0, 0.0], [300.0, 200.0], [0.0, 200.0]])
SQUARE = np.array([[0.0, 0.0], [50.0, 0.0], [50.0, 50.0], [0.0, 50.0]])
AWAY = np.array([40.0, 20.0])


def drawn(*rings: np.ndarray) -> tuple[Arrangement, shapely.Geometry]:
    """The arrangement of an area and rings in it, and the area."""
    return arranged(np.concatenate([ring_edges(ring) for ring in (AREA, *rings)]), 0.01), shapely.Polygon(AREA)


def square_at(x: float, y: float) -> np.ndarray:
    found: np.ndarray = SQUARE + np.array([x, y])
    return found


def turned(ring: np.ndarray, angle: float) -> np.ndarray:
    found: np.ndarray = ring @ np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return found


@pytest.mark.parametrize("angle", [0.0, 0.4])
def test_the_narrowest_of_the_gaps_between_squares_is_found(angle: float) -> None:
    row = [turned(square_at(x, 10.0), angle) + AWAY for x in (0.0, 50.3, 100.5)]
    arrangement, area = drawn(*row)
    gap = narrowest_gap(arrangement, area, 20.0)
    assert gap is not None
    assert gap.width_m == pytest.approx(0.2)
    x, y = turned(gap.middle_m - AWAY, -angle)
    assert x == pytest.approx(100.4)
    assert 10.0 < y < 60.0
    # Two sides of 50 m at 0.3 m and two at 0.2 m: at least half a vertex for each width, and no more than are needed.
    assert gap.vertices == pytest.approx(0.5 * (2 * 50.0 / 0.3 + 2 * 50.0 / 0.2), rel=0.05)
    needed = len(refined(arrangement, area).partition.vertices_m)
    assert gap.vertices < needed < 3 * gap.vertices


def test_wide_gaps_and_corners_that_point_at_an_edge_are_none() -> None:
    diamond = turned(SQUARE, np.pi / 4.0)
    corner = diamond - diamond[3] + np.array([0.02, 100.0])
    assert narrowest_gap(*drawn(square_at(10.0, 10.0), square_at(70.0, 10.0), corner), 20.0) is None


def test_a_gap_outside_the_area_takes_no_triangles() -> None:
    arrangement, area = drawn(square_at(10.0, 10.0), square_at(60.1, 10.0))
    assert narrowest_gap(arrangement, area, 20.0) is not None
    slot = shapely.box(60.0, 10.0, 60.1, 60.0)
    assert narrowest_gap(arrangement, area - slot, 20.0) is None
