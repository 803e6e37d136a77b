"""Mission files into values: the paper's, the defaults, and what can be wrong with a file as such."""

import dataclasses
import json
import math
from dataclasses import replace
from pathlib import Path

import pytest

from mission.errors import SpecError
from mission.geometry.geodesy import LatLon
from mission.spec.document import document_of
from mission.spec.loader import MOST_FAULTS, load_mission, parse_mission
from mission.spec.model import (
    CORRIDOR,
    BoundaryDomain,
    Extension,
    Flight,
    Limits,
    NodesDomain,
    Origin,
    PointShape,
    PolygonShape,
    Refinement,
    Region,
    RegionKind,
    Semantics,
    Smoothing,
    Start,
    TriangleShape,
)
from mission.spec.tube import Margins
from mission.spec.yaml_tree import MAX_BYTES

PAPER = Path(__file__).parents[3] / "missions" / "paper.yaml"

SMALL = """\
domain:
  boundary: [[0, 0], [60, 0], [60, 40], [0, 40]]
regions:
  Field: {kind: survey, polygon: [[10, 10], [20, 10], [20, 20], [10, 20]], loiter_s: 10}
mission: {formula: F Field}
start: {position_m: [5, 5]}
"""


def faults_of(text: str | bytes) -> list[tuple[int, int, str, str]]:
    with pytest.raises(SpecError) as caught:
        parse_mission(text.encode() if isinstance(text, str) else text)
    return [(fault.line, fault.column, fault.path, fault.message) for fault in caught.value.faults]


def test_the_papers_mission_has_the_papers_numbers() -> None:
    spec = load_mission(PAPER)
    assert isinstance(spec.domain, NodesDomain)
    assert len(spec.domain.nodes_m) == 11
    assert {region.name: region.shape for region in spec.regions} == {
        "R": TriangleShape((9, 6, 3)),
        "S1": TriangleShape((7, 4, 1)),
        "S2": TriangleShape((5, 8, 2)),
        "K1": TriangleShape((4, 10, 8)),
    }
    assert spec.formula == "F (S1 & F R) & G !K1"
    assert spec.semantics is Semantics.STANDARD
    assert spec.start == Start((11.0, 9.5), (0.02, 0.0))
    assert spec.smoothing == Smoothing(Extension.EVEN, 28)
    assert (spec.flight.speed_m_s, spec.flight.time_constant_s, spec.flight.final_stay_s) == (0.05, 5.0, 100.0)
    assert spec.flight.disturbance_m_s2 == 0.0


def test_what_a_file_leaves_out_has_defaults() -> None:
    spec = parse_mission(SMALL.encode(), "fields/north.yaml")
    assert (spec.name, spec.description, spec.run, spec.origin) == ("north", "", 0, None)
    assert spec.semantics is Semantics.STANDARD
    assert spec.domain == BoundaryDomain(
        PolygonShape(((0.0, 0.0), (60.0, 0.0), (60.0, 40.0), (0.0, 40.0))), Refinement(20.0, math.inf)
    )
    corners = ((10.0, 10.0), (20.0, 10.0), (20.0, 20.0), (10.0, 20.0))
    assert spec.regions == (Region("Field", RegionKind.SURVEY, PolygonShape(corners), 10.0),)
    assert spec.start == Start((5.0, 5.0), (0.0, 0.0))
    assert spec.flight == Flight(
        speed_m_s=5.0,
        altitude_m=10.0,
        final_stay_s=5.0,
        laps=2,
        time_constant_s=1.0,
        disturbance_m_s2=0.0,
        margins=Margins(estimator_m=0.1, following_m=0.4, correction_m=0.1, following_m_s=0.8),
    )
    assert spec.smoothing == CORRIDOR
    assert spec.limits == Limits(speed_m_s=5.0, acceleration_m_s2=2.5, tilt_rad=math.radians(25.0))


