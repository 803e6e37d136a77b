"""Flights that leave their tube and go on by another plan: nothing is skipped, and the verdict is that of all legs."""

import json
from pathlib import Path

import numpy as np
import pytest

from mission.cli.report import with_later_plans, write_again
from mission.fly.replanner import PlanRequest, SynchronousReplanner
from mission.link.ending import Ending
from mission.plan import FlightPlan
from mission.report.figures.paths import flown_path
from mission.spec.loader import parse_mission
from mission.verify.flown.judging import judged
from mission.verify.logs.flight_record import track_of_record
from tests.support.replanned import Replanned
from tests.support.small_missions import PHOTOGRAPHED, ROUNDS, SMALL, plan_of
from tests.support.usual_cases import ARDUPILOT

GUST = "gust, since: takeoff, at_s: 12, for_s: 3, north_m_s: 20"
REPLANNED = "flight:\n  replan: true\n"


def replanned(text: str) -> FlightPlan:
    return plan_of(text.replace("flight:\n", REPLANNED))


@pytest.fixture(scope="module")
def small() -> FlightPlan:
    return replanned(SMALL)


def test_a_mission_says_whether_it_is_replanned(small: FlightPlan) -> None:
    assert small.spec.flight.replan
    assert not parse_mission(SMALL.encode()).flight.replan


@pytest.fixture(scope="module")
def pushed(small: FlightPlan) -> Replanned:
    """A flight that is pushed out of its tube."""
    return Replanned(small, "px4", GUST)


def test_pushed_out_of_its_tube_it_goes_on_from_there(small: FlightPlan, pushed: Replanned, tmp_path: Path) -> None:
    flown = pushed
    assert flown.result.achieved, flown.result.reason
    assert flown.result.ending is Ending.LANDED
    assert len(flown.result.plans) > 1
    assert flown.entered() == ["home", "goal", "home"]
    begun = flown.events("leg")
    assert [line["number"] for line in begun] == list(range(2, len(flown.result.plans) + 1))
    assert "out of its tube" in begun[0]["reason"]
    # Whoever judges flights of any autopilot says the same, of the mission as it was written.
    assert judged(small.spec, track_of_record(flown.record), fastest_m_s=20.0).achieved
    # The report is of all plans.
    folder = flown.written(tmp_path, SMALL)
    write_again(folder, pictures=False)
    told = json.loads((folder / "summary.json").read_text())["flown"]
    assert told["plans"] == len(flown.result.plans)
    assert told["judged"]["so_far"] == "open"
    assert told["judged"]["violations"] == []
    assert told["largest_error_m"] == pytest.approx(flown.result.largest_distance_m, abs=0.05)
    drawn = flown_path(small, with_later_plans(flown.record, folder))
    named = {line.get_gid() for line in drawn.axes[0].lines}
    assert {"planned", "planned 2", "flown"} <= named


def test_the_same_seed_gives_the_same_flight(small: FlightPlan, pushed: Replanned) -> None:
    assert Replanned(small, "px4", GUST).sink.getvalue() == pushed.sink.getvalue()


@ARDUPILOT
def test_laps_are_counted_over_all_plans(flavour: str) -> None:
    plan = replanned(ROUNDS)
    flown = Replanned(plan, flavour, "gust, since: takeoff, at_s: 16, for_s: 3, east_m_s: 20")
    assert flown.result.achieved, flown.result.reason
    assert len(flown.result.plans) > 1
    assert flown.result.laps == 2
    assert "2 laps were flown" in flown.result.reason or "2 of 2 laps were flown" in flown.result.reason
    visited = flown.entered()
    assert visited[-1] == "home"
    assert min(visited.count("east"), visited.count("north")) >= 2


@ARDUPILOT
def test_a_field_is_covered_by_both_plans_together(flavour: str) -> None:
    plan = replanned(PHOTOGRAPHED)
    flown = Replanned(plan, flavour, "gust, since: takeoff, at_s: 20, for_s: 3, north_m_s: 20")
    assert flown.result.achieved, flown.result.reason
    assert len(flown.result.plans) > 1
    [covered] = flown.result.covered
    assert covered.share >= 0.9
    # No picture is taken twice, and none is left out: by where the record says that they were taken. Only what is left
    # of a lane begins with a picture of its own, however near the last one before it was.
    places = np.array([each.position_m[:2] for each in flown.record.pictures])
    apart = np.hypot(*(places[:, None] - places[None, :]).transpose(2, 0, 1)) + np.diag(np.full(len(places), np.inf))
    assert int((apart.min(axis=1) <= 1.0).sum()) in (0, 2)
    assert apart.min() > 0.2
    assert abs(len(places) - plan.planned_pictures) <= 2
    assert flown.entered()[-1] == "home"


class Gone(SynchronousReplanner):
    """A planner that has ended."""

    trouble = "the planner's process has ended"

    def ask(self, request: PlanRequest) -> None:
        """Nobody hears it."""

    def answer(self) -> None:
        """None comes."""


def test_without_its_planner_it_flies_the_old_plan_on_while_that_is_safe(small: FlightPlan) -> None:
    flown = Replanned(small, "ardupilot", GUST, replanner=lambda vehicle: Gone(vehicle.now_s))
    assert flown.result.achieved, flown.result.reason
    assert len(flown.result.plans) == 1
    assert flown.events("no plan")[0]["reason"] == Gone.trouble
