"""Plans on maps that move, against polygons at dense instants; and what is not planned there."""

from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from mission.errors import NoPlanError
from mission.logic.formula.syntax import eventually, proposition
from mission.plan import plan_from_json, plan_mission, plan_to_json
from mission.plan.flight_plan import FlightPlan
from mission.plan.time_bounds import FOLLOWED_S
from mission.spec.loader import parse_mission
from mission.spec.model import MissionSpec
from tests.support.drawn_cases import tried
from tests.support.drifting_missions import drifting, drifting_text

SHIP = """
domain:
  boundary: [[0, 0], [200, 0], [200, 100], [0, 100]]
  mesh: {largest_m: 25}
regions:
  quay: {kind: home, polygon: [[8, 8], [28, 8], [28, 24], [8, 24]]}
  deck: {kind: survey, polygon: [[60, 74], [84, 74], [84, 88], [60, 88]], loiter_s: %(loiter)s, motion: %(motion)s}
  pier: {kind: area, polygon: [[150, 44], [180, 44], [180, 60], [150, 60]]}
mission: {formula: "%(formula)s"}
start: {position_m: [18, 16]}
flight: {speed_m_s: 5, altitude_m: 25, time_constant_s: 1.0, disturbance_m_s2: 0.5}
limits: {speed_m_s: 8, acceleration_m_s2: 2.5, tilt_deg: 25}
"""


def ship(
    formula: str = "F (deck & F G pier)", motion: str = "{velocity_m_s: [1.5, 0], until_s: 60}", loiter: int = 4
) -> MissionSpec:
    return parse_mission((SHIP % {"formula": formula, "motion": motion, "loiter": loiter}).encode())


@cache
def ship_plan() -> FlightPlan:
    return plan_mission(ship())


def area_at(plan: FlightPlan, name: str, time_s: float) -> shapely.Geometry:
    """Where a region is at a time, by its outline as it is drawn and the displacement that is written beside it."""
    (region,) = (each for each in plan.spec.regions if each.name == name)
    corners = np.array(region.shape.corners_m)  # type: ignore[union-attr]
    rows = np.array(region.motion.waypoints if region.motion else ((0.0, 0.0, 0.0),))
    east, north = (float(np.interp(time_s, rows[:, 0], rows[:, axis])) for axis in (1, 2))
    return shapely.Polygon(corners + np.array([east, north]))


def squares(plan: FlightPlan, times: np.ndarray, half_m: float) -> np.ndarray:
    places = plan.trajectory.position(times)
    return np.asarray(shapely.box(*(places - half_m).T, *(places + half_m).T))


def never_met(plan: FlightPlan, name: str) -> bool:
    """Whether a tube that is off its clock by as much as may be never meets a region."""
    times = np.arange(0.0, plan.trajectory.duration_s + 20.0, 0.05)
    off = (-0.9 * FOLLOWED_S, 0.0, 0.9 * FOLLOWED_S)
    tubes = squares(plan, times, 0.999 * plan.certificate.tube_m)
    return not any(
        shapely.intersects(area_at(plan, name, t + late), tube)
        for late in off
        for t, tube in zip(times, tubes, strict=True)
    )


@given(
    velocity=st.tuples(st.integers(-8, 8), st.integers(-16, 24)),
    begins_s=st.integers(0, 25),
    lasts_s=st.integers(5, 20),
)
@tried(3)
def test_a_plan_keeps_out_of_what_drifts_wherever_that_is(
    velocity: tuple[int, int], begins_s: int, lasts_s: int
) -> None:
    east, north = velocity[0] / 10, velocity[1] / 10
    motion = f"{{velocity_m_s: [{east}, {north}], from_s: {begins_s}, until_s: {begins_s + lasts_s}}}"
    try:
        plan = plan_mission(drifting(motion=motion))
    except NoPlanError:
        return
    assert plan.certificate.holds
    assert never_met(plan, "K")
    assert plan.certificate.clearance_m is not None
    times = np.arange(0.0, plan.trajectory.duration_s, 0.1)
    places = shapely.points(plan.trajectory.position(times))
    nearest = min(shapely.distance(p, area_at(plan, "K", t)) for t, p in zip(times, places, strict=True))
    assert 0.85 * nearest - 0.1 <= plan.certificate.clearance_m <= nearest + 1e-9


