"""Meshes of outlines alone: the same whatever mesh the outlines come from, and with room where it is asked for."""

import numpy as np
import pytest
import shapely

from mission.geometry.location import Locator
from mission.geometry.outline_mesh import ClassedMesh, Outlines
from mission.geometry.regions import union_of
from mission.spec.domain import build_domain, restricted_triangles
from mission.spec.loader import parse_mission

POND, ROOF = shapely.box(10.0, 10.0, 20.0, 20.0), shapely.Polygon([(30, 4), (36, 10), (30, 16), (24, 10)])


def outlines(largest_m: float) -> Outlines:
    text = f"""\
domain:
  boundary: [[0, 0], [40, 0], [40, 30], [0, 30]]
  mesh: {{largest_m: {largest_m}}}
regions:
  pond: {{kind: restricted, polygon: {shapely.get_coordinates(POND)[:-1].tolist()}}}
  roof: {{kind: survey, polygon: {shapely.get_coordinates(ROOF)[:-1].tolist()}}}
mission: {{formula: F roof}}
start: {{position_m: [5, 5]}}
"""
    spec = parse_mission(text.encode())
    partition, labelling = build_domain(spec)
    return Outlines.of(Locator(partition), labelling.letter_of, restricted_triangles(spec, labelling))


def area_of(mesh: ClassedMesh, number: int) -> shapely.Geometry:
    return union_of(mesh.partition, mesh.class_of == number)


def test_outlines_are_straight_and_the_same_on_any_mesh() -> None:
    coarse, fine = outlines(20.0), outlines(3.0)
    assert coarse.within.partition.size < fine.within.partition.size
    assert np.array_equal(coarse.rims_m, fine.rims_m)
    assert np.array_equal(coarse.borders_m, fine.borders_m)
    assert (len(fine.rims_m), len(fine.borders_m)) == (8, 4)
    meshes = [found.mesh(0.5, largest_share=0.1) for found in (coarse, fine)]
    assert np.array_equal(meshes[0].partition.vertices_m, meshes[1].partition.vertices_m)
    assert np.array_equal(meshes[0].class_of, meshes[1].class_of)


@pytest.mark.parametrize("clearance_m", [0.0, 1.0])
def test_what_is_open_is_meshed_but_for_what_is_near_a_rim(clearance_m: float) -> None:
    found = outlines(8.0)
    mesh = found.mesh(clearance_m, largest_share=0.1)
    room = shapely.box(clearance_m, clearance_m, 40.0 - clearance_m, 30.0 - clearance_m)
    room = room.difference(shapely.box(10.0 - clearance_m, 10.0 - clearance_m, 20.0 + clearance_m, 20.0 + clearance_m))
    roof = int(found.classes[found.within.triangle_at(np.array([[30.0, 10.0]]))[0]])
    assert area_of(mesh, roof).symmetric_difference(ROOF).area < 1e-6
    assert area_of(mesh, 1 - roof).symmetric_difference(room.difference(ROOF)).area < 1e-6
    assert mesh.partition.edge_lengths_m.max() <= 0.1 * (40.0 - 2.0 * clearance_m)
