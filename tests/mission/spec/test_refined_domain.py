"""Domains whose mesh refines itself: outlines as people have them, without a point that was placed for the mesh."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mission.errors import SpecError
from mission.plan import plan_from_json, plan_mission, plan_to_json
from mission.spec.document import document_of
from mission.spec.domain import build_domain, drawn_map, joined_m
from mission.spec.loader import load_mission, parse_mission
from tests.support.proofs import untrue

FARM = Path(__file__).parents[3] / "missions" / "farm.yaml"
SITE = """\
domain:
  boundary: [[0, 0], [80, 0], [80, 60], [0, 60]]
  %s
regions:
  home: {kind: home, polygon: [[5, 5], [20, 5], [20, 20], [5, 20]]}
  field: {kind: survey, polygon: [[55, 35], [70, 35], [70, 50], [55, 50]]}
  %s
mission: {formula: F (field & F home)}
start: {position_m: [12, 12]}
flight: {disturbance_m_s2: 0.3}
"""


def site(regions: str, mesh: str = "") -> bytes:
    return (SITE % (f"mesh: {{{mesh}}}" if mesh else "", regions)).encode()


def faults(regions: str, mesh: str = "") -> str:
    with pytest.raises(SpecError) as refused:
        parse_mission(site(regions, mesh))
    return " ".join(fault.message for fault in refused.value.faults)


def test_a_farm_is_planned_and_proved_without_a_placed_point() -> None:
    spec = load_mission(FARM)
    plan = plan_mission(spec)
    assert not untrue(plan)
    assert [warning.split(":")[0] for warning in plan.warnings] == ["regions.road"]
    assert {frozenset({"field", "pond"}), frozenset({"road"})} < set(plan.labelling.letters)
    again = plan_from_json(plan_to_json(plan))
    assert document_of(again.spec) == document_of(spec)
    assert not untrue(again)


@pytest.mark.parametrize("apart_m", [0.0, 1e-9, 1e-6, 1e-3, -1e-6, -1e-3])
def test_neighbours_that_nearly_share_an_edge_are_sound(apart_m: float) -> None:
    west = 70.0 + apart_m
    spec = parse_mission(site(f"next: {{kind: survey, polygon: [[{west}, 35], [76, 35], [76, 50], [{west}, 50]]}}"))
    partition, labelling = build_domain(spec)
    assert frozenset({"field", "next"}) not in labelling.letters
    for name in ("field", "next"):
        area = partition.areas_m2[labelling.triangles_of(name)].sum()
        assert area == pytest.approx({"field": 225.0, "next": 90.0}[name], abs=15.0 * 2.0 * joined_m(80.0))


def test_regions_that_overlap_share_triangles() -> None:
    strip = "bog: {kind: restricted, polygon: [[60, -5], [64, -5], [64, 65], [60, 65]]}"
    partition, labelling = build_domain(parse_mission(site(strip)))
    both = np.isin(labelling.letter_of, [labelling.letters.index(frozenset({"field", "bog"}))])
    assert partition.areas_m2[both].sum() == pytest.approx(60.0)
    assert partition.areas_m2.sum() == pytest.approx(4800.0)


def test_the_edges_and_angles_are_as_asked_for() -> None:
    spec = parse_mission(site("bog: {kind: restricted, polygon: [[30, 24], [44, 24], [44, 36]]}", "largest_m: 6"))
    partition, _ = build_domain(spec)
    assert partition.edge_lengths_m.max() <= 6.0
    assert document_of(spec)["domain"]["mesh"] == {"smallest_angle_deg": 20.0, "largest_m": 6.0}


def test_a_region_outside_or_too_thin_is_refused() -> None:
    assert "lies wholly outside the boundary" in faults("bog: {kind: survey, polygon: [[90, 5], [99, 5], [99, 20]]}")
    thin = "bog: {kind: survey, polygon: [[30, 30], [40, 30], [40, 30.001], [30, 30.001]]}"
    assert "nothing is left of bog in the mesh" in faults(thin)


def test_a_mesh_that_is_too_fine_is_refused() -> None:
    with pytest.raises(SpecError) as refused:
        parse_mission(site("bog: {kind: survey, at: [40, 5]}", "largest_m: 0.01"))
    (fault,) = refused.value.faults
    assert "more than 200,000 vertices" in fault.message
    assert fault.path == "domain.mesh.largest_m"
    assert "write more than 0.333" in fault.hint


def test_a_point_for_the_mesh_is_one_fault_that_says_to_delete_it() -> None:
    text = site("bog: {kind: survey, at: [40, 5]}").replace(
        b"regions:", b"  points: [[40, 30], [200, 1], [0]]\nregions:"
    )
    with pytest.raises(SpecError) as refused:
        parse_mission(text)
    (fault,) = refused.value.faults
    assert (fault.path, fault.line, fault.hint) == ("domain.points", 4, "delete it")
    assert "the mesh places its own points" in fault.message


def test_faults_of_the_geometry_are_told_beside_a_needless_key() -> None:
    text = site("bog: {kind: survey, at: [90, 5]}").replace(b"regions:", b"  points: [[40, 30]]\nregions:")
    with pytest.raises(SpecError) as refused:
        parse_mission(text)
    assert [fault.path for fault in refused.value.faults] == ["domain.points", "regions.bog.at"]


def test_what_is_done_in_a_region_draws_no_other_map() -> None:
    drawn_map.cache_clear()
    spec = parse_mission(site("park: {kind: survey, loiter_s: 5, polygon: [[20, 20], [40, 20], [40, 40]]}"))
    slower = [replace(region, loiter_s=9.0) for region in spec.regions]
    build_domain(spec)
    build_domain(replace(spec, regions=tuple(slower)))
    assert drawn_map.cache_info().misses == 1
