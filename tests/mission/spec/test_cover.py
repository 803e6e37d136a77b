"""``cover`` of a region: what is read, what is refused, and that it is written as it was read."""

import pytest

from mission.errors import SpecError
from mission.spec.covers import cover_data, cover_of
from mission.spec.loader import parse_mission

FILE = """
domain: {boundary: [[0, 0], [60, 0], [60, 40], [0, 40]], mesh: {}}
regions:
  home: {kind: home, polygon: [[4, 4], [14, 4], [14, 12], [4, 12]]}
  field:
    kind: KIND
    polygon: [[26, 4], [50, 4], [50, 30], [26, 30]]
    cover: COVER
mission: {formula: F home}
start: {position_m: [9, 8]}
"""


def faults(cover: str, kind: str = "survey") -> list[tuple[int, str, str]]:
    with pytest.raises(SpecError) as refused:
        parse_mission(FILE.replace("COVER", cover).replace("KIND", kind).encode())
    return [(fault.line, fault.path, fault.message) for fault in refused.value.faults]


@pytest.mark.parametrize(
    "data",
    [
        {"spacing_m": 7.5},
        {"spacing_m": 7.5, "heading_deg": 30, "share": 0.9},
        {"camera": {"field_of_view_deg": [73.7, 53.1], "overlap": 0.7, "sidelap": 0.6}},
        {"camera": {"sensor_mm": [13.2, 8.8], "focal_length_mm": 8.8}, "heading_deg": "auto"},
    ],
)
def test_what_is_read_is_written_and_read_again(data: dict[str, object]) -> None:
    cover = cover_of(data)
    assert cover_of(cover_data(cover)) == cover


@pytest.mark.parametrize(
    ("cover", "path", "words"),
    [
        ("{heading_deg: 10}", "regions.field.cover", "one of spacing_m or camera is missing"),
        ("{spacing_m: 8, camera: {field_of_view_deg: [60, 40]}}", "regions.field.cover", "exclude each other"),
        ("{spacing_m: 0.1}", "regions.field.cover.spacing_m", "0.1 is less than 0.5"),
        ("{spacing: 8}", "regions.field.cover.spacing", "unknown key `spacing`"),
        ("{camera: {sensor_mm: [13, 8]}}", "regions.field.cover.camera.sensor_mm", "goes with `focal_length_mm` only"),
        (
            "{camera: {field_of_view_deg: [0, 40]}}",
            "regions.field.cover.camera.field_of_view_deg[0]",
            "0 is less than 1",
        ),
        ("{spacing_m: 8, heading_deg: north}", "regions.field.cover.heading_deg", "expected auto or a number"),
        ("{spacing_m: 8, share: 98}", "regions.field.cover.share", "98 is more than 1"),
    ],
)
def test_a_fault_is_told_where_it_is(cover: str, path: str, words: str) -> None:
    found = faults(cover)
    assert [(line, where) for line, where, message in found if words in message] == [(8, path)], found


@pytest.mark.parametrize("kind", ["restricted", "home"])
def test_only_regions_to_survey_are_covered(kind: str) -> None:
    assert faults("{spacing_m: 8}", kind) == [(8, "regions.field.cover", f"a region of kind {kind} is not covered")]
