"""Flights of laps that are planned anew in the middle of one: what the lap had is not done again, the rest is."""

from itertools import groupby, product

import numpy as np
import pytest
import shapely

from mission.plan import FlightPlan
from tests.closed_loop.test_amended import flown
from tests.support.fault_grid import MISSION
from tests.support.replanned import Replanned
from tests.support.small_missions import ROUNDS, plan_of
from tests.support.usual_cases import sampled
from vehicle_sim.parameters import Flavour

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


def moments(*usual: tuple[str, float]) -> pytest.MarkDecorator:
    """Flavours and shares of the laps: some are flown always, the others in long campaigns."""
    return sampled(("flavour", "share"), product(Flavour, (0.05, 0.2, 0.4, 0.6, 0.8)), usual)


@moments(("px4", 0.4))
def test_each_region_is_visited_as_often_as_there_are_laps(rounds: FlightPlan, flavour: str, share: float) -> None:
    _, entered = replanned(rounds, flavour, share_of_laps(rounds, share))
    assert entered.count("north") == 2
    # The last lap may be closed where it began.
    assert entered.count("east") in {2, 3}


@moments(("ardupilot", 0.4))
def test_each_lane_is_flown_once_a_lap(field: FlightPlan, flavour: str, share: float) -> None:
    flight, entered = replanned(field, flavour, share_of_laps(field, share))
    assert entered.count("field") == 2
    assert entered.count("goal") in {2, 3}
    [visit] = field.covers
    once_m = float(np.linalg.norm(visit.lanes_m[:, 1] - visit.lanes_m[:, 0], axis=1).sum()) + visit.ways_m
    track = shapely.LineString(flight.record.track.position_m[:, :2])
    inside_m = float(shapely.intersection(track, field.area_of("field")).length)
    assert 1.8 * once_m < inside_m < 2.5 * once_m
