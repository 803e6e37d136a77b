"""`mission export`: what it writes, what it says, and what it refuses."""

import json
from pathlib import Path

import pytest
from shapely.geometry import shape

from mission.interchange.features import Role
from mission.interchange.reading import read_drawing
from tests.support.commands import ran
from tests.support.small_missions import ROUNDS, SMALL, at_a_place

ENDINGS = (".plan", ".waypoints", ".geojson", ".kml", ".kmz", ".gpx")


@pytest.fixture
def placed(tmp_path: Path) -> str:
    file = tmp_path / "small.yaml"
    file.write_text(at_a_place(-47.397742, 8.545594), encoding="utf-8")
    return str(file)


@pytest.fixture
def nowhere(tmp_path: Path) -> str:
    file = tmp_path / "nowhere.yaml"
    file.write_text(SMALL, encoding="utf-8")
    return str(file)


@pytest.mark.parametrize("ending", ENDINGS)
def test_each_kind_of_file_is_written(
    ending: str, placed: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / f"small{ending.upper()}"
    result = ran(capsys, "export", placed, "--to", str(file))
    assert (result.code, result.err) == (0, "")
    assert file.stat().st_size > 400
    assert result.out.startswith(f"Exported       {file}\nPath           ")
    assert "they spell {home} {} {goal} {} {home}\n" in result.out
    assert ("Take-off       -47.39" in result.out) is (ending in {".plan", ".waypoints"})
    assert [each.name for each in tmp_path.iterdir() if each.name.startswith(".")] == []


def test_it_is_said_how_far_off_the_legs_are_and_what_the_vehicle_has_left(
    placed: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    result = ran(capsys, "export", placed, "--to", str(tmp_path / "small.plan"), "--tolerance", "0.1")
    lines = dict(line.split(maxsplit=1) for line in result.out.splitlines() if line[0] != " ")
    items = len(json.loads((tmp_path / "small.plan").read_bytes())["mission"]["items"])
    assert lines["Mission"] == f"{items} items, 4 m/s over ground, 2 stops of 3 s in all"
    deviation, left = (float(part.split(" m ")[0]) for part in result.out.split("at most ")[1].split("\n", 1))
    assert 0.0 < deviation <= 0.1
    assert left == pytest.approx(0.5 - deviation, abs=0.01)
    assert lines["Fence"].startswith("1 area to stay out of; the legs keep ")


def test_a_plan_and_its_mission_give_the_same_file(
    placed: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan, one, other = (tmp_path / name for name in ("plan.json", "one.plan", "other.plan"))
    assert ran(capsys, "plan", placed, "--out", str(plan)).code == 0
    assert ran(capsys, "export", placed, "--to", str(one)).code == 0
    assert ran(capsys, "export", str(plan), "--to", str(other)).code == 0
    assert one.read_bytes() == other.read_bytes()


def test_a_mission_without_a_place_is_put_where_it_is_told(
    nowhere: str, placed: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    refused = ran(capsys, "export", nowhere, "--to", str(tmp_path / "a.plan"))
    assert refused.code == 2
    assert "the mission has no place on Earth" in refused.err
    assert "--at LAT,LON" in refused.err
    assert not (tmp_path / "a.plan").exists()
    assert ran(capsys, "export", nowhere, "--to", str(tmp_path / "a.plan"), "--at", "-47.397742,8.545594").code == 0
    assert ran(capsys, "export", placed, "--to", str(tmp_path / "b.plan")).code == 0
    assert (tmp_path / "a.plan").read_bytes() == (tmp_path / "b.plan").read_bytes()


def test_a_mission_with_a_place_is_put_nowhere_else(
    placed: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    result = ran(capsys, "export", placed, "--to", str(tmp_path / "a.plan"), "--at", "47,8")
    assert result.code == 2
    assert "--at: the mission has its place, its (0, 0) is at -47.397742, 8.545594" in result.err


def test_a_file_that_is_there_is_kept_unless_told(
    placed: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "mine.plan"
    file.write_text("mine", encoding="utf-8")
    refused = ran(capsys, "export", placed, "--to", str(file))
    assert (refused.code, file.read_text(encoding="utf-8")) == (2, "mine")
    assert f"--to: {file} exists" in refused.err
    assert "--force" in refused.err
    assert ran(capsys, "export", placed, "--to", str(file), "--force").code == 0
    assert json.loads(file.read_bytes())["fileType"] == "Plan"


@pytest.mark.parametrize(
    ("name", "tolerance", "words"),
    [
        ("mission.doc", "0.2", "'mission.doc' ends in none of .plan, .waypoints, .geojson, .kml, .kmz, .gpx"),
        ("no/such/folder/mission.plan", "0.2", "cannot be written"),
        ("mission.plan", "0.001", "0.001 m is finer than autopilots keep places"),
    ],
)
def test_what_cannot_be_written_is_refused(
    name: str, tolerance: str, words: str, placed: str, capsys: pytest.CaptureFixture[str]
) -> None:
    result = ran(capsys, "export", placed, "--to", str(Path(placed).parent / name), "--tolerance", tolerance)
    assert result.code == 2
    assert words in result.err


@pytest.mark.parametrize("place", ["47", "47,x", "95,8", "47,8,9"])
def test_what_is_no_place_is_refused(place: str, nowhere: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="2"):
        ran(capsys, "export", nowhere, "--to", "mission.plan", "--at", place)
    assert "--at" in capsys.readouterr().err


@pytest.mark.parametrize(("laps", "words"), [("2", "2 times"), ("until_stopped", "until item ")])
def test_it_is_said_where_the_lap_begins_and_that_the_legs_leave_the_tube(
    laps: str, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mission, file = tmp_path / "rounds.yaml", tmp_path / "rounds.plan"
    mission.write_text(ROUNDS.replace("laps: 2", f"laps: {laps}"), encoding="utf-8")
    result = ran(capsys, "export", str(mission), "--to", str(file), "--at", "47,8", "--tolerance", "1")
    assert "warning: the legs may leave the proved tube, 0.4 m per axis" in result.err
    items = json.loads(file.read_bytes())["mission"]["items"]
    jump = next(item for item in items if item["command"] == 177)
    assert f"from item {jump['params'][0]:.0f} the lap, {words}" in result.out
    assert jump["params"][1] == (1.0 if laps == "2" else -1.0)
    if laps == "until_stopped":
        assert f"until item {jump['doJumpId'] + 1} is chosen" in result.out


def test_the_regions_of_a_map_are_the_regions_of_the_mission(
    placed: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "small.geojson"
    assert ran(capsys, "export", placed, "--to", str(file)).code == 0
    features = json.loads(file.read_bytes())["features"]
    run = next(each["properties"]["run"] for each in features if each["properties"]["kind"] == "path")
    triangles = [each for each in features if each["properties"]["kind"] == "triangle"]
    for place, triangle in enumerate(run):
        assert place in triangles[triangle]["properties"]["run"]
    goal = next(shape(each["geometry"]) for each in features if each["properties"]["name"] == "goal")
    labelled = [shape(each["geometry"]) for each in triangles if each["properties"]["labels"] == ["goal"]]
    assert sum(each.area for each in labelled) == pytest.approx(goal.area, rel=1e-6)
    drawn = read_drawing(file.read_bytes())
    assert {feature.name: feature.role for feature in drawn.features} == {
        "boundary": Role.BOUNDARY,
        "home": Role.HOME,
        "goal": Role.SURVEY,
        "pond": Role.RESTRICTED,
    }
