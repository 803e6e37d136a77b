"""Regions and boundaries whose shapes files draw."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from mission.errors import Fault, SpecError
from mission.geometry.geodesy import LatLon, place_at_offset
from mission.plan import plan_from_json, plan_mission, plan_to_json
from mission.spec.areas import drawn_area
from mission.spec.drawn_files import with_drawn_shapes
from mission.spec.loader import load_mission, parse_mission
from mission.spec.model import BoundaryDomain, CircleShape, MissionSpec, PolygonShape, PolygonsShape, StripShape

ORIGIN = LatLon(51.896772, 6.54038)
ORIGIN_KEYS = {"latitude_deg": ORIGIN.latitude_deg, "longitude_deg": ORIGIN.longitude_deg}
FARM = [[0.0, 0.0], [120.0, 0.0], [120.0, 80.0], [0.0, 80.0]]
NORTH = [[10.0, 40.0], [50.0, 40.0], [50.0, 70.0], [10.0, 70.0]]
POND = [[20.0, 50.0], [25.0, 50.0], [25.0, 55.0], [20.0, 55.0]]
ROWS = [[[70.0, 10.0], [80.0, 10.0], [80.0, 30.0]], [[90.0, 10.0], [100.0, 10.0], [100.0, 30.0]]]


def drawn(*, degrees: bool) -> bytes:
    """The farm as a file, in degrees or metres."""

    def place(point: list[float]) -> list[float]:
        there = place_at_offset(ORIGIN, *point)
        return [there.longitude_deg, there.latitude_deg] if degrees else point

    def feature(kind: str, coordinates: Any, **properties: object) -> dict[str, Any]:  # noqa: ANN401 - any JSON value
        return {"type": "Feature", "properties": properties, "geometry": {"type": kind, "coordinates": coordinates}}

    def ring(points: list[list[float]]) -> list[list[float]]:
        return [place(point) for point in [*points, points[0]]]

    features = [
        feature("Polygon", [ring(FARM)], name="farm"),
        feature("Polygon", [ring(NORTH), ring(POND)], name="north"),
        feature("MultiPolygon", [[ring(row)] for row in ROWS], name="rows"),
        feature("LineString", [place([60.0, 0.0]), place([60.0, 30.0])], name="line"),
        feature("Point", place([110.0, 70.0]), name="mast"),
        feature("Point", place([110.0, 60.0]), name="mast", radius=3),
    ]
    return json.dumps({"type": "FeatureCollection", "features": features}).encode()


def mission(corners: str, changed: dict[str, str] | None = None, *, origin: bool = True) -> str:
    home = {"metres": "[100, 50]", "latitude_longitude": "[51.8972214, 6.5418328]"}[corners]
    regions = {
        "home": f"kind: home, centre: {home}, radius_m: 4",
        "north": "kind: survey, file: farm.json, feature: north",
        "rows": "kind: survey, file: farm.json, feature: 2",
        "line": "kind: restricted, file: farm.json, feature: line, width_m: 6",
        "mast": "kind: restricted, file: farm.json, feature: 5",
    } | (changed or {})
    place = f"origin: {{latitude_deg: {ORIGIN.latitude_deg}, longitude_deg: {ORIGIN.longitude_deg}}}\n"
    listed = "\n".join(f"  {name}: {{{keys}}}" for name, keys in regions.items())
    return (
        f"{place if origin else ''}domain:\n  corners: {corners}\n  boundary: {{file: farm.json, feature: farm}}\n"
        f"regions:\n{listed}\nmission:\n  formula: F north & F rows & F G home\nstart:\n  position_m: {home}\n"
    )


def read(text: str, content: bytes) -> MissionSpec:
    return parse_mission(text.encode(), read=lambda _: content)


def faults(text: str, content: bytes) -> tuple[Fault, ...]:
    with pytest.raises(SpecError) as refused:
        read(text, content)
    return refused.value.faults


@pytest.mark.parametrize(("corners", "degrees"), [("metres", False), ("metres", True), ("latitude_longitude", True)])
def test_every_kind_of_feature_is_a_shape_in_metres_of_the_plane(corners: str, *, degrees: bool) -> None:
    spec = read(mission(corners), drawn(degrees=degrees))
    assert isinstance(spec.domain, BoundaryDomain)
    shapes = {region.name: region.shape for region in spec.regions}
    kinds = {name: type(shape) for name, shape in shapes.items()}
    assert kinds == {
        "home": CircleShape,
        "north": PolygonShape,
        "rows": PolygonsShape,
        "line": StripShape,
        "mast": CircleShape,
    }
    wanted = {"north": 40 * 30 - 25.0, "rows": 200.0, "line": 6 * 30.0}
    for name, area in wanted.items():
        assert drawn_area(shapes[name], outside=False).area == pytest.approx(area, abs=1e-6)  # type: ignore[arg-type]
    boundary = spec.domain.boundary
    assert isinstance(boundary, PolygonShape)
    assert np.allclose(boundary.corners_m, FARM, atol=1e-7)
    assert isinstance(shapes["mast"], CircleShape)
    assert shapes["mast"].radius_m == 3.0


def test_the_file_is_read_beside_the_mission_and_the_plan_needs_neither(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text(mission("latitude_longitude", origin=False), encoding="utf-8")
    (tmp_path / "farm.json").write_bytes(drawn(degrees=True))
    plan = plan_mission(load_mission(tmp_path / "mine.yaml"))
    text = plan_to_json(plan)
    assert "farm.json" not in text
    assert plan_from_json(text).spec == plan.spec


@pytest.mark.parametrize(
    ("keys", "path", "message", "hint"),
    [
        ("file: farm.json", "file", "the file draws 6 features", "add feature: with a name or one of 0 (farm), 1"),
        ("file: farm.json, feature: nort", "feature", "no feature has the name 'nort'", "did you mean 'north'?"),
        ("file: farm.json, feature: 6", "feature", "there is no feature 6", "the features are 0 (farm)"),
        ("file: farm.json, feature: mast", "feature", "2 features have the name 'mast'", "write its index, one of 4"),
        ("file: farm.json, feature: 4", "feature", "the feature is a place, and the file gives it no", "add radius_m"),
        ("file: farm.json, feature: line", "feature", "the feature is a line, and the file gives it", "add width_m"),
        (
            "file: farm.json, feature: 1, width_m: 3",
            "feature",
            "the feature is a polygon: it has nei",
            "take these away",
        ),
    ],
)
def test_a_feature_that_cannot_be_had_is_told_of(keys: str, path: str, message: str, hint: str) -> None:
    data = {"origin": ORIGIN_KEYS, "domain": {}, "regions": {"north": yaml.safe_load(f"{{{keys}}}")}}
    _, (finding,) = with_drawn_shapes(data, lambda _: drawn(degrees=True))
    assert finding.path == ("regions", "north", path)
    assert finding.message.startswith(message)
    assert finding.hint.startswith(hint)


@pytest.mark.parametrize(
    ("coordinates", "message"),
    [
        (
            [[[[i, 0], [i + 1, 0], [i, 1]]] for i in range(1001)],
            "the feature has more than 1000 parts, or holes in one",
        ),
        ([[[[i, i * i] for i in range(10_001)]]], "an outline of the feature has 10001 corners, more than 10000"),
        ([[[[3e7, 0], [3e7, 1], [0, 1]]]], "coordinates are farther than 20000000 m from [0, 0]"),
    ],
)
def test_what_no_mission_file_could_hold_is_refused(coordinates: Any, message: str) -> None:  # noqa: ANN401 - any JSON value
    content = json.dumps({"type": "MultiPolygon", "coordinates": coordinates}).encode()
    data = {"origin": ORIGIN_KEYS, "domain": {}, "regions": {"north": {"file": "a"}}}
    _, (finding,) = with_drawn_shapes(data, lambda _: content)
    assert finding.message.startswith(message)


def test_keys_of_files_go_together_and_exclude_other_shapes() -> None:
    regions = {
        "north": "kind: survey, polygon: [[1, 2], [3, 4], [2, 9]], feature: north",
        "rows": "kind: survey, file: farm.json, feature: 1, at: [1, 2]",
    }
    found = faults(mission("metres", regions).replace("feature: farm", "feature: nowhere"), drawn(degrees=True))
    assert [(fault.line, fault.path, fault.message) for fault in found] == [
        (4, "domain.boundary.feature", "no feature has the name 'nowhere'"),
        (7, "regions.north.feature", "`feature` goes with `file` only"),
        (8, "regions.rows", "at and file exclude each other"),
    ]


def test_what_is_wrong_with_the_file_is_told_once_for_each_that_names_it() -> None:
    found = faults(mission("metres"), drawn(degrees=True)[:100])
    assert [fault.path for fault in found] == [
        "domain.boundary.file",
        *(f"regions.{name}.file" for name in ("north", "rows", "line", "mast")),
    ]
    assert {fault.message.partition(":")[0] for fault in found} == {"farm.json, line 1"}


def test_degrees_need_a_place_on_earth_and_metres_a_mission_in_metres() -> None:
    (fault, *_) = faults(mission("metres", origin=False), drawn(degrees=True))
    assert fault.message == "farm.json is in degrees, and the mission has no origin"
    (fault, *_) = faults(mission("latitude_longitude"), drawn(degrees=False))
    assert fault.message == "farm.json is in metres, and the mission in degrees"


def test_a_file_of_another_place_is_refused() -> None:
    text = mission("metres").replace("51.896772", "52.896772")
    found = faults(text, drawn(degrees=True))
    assert "km from the origin; the plane of a mission ends at 50 km" in found[0].message
    assert found[0].path == "domain.boundary.file"


def test_a_file_that_is_not_there_is_told_of(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text(mission("metres"), encoding="utf-8")
    with pytest.raises(SpecError) as refused:
        load_mission(tmp_path / "mine.yaml")
    assert refused.value.faults[0].message == "farm.json: there is no such file"
