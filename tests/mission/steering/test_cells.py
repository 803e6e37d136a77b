"""Convex cells round stretches: against shapely, on random areas with obstacles."""

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from mission.steering.cells import Cell, borders_of, cell_round


def random_area(rng: np.random.Generator) -> shapely.Geometry:
    """A square of 100 m without up to eight triangles and rectangles."""
    area = shapely.box(0.0, 0.0, 100.0, 100.0)
    for _ in range(int(rng.integers(1, 9))):
        centre, size = rng.uniform(5.0, 95.0, 2), rng.uniform(2.0, 25.0)
        if rng.random() < 0.5:
            shape = shapely.Polygon(centre + rng.uniform(-size, size, (3, 2)))
        else:
            shape = shapely.box(*(centre - size / 2), *(centre + size / 2 * rng.uniform(0.2, 1.0, 2)))
        area = area.difference(shape)
    return area


def as_polygon(cell: Cell, half_m: float) -> shapely.Polygon:
    """What of a large square lies in all half planes of a cell, cut one by one."""
    shape = shapely.box(-half_m, -half_m, half_m, half_m)
    for normal, offset in zip(cell.normals, cell.offsets_m, strict=True):
        side = np.array([-normal[1], normal[0]])
        foot = normal * offset
        far = 10.0 * half_m
        corners = [foot - far * side, foot + far * side, foot + far * (side - normal), foot - far * (side + normal)]
        shape = shape.intersection(shapely.Polygon(corners))
    return shape


@given(st.integers(0, 100_000))
def test_a_cell_holds_its_stretch_and_nothing_that_is_not_free(seed: int) -> None:
    rng = np.random.default_rng(seed)
    area = random_area(rng)
    begin, end = rng.uniform(0.0, 100.0, (2, 2))
    stretch = shapely.LineString([begin, end])
    assume(stretch.within(area))
    cell = cell_round(begin, end, borders_of(area), 30.0)
    assert cell.holds(np.array([begin, end]), 1e-6).all()
    shape = as_polygon(cell, 300.0)
    assert shape.difference(area).area <= 1e-6 * max(1.0, shape.area)
    # It is no smaller than it must be: at least as wide as the nearest border is far, up to its reach.
    room = min(30.0, float(area.boundary.distance(stretch)))
    assert shape.area >= 0.99 * room * (stretch.length + room)


def test_the_cells_at_a_bend_have_room_in_common() -> None:
    area = shapely.box(0.0, 0.0, 100.0, 60.0).difference(shapely.Polygon([(48.0, 0.0), (52.0, 0.0), (50.0, 30.0)]))
    before, corner, after = np.array([10.0, 5.0]), np.array([50.0, 30.0]), np.array([90.0, 5.0])
    borders = borders_of(area)
    bend = cell_round(corner, corner, borders, 20.0, across=np.array([0.0, -1.0]))
    shapes = [as_polygon(cell_round(a, b, borders, 20.0), 300.0) for a, b in ((before, corner), (corner, after))]
    above = as_polygon(bend, 300.0)
    assert above.difference(area).area <= 1e-6
    assert all(shape.intersection(above).area > 100.0 for shape in shapes)


def test_along_a_wall_the_cell_is_on_the_side_that_is_free() -> None:
    area = shapely.box(0.0, 0.0, 50.0, 20.0)
    cell = cell_round(np.array([5.0, 0.0]), np.array([45.0, 0.0]), borders_of(area), 10.0)
    assert cell.holds(np.array([[25.0, 5.0]])).all()
    assert not cell.holds(np.array([[25.0, -0.1]])).any()


def test_borders_have_the_area_on_their_left() -> None:
    area = shapely.box(0.0, 0.0, 4.0, 4.0).difference(shapely.box(1.0, 1.0, 2.0, 2.0))
    edges = borders_of(area)
    along = edges[:, 1] - edges[:, 0]
    left = edges.mean(axis=1) + 1e-3 * np.stack((-along[:, 1], along[:, 0]), axis=1)
    assert shapely.contains(area, shapely.points(left)).all()
    assert np.hypot(along[:, 0], along[:, 1]).sum() == pytest.approx(area.length)


def test_in_the_corner_of_an_area_both_edges_bound_the_cell() -> None:
    area = shapely.box(44.5, 26.5, 59.5, 41.5)
    corner = np.array([44.5, 26.5])
    cell = cell_round(corner, corner, borders_of(area), 10.0)
    assert as_polygon(cell, 300.0).area == pytest.approx(100.0)
