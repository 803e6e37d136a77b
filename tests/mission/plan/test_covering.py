"""Regions that are covered: lanes are part of the path, of its proof, of its time law and of the plan's file."""

import numpy as np
import pytest
import shapely

from mission.errors import NoPlanError
from mission.plan import FlightPlan, plan_from_json, plan_to_json
from tests.support.fields import FIELD_WITH_A_BARN, TWO_FIELDS
from tests.support.proofs import untrue
from tests.support.small_missions import plan_of


@pytest.fixture(scope="module")
def farm() -> FlightPlan:
    return plan_of(FIELD_WITH_A_BARN)


def area_of(plan: FlightPlan, name: str) -> shapely.Geometry:
    return shapely.union_all(shapely.polygons(plan.partition.corners_m[plan.labelling.triangles_of(name)]))


def flown(plan: FlightPlan) -> shapely.LineString:
    return shapely.LineString(plan.trajectory.position(np.arange(0.0, plan.trajectory.duration_s, 0.1)))


def test_the_path_covers_the_region_and_the_word_is_that_of_the_formula(farm: FlightPlan) -> None:
    field, barn = area_of(farm, "field"), area_of(farm, "barn")
    field = field.difference(barn)
    assert farm.certificate.holds
    letters = [frozenset(letter) for letter in ({"home"}, set(), {"field"}, set(), {"home"})]
    assert farm.certificate.word == tuple(letters)
    line = flown(farm)
    missed = field.difference(line.buffer(4.0))
    [visit] = farm.covers
    assert missed.area <= (1.0 - visit.planned_share) * field.area < 0.02 * field.area
    assert line.distance(barn) > 0.3 * np.sqrt(2.0)
    assert visit.region == "field"
    assert visit.heading_deg == 0.0
    tube = field.buffer(-0.3)
    assert all(tube.covers(lane) for lane in shapely.linestrings(visit.lanes_m))


def test_lanes_are_passed_at_their_times(farm: FlightPlan) -> None:
    [visit] = farm.covers
    for lane, (begin_s, end_s) in zip(visit.lanes_m, visit.lanes_s.tolist(), strict=True):
        middle = farm.curve.position([0.5 * (begin_s + end_s)])[0]
        if np.hypot(*(lane[1] - lane[0])) > visit.spacing_m:
            assert np.hypot(*(middle - lane.mean(axis=0))) < 0.5
        ends = farm.curve.position([begin_s, end_s])
        # Corners are rounded: within half the spacing, which puts the path off by 0.27 of that at right angles.
        assert np.hypot(*(ends - lane).T).max() < 8.0 / 3.0
    assert (np.diff(visit.lanes_s.ravel()) >= -1e-9).all()
    assert visit.start_s <= visit.lanes_s[0, 0]


def test_the_flight_keeps_the_limits_and_is_continuous(farm: FlightPlan) -> None:
    t = np.linspace(0.0, farm.trajectory.duration_s, 40_001)
    position, velocity, acceleration = farm.trajectory.state(t)
    step = t[1]
    assert np.hypot(*velocity.T).max() <= 4.0 * (1.0 + 1e-9)
    assert np.hypot(*acceleration.T).max() <= farm.spec.limits.acceleration_m_s2 * (1.0 + 1e-6)
    assert np.hypot(*np.diff(position, axis=0).T).max() <= 4.0 * step * 1.001
    assert np.hypot(*np.diff(velocity, axis=0).T).max() <= farm.spec.limits.acceleration_m_s2 * step * 1.01
    assert farm.path.position([0.0])[0] == pytest.approx([12.0, 12.0])


def test_lanes_are_begun_in_flight(farm: FlightPlan) -> None:
    """Where nothing has to turn back: pieces of the curve go over into each other, and the law does not rest there."""
    joints = np.setdiff1d(farm.curve.joints_s[1:-1], farm.curve.breaks_s)
    assert farm.covers[0].start_s in joints
    t = farm.trajectory.time_at(joints)
    assert np.hypot(*farm.trajectory.velocity(t).T).min() > 0.5
    assert farm.trajectory.time_at(joints, leaving=True) == pytest.approx(t)