@pytest.mark.parametrize(
    ("flight", "tube_m", "tube_m_s", "correction_m"),
    [
        ("{}", 0.6, 0.8, 0.1),
        ("{disturbance_m_s2: 0}", 0.0, 0.8, 0.0),
        ("{disturbance_m_s2: 0.5, time_constant_s: 2}", 2.0, 2.0 / math.e + 0.8, 0.0),
        ("{tube: {}}", 0.6, 0.8, 0.1),
        ("{tube: {following_m: 0.2, correction_m: 0}}", 0.3, 0.8, 0.0),
        ("{disturbance_m_s2: 0.5, tube: {following_m_s: 0}}", 1.1, 1.0 / math.e, 0.1),
    ],
)
def test_the_tube_is_the_sum_of_its_causes(flight: str, tube_m: float, tube_m_s: float, correction_m: float) -> None:
    """A disturbance alone is all of the tube, as it always was; without it there are defaults."""
    spec = parse_mission((SMALL + f"flight: {flight}\n").encode())
    assert spec.flight.tube_m == pytest.approx(tube_m)
    assert spec.flight.tube_m_s == pytest.approx(tube_m_s)
    assert spec.flight.margins.correction_m == correction_m
    assert sum(share_m for _, share_m in spec.flight.tube_causes) == pytest.approx(tube_m)
    assert parse_mission(json.dumps(document_of(spec)).encode()) == spec


def test_what_a_file_gives_is_taken() -> None:
    text = SMALL.replace("{formula: F Field}", "{formula: G F Field, semantics: paper, run: 3, laps: 4}") + (
        "name: North\ndescription: |\n  Two\n  lines\norigin: {latitude_deg: 47.4, longitude_deg: -8.5}\n"
        "limits: {tilt_deg: 10}\nsmoothing: {extension: even, frequencies: 12}\n"
    )
    spec = parse_mission(text.encode())
    assert (spec.name, spec.description, spec.run) == ("North", "Two\nlines\n", 3)
    assert (spec.semantics, spec.flight.laps) == (Semantics.PAPER, 4)
    assert spec.origin == Origin(47.4, -8.5)
    assert isinstance(spec.origin, LatLon)
    assert spec.smoothing == Smoothing(Extension.EVEN, 12)
    assert spec.limits == Limits(speed_m_s=5.0, acceleration_m_s2=2.5, tilt_rad=math.radians(10.0))


def test_a_file_that_a_program_wrote_as_json_is_read() -> None:
    spec = parse_mission(SMALL.encode())
    document = document_of(replace(spec, start=Start((12.0, 12.0)), flight=replace(spec.flight, disturbance_m_s2=1e-5)))
    written = json.dumps(document)
    assert "1e-05" in written
    assert parse_mission(written.encode()) == replace(
        spec, start=Start((12.0, 12.0)), flight=replace(spec.flight, disturbance_m_s2=1e-5)
    )


def test_values_are_frozen() -> None:
    with pytest.raises(dataclasses.FrozenInstanceError):
        parse_mission(SMALL.encode()).name = "other"  # type: ignore[misc]


@pytest.mark.parametrize("text", [SMALL.replace("\n", "\r\n"), "\ufeff" + SMALL, "%YAML 1.1\n---\n" + SMALL])
def test_line_ends_byte_order_marks_and_directives_are_read(text: str) -> None:
    assert parse_mission(text.encode()) == parse_mission(SMALL.encode())


def test_anchors_are_read_and_faults_in_them_point_at_the_anchor() -> None:
    text = SMALL.replace("[5, 5]", "&here [5, 5]").replace(", loiter_s: 10}", "}\n  Pad: {kind: home, at: *here}")
    text = text.replace("  Pad: {kind: home, at: *here}\n", "").replace(
        "start: {position_m: &here [5, 5]}\n", "start: {position_m: &here [5, 5], velocity_m_s: *here}\n"
    )
    assert parse_mission(text.encode()).start.velocity_m_s == (5.0, 5.0)
    assert faults_of(text.replace("[5, 5]", "[5, north]")) == [
        (6, 31, "start.position_m[1]", "expected a number, found the text `north`"),
        (6, 31, "start.velocity_m_s[1]", "expected a number, found the text `north`"),
    ]


def test_regions_may_share_edges_and_lie_in_each_other() -> None:
    more = """\
  Plot: {kind: survey, polygon: [[12, 12], [18, 12], [18, 18], [12, 18]]}
  Next: {kind: restricted, polygon: [[20, 10], [30, 10], [30, 20], [20, 20]]}
  Spot: {kind: home, at: [2, 39]}
"""
    spec = parse_mission(SMALL.replace("mission:", more + "mission:").encode())
    assert spec.regions[-1] == Region("Spot", RegionKind.HOME, PointShape((2.0, 39.0)))


def test_faults_in_a_folded_formula_point_at_its_begin() -> None:
    text = SMALL.replace("{formula: F Field}", "\n  formula: >\n    F Field\n    & F Feild\n")
    assert faults_of(text)[0][:3] == (6, 12, "mission.formula")


