"""Mission files drafted from drawings: each is sound, says what it assumes, and plans."""

from collections.abc import Sequence

import numpy as np
import pytest
import shapely
import yaml
from hypothesis import given
from hypothesis import strategies as st

from mission.draft.drafting import draft_mission
from mission.errors import SpecError
from mission.interchange.features import Drawing, Feature, Lanes, Line, Point, Polygon, Role, Shape, Spot
from mission.plan import FlightPlan, plan_mission
from mission.spec.loader import parse_mission
from mission.spec.model import BoundaryDomain, CircleShape, MissionSpec, PolygonShape, RegionKind
from tests.support.drawn_cases import tried

FIELD = (
    "6.541425 51.896772 6.54118 51.896812 6.540614 51.897072 6.54053 51.897233 6.540431 51.89746 6.540385 51.897588 "
    "6.54038 51.897654 6.540445 51.897664 6.540691 51.897666 6.541767 51.897766 6.541914 51.897501 6.541664 51.897459 "
    "6.541686 51.897406 6.541203 51.897336 6.541339 51.896989 6.542103 51.89709 6.542083 51.897137 6.542269 51.897175 "
    "6.542343 51.896851 6.541932 51.8968 6.541678 51.896774"
)
LOT = "-122.105915 47.659653 -122.104459 47.660026 -122.104734 47.660342 -122.106147 47.659981"
FENCE = "-77.497359085 38.750760863 -77.497092857 38.750940244 -77.496865086 38.750731327 -77.497132359 38.750551952"
EXCLUDED = "-77.497132359 38.750551952 -77.496865086 38.750731327 -77.496979 38.7508358 -77.4972457 38.7506564"


def points(text: str) -> tuple[Point, ...]:
    numbers = list(map(float, text.split()))
    return tuple(zip(numbers[::2], numbers[1::2], strict=True))


def square(west: float, south: float, side: float) -> tuple[Point, ...]:
    return ((west, south), (west + side, south), (west + side, south + side), (west, south + side))


def feature(name: str, shape: Shape, role: Role | None = None) -> Feature:
    return Feature(name, (shape,), role, "told by its name" if role else "")


def drafted(*features: Feature, in_degrees: bool = False) -> str:
    return draft_mission([("drawn", Drawing("GeoJSON", features, in_degrees=in_degrees))], "drawn").text


def mission(text: str) -> MissionSpec:
    return parse_mission(text.encode())


def planned(text: str) -> FlightPlan:
    return plan_mission(mission(text))


def visited(plan: FlightPlan) -> set[str]:
    return {name for triangle in plan.run.prefix for name in plan.labelling.letters[plan.labelling.letter_of[triangle]]}


def kinds(text: str) -> dict[str, str]:
    """Kinds of the regions as they are written: meshing all of them would take its time."""
    return {name: region["kind"] for name, region in yaml.safe_load(text)["regions"].items()}


def test_a_field_is_visited_from_a_home_beside_it() -> None:
    text = drafted(feature("field", Polygon(points(FIELD)), Role.SURVEY), in_degrees=True)
    plan = planned(text)
    assert kinds(text) == {"home": "home", "field": "survey"}
    assert plan.spec.formula == "F field & F G home"
    assert visited(plan) >= {"field", "home"}
    assert "# the file has no boundary; this is 20 m around everything: where may it fly?" in text
    assert '# "field": told by its name' in text
    # Corners are written as they were drawn, the latitude first.
    assert "[[51.896772, 6.541425], [51.896812, 6.54118]" in " ".join(text.split())


def test_what_nothing_tells_of_is_surveyed_where_nothing_else_is_with_a_question() -> None:
    text = drafted(feature("Untitled Polygon", Polygon(points(LOT))), in_degrees=True)
    assert kinds(text) == {"home": "home", "Untitled Polygon": "survey"}
    assert "# nothing in the file tells what it is: is it to be surveyed?" in text


def test_a_fence_is_the_boundary_and_the_planned_home_is_home() -> None:
    home = Spot((-77.49721463637287, 38.75084010396389))
    text = drafted(
        feature("inclusion_polygon_1", Polygon(points(FENCE)), Role.BOUNDARY),
        feature("exclusion_polygon_2", Polygon(points(EXCLUDED)), Role.RESTRICTED),
        feature("home", home, Role.HOME),
        in_degrees=True,
    )
    spec = mission(text)
    assert kinds(text) == {"home": "home", "exclusion_polygon_2": "restricted"}
    assert spec.formula == "F G home"
    assert "position_m: [38.750840104, -77.497214636]" in text
    (shape,) = [region.shape for region in spec.regions if region.name == "home"]
    assert isinstance(shape, CircleShape)
    assert 0.5 < shape.radius_m < 1.5  # the fence is near
    assert "# Nothing is there to be surveyed: the vehicle starts and lands. What should it visit?" in text


