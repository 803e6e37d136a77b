"""``flight.heading`` and ``limits.yaw_rate_deg_s``: what is read, what is refused, and that it is written as read."""

import json
import math

import pytest

from mission.errors import SpecError
from mission.spec.document import document_of
from mission.spec.heading import Heading, Look
from mission.spec.loader import parse_mission

FILE = """
domain: {boundary: [[0, 0], [60, 0], [60, 40], [0, 40]], mesh: {}}
regions:
  home: {kind: home, polygon: [[4, 4], [14, 4], [14, 12], [4, 12]]}
  tower: {kind: area, centre: [30, 20], radius_m: 2}
mission: {formula: F home}
start: {position_m: [9, 8]}
flight: {heading: HEADING}
limits: {yaw_rate_deg_s: 30}
"""


@pytest.mark.parametrize(
    ("written", "read"),
    [
        ("ahead", Heading(Look.AHEAD)),
        ("lanes", Heading(Look.LANES)),
        ("{fixed: -45}", Heading(Look.FIXED, fixed_rad=-math.pi / 4.0)),
        ("{toward: tower}", Heading(Look.TOWARD, region="tower")),
    ],
)
def test_what_is_read_is_written_and_read_again(written: str, read: Heading) -> None:
    spec = parse_mission(FILE.replace("HEADING", written).encode())
    assert spec.flight.heading == read
    assert spec.limits.yaw_rate_rad_s == math.radians(30.0)
    again = parse_mission(json.dumps(document_of(spec)).encode())
    assert again.flight == spec.flight
    assert again.limits.yaw_rate_rad_s == pytest.approx(spec.limits.yaw_rate_rad_s, rel=1e-15)


def test_without_one_there_is_none_and_the_yaw_rate_is_one_for_both_autopilots() -> None:
    spec = parse_mission(FILE.replace("flight: {heading: HEADING}\nlimits: {yaw_rate_deg_s: 30}\n", "").encode())
    assert spec.flight.heading is None
    assert spec.limits.yaw_rate_rad_s == math.pi / 4.0
    assert "heading" not in document_of(spec)["flight"]


@pytest.mark.parametrize(
    ("written", "path", "hint"),
    [
        ("{toward: towr}", "flight.heading.toward", "did you mean `tower`?"),
        ("{toward: zzzzzz}", "flight.heading.toward", "the regions are"),
        ("{fixed: 400}", "flight.heading.fixed", ""),
        ("{fixed: 10, toward: tower}", "flight.heading", ""),
        ("backwards", "flight.heading", "write for example ahead, lanes, {fixed: 90} or {toward: S1}"),
        ("toward tower", "flight.heading", "{toward: S1}"),
        ("90", "flight.heading", "{fixed: 90}"),
        ("lane", "flight.heading", "did you mean `lanes`?"),
    ],
)
def test_what_is_none_is_refused(written: str, path: str, hint: str) -> None:
    with pytest.raises(SpecError) as refused:
        parse_mission(FILE.replace("HEADING", written).encode())
    [fault] = refused.value.faults
    assert fault.path == path
    assert fault.line == 8
    assert hint in (fault.hint or "")
