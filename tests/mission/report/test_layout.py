"""Geometry of the drawings: boxes in triangles, places of names, layers of automata, shortened guards."""

import itertools

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from mission.logic.automata.guards import Guard
from mission.report.figures.arrows import between_discs, bowed
from mission.report.figures.fitting import largest_boxes, place_names, towards_incentres
from mission.report.figures.guard_text import keyed, shortened, written
from mission.report.figures.layering import APART_PT, layered
from tests.support.drawn_cases import tried

coordinate = st.floats(-10, 10)


def a_triangle(points: list[tuple[float, float]]) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]] | None:
    corners = np.array(points)
    (ax, ay), (bx, by), (cx, cy) = points
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    if abs(area) < 0.5:
        return None
    return corners if area > 0 else corners[::-1]


@tried(80)
@given(st.lists(st.tuples(coordinate, coordinate), min_size=3, max_size=3), st.floats(0.2, 4), st.floats(0.2, 4))
def test_no_box_of_the_same_shape_in_a_triangle_is_larger(
    points: list[tuple[float, float]], width: float, height: float
) -> None:
    corners = a_triangle(points)
    if corners is None:
        return
    size = np.array([[width, height]])
    centres, scales = largest_boxes(corners[None], size)
    triangle = shapely.Polygon(corners)

    def box(x: float, y: float, scale: float) -> shapely.Polygon:
        half = 0.5 * scale * size[0]
        return shapely.box(x - half[0], y - half[1], x + half[0], y + half[1])

    (x, y), scale = centres[0], float(scales[0])
    assert triangle.buffer(1e-7).contains(box(x, y, scale))
    west, south, east, north = triangle.bounds
    rng = np.random.default_rng(0)
    for other_x, other_y in rng.uniform((west, south), (east, north), (60, 2)):
        assert not triangle.contains(box(other_x, other_y, 1.001 * scale))
    moved = towards_incentres(corners[None], centres, 0.5 * scale * size)[0]
    assert triangle.buffer(1e-7).contains(box(float(moved[0]), float(moved[1]), 0.5 * scale))


def test_a_name_stands_inside_its_shape_off_what_is_in_the_way() -> None:
    shape = shapely.box(0, 0, 10, 4)
    way = shapely.LineString([(0, 2), (10, 2)]).buffer(0.2)
    frame = shapely.box(-50, -50, 50, 50)
    (free,) = place_names([("S1", shape, (1.3, 1.2))], em_m=0.1, sizes_pt=(12, 8), obstacles=[], frame=frame)
    assert (free.x_m, free.y_m) == pytest.approx((5, 2), abs=1)
    assert free.leader_m is None
    (moved,) = place_names([("S1", shape, (1.3, 1.2))], em_m=0.1, sizes_pt=(12, 8), obstacles=[way], frame=frame)
    assert shape.contains(moved.box(0.1))
    assert not way.intersects(moved.box(0.1))


def test_a_name_without_room_stands_beside_its_shape_with_a_leader_into_it() -> None:
    shape, other = shapely.box(0, 0, 1, 1), shapely.box(1.5, -3, 9, 4)
    names = [("long_name", shape, (6.0, 1.2)), ("b", other, (1.0, 1.2))]
    frame = shapely.box(-50, -50, 50, 50)
    beside, _ = place_names(names, em_m=0.1, sizes_pt=(10, 8), obstacles=[], frame=frame)
    assert beside.leader_m is not None
    assert shape.contains(shapely.Point(beside.leader_m))
    assert not beside.box(0.1).intersects(shapely.union(shape, other))
    assert place_names(names[:1], em_m=0.1, sizes_pt=(10, 8), obstacles=[], frame=None) == ()


def test_an_arrow_ends_on_the_rims_of_its_discs() -> None:
    start, end = np.array([0.0, 0.0]), np.array([10.0, 5.0])
    arrow = between_discs(bowed(start, end, 0.2), 1.5, 2.5)
    assert np.hypot(*(arrow[0] - start)) == pytest.approx(1.5)
    assert np.hypot(*(arrow[-1] - end)) == pytest.approx(2.5)
    assert len(between_discs(bowed(start, end, 0.1), 20.0, 20.0)) == 0


@tried(60)
@given(st.integers(2, 12), st.lists(st.tuples(st.integers(0, 11), st.integers(0, 11)), max_size=30), st.integers(0, 99))
def test_layers_keep_apart_what_stands_in_them_and_lead_each_edge_from_end_to_end(
    size: int, edges: list[tuple[int, int]], seed: int
) -> None:
    edges = [(a % size, b % size) for a, b in edges if a % size != b % size]
    rng = np.random.default_rng(seed)
    extents = [(float(up), float(down)) for up, down in rng.uniform(10.0, 60.0, (size, 2))]
    heights = rng.uniform(5.0, 30.0, len(edges)).tolist()
    layers = layered(extents, [0], edges, heights)
    assert layers == layered(extents, [0], edges, heights)
    assert all(level % 2 == 0 for level in layers.layer)
    standing = [(level, y - up, y + down) for level, y, (up, down) in zip(layers.layer, layers.y, extents, strict=True)]
    for (source, target), way, label, height in zip(edges, layers.ways, layers.labels, heights, strict=True):
        assert way[0] == (layers.layer[source], layers.y[source])
        assert way[-1] == (layers.layer[target], layers.y[target])
        assert all(abs(b[0] - a[0]) == 1 for a, b in itertools.pairwise(way))
        assert way[label][0] % 2 == 1
        reach = [0.5 * height if k == label else 0.0 for k in range(len(way))]
        standing += [(level, y - r, y + r) for (level, y), r in zip(way[1:-1], reach[1:-1], strict=True)]
    for (level, _, bottom), (below, top, _) in itertools.pairwise(sorted(standing)):
        assert level != below or top - bottom >= APART_PT - 1e-6
    if all(a < b for a, b in edges):
        assert all(layers.layer[a] < layers.layer[b] for a, b in edges)


PROPOSITIONS = ("a", "b", "c", "d")


@tried(100)
@given(
    st.lists(st.tuples(st.integers(0, 15), st.integers(0, 15)), min_size=1, max_size=4),
    st.sets(st.frozensets(st.sampled_from(PROPOSITIONS)), min_size=1, max_size=8),
)
def test_a_shortened_guard_allows_the_same_letters(cubes: list[tuple[int, int]], letters: set[frozenset[str]]) -> None:
    guard = Guard(PROPOSITIONS, tuple((holds, fails & ~holds) for holds, fails in cubes))
    alphabet = sorted(letters, key=sorted)
    shorter = shortened(guard, alphabet)
    assert [shorter.allows(letter) for letter in alphabet] == [guard.allows(letter) for letter in alphabet]
    literals = [sum((holds | fails).bit_count() for holds, fails in one.cubes) for one in (shorter, guard)]
    assert literals[0] <= literals[1]


def test_guards_are_cut_where_regions_are_apart() -> None:
    apart = [frozenset[str](), frozenset("a"), frozenset("b"), frozenset("c")]
    assert str(shortened(Guard(PROPOSITIONS, ((0b0001, 0b1110),)), apart)) == "a"
    assert written(Guard(("S1", "K1"), ((0b01, 0b10),))) == "S1 ∧ ¬K1"
    names, key = keyed([Guard(PROPOSITIONS, ((0b0001, 0b1110),)), Guard(PROPOSITIONS, ((0b0001, 0),))])
    assert names == ["g1", "a"]
    assert key == ["g1:  a ∧ ¬b ∧ ¬c ∧ ¬d"]