@pytest.mark.parametrize(
    ("formula", "line", "column"),
    [
        ('"F Feild"', 5, 23),
        ("'F Field & Feild'", 5, 31),
        ('"F \\x46eild"', 5, 20),
        ("F Feild", 5, 22),
    ],
)
def test_faults_in_a_formula_point_at_the_word(formula: str, line: int, column: int) -> None:
    ((found_line, found_column, path, message),) = faults_of(SMALL.replace("F Field", formula))
    assert (found_line, found_column, path) == (line, column, "mission.formula")
    assert "`Feild`, which is no region" in message


def test_a_region_that_is_named_badly_does_not_change_how_the_formula_is_read() -> None:
    text = SMALL.replace("  Field:", "  GF: {kind: survey, at: [50, 30]}\n  Field:").replace("F Field", "GF Field")
    assert [fault[2] for fault in faults_of(text)] == ["regions.GF"]


def test_a_missing_file_a_directory_and_a_null_are_told_apart(tmp_path: Path) -> None:
    for path, words in ((tmp_path / "no.yaml", "there is no such file"), (tmp_path, "is a directory")):
        with pytest.raises(SpecError, match=words) as caught:
            load_mission(path)
        assert caught.value.source == str(path)
    with pytest.raises(SpecError, match="cannot be read"):
        load_mission("a\0b")
    with pytest.raises(SpecError, match="cannot be read"):
        load_mission(tmp_path / ("x" * 5000))


def test_a_file_that_may_not_be_read_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # By permission bits this could not be shown to the superuser, who reads everything.
    def refused(*_: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refused)
    with pytest.raises(SpecError, match="cannot be read: Permission denied"):
        load_mission(tmp_path / "mine.yaml")


def test_a_file_that_is_too_large_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "large.yaml"
    path.write_bytes(b"#" * (MAX_BYTES + 1))
    with pytest.raises(SpecError, match=f"larger than {MAX_BYTES} bytes"):
        load_mission(path)


def test_a_flood_of_faults_is_counted() -> None:
    extra = "".join(f"x{i}: 1\n" for i in range(5 * MOST_FAULTS))
    found = faults_of(SMALL + extra)
    assert len(found) == MOST_FAULTS + 1
    assert found[0] == (0, 0, "", f"the file has {5 * MOST_FAULTS} faults; the first {MOST_FAULTS} are listed")


def test_more_errors_than_the_validator_is_asked_for_stop_the_check() -> None:
    nodes = ", ".join("[x, x]" for _ in range(2000))
    text = SMALL.replace("boundary: [[0, 0], [60, 0], [60, 40], [0, 40]]", f"nodes: [{nodes}]")
    assert [fault[2] for fault in faults_of(text)[:2]] == ["", "domain.nodes[0][0]"]


@pytest.mark.parametrize(
    "drawing",
    [
        b'<?xml version="1.0"?>\n<kml xmlns="http://www.opengis.net/kml/2.2"></kml>\n',
        b'{"type": "FeatureCollection", "features": []}',
        b'{"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [1, 1], [0, 0]]]}',
        b'{"fileType": "Plan", "mission": {"items": []}, "version": 1}',
    ],
)
def test_a_drawing_is_shown_its_way(drawing: bytes) -> None:
    with pytest.raises(SpecError) as caught:
        parse_mission(drawing)
    (fault,) = caught.value.faults
    assert "`mission new --from FILE`" in fault.hint


def test_utf16_is_refused_with_its_place() -> None:
    assert faults_of(SMALL.encode("utf-16")) == [(1, 1, "", "the byte 0xff is not UTF-8")]


@pytest.mark.parametrize("text", ["%YAML " + "9" * 5000 + ".1\n---\na: b\n", 'name: "\\UFFFFFFFF"\n', "%TAG ! \n--- a"])
def test_directives_and_escapes_that_upset_the_parser_are_faults(text: str) -> None:
    assert len(faults_of(text)) == 1


@pytest.mark.parametrize(
    ("section", "key", "place"),
    [
        ("mission", "tasks", "at the top of the file"),
        ("mission", "start", "at the top of the file"),
        ("flight", "formula", "in `mission`"),
        ("", "altitude_m", "in `flight`"),
    ],
)
def test_a_key_in_the_wrong_place_is_told_where_it_belongs(section: str, key: str, place: str) -> None:
    written = f"{section}: {{{key}: 3}}" if section else f"{key}: 3"
    with pytest.raises(SpecError) as caught:
        parse_mission(written.encode())
    fault = next(fault for fault in caught.value.faults if fault.message == f"unknown key `{key}`")
    assert fault.hint == f"it belongs {place}"
