"""Where the nose looks: as the mission says, and no faster than the vehicle turns, on whole planned flights."""

import json
import math
from dataclasses import replace
from functools import cache
from typing import Final

import numpy as np
import pytest
import shapely

from mission.geometry.arrays import BoolArray, FloatArray
from mission.link.course import Course
from mission.plan import FlightPlan, plan_mission
from mission.plan.heading import nose_of
from mission.plan.serial import plan_to_json
from mission.plan.turning import slow_to_turn
from mission.spec.heading import Heading, Look
from mission.spec.loader import parse_mission
from mission.steering.joined import JoinedCurve
from mission.steering.rounded import RoundedPolyline
from mission.verify.plans.checker import claims
from tests.support.fields import SMALL_FIELD
from tests.support.small_missions import ROUNDS, SMALL
from tests.support.usual_cases import sampled

STEP_S = 1.0 / 30.0
EARLY_S = 10.0
"""So long the nose may turn before the trajectory begins."""
STANDING_M_S = 0.05
EXACT_RAD = 1e-3


AHEAD: Final = Heading(Look.AHEAD)
LANES: Final = Heading(Look.LANES)
FIXED: Final = Heading(Look.FIXED, math.radians(120.0))
HOME: Final = Heading(Look.TOWARD, region="home")
GOAL: Final = Heading(Look.TOWARD, region="goal")
TOWER: Final = SMALL.replace("  pond:", "  tower: {kind: area, centre: [20, 10], radius_m: 0.5}\n  pond:")
TOWARD_TOWER: Final = Heading(Look.TOWARD, region="tower")

YAW_RATES: Final = sampled("yaw_rate_deg_s", [20.0, 45.0], [20.0])


@cache
def planned(text: str, heading: Heading | None, yaw_rate_deg_s: float = 45.0) -> FlightPlan:
    """A small mission with a heading."""
    spec = parse_mission(text.encode())
    limits = replace(spec.limits, yaw_rate_rad_s=math.radians(yaw_rate_deg_s))
    return plan_mission(replace(spec, limits=limits, flight=replace(spec.flight, heading=heading)))


def flown(plan: FlightPlan) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Times of setpoints, their headings, and their yaw rates, beginning with a nose to the south-west."""
    course = Course(plan.trajectory, -2.5, None, nose_of(plan))
    times = np.arange(-EARLY_S, plan.trajectory.duration_s, STEP_S)
    rows = [(course.turn(course.reference(t), max(t, 0.0), t), course.yaw_rate_rad_s) for t in times.tolist()]
    headings, rates = np.array(rows).T
    return times, headings, rates


def off(one: FloatArray, other: FloatArray | float) -> FloatArray:
    """The angles between headings."""
    return np.abs((one - other + math.pi) % (2.0 * math.pi) - math.pi)


def flight_of(plan: FlightPlan, times: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Speed and direction of the flight at times, by differences of positions."""
    half = 0.01
    steps = plan.trajectory.position(times + half) - plan.trajectory.position(times - half)
    return np.hypot(steps[:, 0], steps[:, 1]) / (2.0 * half), np.arctan2(steps[:, 0], steps[:, 1])


@pytest.mark.parametrize("text", [SMALL, ROUNDS, SMALL_FIELD], ids=["small", "rounds", "field"])
@pytest.mark.parametrize("heading", [AHEAD, LANES, FIXED, HOME])
@YAW_RATES
def test_no_heading_changes_faster_than_the_vehicle_turns(text: str, heading: Heading, yaw_rate_deg_s: float) -> None:
    plan = planned(text, heading, yaw_rate_deg_s)
    _, headings, rates = flown(plan)
    most = math.radians(yaw_rate_deg_s)
    assert off(headings[1:], headings[:-1]).max() <= most * STEP_S + 1e-9
    assert np.abs(rates).max() <= most + 1e-9


def between_lanes(plan: FlightPlan, times: FloatArray) -> BoolArray:
    """Which times are in a lane along which the nose looks, or next to it where it may be on its way."""
    nose = nose_of(plan)
    lead_s = math.pi / nose.rate_rad_s + 1.0
    found = np.zeros(len(times), dtype=np.bool_)
    for lane in nose.stretches:
        found |= (lane.begin_s - lead_s <= times) & (times <= lane.end_s + lead_s)
    return found


@pytest.mark.parametrize("text", [SMALL, ROUNDS, SMALL_FIELD], ids=["small", "rounds", "field"])
@YAW_RATES
def test_ahead_is_where_the_vehicle_flies(text: str, yaw_rate_deg_s: float) -> None:
    plan = planned(text, AHEAD, yaw_rate_deg_s)
    times, headings, _ = flown(plan)
    speeds, directions = flight_of(plan, np.maximum(times, 0.0))
    moving = (speeds > STANDING_M_S) & (times > 0.0) & ~between_lanes(plan, times)
    assert moving.sum() > 20
    assert off(headings, directions)[moving].max() < EXACT_RAD


def test_laps_begin_ahead_each_time() -> None:
    """The third lap is entered from the second, and the way back from the third, with other turns than the first."""
    plan = planned(ROUNDS, AHEAD)
    trajectory = replace(plan.trajectory, laps=3)
    times, headings, _ = flown(replace(plan, trajectory=trajectory))
    speeds, directions = flight_of(replace(plan, trajectory=trajectory), np.maximum(times, 0.0))
    moving = (speeds > STANDING_M_S) & (times > 0.0)
    assert off(headings, directions)[moving].max() < EXACT_RAD


