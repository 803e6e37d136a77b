"""Missions whose corners are latitudes and longitudes."""

import re
from collections.abc import Callable

import numpy as np
import pytest

from mission.errors import Fault, SpecError
from mission.geometry.geodesy import LatLon, enu_offset_m, place_at_offset
from mission.geometry.places import enu_offsets_m
from mission.plan import plan_from_json, plan_mission, plan_to_json
from mission.spec.loader import parse_mission
from mission.spec.model import BoundaryDomain

METRES = """\
origin: {latitude_deg: 51.896772, longitude_deg: 6.54038}
domain:
  boundary: [[0, 0], [80, 0], [80, 60], [0, 60]]
  mesh: {}
regions:
  home: {kind: home, polygon: [[5, 5], [20, 5], [20, 20], [5, 20]]}
  field: {kind: survey, polygon: [[55, 35], [70, 35], [70, 50], [55, 50]]}
  barn: {kind: restricted, polygon: [[32, 24], [44, 24], [44, 36], [32, 36]]}
mission:
  formula: F (field & F home) & G !barn
start:
  position_m: [12, 12]
"""
PAIR = re.compile(r"\[(-?[0-9.]+), (-?[0-9.]+)\]")


def degrees(origin: LatLon, text: str = METRES) -> str:
    def place(found: re.Match[str]) -> str:
        there = place_at_offset(origin, float(found[1]), float(found[2]))
        return f"[{there.latitude_deg!r}, {there.longitude_deg!r}]"

    text = text.replace("  mesh: {}\n", "  mesh: {}\n  corners: latitude_longitude\n")
    text = text.replace("51.896772", repr(origin.latitude_deg)).replace("6.54038", repr(origin.longitude_deg))
    return PAIR.sub(place, text)


def faults(text: str) -> tuple[Fault, ...]:
    with pytest.raises(SpecError) as refused:
        parse_mission(text.encode())
    return refused.value.faults


@pytest.mark.parametrize(
    "origin", [LatLon(51.896772, 6.54038), LatLon(-16.5, 179.9997), LatLon(-16.5, -179.9999), LatLon(78.2, 15.6)]
)
def test_they_are_the_same_places_as_in_metres(origin: LatLon) -> None:
    spec = parse_mission(degrees(origin).encode())
    assert isinstance(spec.domain, BoundaryDomain)
    here = parse_mission(METRES.encode())
    assert spec.start.position_m == pytest.approx(here.start.position_m, abs=1e-8)
    for mine, other in zip(spec.regions, here.regions, strict=True):
        assert np.allclose(np.array(mine.shape.corners_m), np.array(other.shape.corners_m), atol=1e-8)  # type: ignore[union-attr]
    assert spec.origin
    assert (spec.origin.latitude_deg, spec.origin.longitude_deg) == (origin.latitude_deg, origin.longitude_deg)


def test_without_an_origin_the_middle_of_the_boundary_is_one_also_across_the_antimeridian() -> None:
    there = LatLon(-16.5, 179.9997)
    text = degrees(there)
    spec = parse_mission(text.partition("\n")[2].encode())
    assert spec.origin is not None
    middle = enu_offset_m(there, spec.origin)
    assert middle == pytest.approx((40.0, 30.0), abs=0.02)
    assert np.add(middle, spec.start.position_m) == pytest.approx((12.0, 12.0), abs=0.01)


def test_a_plan_of_it_is_read_back_in_metres() -> None:
    plan = plan_mission(parse_mission(degrees(LatLon(51.896772, 6.54038)).encode()))
    assert plan_from_json(plan_to_json(plan)).spec == plan.spec


@pytest.mark.parametrize(
    ("change", "line", "message", "hint"),
    [
        (
            lambda text: text.replace("position_m: [51.", "position_m: [52."),
            13,
            "is 111 km from the origin; the plane of a mission ends at 50 km",
            "move the origin there, or make several missions of it",
        ),
        (
            lambda text: PAIR.sub(lambda found: f"[{found[2]}, {found[1]}]", text),
            3,
            "km from the origin; the plane of a mission ends at 50 km",
            "write the latitude first, [51.89",
        ),
        (
            lambda text: PAIR.sub(lambda found: f"[{float(found[2]) + 100.0}, {found[1]}]", text),
            3,
            "is no latitude, -89.9 to 89.9, and longitude",
            "write the latitude first, [51.89",
        ),
    ],
)
def test_what_cannot_be_there_is_told_where_it_stands(
    change: Callable[[str], str], line: int, message: str, hint: str
) -> None:
    text = change(degrees(LatLon(51.896772, 6.54038)))
    (*_, fault) = [each for each in faults(text) if each.line == line]
    assert message in fault.message
    assert fault.hint.startswith(hint)


@pytest.mark.parametrize(
    ("start", "words"), [((12, -3), "lies outside the domain"), ((40, 30), "lies in the restricted")]
)
def test_a_start_is_told_as_the_file_has_it(start: tuple[float, float], words: str) -> None:
    origin = LatLon(51.896772, 6.54038)
    there = place_at_offset(origin, *start)
    (fault,) = faults(degrees(origin, METRES.replace("position_m: [12, 12]", f"position_m: [{start[0]}, {start[1]}]")))
    assert fault.message.startswith(f"the start [{there.latitude_deg:.7f}".rstrip("0"))
    assert f"{there.longitude_deg:.7f}".rstrip("0") in fault.message
    assert words in fault.message


def test_many_offsets_are_the_same_as_each_alone() -> None:
    origin = LatLon(51.9, 6.5)
    places = np.array([[51.9, 6.5], [51.95, 6.4], [52.3, 7.0]])
    offsets, apart = enu_offsets_m(origin, places)
    for place, offset, distance in zip(places, offsets, apart, strict=True):
        alone = enu_offset_m(origin, LatLon(*map(float, place)))
        assert offset == pytest.approx(alone, abs=1e-8)
        assert distance == pytest.approx(float(np.hypot(*alone)), rel=1e-4, abs=1e-6)


@pytest.mark.parametrize("point", ["[1" + "0" * 400 + ", 2]", "[.inf, 2]", "[51, [1, 2]]", "[51]", "51", "{a: [1, 2]}"])
@pytest.mark.parametrize("key", ["position_m: ", "boundary: "])
def test_whatever_stands_for_a_point_is_a_fault_of_its_own(key: str, point: str) -> None:
    text = re.sub(f"{key}.*", lambda _: key + point, degrees(LatLon(51.896772, 6.54038)))
    assert faults(text)
