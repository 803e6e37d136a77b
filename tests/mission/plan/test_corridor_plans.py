"""Whole plans in corridors: proved, as short as the map allows, whatever the mesh."""

import re
from pathlib import Path

import numpy as np
import pytest

from mission.plan import FlightPlan, plan_from_json, plan_mission, plan_to_json
from mission.spec.loader import parse_mission
from mission.steering.bezier import BezierCurve
from mission.steering.polyline import Polyline

MISSIONS = Path(__file__).parents[3] / "missions"
CORRIDOR = "\nsmoothing: corridor\nsearch: {cost: distance}\n"
SQUARE = """
domain: {boundary: [[0, 0], [60, 0], [60, 40], [0, 40]]}
regions:
  a: {kind: survey, polygon: [[4, 26], [12, 26], [12, 34], [4, 34]]}
  b: {kind: survey, polygon: [[46, 26], [54, 26], [54, 34], [46, 34]]}
  k: {kind: restricted, polygon: [[24, 12], [34, 12], [34, 40], [24, 40]]}
mission: {formula: FORMULA}
start: {position_m: [6, 6]}
flight: {speed_m_s: 4, disturbance_m_s2: 0.5}
smoothing: corridor
search: {cost: distance}
"""


def in_corridor(name: str, largest_m: float | None = None) -> FlightPlan:
    """The plan of a mission of the gallery in the corridor of its shortest path."""
    text = (MISSIONS / f"{name}.yaml").read_text()
    text = re.sub(r"^smoothing:\n(?:  .*\n)+", "", text, flags=re.MULTILINE) + CORRIDOR
    if largest_m is not None:
        text = re.sub(r"largest_m: [\d.]+", f"largest_m: {largest_m}", text)
    return plan_mission(parse_mission(text.encode()))


def square(formula: str) -> FlightPlan:
    return plan_mission(parse_mission(SQUARE.replace("FORMULA", formula).encode()))


def test_the_survey_is_as_short_as_the_map_allows_and_proved() -> None:
    plan = in_corridor("survey")
    assert isinstance(plan.path, Polyline)
    assert not plan.instead
    assert plan.certificate.holds
    # 226 m is the shortest path that keeps half a metre from everything; the tube is a square of that half width.
    assert 226.0 <= plan.path.length_m <= 227.0
    assert plan.curve.length_m <= 1.02 * plan.path.length_m
    again = plan_from_json(plan_to_json(plan))
    assert plan_to_json(again) == plan_to_json(plan)


def test_how_fine_the_mesh_is_does_not_show_in_the_path() -> None:
    lengths = [in_corridor("survey", largest_m).path.length_m for largest_m in (100.0, 25.0, 12.0)]
    assert lengths == pytest.approx([lengths[0]] * 3, rel=1e-3)


def test_laps_are_flown_through_and_the_way_back_goes_on_from_them() -> None:
    plan = in_corridor("patrol")
    to_lap, lap, back = plan.curve.legs
    assert plan.trajectory.lap == 1
    assert plan.homeward is not None
    for order in (1, 2):
        end = lap.derivative([lap.duration_s], order)[0]
        assert lap.derivative([0.0], order)[0] == pytest.approx(end, abs=1e-6)
        assert to_lap.derivative([to_lap.duration_s], order)[0] == pytest.approx(end, abs=1e-6)
        assert back.derivative([0.0], order)[0] == pytest.approx(end, abs=1e-6)
    assert isinstance(lap, BezierCurve)
    gate = lap.position(lap.knots_s)
    assert plan.locator.triangle_at(gate).min() >= 0


def test_lanes_begin_and_end_where_the_ways_to_and_from_them_do() -> None:
    plan = in_corridor("orchard")
    (visit,) = plan.covers
    begin, end = visit.lanes_s[0, 0], visit.lanes_s[-1, 1]
    assert plan.curve.position([begin])[0] == pytest.approx(visit.lanes_m[0, 0], abs=0.3 * visit.spacing_m)
    assert plan.curve.position([end])[0] == pytest.approx(visit.lanes_m[-1, 1], abs=0.3 * visit.spacing_m)
    assert np.isclose(plan.curve.joints_s, visit.start_s).any()


@pytest.mark.parametrize(
    "formula", ["F a & F b & G !k", "(!b U a) & F b & G !k", "G F a & G F b & G !k", "F (a & X F b) & G !k"]
)
def test_formulas_are_flown_in_corridors(formula: str) -> None:
    plan = square(formula)
    assert plan.certificate.holds
    assert not plan.instead


def test_words_that_count_triangles_are_flown_by_fields_and_said_to_be() -> None:
    plan = square("X !a & F b & G !k")
    assert not isinstance(plan.path, Polyline)
    assert any("the path of the fields is flown" in warning for warning in plan.warnings)


def test_who_begins_where_the_flight_may_end_stays_there() -> None:
    plan = square("F G !k")
    assert plan.certificate.holds
    assert not plan.instead
    assert plan.curve.length_m == 0.0


@pytest.mark.parametrize("loiter", ["", ", loiter_s: 3"])
def test_a_flight_that_begins_beside_the_rim_of_what_it_visits_goes_into_it_first(loiter: str) -> None:
    """0.2 m inside of b, less than the tube of half a metre; to begin inside is not to enter, so it does not stay."""
    text = (
        SQUARE.replace("FORMULA", "F b & F a")
        .replace("[6, 6]", "[46.2, 30]")
        .replace("[46, 34]]", f"[46, 34]]{loiter}")
    )
    plan = plan_mission(parse_mission(text.encode()))
    assert isinstance(plan.path, Polyline)
    assert not plan.instead
    assert plan.certificate.word[0] == {"b"}
    assert plan.path.position(np.linspace(0.0, plan.path.duration_s, 500))[:, 0].max() > 46.45
    assert plan.stops == ()
