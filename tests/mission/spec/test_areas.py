"""Regions and boundaries of every shape that a file can draw: what they contain, and what is said of faults."""

import json

import numpy as np
import pytest
import shapely

from mission.errors import SpecError
from mission.geometry.location import Locator
from mission.spec.areas import boundary_ground, region_ground
from mission.spec.document import document_of
from mission.spec.domain import build_domain
from mission.spec.loader import parse_mission
from mission.spec.model import BoundaryDomain, MissionSpec

SITE = """\
domain:
  boundary: %s
  %s
regions:
  home: {kind: home, polygon: [[5, 5], [20, 5], [20, 20], [5, 20]]}
  field: %s
mission: {formula: F field}
start: {position_m: [12, 12]}
"""
SQUARE = "[[0, 0], [100, 0], [100, 80], [0, 80]]"
PLAIN = "{kind: survey, polygon: [[40, 20], [80, 20], [80, 60], [40, 60]]}"


def site(field: str = PLAIN, boundary: str = SQUARE, clearances: str = "") -> MissionSpec:
    return parse_mission((SITE % (boundary, clearances, field)).encode())


def faults(field: str = PLAIN, boundary: str = SQUARE, clearances: str = "") -> list[tuple[str, str]]:
    with pytest.raises(SpecError) as refused:
        site(field, boundary, clearances)
    return [(fault.path, fault.message) for fault in refused.value.faults]


def area_m2(spec: MissionSpec, name: str) -> float:
    partition, labelling = build_domain(spec)
    return float(partition.areas_m2[labelling.triangles_of(name)].sum())