def test_a_hole_is_kept_off_and_a_narrow_ring_is_visited_with_a_narrow_tube() -> None:
    text = drafted(feature("Ring", Polygon(square(0, 0, 10), (square(1, 1, 8),))))
    plan = planned(text)
    assert kinds(text) == {"home": "home", "Ring": "survey", "Ring_holes": "restricted"}
    assert "corners:" not in text
    assert plan.spec.flight.disturbance_m_s2 < 0.2
    assert "Ring" in visited(plan)


def test_a_hole_that_another_feature_fills_is_left_to_that() -> None:
    field = feature("field", Polygon(square(0, 0, 100), (square(40, 40, 20),)), Role.SURVEY)
    text = drafted(field, feature("lawn", Polygon(square(40, 40, 20)), Role.AREA))
    assert kinds(text) == {"home": "home", "field": "survey", "lawn": "area"}


def test_what_holds_everything_is_the_boundary() -> None:
    text = drafted(
        feature("Farm", Polygon(square(0, 0, 200))),
        feature("north", Polygon(square(20, 120, 50)), Role.SURVEY),
        feature("house", Polygon(square(120, 20, 30)), Role.RESTRICTED),
        feature("strange", Polygon(square(20, 20, 30))),
    )
    spec = mission(text)
    assert kinds(text) == {"home": "home", "north": "survey", "house": "restricted", "strange": "area"}
    assert isinstance(spec.domain, BoundaryDomain)
    assert spec.domain.boundary == PolygonShape(((0, 0), (200, 0), (200, 200), (0, 200)))
    assert "# it holds everything else: is it where the vehicle may fly?" in text
    assert "# nothing in the file tells what it is: survey, restricted, home, or an area like any other?" in text


def test_a_field_with_a_pond_in_it_is_not_the_boundary() -> None:
    text = drafted(feature("A", Polygon(square(0, 0, 100))), feature("pond", Spot((50, 50), 8), Role.RESTRICTED))
    assert kinds(text) == {"home": "home", "A": "survey", "pond": "restricted"}


def test_lines_and_places_get_a_width_and_a_circle() -> None:
    text = drafted(
        feature("field", Polygon(square(0, 0, 100)), Role.SURVEY),
        feature("power line", Line(((-20, 110), (120, 120))), Role.RESTRICTED),
        feature("canal", Line(((-20, -30), (120, -30)), 8.0), Role.RESTRICTED),
        feature("Point 1", Spot((50, 130))),
    )
    flat = " ".join(text.split())
    assert "line: [[-20, 110], [120, 120]] width_m: 10" in flat
    assert "# the file gives the line no width: is this one right?" in text
    assert "line: [[-20, -30], [120, -30]] width_m: 8" in flat
    assert kinds(text) == {
        "home": "home",
        "field": "survey",
        "power line": "restricted",
        "canal": "restricted",
        "Point 1": "area",
    }


def test_many_regions_are_visited_in_a_row_and_few_in_any_order() -> None:
    plots = [feature(f"plot {i}", Polygon(square(30 * i, 0, 20)), Role.SURVEY) for i in range(6)]
    home = feature("home", Spot((-10, 10)), Role.HOME)
    assert (
        yaml.safe_load(drafted(home, *plots[:3]))["mission"]["formula"]
        == 'F "plot 0" & F "plot 1" & F "plot 2" & F G home'
    )
    plan = planned(drafted(home, *plots))
    assert plan.spec.formula.startswith('F ("plot 0" & F ("plot 1" & F ("plot 2" & ')
    assert visited(plan) >= {f"plot {i}" for i in range(6)}


