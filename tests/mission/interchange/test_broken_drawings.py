"""Files that are broken, hostile or too large: refused with the place and the reason, quickly."""

import json
import zipfile
from io import BytesIO

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.errors import Fault, SpecError
from mission.interchange import reading
from mission.interchange.reading import MAX_BYTES, read_drawing
from tests.mission.interchange.test_kml import GOOGLE_EARTH, archive
from tests.mission.interchange.test_plan_file import CAMERA, SIMPLE
from tests.mission.interchange.test_waypoints import MAVPROXY_FENCE, MISSION_PLANNER, OLD_FENCE


def refusal(content: bytes | str) -> Fault:
    with pytest.raises(SpecError) as refused:
        read_drawing(content.encode() if isinstance(content, str) else content)
    (fault,) = refused.value.faults
    return fault


def collection(coordinates: object, kind: str = "Polygon") -> str:
    geometry = {"type": kind, "coordinates": coordinates}
    return json.dumps({"type": "FeatureCollection", "features": [{"type": "Feature", "geometry": geometry}]})


@pytest.mark.parametrize(
    ("content", "place", "message"),
    [
        ("", (0, ""), "the file is of no format that is known"),
        ("# only a comment\n", (0, ""), "the file is of no format that is known"),
        ('{"type": "FeatureCollection",\n "features": [', (2, ""), "this is not JSON: Expecting value"),
        ('{"type": "Topology"}', (0, "geometry"), "`Topology` is no kind of geometry"),
        ('{"type": 5}', (0, ""), "this JSON is neither GeoJSON nor a QGroundControl plan"),
        ("[" * 100_000, (0, ""), "lists and objects are nested too deeply"),
        ('{"type": "Point", "coordinates": [NaN, 1]}', (0, ""), "this is not JSON: NaN is no number"),
        ('{"type": "FeatureCollection"}', (0, ""), "`features` is missing"),
        ('{"type": "FeatureCollection", "features": []}', (0, ""), "the file draws nothing"),
        (
            collection([[[7, 51], [7, "x"], [7.1, 51]]]),
            (0, "features[0].geometry.coordinates[0][1]"),
            'expected a position [longitude, latitude], found [7, "x"]',
        ),
        (
            collection([[[7, 51], [7.1, 51], [7, 51]]]),
            (0, "features[0].geometry.coordinates"),
            "the ring has 2 different corners, a polygon has at least 3",
        ),
        (collection([7, 51]), (0, "features[0].geometry.coordinates[0]"), "expected a list of positions, found 7"),
        (GOOGLE_EARTH[:900], (23, ""), "this is not well-formed XML"),
        (GOOGLE_EARTH.replace("51.892,0", "51.892°"), (40, ""), "'6.541,51.892°' is no position"),
        (GOOGLE_EARTH.replace("6.5405,51.8895", "6.5405,518.895"), (0, ""), "longitude 6.5405, latitude 518.895"),
        ("<svg/>", (1, ""), "the outermost element is <svg>, not <kml> or <gpx>, and no other XML is read"),
        ("<kml>" + "<Folder>" * 100, (1, ""), "the file nests too deeply"),
        (MISSION_PLANNER.replace("149.16400000", "149.164x"), (5, ""), "expected numbers, found '3 0 3 16"),
        (MISSION_PLANNER.replace("\t25.000000\t1", ""), (3, ""), "an item has 12 columns, this one has 10"),
        (
            MAVPROXY_FENCE.replace("5001\t3.0", "5001\t4.0"),
            (2, ""),
            "the polygon says that it has 4 corners, 3 follow",
        ),
        (OLD_FENCE.replace("149.154434", ""), (3, ""), "expected numbers, found '-35.359295'"),
        (OLD_FENCE.replace("149.154434", "249.154434"), (3, ""), "latitude -35.359295 and longitude 249.154434 are no"),
        ("1 2\n3 4\n", (2, ""), "a fence has a return point and at least three corners"),
        ("outer_m: [[0, 0], [1, 0]\nholes_m: []", (2, ""), "this is not YAML"),
        ("outer_m: &a [[0, 0], [1, 0], [1, 1]]\nholes_m: [*a]", (0, ""), "this is not YAML: aliases are not read"),
        (b"PK\x03\x04" + b"\0" * 100, (0, ""), "this is no KMZ archive"),
        (b"\xff\xfe\x00", (1, ""), "this is not "),
    ],
)
def test_the_place_and_the_reason_are_told(content: bytes | str, place: tuple[int, str], message: str) -> None:
    fault = refusal(content)
    assert fault.message.startswith(message)
    assert (fault.line, fault.path) == place