def test_it_goes_round_what_is_in_the_way_then_and_straight_where_it_is_not() -> None:
    across = plan_mission(drifting())
    aside = plan_mission(drifting(motion="{velocity_m_s: [0, 0.1], until_s: 9}"))
    assert aside.trajectory.duration_s < across.trajectory.duration_s
    assert never_met(across, "K")


def test_a_deck_under_way_is_visited_where_it_is_and_its_run_is_one_of_the_map() -> None:
    plan = ship_plan()
    (stop,) = (s for s, seconds in plan.stops if seconds == 4.0)
    begin_s, end_s = plan.trajectory.time_at([stop])[0], plan.trajectory.time_at([stop], leaving=True)[0]
    times = np.arange(begin_s, end_s, 0.1)
    tubes = squares(plan, times, plan.certificate.tube_m)
    assert end_s - begin_s >= 4.0
    assert all(shapely.covers(area_at(plan, "deck", t), tube) for t, tube in zip(times, tubes, strict=True))
    assert plan.certificate.word[::2] == (frozenset({"quay"}), frozenset({"deck"}), frozenset({"pier"}))
    states = [*plan.run.states]
    across = plan.partition.neighbours
    assert all(b in across[a] for a, b in pairwise(states))
    assert plan.labelling.label(states[-1]) == {"pier"}
    assert plan.moving is not None


def test_a_flight_may_end_on_a_deck_that_has_come_to_rest() -> None:
    plan = plan_mission(ship("F G deck", "{waypoints: [[20, 60, -20]]}", 0))
    assert plan.trajectory.duration_s > 15.0
    end_m = shapely.Point(plan.trajectory.position([1e6])[0])
    assert shapely.covers(area_at(plan, "deck", 1e6), end_m)


def test_a_plan_is_the_same_again_and_its_file_gives_it_back() -> None:
    plan = ship_plan()
    text = plan_to_json(plan)
    assert plan_to_json(plan_mission(ship())) == text
    again = plan_from_json(text)
    assert plan_to_json(again) == text
    assert again.moving is not None
    assert (again.moving.places_m == plan.moving.places_m).all()  # type: ignore[union-attr]
    assert all(bound.kept for bound in again.bounds)


def test_bounds_in_seconds_of_what_moves_are_those_of_its_visit() -> None:
    plan = ship_plan()
    asked = replace(plan.required, timed=(eventually(proposition("deck"), (Fraction(0), Fraction(40))),))
    (bound,) = replace(plan, required=asked).bounds
    times = np.arange(0.0, 40.0, 0.01)
    inside = [
        shapely.covers(area_at(plan, "deck", t), s) for t, s in zip(times, squares(plan, times, 0.5), strict=True)
    ]
    spare_s = 40.0 - float(times[int(np.argmax(inside))])
    assert spare_s - 0.8 <= bound.margin_s <= spare_s
    with pytest.raises(NoPlanError, match=r"F\[0,8\] deck fails by 1\d\.\d\d s"):
        plan_mission(ship("F[0,8] deck & F G pier"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (drifting_text("G F S1 & G F home"), "laps are flown again and again"),
        (
            drifting_text() + "smoothing: {extension: odd, frequencies: auto}\n",
            "path of the fields is made for a map that stands still",
        ),
    ],
)
def test_what_is_made_for_maps_that_stand_still_is_refused(text: str, message: str) -> None:
    with pytest.raises(NoPlanError, match=message):
        plan_mission(parse_mission(text.encode()))


def test_a_deck_that_leaves_while_one_should_stand_over_it_is_refused() -> None:
    with pytest.raises(NoPlanError, match=r"deck moves on so fast that no place is in it from \d+\.\d to \d+\.\d s"):
        plan_mission(ship(loiter=30))
