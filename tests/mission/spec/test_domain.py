"""Mesh and labels of a mission."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.errors import SpecError
from mission.geometry.location import Locator
from mission.spec.domain import build_domain, restricted_triangles
from mission.spec.loader import load_mission, parse_mission
from mission.spec.model import BoundaryDomain, PolygonShape, Refinement, Region, RegionKind, Start
from tests.support.domains import PAPER_TRIANGLES
from tests.support.drawn_cases import tried

PAPER = load_mission(Path(__file__).parents[3] / "missions" / "paper.yaml")


def square(x: float, y: float, side: float) -> tuple[tuple[float, float], ...]:
    return ((x, y), (x + side, y), (x + side, y + side), (x, y + side))


def test_the_papers_mission_has_the_papers_triangles_and_labels() -> None:
    partition, labelling = build_domain(PAPER)
    assert partition.triangles.tolist() == PAPER_TRIANGLES
    labels = {i: labelling.label(i) for i in range(13) if labelling.label(i)}
    assert labels == {0: {"S2"}, 3: {"S1"}, 6: {"K1"}, 10: {"R"}}
    assert np.flatnonzero(restricted_triangles(PAPER, labelling)).tolist() == [6]
    assert labelling.letter_of[[1, 2, 4, 5, 7, 8, 9, 11, 12]].tolist() == [labelling.letter_of[1]] * 9


def test_polygons_over_nodes_are_unions_of_triangles() -> None:
    both = PolygonShape(((6.0, 10.0), (2.0, 8.0), (5.0, 5.0), (8.0, 7.0)))
    spec = replace(PAPER, regions=(*PAPER.regions, Region("Wide", RegionKind.SURVEY, both)))
    partition, labelling = build_domain(spec)
    assert labelling.triangles_of("Wide").tolist() == [6, 7]
    assert labelling.label(6) == {"Wide", "K1"}
    assert partition.areas_m2[[6, 7]].sum() == pytest.approx(15.5)


def test_restricted_regions_win_where_regions_overlap() -> None:
    outer = Region("Field", RegionKind.SURVEY, PolygonShape(square(10.0, 10.0, 30.0)))
    inner = Region("Pond", RegionKind.RESTRICTED, PolygonShape(square(20.0, 20.0, 10.0)))
    boundary = PolygonShape(((0.0, 0.0), (60.0, 0.0), (60.0, 50.0), (0.0, 50.0)))
    domain = BoundaryDomain(boundary, Refinement(20.0, np.inf))
    spec = replace(PAPER, domain=domain, regions=(outer, inner), start=Start((5.0, 5.0)))
    partition, labelling = build_domain(spec)
    assert labelling.letters == (frozenset(), frozenset({"Field"}), frozenset({"Field", "Pond"}))
    restricted = restricted_triangles(spec, labelling)
    assert partition.areas_m2[restricted].sum() == pytest.approx(100.0)
    assert partition.areas_m2[labelling.triangles_of("Field")].sum() == pytest.approx(900.0)
    assert partition.areas_m2.sum() == pytest.approx(3000.0)


def test_a_bad_value_raises_every_fault_without_lines() -> None:
    elsewhere = Region("Far", RegionKind.HOME, PolygonShape(square(100.0, 0.0, 5.0)))
    spec = replace(PAPER, regions=(elsewhere,), start=Start((100.0, 100.0)))
    with pytest.raises(SpecError) as caught:
        build_domain(spec)
    assert {(fault.line, fault.path) for fault in caught.value.faults} == {
        *((0, f"regions.Far.polygon[{corner}]") for corner in range(4)),
        (0, "start.position_m"),
    }


@given(st.integers(0, 10_000), st.integers(1, 5))
@tried(20)
def test_random_squares_come_out_wherever_they_lie(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    corners = rng.uniform(2.0, 80.0, (count, 2)).round(1)
    sides = rng.uniform(3.0, 15.0, count).round(1)
    lines = [
        f"  S{i}: {{kind: survey, polygon: {[list(p) for p in square(float(x), float(y), float(side))]}}}"
        for i, ((x, y), side) in enumerate(zip(corners, sides, strict=True))
    ]
    head = "domain: {boundary: [[0, 0], [100, 0], [100, 100], [0, 100]]}\nregions:\n"
    tail = "\nmission: {formula: F S0}\nstart: {position_m: [1, 1]}\n"
    spec = parse_mission((head + "\n".join(lines) + tail).encode())
    partition, labelling = build_domain(spec)
    locator = Locator(partition)
    for i, (corner, side) in enumerate(zip(corners, sides, strict=True)):
        members = labelling.triangles_of(f"S{i}")
        assert partition.areas_m2[members].sum() == pytest.approx(side**2)
        assert locator.triangle_at((corner + side * rng.uniform(0.01, 0.99, 2))[None])[0] in members


def test_the_suggested_nodes_make_a_missing_edge_come_out() -> None:
    text = """\
domain:
  nodes: [[0, 0], [60, 0], [60, 40], [0, 40], [30, 20], [10, 21], [35, 21], [35, 35], [10, 35]]
regions:
  Field: {kind: survey, polygon: [[10, 21], [35, 21], [35, 35], [10, 35]]}
mission: {formula: F Field}
start: {position_m: [5, 5]}
"""
    with pytest.raises(SpecError):
        parse_mission(text.encode())
    for _ in range(6):
        try:
            spec = parse_mission(text.encode())
        except SpecError as error:
            for fault in error.faults:
                text = text.replace("]]\nregions", f"], {fault.hint.partition('such as ')[2]}]\nregions")
        else:
            assert build_domain(spec)[0].areas_m2.sum() == pytest.approx(2400.0)
            return
    raise AssertionError(text)