@pytest.mark.parametrize("heading", [HOME, GOAL], ids=["home", "goal"])
@YAW_RATES
def test_toward_is_where_the_centre_of_the_region_lies(heading: Heading, yaw_rate_deg_s: float) -> None:
    plan = planned(SMALL, heading, yaw_rate_deg_s)
    times, headings, _ = flown(plan)
    away = np.array(shapely.box(*{"home": (4, 4, 14, 12), "goal": (26, 4, 36, 12)}[heading.region]).centroid.coords[0])
    away = away - plan.trajectory.position(np.maximum(times, 0.0))
    far = (np.hypot(away[:, 0], away[:, 1]) > 1.0) & (times > 0.0)
    # After a passage within a metre, which turns it right round, it has to come after.
    settled = far.copy()
    for k in range(1, round(math.pi / math.radians(yaw_rate_deg_s) / STEP_S) + 2):
        settled[k:] &= far[:-k] | (times[:-k] <= 0.0)
    assert settled.sum() > 100
    assert off(headings, np.arctan2(away[:, 0], away[:, 1]))[settled].max() < EXACT_RAD


def test_a_region_that_is_passed_closely_is_passed_slowly() -> None:
    """Past a tower at 2 m, a nose that turns at 20 degrees/s allows of 0.7 m/s."""
    hasty, plan = planned(TOWER, FIXED), planned(TOWER, TOWARD_TOWER, 20.0)
    times, headings, _ = flown(plan)
    away = np.array([20.0, 10.0]) - plan.trajectory.position(np.maximum(times, 0.0))
    assert 1.0 < np.hypot(away[:, 0], away[:, 1]).min() < 3.0
    assert off(headings, np.arctan2(away[:, 0], away[:, 1]))[times > 0.0].max() < EXACT_RAD
    assert plan.trajectory.duration_s > hasty.trajectory.duration_s + 5.0


def test_fixed_is_the_same_all_the_time() -> None:
    plan = planned(SMALL, replace(FIXED, fixed_rad=math.radians(-240.0)))
    times, headings, rates = flown(plan)
    assert off(headings, math.radians(120.0))[times > 0.0].max() < 1e-9
    assert np.abs(rates[times > 0.0]).max() == 0.0
    assert plan.trajectory.duration_s == planned(SMALL, FIXED, 20.0).trajectory.duration_s


@pytest.mark.parametrize("heading", [AHEAD, LANES, FIXED, HOME])
def test_pictures_are_taken_along_their_lanes_whatever_the_heading(heading: Heading) -> None:
    plan = planned(SMALL_FIELD, heading, 30.0)
    times, headings, _ = flown(plan)
    assert plan.photographs
    for lane in plan.photographs:
        assert lane.heading_rad is not None
        within = (times >= lane.begin_s) & (times <= lane.end_s)
        assert off(headings[within], lane.heading_rad).max() < EXACT_RAD


def test_lanes_without_a_camera_are_looked_along_where_the_mission_says_so() -> None:
    text = SMALL_FIELD.replace("camera: {field_of_view_deg: [60, 45], overlap: 0.5, sidelap: 0.4}", "spacing_m: 5")
    plan, hasty = planned(text, LANES), planned(text, FIXED)
    times, headings, _ = flown(plan)
    [visit] = plan.covers
    assert visit.trigger_m is None
    ends = plan.trajectory.time_at(visit.lanes_s[:, 1]).tolist()
    begins = plan.trajectory.time_at(visit.lanes_s[:, 0], leaving=True).tolist()
    for begin, end, ((x, y), (u, v)) in zip(begins, ends, visit.lanes_m.tolist(), strict=True):
        within = (times >= begin) & (times <= end)
        assert off(headings[within], math.atan2(u - x, v - y)).max() < EXACT_RAD
    assert plan.trajectory.duration_s > hasty.trajectory.duration_s


def test_a_way_that_nowhere_turns_is_no_slower_for_the_nose() -> None:
    curve = JoinedCurve((RoundedPolyline(np.array([[3.0, -2.0], [33.0, -2.0]]), np.empty(0), 1.0),))
    assert slow_to_turn(planned(SMALL, AHEAD, 360.0).spec, curve, (), None) == ((), ())


def test_without_a_heading_nothing_is_slower() -> None:
    one, other = planned(ROUNDS, None).trajectory, planned(ROUNDS, None, 20.0).trajectory
    for before, after in zip(one.legs, other.legs, strict=True):
        np.testing.assert_array_equal(before.law.knots_t_s, after.law.knots_t_s)


@pytest.mark.parametrize("text", [SMALL, ROUNDS, SMALL_FIELD], ids=["small", "rounds", "field"])
@pytest.mark.parametrize("heading", [AHEAD, LANES, FIXED, HOME])
def test_the_checker_finds_each_of_these_plans_true(text: str, heading: Heading) -> None:
    found = {claim.name: claim.fault for claim in claims(plan_to_json(planned(text, heading, 20.0)))}
    assert not any(found[name] for name in ("time law", "stops", "lanes", "photographs", "heading")), found


@pytest.mark.parametrize(
    ("text", "heading", "words"),
    [(SMALL, AHEAD, "too soon to turn"), (ROUNDS, AHEAD, "rad/s at"), (TOWER, TOWARD_TOWER, "rad/s at")],
    ids=["small", "rounds", "tower"],
)
def test_the_checker_finds_a_flight_that_is_too_fast_for_its_nose(text: str, heading: Heading, words: str) -> None:
    plan = json.loads(plan_to_json(planned(text, heading)))
    plan["mission"]["limits"]["yaw_rate_deg_s"] = 15.0
    [fault] = [claim.fault for claim in claims(json.dumps(plan)) if claim.name == "heading"]
    assert fault is not None
    assert words in fault
