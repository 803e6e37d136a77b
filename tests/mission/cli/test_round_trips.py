"""What ``mission export`` writes, read again by ``mission import``: nothing that the format can carry is lost."""

from pathlib import Path

import numpy as np
import pytest

from mission.spec.loader import load_mission, parse_mission
from mission.spec.model import CircleShape, MissionSpec, PolygonShape, StripShape
from tests.support.commands import ran
from tests.support.small_missions import ROUNDS, at_a_place

FARM = """\
name: Round trip
origin: {latitude_deg: 51.896772, longitude_deg: 6.54038}
domain:
  boundary: [[-20, -20], [130, -20], [130, 100], [-20, 100]]
  clearance_m: 2
regions:
  pad: {kind: home, polygon: [[100, 0], [115, 0], [115, 15], [100, 15]]}
  field:
    kind: survey
    polygon: [[0, 0], [80, 0], [80, 60], [0, 60]]
    holes: [[[30, 20], [40, 20], [40, 30], [30, 30]]]
    cover: {spacing_m: 20, heading_deg: 90, share: 0.5}
  strip: {kind: survey, line: [[10, 85], [40, 82], [70, 85]], width_m: 14, loiter_s: 3}
  plot:
    kind: survey
    polygon: [[95, 40], [120, 40], [120, 60], [95, 60]]
    cover: {camera: {sensor_mm: [13.2, 8.8], focal_length_mm: 8.8, overlap: 0.6, sidelap: 0.7}}
  pond: {kind: restricted, centre: [60, 30], radius_m: 6, clearance_m: 3}
  road: {kind: area, line: [[90, -15], [90, 95]], width_m: 4}
mission:
  formula: F (field & F plot) & F strip & F G pad
start:
  position_m: [104, 6]
flight: {speed_m_s: 6, altitude_m: 25, disturbance_m_s2: 0.3}
limits: {speed_m_s: 6}
search: {cost: distance}
smoothing: corridor
"""


def again(text: str, ending: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> tuple[str, str]:
    """A mission's file after an export and an import, and what the import says."""
    mission, drawn, imported = folder / "first.yaml", folder / f"drawn{ending}", folder / "again.yaml"
    mission.write_text(text, encoding="utf-8")
    assert ran(capsys, "export", str(mission), "--to", str(drawn)).code == 0
    read = ran(capsys, "import", str(drawn), "--out", str(imported))
    assert read.code == 0
    assert "it plans as it is" in read.out
    return imported.read_text(encoding="utf-8"), read.err


def places(spec: MissionSpec) -> np.ndarray:
    """All corners of a mission's shapes in order, round ones by what they are drawn with; by the first of them."""
    points = []
    for region in spec.regions:
        shape = region.shape
        if isinstance(shape, PolygonShape):
            points += [min(shape.corners_m), *(min(hole) for hole in shape.holes_m)]
        elif isinstance(shape, CircleShape):
            points.append(shape.centre_m)
        elif isinstance(shape, StripShape):
            points += shape.line_m
    return np.array([*points, spec.start.position_m]) - points[0]


@pytest.mark.parametrize("ending", [".geojson", ".kml"])
def test_maps_carry_the_whole_mission(ending: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text, _ = again(FARM, ending, tmp_path, capsys)
    first, spec = load_mission(tmp_path / "first.yaml"), parse_mission(text.encode())
    regions = {region.name: region for region in spec.regions}
    assert sorted(regions) == sorted(region.name for region in first.regions)
    for region in first.regions:
        mine = regions[region.name]
        assert (mine.kind, type(mine.shape)) == (region.kind, type(region.shape))
        assert (mine.cover, mine.loiter_s, mine.clearance_m) == (region.cover, region.loiter_s, region.clearance_m)
    assert (regions["pond"].shape.radius_m, regions["road"].shape.width_m) == (6.0, 4.0)  # type: ignore[union-attr]
    np.testing.assert_allclose(places(spec), places(first), atol=2e-3)
    assert (spec.formula, spec.flight, spec.limits) == (first.formula, first.flight, first.limits)
    assert (spec.search, spec.smoothing) == (first.search, first.smoothing)
    assert spec.domain.clearance_m == 2.0  # type: ignore[union-attr]
    assert "?" not in text  # nothing is left to ask


@pytest.mark.parametrize("ending", [".plan", ".waypoints", ".gpx"])
def test_a_route_is_no_region(ending: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text, said = again(FARM, ending, tmp_path, capsys)
    assert "waypoints is left out: a way is no region; what it was flown for is not in the file" in said
    spec = parse_mission(text.encode())
    kinds = {str(region.kind) for region in spec.regions}
    assert kinds == ({"home", "restricted"} if ending == ".plan" else {"home"})
    assert "What should it visit?" in text
    if ending == ".plan":
        # The fence has the clearances in it.
        assert "radius_m: 9" in text
        assert (spec.flight.altitude_m, spec.flight.speed_m_s) == (25.0, 6.0)


def test_laps_are_kept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    place = at_a_place(47.0, 8.0).splitlines()[-1] + "\n"
    text, _ = again(ROUNDS + place, ".geojson", tmp_path, capsys)
    first, spec = load_mission(tmp_path / "first.yaml"), parse_mission(text.encode())
    assert (spec.formula, spec.flight.laps, spec.flight.tube_m) == (first.formula, 2, first.flight.tube_m)


def test_an_antimeridian_is_no_edge(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text, _ = again(FARM.replace("longitude_deg: 6.54038", "longitude_deg: 179.9995"), ".geojson", tmp_path, capsys)
    first, spec = load_mission(tmp_path / "first.yaml"), parse_mission(text.encode())
    assert [region.name for region in spec.regions if region.cover] == [r.name for r in first.regions if r.cover]
    shapes = {region.name: region.shape for region in spec.regions}
    assert isinstance(shapes["road"], StripShape)
    assert np.ptp(np.array(shapes["road"].line_m)[:, 0]) < 1.0
