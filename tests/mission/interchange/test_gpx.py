"""GPX as receivers and map programs write it."""

import pytest

from mission.errors import SpecError
from mission.interchange.features import Polygon, Role, Spot
from mission.interchange.reading import read_drawing

HEAD = '<?xml version="1.0"?>\n<gpx version="1.1" xmlns="http://www.topografix.com/GPX/1/1">\n'


def way(points: str, kind: str = "trk", name: str = "") -> str:
    places = [place.split(",") for place in points.split()]
    inner = "".join(f'<{kind}pt lat="{lat}" lon="{lon}"><ele>3</ele></{kind}pt>' for lon, lat in places)
    segment = f"<trkseg>{inner}</trkseg>" if kind == "trk" else inner
    return f"<{kind}><name>{name}</name>{segment}</{kind}>\n"


def test_marks_are_places_and_what_was_walked_round_is_an_outline() -> None:
    # The last fix is some metres beside the first one.
    walked = way("8,47 8.001,47 8.001,47.001 8,47.001 8.00001,47.00002", name="north field")
    drawing = read_drawing(
        f'{HEAD}<wpt lat="47.1" lon="8.1"><name>home</name></wpt>\n{walked}</gpx>'.encode(), "farm.gpx"
    )
    home, field = drawing.features
    assert (home.role, home.shapes) == (Role.HOME, (Spot((8.1, 47.1)),))
    assert (field.name, field.role) == ("north field", Role.SURVEY)
    (outline,) = field.shapes
    assert isinstance(outline, Polygon)
    assert outline.outline[:4] == ((8.0, 47.0), (8.001, 47.0), (8.001, 47.001), (8.0, 47.001))
    assert drawing.route == ()


@pytest.mark.parametrize("kind", ["trk", "rte"])
def test_a_way_that_goes_round_nothing_is_a_route(kind: str) -> None:
    there = "8,47 8.001,47 8.001,47.001"
    crossed = "8,47 8.001,47.001 8.001,47 8,47.001 8,47"
    for points in (there, crossed):
        drawing = read_drawing(f"{HEAD}{way(points, kind)}</gpx>".encode())
        assert drawing.features == ()
        assert drawing.route == tuple(tuple(map(float, each.split(","))) for each in points.split())
    drawing = read_drawing(f"{HEAD}{way(there, kind)}{way(there, kind, 'back')}</gpx>".encode())
    assert drawing.remarks == ("'back' is left out: it bounds nothing, and another one is taken for the flight",)


def test_a_place_that_is_none_is_told_with_its_line() -> None:
    with pytest.raises(SpecError) as refused:
        read_drawing(f'{HEAD}<wpt lat="x" lon="8.1"/></gpx>'.encode())
    (fault,) = refused.value.faults
    assert (fault.line, fault.message) == (3, "<wpt> has no latitude and longitude")
    with pytest.raises(SpecError, match="the file draws nothing"):
        read_drawing(f"{HEAD}</gpx>".encode())
