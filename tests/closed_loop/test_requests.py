"""Somebody who watches asks the flight to hold, to go on, to return, to land: granted or refused in words."""

import math
from itertools import pairwise

import pytest

from mission.fly import FlightOptions, Progress
from mission.fly.requests import Request
from mission.link.ending import Ending
from mission.monitor.stage import Stage
from mission.plan import FlightPlan
from tests.support.replanned import Replanned
from tests.support.small_missions import SMALL, plan_of
from tests.support.usual_cases import ARDUPILOT, PX4
from vehicle_sim.autopilot import Mode

HOLD, RESUME, RETURN, LAND = Request


@pytest.fixture(scope="module")
def small() -> FlightPlan:
    return plan_of(SMALL)


class Asked:
    """Requests at times after the trajectory began, and what was answered when."""

    def __init__(self, *requests: tuple[float, Request], piloted_from_s: float = math.inf) -> None:
        self.waiting = [*requests]
        self.since_s = -math.inf
        self.answers: list[tuple[float, Request, str, bool]] = []
        self.piloted_from_s = piloted_from_s

    def look(self, flown: Replanned, since_s: float) -> None:
        self.since_s = since_s
        if since_s >= self.piloted_from_s:
            self.piloted_from_s = math.inf
            flown.vehicle.vehicle.autopilot.set_mode(Mode.POSITION)

    def take(self) -> Request | None:
        if not self.waiting or self.since_s < self.waiting[0][0]:
            return None
        return self.waiting.pop(0)[1]

    def answer(self, request: Request, words: str, *, granted: bool) -> None:
        self.answers.append((self.since_s, request, words, granted))


def flown(
    plan: FlightPlan, flavour: str, *requests: tuple[float, Request], options: FlightOptions | None = None
) -> tuple[Replanned, Asked]:
    asked = Asked(*requests)
    return Replanned(plan, flavour, at_step=asked.look, requests=asked, options=options), asked


def places(flight: Replanned, from_s: float, to_s: float) -> list[tuple[float, float]]:
    """Where it was reported, between times after the trajectory began."""
    began_s = flight.result.began_s or 0.0
    rows = [row for row in flight.lines if row["kind"] == "telemetry" and from_s <= row["t_s"] - began_s <= to_s]
    return [(row["position_m"][0], row["position_m"][1]) for row in rows]


@PX4
def test_a_hold_rests_the_vehicle_on_its_path_until_it_is_told_to_go_on(small: FlightPlan, flavour: str) -> None:
    flight, asked = flown(small, flavour, (2.0, HOLD), (6.0, HOLD), (9.0, RESUME), (10.0, RESUME))
    assert [granted for *_, granted in asked.answers] == [True, False, True, False]
    assert "holds already" in asked.answers[1][2]
    assert "nothing waits" in asked.answers[3][2]
    assert max(math.dist(a, b) for a, b in pairwise(places(flight, 7.0, 9.0))) < 0.1
    assert flight.result.achieved, flight.result.reason
    assert len(flight.result.plans) == 1
    assert flight.result.largest_error_m <= small.certificate.tube_m
    assert flight.entered() == ["home", "goal", "home"]
    # What was asked, and what came of it, is in the record, and told to those who watch the terminal.
    assert [row["request"] for row in flight.events("request")] == ["hold", "hold", "resume", "resume"]
    assert [row["granted"] for row in flight.events("request answered")] == [True, False, True, False]
    assert flight.told[0] == "asked to hold: the vehicle slows to rest on its path and holds there"


def test_whoever_is_held_gets_no_other_plan_when_wind_blows_it_out_of_its_tube() -> None:
    plan = plan_of(SMALL.replace("flight:\n", "flight:\n  replan: true\n"))
    asked = Asked((7.2, HOLD), (10.0, LAND))
    gust = (
        "gust, since: takeoff, at_s: 12, for_s: 3, north_m_s: 20"  # alone it has another plan made 7.6 s from the start
    )
    flight = Replanned(plan, "ardupilot", gust, at_step=asked.look, requests=asked)
    assert [granted for *_, granted in asked.answers] == [True, True]
    assert flight.result.largest_error_m > plan.certificate.tube_m
    assert flight.events("replanning") == []