def test_a_home_that_cannot_be_used_is_replaced_and_said_so() -> None:
    fence = feature("fence", Polygon(square(0, 0, 100)), Role.BOUNDARY)
    field = feature("field", Polygon(square(50, 50, 40)), Role.SURVEY)
    text = drafted(fence, field, feature("start", Spot((300, 10)), Role.HOME))
    assert "# Note: start lies outside the boundary and is left out." in text
    text = drafted(
        fence, field, feature("start", Spot((20, 20)), Role.HOME), feature("barn", Spot((20, 20), 9), Role.RESTRICTED)
    )
    assert "# Note: start lies outside the boundary or where it is restricted, and is left out." in text
    assert mission(text).start.position_m != (20.0, 20.0)


def test_what_lies_outside_of_a_fence_is_left_out_and_said_so() -> None:
    text = drafted(
        feature("fence", Polygon(square(0, 0, 100)), Role.BOUNDARY),
        feature("field", Polygon(square(50, 50, 40)), Role.SURVEY),
        feature("far", Polygon(square(500, 50, 40)), Role.SURVEY),
    )
    assert kinds(text) == {"home": "home", "field": "survey"}
    assert "# Note: far lies outside the boundary and is left out." in text


def test_what_cannot_be_reached_is_not_asked_for() -> None:
    walls = Polygon(square(50, 0, 50), (square(60, 10, 30),))
    text = drafted(
        feature("moat", walls, Role.RESTRICTED),
        feature("island", Polygon(square(65, 15, 10)), Role.SURVEY),
        feature("field", Polygon(square(0, 0, 30)), Role.SURVEY),
        feature("under", Polygon(square(51, 1, 6)), Role.SURVEY),
    )
    plan = planned(text)
    assert plan.spec.formula == "F field & F G home"
    assert "# Note: island cannot be reached from home: moat lies between or over it." in text
    assert "# Note: under cannot be reached from home: moat lies between or over it." in text


def test_several_fences_are_one_boundary_and_several_homes_one_is_returned_to() -> None:
    text = drafted(
        feature("inclusion_polygon_1", Polygon(square(0, 0, 60)), Role.BOUNDARY),
        feature("inclusion_polygon_2", Polygon(square(50, 0, 60)), Role.BOUNDARY),
        feature("field", Polygon(square(70, 10, 30)), Role.SURVEY),
        feature("home", Spot((10, 10)), Role.HOME),
        feature("rally_1", Spot((10, 40), 6.0), Role.HOME),
    )
    plan = planned(text)
    assert plan.spec.formula == "F field & F G (home | rally_1)"
    assert isinstance(plan.spec.domain, BoundaryDomain)
    assert visited(plan) >= {"field"}


def test_names_are_those_of_regions_each_once() -> None:
    names = ["Nörd-Fläche 1", "3. Schlag", "G", "", "a\nkind: home", "a\nkind: home", "\x1b[2J\u202e", "北"]
    features = [feature(name, Polygon(square(30 * i, 0, 20)), Role.SURVEY) for i, name in enumerate(names)]
    text = drafted(*features)
    assert list(kinds(text))[1:] == [
        "Nörd-Fläche 1",
        "3. Schlag",
        "region G",
        "drawn",
        "a kind: home",
        "a kind: home_2",
        "[2J",
        "北",
    ]
    assert "\x1b" not in text
    assert "\u202e" not in text


def test_coordinates_of_a_projection_are_taken_near_zero_without_loss() -> None:
    text = drafted(feature("field", Polygon(square(389_000.25, 5_751_000.125, 60.0)), Role.SURVEY))
    assert "# [389000, 5751000] is taken from all coordinates of the file. Where on Earth is [0, 0]?" in text
    assert "polygon: [[0.25, 0.125], [60.25, 0.125], [60.25, 60.125], [0.25, 60.125]]" in text
    assert mission(text).origin is None


def test_across_the_antimeridian() -> None:
    corners = ((179.9995, -16.5), (-179.9995, -16.5), (-179.9995, -16.499), (179.9995, -16.499))
    plan = planned(drafted(feature("reef", Polygon(corners), Role.SURVEY), in_degrees=True))
    assert plan.spec.origin is not None
    assert abs(plan.spec.origin.longitude_deg) == pytest.approx(180.0)
    (reef,) = [region.shape for region in plan.spec.regions if region.name == "reef"]
    assert isinstance(reef, PolygonShape)
    assert max(abs(value) for corner in reef.corners_m for value in corner) < 60.0


@pytest.mark.parametrize(("side", "in_degrees"), [(0.5, True), (60_000.0, False)])
def test_what_reaches_farther_than_a_plane_is_refused(side: float, *, in_degrees: bool) -> None:
    with pytest.raises(SpecError, match="km wide; the plane of a mission ends at 50 km"):
        drafted(feature("field", Polygon(square(7.0, 51.0, side))), in_degrees=in_degrees)