RING = "[[40, 20], [80, 20], [80, 60], [40, 60]]"
BESIDE = "{polygon: [[%d, 20], [%d, 20], [%d, 30], [%d, 30]]}"
PARTS = "polygons: [{polygon: " + RING + "}, " + BESIDE + "]"
SHAPES = {
    "hole": (f"polygon: {RING}, holes: [[[50, 30], [60, 30], [60, 40], [50, 40]]]", 1500.0),
    "hole at the rim": (f"polygon: {RING}, holes: [[[40, 30], [60, 30], [60, 40], [40, 40]]]", 1400.0),
    "hole across the rim": (f"polygon: {RING}, holes: [[[30, 30], [60, 30], [60, 40], [30, 40]]]", 1400.0),
    "parts": (PARTS % (85, 95, 95, 85), 1700.0),
    "parts that share an edge": (PARTS % (80, 90, 90, 80), 1700.0),
    "parts that overlap": (PARTS % (70, 90, 90, 70), 1700.0),
    "circle": ("centre: [60, 40], radius_m: 15", 0.5 * 24 * 225.0 * np.sin(np.pi / 12.0)),
    "strip": ("line: [[30, 70], [90, 70]], width_m: 8", 480.0),
    "strip across the boundary": ("line: [[30, 70], [130, 70]], width_m: 8", 560.0),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_a_region_is_the_area_that_its_keys_draw_and_a_file_of_it_says_the_same(shape: str) -> None:
    keys, expected = SHAPES[shape]
    spec = site(f"{{kind: survey, {keys}}}")
    assert area_m2(spec, "field") == pytest.approx(expected, rel=1e-4)
    again = parse_mission(json.dumps(document_of(spec)).encode())
    assert (again.domain, again.regions) == (spec.domain, spec.regions)


@pytest.mark.parametrize("kind", ["restricted", "survey", "home", "area"])
@pytest.mark.parametrize("keys", ["centre: [60, 40], radius_m: 15", "line: [[40, 40], [60, 40], [60, 60]], width_m: 9"])
def test_what_is_round_errs_to_the_safe_side(kind: str, keys: str) -> None:
    spec = site(f"{{kind: {kind}, {keys}}}")
    ground = region_ground(spec.regions[1], spec.domain)
    assert ground is not None
    exact = shapely.Point(60, 40).buffer(15.0, quad_segs=500)
    if "line" in keys:
        exact = shapely.LineString([(40, 40), (60, 40), (60, 60)]).buffer(4.5, quad_segs=500, cap_style="flat")
    less, more = (exact, ground.drawn) if kind == "restricted" else (ground.drawn, exact)
    assert shapely.difference(less, more).area < 1e-2
    assert shapely.difference(more, less).area > 0.1


def test_a_boundary_has_holes_and_parts_and_what_is_round_lies_in_it() -> None:
    holed = "{polygon: [[0, 0], [100, 0], [100, 80], [0, 80]], holes: [[[30, 0], [34, 0], [34, 70], [30, 70]]]}"
    partition, _ = build_domain(site(boundary=holed))
    assert partition.areas_m2.sum() == pytest.approx(8000.0 - 280.0)
    assert not len(Locator(partition).triangles_touching((32.0, 30.0)))
    round_one = site(boundary="{centre: [50, 40], radius_m: 60}")
    assert isinstance(round_one.domain, BoundaryDomain)
    ground = boundary_ground(round_one.domain)
    assert shapely.hausdorff_distance(ground.drawn.boundary, shapely.Point(50, 40)) == pytest.approx(60.0)
    again = parse_mission(json.dumps(document_of(round_one)).encode())
    assert again.domain == round_one.domain
    partition, _ = build_domain(round_one)
    assert partition.areas_m2.sum() == pytest.approx(ground.drawn.area)


def test_clearances_move_rims_to_the_safe_side_and_the_region_s_own_comes_first() -> None:
    restricted = "{kind: restricted, polygon: [[40, 20], [60, 20], [60, 40], [40, 40]]%s}"
    for own, by in (("", 3.0), (", clearance_m: 5", 5.0), (", clearance_m: 0", 0.0)):
        spec = site(restricted % own, clearances="restricted_clearance_m: 3")
        exact = 400.0 + 80.0 * by + np.pi * by**2
        assert exact - 0.2 * by <= area_m2(spec, "field") <= exact + 0.1 * by**2 + 0.2 * by
    spec = site(PLAIN.replace("]]}", "]], clearance_m: 3}"), clearances="clearance_m: 2\n  restricted_clearance_m: 9")
    assert area_m2(spec, "field") == pytest.approx(34.0**2)
    assert build_domain(spec)[0].areas_m2.sum() == pytest.approx(96.0 * 76.0)
    ground = region_ground(spec.regions[1], spec.domain)
    assert ground is not None
    assert (ground.drawn.area, ground.kept.area) == (1600.0, pytest.approx(34.0**2))


def test_an_area_is_neither_surveyed_nor_forbidden() -> None:
    spec = site("{kind: area, polygon: [[8, 0], [30, 0], [30, 40], [8, 40]]}")  # the start lies in it
    partition, labelling = build_domain(spec)
    assert partition.areas_m2[labelling.triangles_of("field")].sum() == pytest.approx(880.0)
    assert frozenset({"home", "field"}) in labelling.letters


@pytest.mark.parametrize(
    ("keys", "path", "message"),
    [
        (f"polygon: {RING}, centre: [1, 2], radius_m: 3", "regions.field", "polygon and centre exclude each other"),
        ("centre: [40, 40]", "regions.field.centre", "`centre` goes with `radius_m` only"),
        ("line: [[1, 2], [3, 4]]", "regions.field.line", "`line` goes with `width_m` only"),
        (
            "line: [[40, 40], [60, 40], [60, 40]], width_m: 4",
            "regions.field.line[2]",
            "corners 1 and 2 of the line of field are the same point",
        ),
        (
            f"polygon: {RING}, holes: [[[50, 30], [60, 40], [60, 30], [50, 40]]]",
            "regions.field.holes[0]",
            "hole 0 of field is not simple: its edges 0-1 and 2-3 cross at (55, 35)",
        ),
        (
            f"polygon: {RING}, holes: [[[90, 30], [95, 40], [95, 30]]]",
            "regions.field.holes[0]",
            "hole 0 of field lies outside its polygon",
        ),
        (
            f"polygons: [{{polygon: {RING}, holes: [[[30, 10], [90, 10], [90, 70], [30, 70]]]}}]",
            "regions.field.polygons[0].holes[0]",
            "hole 0 of field leaves nothing of its polygon",
        ),
        (
            "centre: [140, 40], radius_m: 20",
            "regions.field.centre",
            "field lies wholly outside the boundary: 20 m from it",
        ),
    ],
)
def test_faults_of_shapes_stand_where_they_are(keys: str, path: str, message: str) -> None:
    assert faults(f"{{kind: survey, {keys}}}") == [(path, message)]


def said(field: str = PLAIN, clearances: str = "") -> tuple[str, str]:
    with pytest.raises(SpecError) as refused:
        site(field, clearances=clearances)
    (fault,) = refused.value.faults
    return fault.message, fault.hint


def most(hint: str) -> float:
    """The value that a hint names."""
    return float(hint.split("write at most ")[1].split(" ", maxsplit=1)[0])


def test_a_start_that_a_clearance_forbids_is_told_the_largest_that_does_not() -> None:
    for shape in ("polygon: [[15.5, 17], [30, 17], [30, 30], [15.5, 30]]", "centre: [20, 20], radius_m: 5"):
        field = f"{{kind: restricted, {shape}}}"
        message, hint = said(field, clearances="restricted_clearance_m: 8")
        assert message.startswith("the start (12, 12) is 6.")
        assert message.endswith(" m from field, within its clearance of 8 m")
        site(field, clearances=f"restricted_clearance_m: {most(hint)}")
        said(field, clearances=f"restricted_clearance_m: {most(hint) + 0.01}")
    message, hint = said(clearances="clearance_m: 15")
    assert message == "the start (12, 12) is 12 m from the boundary, within its clearance of 15 m"
    assert hint == "move it away, or write at most 11.41 for domain.clearance_m"  # the tube takes 98 % of 0.6 m
    site(clearances="clearance_m: 11.41")
    said(clearances="clearance_m: 11.42")


def test_a_boundary_that_its_clearance_takes_away_is_told_the_largest_that_does_not() -> None:
    message, hint = said(clearances="clearance_m: 45")
    assert message == "nothing is left within the boundary with a clearance of 45 m"
    assert most(hint) == 39.99
