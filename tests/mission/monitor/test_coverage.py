"""What of a field was covered is told from where the vehicle said that it was while it flew its lanes."""

from dataclasses import replace

import numpy as np
import pytest

from mission.geometry.arrays import FloatArray
from mission.monitor.coverage import CoverageWatch, Covered, coverage_text, judged, on_lanes
from mission.monitor.monitor import Outcome
from mission.plan import FlightPlan
from tests.support.fields import FIELD_WITH_A_BARN, TWO_FIELDS
from tests.support.small_missions import plan_of

LANDED = Outcome(achieved=True, reason="the word that was flown satisfies the specification")


@pytest.fixture(scope="module")
def farm() -> FlightPlan:
    return plan_of(FIELD_WITH_A_BARN)


def watched(plan: FlightPlan, times: FloatArray, off_m: tuple[float, float] = (0.0, 0.0)) -> tuple[Covered, ...]:
    """A flight that is told of at these times on the trajectory, a little to one side."""
    watch = CoverageWatch(plan)
    places = plan.trajectory.position(times) + np.array(off_m)
    for t_s, (east, north) in zip(times.tolist(), places.tolist(), strict=True):
        watch.report(100.0 + t_s, t_s, (east, north))
    return watch.covered(plan.trajectory)


def test_a_flight_on_the_trajectory_covers_what_was_planned(farm: FlightPlan) -> None:
    [seen] = watched(farm, np.arange(0.0, farm.trajectory.duration_s, 0.2))
    [visit] = farm.covers
    assert seen.region == "field"
    assert seen.lap == 0
    assert seen.share == pytest.approx(visit.planned_share, abs=2e-3)
    assert seen.enough
    assert coverage_text([seen]) == f"field covered to {seen.share:.1%}"
    assert judged(LANDED, [seen]) is LANDED
    assert seen.left_out.area == pytest.approx((1.0 - seen.share) * farm.area_of("field").area)


def test_a_lane_that_was_not_told_of_is_not_covered(farm: FlightPlan) -> None:
    """Reports of a third of the longest lane are missing: its strip is left out where no neighbour covers it too."""
    [visit] = farm.covers
    times = np.arange(0.0, farm.trajectory.duration_s, 0.2)
    longest = int(np.argmax(visit.lanes_s[:, 1] - visit.lanes_s[:, 0]))
    begin, end = visit.lanes_s[longest]
    s = farm.trajectory.parameter(times)
    third = (end - begin) / 3.0
    heard = (s < begin + third) | (s > end - third)
    [seen] = watched(farm, times[heard])
    length_m = np.hypot(*(visit.lanes_m[longest, 1] - visit.lanes_m[longest, 0]))
    lost = length_m / 3.0 * visit.spacing_m / farm.area_of("field").area
    assert 0.4 * lost < visit.planned_share - seen.share < 1.1 * lost
    asked = replace(seen, asked=0.99)
    assert not asked.enough
    assert judged(LANDED, [asked]) == Outcome(achieved=False, reason="too little of field was covered, 99.0% is asked")


def test_what_is_flown_between_lanes_does_not_count(farm: FlightPlan) -> None:
    [visit] = farm.covers
    times = np.arange(0.0, farm.trajectory.duration_s, 0.2)
    off = ~on_lanes(visit, farm.trajectory.parameter(times))
    assert off.any()
    assert all(seen.share < 0.1 for seen in watched(farm, times[off]))  # lanes shorter than a gap between reports
    aside = watched(farm, times, off_m=(0.0, 30.0))
    assert aside[0].share < 0.8


def test_each_lap_is_judged_for_itself() -> None:
    plan = plan_of(TWO_FIELDS.replace("START", "40, 9"))
    times = np.arange(0.0, plan.trajectory.duration_s, 0.2)
    assert [(seen.region, seen.lap, seen.enough) for seen in watched(plan, times)] == [
        (region, lap, True) for lap in (1, 2) for region in dict.fromkeys(visit.region for visit in plan.covers)
    ]
    second = watched(plan, times[plan.trajectory.lap_at(times) != 1])
    assert {seen.lap for seen in second} == {2}
    poor = [replace(seen, share=0.5) for seen in second]
    assert coverage_text(poor) == ", ".join(f"{seen.region} covered to 50.0% in lap 2" for seen in poor)
    assert judged(LANDED, poor).reason == f"too little of {poor[0].region} was covered, 98.0% is asked; so were 1 more"