def test_a_plan_with_lanes_is_read_as_it_was_written_and_proved_again(farm: FlightPlan) -> None:
    text = plan_to_json(farm)
    again = plan_from_json(text)
    assert plan_to_json(again) == text
    assert not untrue(again)


@pytest.mark.parametrize("start", ["40, 9", "13, 20"])
def test_each_lap_covers_each_region_once_wherever_it_begins(start: str) -> None:
    """Also where the lap begins within a visit, and where the flight begins in a region."""
    plan = plan_of(TWO_FIELDS.replace("START", start))
    assert plan.trajectory.lap is not None
    begin, end = plan.curve.starts_s[plan.trajectory.lap : plan.trajectory.lap + 2]
    inside = [visit.region for visit in plan.covers if begin - 1e-9 <= visit.start_s < end]
    assert sorted(inside) == ["east", "west"]
    assert len(plan.trajectory.legs) == 3
    west = area_of(plan, "west")
    assert west.difference(flown(plan).buffer(4.0)).area < 0.01 * west.area


def test_a_visit_that_the_mission_does_not_ask_for_covers_nothing() -> None:
    plan = plan_of(
        FIELD_WITH_A_BARN.replace("F (field & F home)", "F (barn2 & F home)").replace(
            "  barn:", "  barn2: {kind: survey, polygon: [[142, 2], [148, 2], [148, 8], [142, 8]]}\n  barn:"
        )
    )
    assert plan.covers == ()


def test_a_region_that_starts_the_flight_is_covered_where_the_mission_asks_for_it() -> None:
    plan = plan_of(FIELD_WITH_A_BARN.replace("position_m: [12, 12]", "position_m: [50, 30]"))
    assert [visit.region for visit in plan.covers] == ["field"]


@pytest.mark.parametrize(
    "lens",
    ["field_of_view_deg: [60, 45]", "sensor_mm: [11.547005383792515, 8.284271247461902], focal_length_mm: 10"],
)
def test_a_camera_gives_the_spacing_and_the_distance_between_images(lens: str) -> None:
    camera = f"camera: {{{lens}, overlap: 0.8, sidelap: 0.5}}"
    plan = plan_of(
        FIELD_WITH_A_BARN.replace("spacing_m: 8", camera).replace("speed_m_s: 4", "speed_m_s: 4, altitude_m: 20")
    )
    [visit] = plan.covers
    assert visit.spacing_m == pytest.approx(2.0 * 20.0 * np.tan(np.radians(30.0)) * 0.5)
    assert visit.trigger_m == pytest.approx(2.0 * 20.0 * np.tan(np.radians(22.5)) * 0.2)
    assert plan_to_json(plan_from_json(plan_to_json(plan))) == plan_to_json(plan)


def test_a_region_too_narrow_for_its_tube_is_refused_with_the_widths() -> None:
    outline = "[[40, 20], [130, 20], [140, 90], [100, 90], [95, 60], [60, 60], [55, 90], [30, 90]]"
    strip = FIELD_WITH_A_BARN.replace(outline, "[[40, 20], [130, 20], [130, 26], [40, 26]]")
    narrow = strip.replace("disturbance_m_s2: 0.3", "disturbance_m_s2: 5")
    with pytest.raises(NoPlanError, match=r"the tube does not fit into field; a tube of 2\.11 m per axis") as refused:
        plan_of(narrow)
    assert "not with this one of 5 m per axis" in str(refused.value)
    between = strip.replace("disturbance_m_s2: 0.3", "disturbance_m_s2: 2.9")
    with pytest.raises(NoPlanError, match=r"covered by lanes 8 m apart in a tube of 2\.9 m on each side"):
        plan_of(between)


