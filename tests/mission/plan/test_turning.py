"""Time to turn before photographed lanes: enough of it, and none where nothing is photographed."""

from dataclasses import replace
from itertools import pairwise
from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.plan import FlightPlan, plan_to_json
from mission.plan.pace import trajectory_of
from mission.plan.turning import SETTLE_S, TURN_RAD_S, RunIn, headings_of, lead_s, looked_along, run_ins, turn_s
from mission.verify.plans import claims
from tests.support.fields import SMALL_FIELD
from tests.support.small_missions import plan_of

LAPS = 'mission: {formula: "G F field & G F home", laps: 2}'
LEAD_S = lead_s(TURN_RAD_S)


@pytest.fixture(scope="module")
def plan() -> FlightPlan:
    return plan_of(SMALL_FIELD)


def test_headings_are_clockwise_from_north() -> None:
    lanes = np.array([[[0.0, 0.0], [0.0, 5.0]], [[1.0, 1.0], [4.0, 1.0]], [[0.0, 0.0], [0.0, -2.0]]])
    np.testing.assert_allclose(headings_of(lanes), [0.0, pi / 2.0, pi])


def test_turning_takes_the_short_way_and_time_to_settle() -> None:
    assert turn_s(0.1, 0.1) == 0.0
    assert turn_s(-3.0, 3.0) == pytest.approx((2.0 * pi - 6.0) / TURN_RAD_S + SETTLE_S)
    assert turn_s(0.0, pi) == pytest.approx(LEAD_S)


@given(st.floats(0.0, 100.0), st.floats(0.0, 20.0), st.floats(0.1, 10.0))
def test_a_run_in_lasts_as_long_as_it_takes_to_turn(begin_s: float, length_s: float, lasts_s: float) -> None:
    run_in = RunIn(begin_s, begin_s + length_s, lasts_s)
    way_s = run_in.end_s - run_in.begin_s
    assert way_s / run_in.rate + run_in.wait_s == pytest.approx(lasts_s)
    assert run_in.wait_s >= -1e-9 or way_s > lasts_s


def test_between_lanes_there_is_time_to_turn(plan: FlightPlan) -> None:
    [visit] = plan.covers
    hasty = trajectory_of(plan.spec, plan.trajectory.curve, plan.stops, None)
    assert run_ins(hasty, plan.covers)
    headings = headings_of(visit.lanes_m).tolist()
    assert plan.photographs[0].begin_s >= LEAD_S
    for (before, after), (one, other) in zip(pairwise(plan.photographs), pairwise(headings), strict=True):
        assert after.begin_s - before.end_s >= turn_s(one, other) - 1e-6
    assert [stretch.heading_rad for stretch in plan.photographs] == headings
    assert hasty.duration_s < plan.trajectory.duration_s < hasty.duration_s + len(headings) * LEAD_S


def test_without_a_camera_nothing_is_slower(plan: FlightPlan) -> None:
    blind = [replace(visit, trigger_m=None) for visit in plan.covers]
    hasty = trajectory_of(plan.spec, plan.trajectory.curve, plan.stops, None)
    assert run_ins(hasty, looked_along(plan.spec, blind)) == ()
    assert trajectory_of(plan.spec, plan.trajectory.curve, plan.stops, None, blind).duration_s == hasty.duration_s


def test_each_lap_has_time_to_turn_before_its_lanes() -> None:
    text = SMALL_FIELD.replace(SMALL_FIELD[SMALL_FIELD.index("mission:") :].splitlines()[0], LAPS)
    plan = plan_of(text)
    assert plan.trajectory.lap is not None
    [visit] = plan.covers
    begin, end = plan.curve.starts_s[plan.trajectory.lap : plan.trajectory.lap + 2]
    assert begin <= visit.start_s == visit.lanes_s[0, 0] < end
    assert [claim.fault for claim in claims(plan_to_json(plan), "plan.json") if claim.fault] == []


FEW_ON_SLOW_TURNS = """\
domain: {boundary: [[0, 0], [99.7, 0], [99.7, 78.5], [0, 78.5]]}
regions:
  a:
    kind: survey
    polygon: [[74.3, 21.4], [82.4, 35.5], [72.7, 48.9], [58.2, 41.6], [57.7, 25.3]]
    cover: {camera: {field_of_view_deg: [60, 45], overlap: 0.5, sidelap: 0.3}}
mission: {formula: F a}
start: {position_m: [64.7, 11.2]}
flight: {heading: lanes, altitude_m: ALTITUDE}
limits: {yaw_rate_deg_s: 20}
"""


@pytest.mark.parametrize("altitude_m", ["5", "6"])
def test_time_to_turn_that_is_lost_elsewhere_is_given_there_too(altitude_m: str) -> None:
    """At 5 m a wait to turn lies a micrometre behind the begin of a lane; at 6 m a part is faster the second time."""
    plan = plan_of(FEW_ON_SLOW_TURNS.replace("ALTITUDE", altitude_m))
    assert [claim for claim in claims(plan_to_json(plan)) if claim.fault] == []