def test_the_smallest_part_of_what_is_restricted_is_kept_and_where_nothing_is_left_that_is_said() -> None:
    fence = feature("fence", Polygon(square(0, 0, 100)), Role.BOUNDARY)
    airport = feature("airport", Polygon(square(99, 50, 9000)), Role.RESTRICTED)
    assert kinds(drafted(fence, airport)) == {"home": "home", "airport": "restricted"}
    with pytest.raises(SpecError, match="nothing is left to fly in"):
        drafted(fence, feature("all", Polygon(square(-1, -1, 102)), Role.RESTRICTED))


def test_an_outline_that_crosses_itself_is_refused_with_its_place() -> None:
    corners = ((0.0, 0.0), (100.0, 100.0), (100.0, 0.0), (0.0, 100.0))
    with pytest.raises(SpecError, match=r'an outline of "bow" crosses itself or has no width near \[50, 50\]'):
        drafted(feature("bow", Polygon(corners)))


def test_more_than_a_mission_can_have_is_refused() -> None:
    with pytest.raises(SpecError, match="more than 1000 areas are drawn"):
        drafted(*(feature("", Spot((float(i), 0.0))) for i in range(1001)))


def test_files_are_drawn_together_and_their_names_may_tell() -> None:
    plain = Drawing("KML", (feature("1", Polygon(square(7.0, 51.0, 0.001))),))
    other = Drawing("KML", (feature("2", Polygon(square(7.0002, 51.0002, 0.0002))),))
    text = draft_mission([("fields", plain), ("houses", other)], "fields and houses").text
    assert kinds(text) == {"home": "home", "1": "survey", "2": "restricted"}
    metres = Drawing("GeoJSON", plain.features, in_degrees=False)
    with pytest.raises(SpecError, match="the coordinates of b are metres, those of the other files are degrees"):
        draft_mission([("a", plain), ("b", metres)], "both")


def test_height_speed_and_lanes_of_the_file_are_kept() -> None:
    survey = Feature("survey_1", (Polygon(square(0, 0, 100)),), Role.SURVEY, "a survey", lanes=Lanes(18.5, 30.0))
    drawing = Drawing("QGroundControl plan", (survey,), in_degrees=False, altitude_m=50.0, speed_m_s=7.0)
    text = draft_mission([("x", drawing)], "x").text
    spec = mission(text)
    assert (spec.flight.altitude_m, spec.flight.speed_m_s, spec.limits.speed_m_s) == (50.0, 7.0, 7.0)
    assert "    # as it was planned before\n    cover: {spacing_m: 18.5, heading_deg: 30}" in text
    (region,) = [region for region in spec.regions if region.cover]
    assert region.cover is not None
    assert (region.cover.spacing_m, region.cover.heading_deg) == (18.5, 30.0)


def test_what_is_surveyed_is_covered_where_there_is_room_for_lanes() -> None:
    text = drafted(
        feature("field", Polygon(square(0, 0, 100)), Role.SURVEY),
        feature("bed", Polygon(square(130, 0, 12)), Role.SURVEY),
        feature("spot", Spot((130, 40), 1.5), Role.SURVEY),
        feature("road", Line(((-20, 120), (120, 120)), 8.0), Role.SURVEY),
        feature("verge", Polygon(((-20, 130), (120, 130), (120, 133), (-20, 133))), Role.SURVEY),
    )
    regions = yaml.safe_load(text)["regions"]
    covers = {name: region["cover"]["spacing_m"] for name, region in regions.items() if "cover" in region}
    assert covers == {"field": 10, "bed": 6, "road": 8, "verge": 3}
    assert "# how far apart are the lanes to be?" in text


def test_lanes_are_closer_where_houses_cut_them() -> None:
    houses = tuple(square(x, y, 12) for x in range(8, 100, 24) for y in range(8, 100, 24))
    text = drafted(feature("yard", Polygon(square(0, 0, 100), houses), Role.SURVEY))
    spacing_m = yaml.safe_load(text)["regions"]["yard"]["cover"]["spacing_m"]
    assert spacing_m == 3
    # On a grid of lines the lanes are six spacings long on average.
    yard = shapely.Polygon(square(0, 0, 100), houses)
    lines = [shapely.LineString([(-9, y), (109, y)]) for y in np.linspace(0.05, 99.95, 1000)]
    pieces = shapely.get_parts(shapely.intersection(yard, shapely.MultiLineString(lines)))
    assert shapely.length(pieces).mean() > 6.0 * spacing_m