@pytest.mark.parametrize("forbidden", ["G !pond", "(!pond U home) & F home", "(field -> !pond) U G home"])
def test_lanes_keep_out_of_what_the_mission_forbids_at_that_time(forbidden: str) -> None:
    pond = "pond: {kind: area, polygon: [[40, 21], [48, 21], [48, 29], [40, 29]]}"
    start = "[60, 5]" if "!pond U" in forbidden else "[12, 12]"
    text = FIELD_WITH_A_BARN.replace("  barn:", f"  {pond}\n  barn:").replace("[12, 12]", start)
    plan = plan_of(text.replace("G !barn", forbidden))
    assert plan.certificate.holds
    line = flown(plan)
    assert line.distance(area_of(plan, "pond")) > 0.3
    assert plan.covers[0].planned_share > 0.9


def test_ways_between_the_parts_of_a_field_cross_what_the_mission_leaves_open() -> None:
    parts = "[{polygon: [[30, 20], [55, 20], [55, 80], [30, 80]]}, {polygon: [[65, 20], [90, 20], [90, 80], [65, 80]]}]"
    text = f"""
domain: {{boundary: [[0, 0], [100, 0], [100, 90], [0, 90]]}}
regions:
  home: {{kind: home, polygon: [[5, 5], [20, 5], [20, 20], [5, 20]]}}
  field: {{kind: survey, polygons: {parts}, cover: {{spacing_m: 8}}}}
  road: {{kind: area, polygon: [[57, 0], [63, 0], [63, ROAD], [57, ROAD]]}}
mission: {{formula: F (field & F home) & FORBIDDEN}}
start: {{position_m: [12, 12]}}
flight: {{disturbance_m_s2: 0.5}}
"""
    across = plan_of(text.replace("ROAD", "90").replace("FORBIDDEN", "true"))
    assert across.covers[0].planned_share > 0.98
    assert flown(across).intersects(area_of(across, "road"))
    around = plan_of(text.replace("ROAD", "85").replace("FORBIDDEN", "G !road"))
    assert around.covers[0].planned_share > 0.98
    assert flown(around).distance(area_of(around, "road")) > 0.5
    with pytest.raises(NoPlanError, match=r"no way leads to \d\d\.\d% of it, about \(.*leave that out, visit it as"):
        plan_of(text.replace("ROAD", "90").replace("FORBIDDEN", "G !road"))


def test_a_part_that_cannot_be_reached_is_left_out_where_the_share_allows_it() -> None:
    fence = "fence: {kind: restricted, polygon: [[0, 84], [150, 84], [150, 86], [0, 86]]}"
    text = FIELD_WITH_A_BARN.replace("  barn:", f"  {fence}\n  barn:")
    with pytest.raises(NoPlanError, match=r"set a lower `regions.field.cover.share`"):
        plan_of(text.replace("spacing_m: 8", "spacing_m: 2"))
    plan = plan_of(text.replace("spacing_m: 8", "spacing_m: 2, share: 0.9"))
    assert 0.9 < plan.covers[0].planned_share < 0.99


@pytest.mark.parametrize(("spare", "said"), [(0.0061, ""), (0.002, "hardly more than"), (-0.002, "less than the")])
def test_a_plan_that_covers_hardly_what_is_asked_for_says_so(spare: float, said: str) -> None:
    planned = plan_of(FIELD_WITH_A_BARN.replace("spacing_m: 8", "spacing_m: 8, share: 1")).covers[0].planned_share
    plan = plan_of(FIELD_WITH_A_BARN.replace("spacing_m: 8", f"spacing_m: 8, share: {planned - spare:.9f}"))
    assert [said in warning for warning in plan.warnings if "lanes cover" in warning] == [True] * bool(said)


