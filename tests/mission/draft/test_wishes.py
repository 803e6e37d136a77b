"""What is wanted of a drawing goes before what the drawing tells."""

import pytest

from mission.draft.wishes import Wishes, names_in, plain_field, wished
from mission.errors import SpecError
from mission.interchange.features import Drawing, Feature, Polygon, Role, Spot


def square(x: float, y: float, size: float) -> Polygon:
    return Polygon(((x, y), (x + size, y), (x + size, y + size), (x, y + size)))


def drawing(*features: tuple[str, Polygon | Spot, Role | None]) -> list[tuple[str, Drawing]]:
    drawn = tuple(Feature(name, (shape,), role) for name, shape, role in features)
    return [("file", Drawing("GeoJSON", drawn, in_degrees=False))]


LAND, FIELD, PEN = (
    ("land", square(0, 0, 100), None),
    ("field", square(10, 10, 20), None),
    ("pen", square(50, 50, 9), None),
)


def roles(drawings: list[tuple[str, Drawing]], **wishes: tuple[str, ...]) -> dict[str, Role | None]:
    return names_in(wished(drawings, Wishes(wishes)))


@pytest.mark.parametrize(
    ("drawn", "expected"),
    [
        ((LAND, FIELD, PEN), {"land": None, "field": Role.SURVEY, "pen": Role.RESTRICTED}),
        ((FIELD, PEN), {"field": Role.SURVEY, "pen": Role.RESTRICTED}),
        (
            (("land", square(0, 0, 100), Role.BOUNDARY), FIELD, PEN),
            {"land": Role.BOUNDARY, "field": Role.SURVEY, "pen": Role.RESTRICTED},
        ),
        (
            (("plot", square(0, 0, 30), None), ("spot", Spot((90.0, 90.0)), Role.AREA), PEN),
            {"plot": Role.SURVEY, "spot": Role.SURVEY, "pen": Role.RESTRICTED},
        ),
    ],
)
def test_all_is_what_is_for_nothing_else_and_does_not_hold_the_rest(
    drawn: tuple[tuple[str, Polygon | Spot, Role | None], ...], expected: dict[str, Role | None]
) -> None:
    assert roles(drawing(*drawn), visit=("all",), avoid=("pen",)) == expected


def test_a_drawing_of_one_thing_is_visited() -> None:
    assert roles(drawing(FIELD), visit=("all",)) == {"field": Role.SURVEY}


def test_a_wish_goes_before_what_the_file_tells_whatever_its_capitals() -> None:
    told = drawing(LAND, ("field", square(10, 10, 20), Role.RESTRICTED))
    assert roles(told, visit=("FIELD",), boundary=("Land",)) == {"land": Role.BOUNDARY, "field": Role.SURVEY}
    assert roles(told) == {"land": None, "field": Role.RESTRICTED}


def test_what_has_no_name_goes_by_that_of_its_file() -> None:
    assert roles(drawing(("", square(0, 0, 9), None)), visit=("file",)) == {"file": Role.SURVEY}


def test_each_name_that_cannot_be_is_told() -> None:
    with pytest.raises(SpecError) as refused:
        roles(drawing(LAND, FIELD), visit=("feld", "land"), avoid=("land", "nothing"))
    assert [(fault.path, fault.message) for fault in refused.value.faults] == [
        ("--avoid", "land is to be something else, too"),
        ("--avoid", "nothing is drawn by the name of nothing"),
        ("--visit", "nothing is drawn by the name of feld"),
    ]


def test_figures_go_before_those_of_the_file() -> None:
    ((_, drawn),) = wished([("plain", plain_field(60.0, 40.0))], Wishes({}, altitude_m=25.0))
    assert (drawn.altitude_m, drawn.speed_m_s) == (25.0, None)
    assert names_in([("plain", drawn)]) == {"boundary": Role.BOUNDARY, "field": Role.SURVEY}
