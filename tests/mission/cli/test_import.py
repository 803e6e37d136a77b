"""``mission import``: from a file that another program wrote to a mission that plans."""

import json
from pathlib import Path

import pytest

from tests.support.commands import ran

FIELD = {
    "type": "Feature",
    "properties": {"name": "North field"},
    "geometry": {
        "type": "Polygon",
        "coordinates": [
            [[6.5404, 51.8968], [6.5414, 51.8968], [6.5414, 51.8974], [6.5404, 51.8974], [6.5404, 51.8968]]
        ],
    },
}


@pytest.fixture
def field(tmp_path: Path) -> str:
    file = tmp_path / "farm.geojson"
    file.write_text(json.dumps(FIELD), encoding="utf-8")
    return str(file)


def test_what_is_written_plans_and_is_verified_without_the_file(
    field: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mission, plan = str(tmp_path / "mission.yaml"), str(tmp_path / "plan.json")
    written = ran(capsys, "import", field, "--out", mission)
    assert (written.code, written.err) == (0, "")
    assert written.out.startswith(f"{mission}: 4 questions in it, as comments\n    it plans as it is: ")
    Path(field).unlink()
    planned = ran(capsys, "plan", mission, "--out", plan)
    assert (planned.code, planned.err) == (0, "")
    assert "the flight surely spells {home}" in planned.out
    assert ran(capsys, "verify", plan).code == 0


def test_without_a_name_it_goes_to_standard_output(field: str, capsys: pytest.CaptureFixture[str]) -> None:
    printed = ran(capsys, "import", field)
    assert (printed.code, printed.err) == (0, "")
    assert printed.out.startswith("# Drafted from farm (GeoJSON).")
    assert '\nname: "farm"\n' in printed.out


def test_a_file_that_is_there_is_kept_unless_it_is_said(
    field: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mine = tmp_path / "mine.yaml"
    mine.write_text("mine", encoding="utf-8")
    refused = ran(capsys, "import", field, "--out", str(mine))
    assert refused.code == 2
    assert refused.err == (
        f"--out: {mine} is there already\n    choose another name, or say --force to write over it\n"
    )
    assert mine.read_text(encoding="utf-8") == "mine"
    assert ran(capsys, "import", field, "--out", str(mine), "--force").code == 0
    assert mine.read_text(encoding="utf-8").startswith("# Drafted from farm")


def test_what_is_wrong_with_a_file_is_told_with_its_place(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "farm.kml"
    file.write_text("<kml>\n<Placemark>\n<Point><coordinates>8,x</coordinates>", encoding="utf-8")
    refused = ran(capsys, "import", str(file))
    assert refused.code == 2
    assert refused.err.startswith(f"{file}:3:")
    assert "this is not well-formed XML" in refused.err
    refused = ran(capsys, "import", str(tmp_path / "none.kml"))
    assert (refused.code, refused.out) == (2, "")
    assert "cannot be read: no such file or directory" in refused.err


def test_what_is_left_out_is_a_warning(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "farm.geojson"
    empty = {"type": "Feature", "properties": None, "geometry": None}
    file.write_text(json.dumps({"type": "FeatureCollection", "features": [empty, FIELD]}), encoding="utf-8")
    printed = ran(capsys, "import", str(file))
    assert printed.code == 0
    assert "warning: features[0] has no geometry" in printed.err
    assert "# Note: features[0] has no geometry." in printed.out


def test_coordinates_are_metres_where_that_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "yard.geojson"
    ring = [[10, 20], [60, 20], [60, 60], [10, 60], [10, 20]]
    file.write_text(json.dumps({"type": "Polygon", "coordinates": [ring]}), encoding="utf-8")
    refused = ran(capsys, "import", str(file))
    assert refused.code == 2
    assert "km wide; the plane of a mission ends at 50 km" in refused.err
    assert "--metres" in refused.err
    printed = ran(capsys, "import", str(file), "--metres")
    assert printed.code == 0
    assert "polygon: [[10, 20], [60, 20], [60, 60], [10, 60]]" in printed.out