roles = st.sampled_from([None, *Role])
places = st.tuples(st.integers(0, 60), st.integers(0, 60))
shapes = st.one_of(
    st.builds(lambda at, side: Polygon(square(at[0], at[1], side)), places, st.integers(4, 40)),
    st.builds(Spot, places, st.sampled_from([None, 4.0, 9.0])),
    st.builds(lambda a, b, width: Line((a, (b[0] + 70, b[1])), width), places, places, st.sampled_from([None, 3.0])),
)


@tried(10)
@given(st.lists(st.builds(feature, st.just("x"), shapes, roles), min_size=1, max_size=6))
def test_whatever_is_drawn_the_draft_is_sound(features: Sequence[Feature]) -> None:
    spec = mission(drafted(*features))
    assert any(region.kind is RegionKind.HOME for region in spec.regions)


def mended(*rings: tuple[Point, ...]) -> dict[str, object]:
    region = yaml.safe_load(drafted(feature("field", Polygon(rings[0], rings[1:]), Role.SURVEY)))["regions"]["field"]
    assert isinstance(region, dict)
    return region


def test_outlines_that_touch_themselves_are_taken_apart_and_spikes_taken_off() -> None:
    hourglass = ((0, 0), (40, 0), (20, 20), (40, 40), (0, 40), (20, 20))
    parts = mended(hourglass)["polygons"]
    assert isinstance(parts, list)
    assert sorted(sorted(map(tuple, part["polygon"])) for part in parts) == [
        [(0, 0), (20, 20), (40, 0)],
        [(0, 40), (20, 20), (40, 40)],
    ]
    spike = ((0, 0), (40, 0), (40, 20), (90, 20), (40, 20), (40, 40), (0, 40))
    assert sorted(map(tuple, mended(spike)["polygon"])) == [(0, 0), (0, 40), (40, 0), (40, 20), (40, 40)]  # type: ignore[call-overload]
    # Somebody drew the hole with the pen down: from a corner inwards, round it, and back.
    keyhole = ((0, 0), (40, 0), (40, 40), (0, 40), (0, 0), (10, 10), (10, 20), (20, 20), (20, 10), (10, 10))
    region = mended(keyhole)
    assert sorted(map(tuple, region["holes"][0])) == [(10, 10), (10, 20), (20, 10), (20, 20)]  # type: ignore[index]


@pytest.mark.parametrize(
    "ring",
    [
        ((0, 0), (40, 40), (40, 0), (0, 40)),  # which of the two is meant, or both?
        ((0, 0), (40, 0), (20, 20), (0, 40), (40, 40), (20, 20)),  # one loop goes round the other way
        ((0, 0), (40, 0), (20, 0)),
    ],
)
def test_outlines_that_could_mean_several_things_are_refused_with_the_place(ring: tuple[Point, ...]) -> None:
    with pytest.raises(SpecError, match=r'an outline of "field" crosses itself or has no width near \['):
        drafted(feature("field", Polygon(ring), Role.SURVEY))


def test_a_hole_outside_of_its_polygon_is_left_out_and_said_so() -> None:
    text = drafted(feature("field", Polygon(square(0, 0, 40), (square(60, 0, 10), square(5, 5, 10))), Role.SURVEY))
    assert "# a hole that lies outside of it is left out" in text
    assert yaml.safe_load(text)["regions"]["field"]["holes"] == [[[5, 5], [15, 5], [15, 15], [5, 15]]]
    assert "field_holes" in text  # of the one that is left, whether it may be flown over


def test_what_is_too_small_is_not_asked_for_and_neither_is_what_makes_the_formula_too_long() -> None:
    text = drafted(
        feature("speck", Polygon(square(0, 0, 0.1)), Role.SURVEY),
        feature("field", Polygon(square(10, 0, 40)), Role.SURVEY),
    )
    assert "# Note: speck is too narrow to be visited, with room for a circle of 0.05 m." in text
    text = drafted(*(feature(f"p{i}", Polygon(square(30 * i, 0, 20)), Role.SURVEY) for i in range(100)))
    assert "# Note: of 100 regions to survey, the first 90 are asked for" in text
    assert mission(text).formula.count("F (") == 90
