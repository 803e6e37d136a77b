"""Flights of laps that are planned anew in the middle of one: what the lap had is not done again, the rest is."""

from itertools import groupby

import pytest

from mission.plan import FlightPlan
from tests.closed_loop.test_amended import flown
from tests.support.fault_grid import MISSION
from tests.support.replanned import Replanned
from tests.support.small_missions import ROUNDS, plan_of

EITHER = pytest.mark.parametrize("flavour", ["ardupilot", pytest.param("px4", marks=pytest.mark.long)])
ELSEWHERE = "restrict elsewhere [[17, 27], [19, 27], [19, 29], [17, 29]]"
"""What is in nobody's way: for its sake another plan is made."""


def replanned(plan: FlightPlan, flavour: str, at_s: float) -> tuple[Replanned, list[str]]:
    """A flight for which another plan is asked for at a time of its trajectory, and what it entered."""
    flight, said = flown(plan, flavour, (at_s, ELSEWHERE))
    [(_, answer)] = said.answers
    assert answer.accepted, answer.words
    assert flight.result.achieved, flight.result.reason
    assert flight.result.laps == 2
    assert flight.result.reason.startswith(("2 of 2 laps were flown", "2 laps were flown"))
    # On the rim of a region a vehicle may enter it twice.
    return flight, [name for name, _ in groupby(flight.entered())]


def share_of_laps(plan: FlightPlan, share: float) -> float:
    begin_s = plan.trajectory.legs[0].duration_s
    return begin_s + share * (plan.trajectory.laps_end_s - begin_s)


@pytest.fixture(scope="module")
def rounds() -> FlightPlan:
    return plan_of(ROUNDS)


@pytest.fixture(scope="module")
def field() -> FlightPlan:
    return plan_of(MISSION.replace("laps: 1", "laps: 2"))


@EITHER
@pytest.mark.parametrize("share", [0.05, 0.2, 0.4, 0.6, 0.8])
def test_each_region_is_visited_as_often_as_there_are_laps(rounds: FlightPlan, flavour: str, share: float) -> None:
    _, entered = replanned(rounds, flavour, share_of_laps(rounds, share))
    print("ZZ", share, flavour, entered, [(e["laps_before"], e["begun"], e["t_s"]) for e in _.events("leg")], [e["reason"] for e in _.events("asked again")])
    assert entered.count("north") == 2
    # The last lap may be closed where it began.
    assert entered.count("east") in {2, 3}


@EITHER
@pytest.mark.parametrize("share", [0.05, 0.2, 0.4, 0.6, 0.8])
def test_each_lane_is_flown_once_a_lap(field: FlightPlan, flavour: str, share: float) -> None:
    flight, entered = replanned(field, flavour, share_of_laps(field, share))
    inside = [field.area_of("field").contains(__import__("shapely").Point(l["position_m"])) for l in flight.lines if l["kind"]=="telemetry"]
    print("ZZ", share, flavour, entered, sum(inside), [(e["laps_before"], e["begun"], e["t_s"]) for e in flight.events("leg")], [e["reason"] for e in flight.events("asked again")])
    assert entered.count("field") == 2
    assert entered.count("goal") in {2, 3}