@ARDUPILOT
def test_a_return_is_planned_proved_and_ends_at_home(small: FlightPlan, flavour: str) -> None:
    flight, asked = flown(small, flavour, (2.5, HOLD), (9.0, RETURN), (11.0, RETURN))
    _, (_, _, words, granted), (_, _, again, twice) = asked.answers
    assert granted, words
    assert (twice, again) == (False, "the vehicle returns already")
    assert flight.result.ending is Ending.LANDED
    assert not flight.result.violations
    assert flight.result.plans[1].certificate.holds
    assert flight.entered() == ["home", "home"]
    assert not flight.result.achieved
    assert "the mission was given up for a return" in flight.result.reason
    assert "left undone: goal" in flight.result.reason
    [leg] = flight.events("leg")
    assert (leg["reason"], leg["returns"]) == ("asked to return", True)
    assert math.dist(leg["start_m"], places(flight, 8.0, 9.0)[-1]) < 0.5  # where it waited


@ARDUPILOT
def test_a_landing_lands_where_the_vehicle_is(small: FlightPlan, flavour: str) -> None:
    flight, asked = flown(small, flavour, (-math.inf, RETURN), (2.0, LAND), (4.0, LAND), (4.5, HOLD))
    [before, *asked.answers] = asked.answers
    assert (before[2], before[3]) == (
        f"the vehicle is {Stage.STREAMS}: it can return only while it flies its path",
        False,
    )
    assert [granted for *_, granted in asked.answers] == [True, False, False]
    assert asked.answers[1][2].endswith("already")
    assert "it can hold only while it flies its path" in asked.answers[2][2]
    assert flight.result.ending is Ending.STOPPED
    assert flight.result.interrupted
    assert not flight.vehicle.vehicle.autopilot.armed
    assert flight.result.reason.startswith("a landing was asked for")
    assert math.dist(places(flight, 2.0, 2.2)[0], places(flight, 2.0, math.inf)[-1]) < 10.0


def test_a_landing_in_the_take_off_waits_for_some_height(small: FlightPlan) -> None:
    """On the ground it would be a disarming, which an autopilot that is about to lift off refuses."""
    asked = Asked()

    class TakesOff(Replanned):
        def _look(self, progress: Progress) -> None:
            super()._look(progress)
            if progress.stage in (Stage.TAKE_OFF, Stage.CLIMB) and not (asked.answers and asked.answers[-1][3]):
                asked.waiting = [(-math.inf, HOLD), (-math.inf, LAND)]

    flight = TakesOff(small, "px4", requests=asked)
    assert not any(granted for _, request, _, granted in asked.answers if request is HOLD)
    refused = [words for _, request, words, granted in asked.answers if request is LAND and not granted]
    assert all(words.endswith("it can land once it is 2 m high") for words in refused)
    assert any(Stage.TAKE_OFF in words for words in refused)
    assert flight.result.reason.startswith("a landing was asked for")
    assert not flight.vehicle.vehicle.autopilot.armed


def test_a_pilot_wins(small: FlightPlan) -> None:
    options = FlightOptions(resume_when_handed_back=True)

    class GivesBack(Asked):
        def look(self, flown: Replanned, since_s: float) -> None:
            super().look(flown, since_s)
            if since_s >= 12.0 and flown.vehicle.vehicle.autopilot.mode is Mode.POSITION:
                flown.vehicle.vehicle.autopilot.set_mode(Mode.GUIDED)

    asked = GivesBack(*((5.0 + k, request) for k, request in enumerate(Request)), piloted_from_s=3.0)
    flight = Replanned(small, "ardupilot", at_step=asked.look, requests=asked, options=options)
    assert [granted for *_, granted in asked.answers] == [False] * 4
    assert all("not fought" in words for _, _, words, _ in asked.answers)
    held, back = flight.events("held by a pilot")[0]["t_s"], flight.events("handed back")[0]["t_s"]
    assert not [row for row in flight.events("command") if held <= (row["t_s"] or 0.0) <= back]
    assert flight.result.achieved, flight.result.reason
