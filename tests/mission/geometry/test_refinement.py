"""Refined meshes: outlines come out, angles are no smaller than asked for, and the domain is covered once."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from mission.errors import GeometryError
from mission.geometry import refinement
from mission.geometry.arrangement import Arrangement, arranged
from mission.geometry.delaunay import Cavities, Growth, Triangulation
from mission.geometry.faces import FacedMesh
from mission.geometry.refinement import refined
from mission.geometry.rings import ring_edges
from mission.geometry.simplices import Partition
from tests.support.drawn_cases import tried

TOLERANCE_M = 0.01
SQUARE = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 100.0], [0.0, 100.0]])


def angles_deg(partition: Partition) -> np.ndarray:
    """Angles at the corners, shape (M, 3)."""
    sides = partition.edge_lengths_m
    other, last = np.roll(sides, -1, axis=1), np.roll(sides, -2, axis=1)
    cosines = (other**2 + last**2 - sides**2) / (2.0 * other * last)
    angles: np.ndarray = np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0)))
    return angles


def drawn(*rings: np.ndarray) -> Arrangement:
    return arranged(np.concatenate([ring_edges(ring) for ring in rings]), TOLERANCE_M)


def assert_sound(found: FacedMesh, arrangement: Arrangement, domain: shapely.Geometry) -> None:
    """The triangles are those of the domain, each once, and no edge of one crosses a segment."""
    partition = found.partition
    assert partition.areas_m2.sum() == pytest.approx(domain.area, rel=1e-6)
    tree = shapely.STRtree(shapely.linestrings(arrangement.vertices_m[arrangement.segments]))
    shrunk = shapely.buffer(shapely.polygons(partition.corners_m), -1e-6 * partition.extent_m)
    assert not len(tree.query(shrunk, predicate="intersects")[0])
    # Each triangle is across the facet from its neighbour.
    rows, sides = np.nonzero(partition.neighbours >= 0)
    beyond = partition.neighbours[rows, sides]
    assert (partition.neighbours[beyond] == rows[:, None]).any(axis=1).all()


def test_a_square_is_two_triangles() -> None:
    found = refined(drawn(SQUARE), shapely.Polygon(SQUARE))
    assert (found.partition.size, len(found.inside_m)) == (2, 1)
    assert found.partition.vertices_m.tolist() == SQUARE.tolist()


def test_a_hole_stays_empty_and_a_region_is_a_face_of_its_own() -> None:
    hole, region = SQUARE * 0.2 + 10.0, SQUARE * 0.3 + 60.0
    domain = shapely.Polygon(SQUARE, [hole])
    arrangement = drawn(SQUARE, hole, region)
    found = refined(arrangement, domain)
    assert_sound(found, arrangement, domain)
    assert len(found.inside_m) == 2
    inside = shapely.contains_xy(shapely.Polygon(region), *found.inside_m.T)
    assert found.partition.areas_m2[inside[found.face_of]].sum() == pytest.approx(900.0)
    assert angles_deg(found.partition).min() >= 20.0


def test_no_edge_is_longer_than_asked_for() -> None:
    found = refined(drawn(SQUARE), shapely.Polygon(SQUARE), largest_m=10.0)
    assert found.partition.edge_lengths_m.max() <= 10.0
    assert found.partition.size < 420  # 231 equilateral ones would do
    assert angles_deg(found.partition).min() >= 20.0


def test_a_larger_least_angle_is_kept() -> None:
    region = np.array([[30.0, 30.0], [60.0, 33.0], [58.0, 36.0], [31.0, 34.0]])
    found = refined(drawn(SQUARE, region), shapely.Polygon(SQUARE), smallest_angle_deg=28.0)
    assert angles_deg(found.partition).min() >= 28.0


@pytest.mark.parametrize("angle_deg", [59.0, 30.0, 10.0, 3.0, 1.0])
def test_an_angle_of_the_outlines_stays_and_nothing_is_sharper(angle_deg: float) -> None:
    turn = np.radians(angle_deg)
    wedge = np.array([[20.0, 20.0], [80.0, 20.0], [20.0 + 60.0 * np.cos(turn), 20.0 + 60.0 * np.sin(turn)]])
    arrangement = drawn(SQUARE, wedge)
    found = refined(arrangement, shapely.Polygon(SQUARE))
    assert_sound(found, arrangement, shapely.Polygon(SQUARE))
    assert angles_deg(found.partition).min() >= min(20.0, angle_deg) - 1e-6
    assert found.partition.size < 600


def test_many_segments_that_meet_in_one_vertex() -> None:
    spokes = [
        np.array([[50.0, 50.0], [50.0 + reach * np.cos(turn), 50.0 + reach * np.sin(turn)]])
        for turn, reach in zip(np.linspace(0.1, 3.2, 9), np.linspace(20.0, 45.0, 9), strict=True)
    ]
    arrangement = arranged(np.concatenate((ring_edges(SQUARE), np.array(spokes))), TOLERANCE_M)
    found = refined(arrangement, shapely.Polygon(SQUARE))
    assert_sound(found, arrangement, shapely.Polygon(SQUARE))
    assert found.partition.size < 3000


def test_a_mesh_without_end_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(refinement, "MOST_VERTICES", 100)
    with pytest.raises(GeometryError, match="more than 100 vertices"):
        refined(drawn(SQUARE), shapely.Polygon(SQUARE), largest_m=1.0)


def test_outlines_that_run_beside_each_other_are_refused_before_they_are_meshed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The refusal says how near they are and how far apart would do, and that is true."""
    monkeypatch.setattr(refinement, "MOST_VERTICES", 2000)
    grown = []
    insert = Triangulation.insert

    def counted(mesh: Triangulation, points: np.ndarray, cavities: Cavities) -> Growth:
        grown.append(len(mesh.vertices))
        return insert(mesh, points, cavities)

    monkeypatch.setattr(Triangulation, "insert", counted)

    def beside(gap_m: float) -> list[np.ndarray]:
        return [SQUARE * 0.4 + [5.0 + (40.0 + gap_m) * column, 30.0] for column in (0, 1)]

    with pytest.raises(GeometryError) as refused:
        refined(drawn(SQUARE, *beside(0.012)), shapely.Polygon(SQUARE))
    assert str(refused.value) == (
        "the mesh would have more than 2,000 vertices: outlines run 0.012 m apart, as near (45.01, 32.50);"
        " 0.06 m would do"
    )
    assert max(grown) < 500
    assert refined(drawn(SQUARE, *beside(0.06)), shapely.Polygon(SQUARE)).partition.size < 4000