def test_a_field_that_is_all_of_the_domain_is_covered() -> None:
    outline = "[[40, 20], [130, 20], [140, 90], [100, 90], [95, 60], [60, 60], [55, 90], [30, 90]]"
    whole = FIELD_WITH_A_BARN.replace(outline, "[[0, 0], [150, 0], [150, 100], [0, 100]]")
    barn = "  barn: {kind: restricted, polygon: [[70, 30], [80, 30], [80, 40], [70, 40]]}\n"
    plan = plan_of(whole.replace(barn, "").replace(" & G !barn", ""))
    [visit] = plan.covers
    assert visit.planned_share > 0.98
    assert not any("asks nothing" in warning for warning in plan.warnings)


def test_a_region_that_the_mission_does_not_name_is_not_covered_for_what_lies_inside() -> None:
    home = FIELD_WITH_A_BARN.replace("[[5, 5], [20, 5], [20, 20], [5, 20]]", "[[50, 30], [60, 30], [60, 40], [50, 40]]")
    assert not plan_of(home.replace("F (field & F home)", "F home")).covers
    assert len(plan_of(home.replace("F (field & F home)", "F field & F G home")).covers) == 1


LAPPED = """\
domain:
  boundary: [[0, 0], [120, 0], [120, 80], [0, 80]]
regions:
  home: {kind: home, polygon: [[5, 5], [20, 5], [20, 20], [5, 20]]}
  field: {kind: survey, polygon: [[30, 10], [110, 10], [110, 70], [30, 70]], cover: {spacing_m: 15, share: 0.9}}
  k: {kind: area, polygon: K}
mission:
  formula: FORMULA
start:
  position_m: [12, 12]
flight: {disturbance_m_s2: 0.5}
"""


@pytest.mark.parametrize(
    "formula",
    [
        "G F field & G F home & F G !k",  # what must end some day must not be in the lap
        "G F field & G F home & G !k",
        "G F home & G F field & G (field -> (!k U home))",
        "F field & F G home & G (field -> (!k U home))",
    ],
)
def test_lanes_keep_out_of_what_would_spoil_the_run(formula: str) -> None:
    corners = "[[66, 30], [76, 30], [76, 40], [66, 40]]"
    plan = plan_of(LAPPED.replace("K", corners, 1).replace("FORMULA", formula))
    assert plan.certificate.holds
    (visit,) = plan.covers
    assert shapely.distance(flown(plan), shapely.box(66, 30, 76, 40)) > 0.5
    assert visit.planned_share > 0.9


def test_what_keeps_lanes_out_is_named_where_they_do_not_reach() -> None:
    text = LAPPED.replace("K", "[[66, -5], [74, -5], [74, 85], [66, 85]]", 1)
    with pytest.raises(NoPlanError, match="; the lanes keep out of k, as the mission asks then") as refused:
        plan_of(text.replace("FORMULA", "G F field & G F home & F G !k"))
    assert refused.value.regions == ("field",)


_LONG_AND_SHORT = """
domain: {boundary: [[0, 0], [170, 0], [170, 60], [0, 60]]}
regions:
  yard: {kind: home, polygon: [[150, 44], [166, 44], [166, 58], [150, 58]]}
  field: {kind: survey, polygon: [[10, 14], [100, 8], [130, 20], [126, 48], [60, 46], [14, 54]], cover: {spacing_m: 18}}
mission: {formula: F (field & F yard)}
start: {position_m: [158, 50]}
flight: {speed_m_s: 8, disturbance_m_s2: 1.2}
limits: {speed_m_s: 10}
"""


def test_lanes_are_fastest_or_shortest_as_the_search_says() -> None:
    unsaid, fastest, shortest = (
        plan_of(_LONG_AND_SHORT + said) for said in ("", "search: {cost: time}", "search: {cost: distance}")
    )
    assert unsaid.spec == fastest.spec
    assert fastest.trajectory.duration_s < shortest.trajectory.duration_s
    assert shortest.curve.length_m < fastest.curve.length_m