def test_a_plan_says_where_in_it() -> None:
    item = {"type": "ComplexItem", "complexItemType": "survey", "TransectStyleComplexItem": {"CameraCalc": CAMERA}}
    waypoint = SIMPLE | {"command": 16, "params": [0, 0, 0, None, None, 8.1, 40]}
    for faulty, path in (
        (item | {"polygon": [[1, 2], [3]]}, "mission.items[0].polygon[1]"),
        (waypoint, "mission.items[0].params"),
        (item, "mission.items[0]"),
    ):
        assert refusal(json.dumps({"fileType": "Plan", "mission": {"items": [faulty]}})).path == path


LAUGHS = """<?xml version="1.0"?>
<!DOCTYPE kml [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;"><!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;">]>
<kml><Placemark><name>&c;</name></Placemark></kml>"""
OUTSIDE = """<?xml version="1.0"?>
<!DOCTYPE kml [<!ENTITY secret SYSTEM "file:///etc/passwd">]>
<kml><Placemark><name>&secret;</name></Placemark></kml>"""
ELSEWHERE = """<?xml version="1.0"?>
<!DOCTYPE kml SYSTEM "http://example.org/kml.dtd">
<kml><Placemark><name>x</name></Placemark></kml>"""


@pytest.mark.parametrize("text", [LAUGHS, OUTSIDE, ELSEWHERE])
def test_entities_and_what_lies_outside_are_refused(text: str) -> None:
    fault = refusal(text)
    assert fault.message.startswith("the file declares what XML must not load or repeat")
    assert fault.line == 2


def test_a_small_archive_of_a_large_text_is_refused_before_it_is_unpacked() -> None:
    bomb = archive({"doc.kml": "<kml>" + " " * (MAX_BYTES + 1)})
    assert len(bomb) < 100_000
    assert refusal(bomb).message == f"doc.kml in the archive is larger than {MAX_BYTES} bytes"


def test_archives_without_a_text_or_cut_off_are_refused() -> None:
    assert refusal(archive({"image.png": "x"})).message == "the archive has no .kml file in it"
    assert refusal(archive({"doc.kml": GOOGLE_EARTH})[:-40]).message.startswith("this is no KMZ archive")


def test_what_is_too_large_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reading, "MOST_POSITIONS", 1000)
    assert refusal(b" " * (MAX_BYTES + 1)).message == f"the file is larger than {MAX_BYTES} bytes"
    many = [[7 + i * 1e-9, 51] for i in range(1001)]
    assert refusal(collection(many, "LineString")).message == "the file has 1001 positions, more than 1000"


def _kmz() -> bytes:
    content = BytesIO()
    with zipfile.ZipFile(content, "w") as written:
        written.writestr(zipfile.ZipInfo("doc.kml"), GOOGLE_EARTH)
    return content.getvalue()


@given(
    st.sampled_from(
        [
            GOOGLE_EARTH.encode(),
            MISSION_PLANNER.encode(),
            MAVPROXY_FENCE.encode(),
            OLD_FENCE.encode(),
            collection([[[7, 51], [7.1, 51], [7, 51.1]]]).encode(),
            _kmz(),
        ]
    ),
    st.integers(0, 2000),
    st.binary(max_size=4),
    st.integers(0, 8),
)
def test_whatever_is_in_a_file_it_is_read_or_refused(content: bytes, at: int, inserted: bytes, cut: int) -> None:
    at = at % len(content)
    try:
        drawing = read_drawing(content[:at] + inserted + content[at + cut :])
    except SpecError as error:
        assert error.faults[0].message  # noqa: PT017 - either is right
    else:
        assert drawing.features or drawing.route