def test_the_same_outlines_give_the_same_mesh() -> None:
    region = np.array([[30.0, 30.0], [61.3, 33.1], [58.0, 66.7], [31.0, 54.2]])
    first, second = (refined(drawn(SQUARE, region), shapely.Polygon(SQUARE)).partition for _ in range(2))
    assert first.vertices_m.tobytes() == second.vertices_m.tobytes()
    assert first.triangles.tobytes() == second.triangles.tobytes()


@tried(40)
@given(st.integers(0, 10**6), st.integers(1, 12))
def test_whatever_is_drawn_is_meshed(seed: int, count: int) -> None:
    """Overlapping triangles at random, far from the origin, cut off at the rim."""
    chance = np.random.default_rng(seed)
    offset = np.array([5.0e5, 5.4e6]) * chance.integers(0, 2)
    square = shapely.Polygon(SQUARE + offset)
    shapes = shapely.polygons(chance.uniform(-10.0, 110.0, size=(count, 3, 2)) + offset)
    rims = [np.array(part.exterior.coords)[:-1] for part in shapely.get_parts(shapes & square) if part.area > 1.0]
    arrangement = drawn(SQUARE + offset, *rims)
    found = refined(arrangement, square)
    assert found.partition.areas_m2.sum() == pytest.approx(1.0e4, rel=1e-3)
    assert_thin_beside_sharp_angles_only(found.partition, arrangement)


def assert_thin_beside_sharp_angles_only(partition: Partition, arrangement: Arrangement) -> None:
    """A triangle with an angle below the least has it between segments, or its shortest edge ends on two of them."""
    angles = angles_deg(partition)
    thin = np.flatnonzero(angles.min(axis=1) < 20.0 - 1e-6)
    assert not len(thin) or sharpest(arrangement) < 60.0
    segments = shapely.linestrings(arrangement.vertices_m[arrangement.segments])
    lines = shapely.union_all(segments)
    tips = partition.edge_lengths_m[thin].argmin(axis=1)
    for side in (1, 2):
        ends = partition.corners_m[thin, (tips + side) % 3]
        assert (shapely.distance(lines, shapely.points(ends)) < 1e-6).all()


def sharpest(arrangement: Arrangement) -> float:
    """The least angle between segments that meet, degrees."""
    vertices = arrangement.vertices_m
    least = 180.0
    for hub in range(len(vertices)):
        ends = arrangement.segments[(arrangement.segments == hub).any(axis=1)]
        others = np.where(ends[:, 0] == hub, ends[:, 1], ends[:, 0])
        bearings = np.sort(np.degrees(np.arctan2(*(vertices[others] - vertices[hub]).T)))
        gaps = np.diff(np.append(bearings, bearings[0] + 360.0))
        least = min(least, float(gaps.min()))
    return least


def test_nested_squares_a_metre_apart_are_meshed_at_their_own_scale() -> None:
    rings = [np.array([[a, a], [110.0 - a, a], [110.0 - a, 110.0 - a], [a, 110.0 - a]]) for a in range(20, 50)]
    arrangement = drawn(SQUARE, *rings)
    found = refined(arrangement, shapely.Polygon(SQUARE))
    assert found.partition.edge_lengths_m.min() > 0.1
    assert_sound(found, arrangement, shapely.Polygon(SQUARE))
