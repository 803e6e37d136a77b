"""Degrees and projected coordinates: one fault each, and its cure ends in a sound file."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from mission.errors import SpecError
from mission.geometry.geodesy import LatLon, enu_offset_m
from mission.plan import plan_mission
from mission.spec.loader import parse_mission
from tests.support.proofs import untrue

BROKEN = Path(__file__).parents[3] / "missions" / "broken"
PAIR = re.compile(r"\[(-?[0-9.]+), (-?[0-9.]+)\]")


def hint_of(text: str) -> str:
    with pytest.raises(SpecError) as caught:
        parse_mission(text.encode())
    (fault,) = caught.value.faults
    return fault.hint


def converted(text: str, change: Callable[[float, float], tuple[float, float]]) -> str:
    return PAIR.sub(lambda found: "[{:.9f}, {:.9f}]".format(*change(float(found[1]), float(found[2]))), text)


def test_projected_coordinates_less_what_the_hint_says_are_sound() -> None:
    text = (BROKEN / "projected_coordinates.yaml").read_text(encoding="utf-8")
    east, north = map(float, PAIR.findall(hint_of(text))[0])
    assert parse_mission(converted(text, lambda x, y: (x - east, y - north)).encode()).start.position_m == (
        12.41,
        12.67,
    )


@pytest.mark.parametrize("place", [(8.54, 47.39), (-179.9995, -16.5), (179.9999, 0.0), (-58.4, -34.6)])
def test_degrees_with_the_key_that_the_hint_names_are_sound(place: tuple[float, float]) -> None:
    text = converted(
        (BROKEN / "degrees_as_metres.yaml").read_text(encoding="utf-8"),
        lambda x, y: (place[0] + (x - 8.54) / 20, place[1] + (y - 47.39) / 20),
    )
    hint = hint_of(text)
    first = PAIR.findall(hint)[0]
    assert (float(first[1]), float(first[0])) == place
    (key,) = re.findall("`(corners: .*?)`", hint)
    degrees = converted(text, lambda x, y: (y, (x + 180.0) % 360.0 - 180.0)).replace("domain:\n", f"domain:\n  {key}\n")
    spec = parse_mission(degrees.encode())
    start = LatLon(place[1] + 0.0002 / 20, (place[0] + 0.0002 / 20 + 180.0) % 360.0 - 180.0)
    assert spec.origin is not None
    assert spec.start.position_m == pytest.approx(enu_offset_m(spec.origin, start), abs=0.01)


def test_a_small_domain_that_is_not_in_degrees_is_refused_too() -> None:
    text = (BROKEN / "degrees_as_metres.yaml").read_text(encoding="utf-8")
    assert hint_of(converted(text, lambda x, y: (x + 500.0, y))) == "write all points in metres, x east and y north"


def test_one_point_far_away_is_a_slip_of_its_own() -> None:
    text = (BROKEN / "projected_coordinates.yaml").read_text(encoding="utf-8").replace("origin", "# origin")
    text = converted(text, lambda x, y: (x - 500123, y - 5412345)).replace("[0.410000000", "[5412345.0", 1)
    assert "correct the point that is far off" in hint_of(text)


def test_eastings_and_northings_are_metres_like_any_other_and_lose_nothing() -> None:
    text = (BROKEN / "projected_coordinates.yaml").read_text(encoding="utf-8").replace("origin", "# origin")
    far, near = (
        plan_mission(parse_mission(each.encode()))
        for each in (text, converted(text, lambda x, y: (x - 500123.41, y - 5412345.67)))
    )
    assert not untrue(far)
    assert far.partition.size == near.partition.size
    for name in ("a", "home", "k"):
        areas = [plan.partition.areas_m2[plan.labelling.triangles_of(name)].sum() for plan in (far, near)]
        assert areas[0] == pytest.approx(areas[1], rel=1e-7)
    assert far.certificate.clearance_m == pytest.approx(near.certificate.clearance_m, abs=0.01)
