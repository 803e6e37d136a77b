"""``mission new``: by options or by answers, planned before it is written, and nothing that is there is lost."""

import io
import json
import sys
from pathlib import Path

import pytest

from mission.cli import new
from mission.draft.drafting import Draft
from mission.draft.trials import Trial
from mission.errors import Fault, NoPlanError, SpecError
from mission.spec.loader import load_mission
from mission.spec.model import RegionKind
from tests.support.commands import Ran, ran


def box(name: str, x: float, y: float, size: float) -> dict[str, object]:
    ring = [[x, y], [x + size, y], [x + size, y + size], [x, y + size], [x, y]]
    return {
        "type": "Feature",
        "properties": {"name": name},
        "geometry": {"type": "Polygon", "coordinates": [ring]},
    }


AREA = {
    "type": "FeatureCollection",
    "features": [box("Land", 0, 0, 100), box("crop", 60, 10, 25), box("Pen", 60, 60, 20), box("den", 10, 40, 12)],
}


class Typed(io.StringIO):
    """What somebody types on a terminal."""

    def isatty(self) -> bool:
        return True


@pytest.fixture
def area(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "area.geojson"
    file.write_text(json.dumps(AREA), encoding="utf-8")
    return file


def answered(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], answers: list[str], *options: str
) -> Ran:
    monkeypatch.setattr(sys, "stdin", Typed("".join(f"{answer}\n" for answer in answers)))
    return ran(capsys, "new", *options)


def test_options_alone_make_a_mission_that_plans(area: Path, capsys: pytest.CaptureFixture[str]) -> None:
    options = ["--visit", "all", "--avoid", "pen", "--home", "den", "--altitude", "40", "--speed", "6"]
    written = ran(capsys, "new", "--from", str(area), *options)
    assert (written.code, written.err) == (0, "")
    assert "it plans as it is: " in written.out
    assert written.out.endswith("    to fly it: mission fly area.yaml\n")
    spec = load_mission("area.yaml")
    kinds = {region.name: region.kind for region in spec.regions}
    assert kinds == {"den": RegionKind.HOME, "crop": RegionKind.SURVEY, "Pen": RegionKind.RESTRICTED}
    assert (spec.flight.altitude_m, spec.flight.speed_m_s) == (40.0, 6.0)
    assert "#" in Path("area.yaml").read_text(encoding="utf-8")
    assert ran(capsys, "check", "area.yaml").code == 0


def test_what_is_there_is_kept_unless_it_is_said(area: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mine = Path("area.yaml")
    mine.write_text("mine", encoding="utf-8")
    refused = ran(capsys, "new", "--from", str(area), "--visit", "crop")
    assert refused.code == 2
    assert "--out: area.yaml is there already\n" in refused.err
    assert mine.read_text(encoding="utf-8") == "mine"
    assert ran(capsys, "new", "--from", str(area), "--visit", "crop", "--force").code == 0
    assert load_mission(mine).name == "area"


def test_without_a_drawing_there_is_a_rectangle_to_begin_with(area: Path, capsys: pytest.CaptureFixture[str]) -> None:
    printed = ran(capsys, "new", "--extent", "60,40", "--name", "My field", "--out", "-")
    assert (printed.code, printed.err) == (0, "")
    assert 'name: "My field"\n' in printed.out
    assert "boundary: [[0, 0], [60, 0], [60, 40], [0, 40]]" in printed.out
    assert [*area.parent.iterdir()] == [area]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--from", "area.geojson", "--avoid", "penn"], "--avoid: nothing is drawn by the name of penn"),
        (["--from", "area.geojson", "--avoid", "Pen", "--home", "pen"], "--home: Pen is to be something else, too"),
        (["--from", "area.geojson", "--extent", "9,9"], "--extent: a drawing says itself how far it reaches"),
        (["--from", "none.kml"], "none.kml: cannot be read"),
        (["--from", "area.geojson", "--boundary", "crop", "--avoid", "Land"], "nothing is left to fly in"),
    ],
)
def test_what_cannot_be_is_said_and_nothing_is_written(
    options: list[str], words: str, area: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    refused = ran(capsys, "new", *options)
    assert (refused.code, refused.out) == (2, "")
    assert words in refused.err
    assert [*area.parent.iterdir()] == [area]


def test_what_does_not_plan_is_not_written(
    area: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    draft = Draft("name: nobody has this file\n", (), tube_guessed=False, remarks=())
    for error in (NoPlanError("the pond is in the way"), SpecError((Fault(7, 3, "start", "it is outside"),))):
        monkeypatch.setattr(new, "draft_that_plans", lambda *_, why=error: Trial(draft, None, why))
        refused = ran(capsys, "new", "--from", str(area))
        assert (refused.code, refused.out) == (error.exit_code, "")
        assert refused.err.startswith("it does not plan: nothing is written; ")
        assert str(error) in refused.err
        assert "7" not in refused.err
        assert [*area.parent.iterdir()] == [area]


def test_questions_are_asked_until_they_are_answered(
    area: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("taken.yaml").touch()
    answers = ["nothing.kml", "area.geojson", "penn", "pen", "", "crop, den", "-3", "40", "", "taken.yaml", "mine.yaml"]
    written = answered(monkeypatch, capsys, answers)
    assert written.code == 0
    for words in ("nothing.kml: cannot be read", "did you mean `Pen`?", "-3 is not positive", "taken.yaml is there"):
        assert words in written.err
    assert "There are: Land (not told), crop (survey), Pen (not told), den (not told)" in written.err
    spec = load_mission("mine.yaml")
    assert {region.name for region in spec.regions if region.kind is RegionKind.SURVEY} == {"crop", "den"}
    assert (spec.flight.altitude_m, spec.flight.speed_m_s) == (40.0, 5.0)
    assert area.is_file()


def test_an_option_is_an_answer(
    area: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    options = ["--from", str(area), "--visit", "crop", "--avoid", "Pen", "--home", "den", "--altitude", "20"]
    written = answered(monkeypatch, capsys, [""], *options, "--out", "mine.yaml")
    assert written.code == 0
    assert written.err.count("?") == 1
    assert "How fast, in m/s?" in written.err


def test_whoever_stops_answering_gets_no_mission(
    area: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    stopped = answered(monkeypatch, capsys, ["", "60,40"])
    assert (stopped.code, stopped.out) == (2, "")
    assert "not all questions were answered: nothing is written" in stopped.err
    assert [*area.parent.iterdir()] == [area]


def test_where_nothing_can_be_written_is_asked_again(
    area: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    answers = [str(area), "", "", "", "", "", "q" * 300, "a\0b", "no/such/folder.yaml", str(area.parent), "ok.yaml"]
    result = answered(monkeypatch, capsys, answers)
    assert result.code == 0
    assert sorted(file.name for file in area.parent.iterdir()) == ["area.geojson", "ok.yaml"]
    for words in ("cannot be written: ", "there is no folder no/such", "is there already"):
        assert words in result.err
    assert "Traceback" not in result.err
