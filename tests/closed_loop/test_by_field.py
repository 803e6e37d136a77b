"""Flights without a time law: pushed off their way, held by a pilot, or put where nothing can be completed."""

import io
import json
from dataclasses import replace
from math import hypot

import numpy as np
import pytest
from shapely import Point, Polygon

from mission.fly import fly
from mission.fly.interruption import INTERRUPTED, StopRequest
from mission.fly.result import Progress
from mission.link.ending import Ending
from mission.monitor.stage import Stage
from mission.plan import FlightPlan
from mission.report.figures.histories import control_signals, tracked_states
from mission.report.figures.paths import smoothed_path
from mission.report.page import page as write_page
from mission.report.reading import parse_record
from mission.report.record import FlightRecord
from mission.report.summary import summary
from tests.support.faults import schedule_of
from tests.support.lockstep import LockstepVehicle, vehicle_of
from tests.support.small_missions import FLOWN_BRISKLY, ROUNDS, plan_of
from tests.support.usual_cases import PX4, sampled
from vehicle_sim.autopilot import Mode

PILOTED = {"ardupilot": Mode.POSITION, "px4": Mode.HOLD}

DRAG_PER_S = 0.5
"""Enough for gusts to carry the vehicle away."""

WALL = Polygon([(18, 0), (22, 0), (22, 8), (18, 8)])
GOAL = Polygon([(28, 4), (36, 4), (36, 12), (28, 12)])
START_M = (9.0, 8.0)
BY_FIELD = FLOWN_BRISKLY.replace("flight:\n", "flight:\n  guidance: field\n")
ROUND_THE_WALL = (
    """\
name: Round the wall
domain:
  boundary: [[0, 0], [40, 0], [40, 30], [0, 30]]
  mesh: {largest_m: 3.5}
regions:
  home: {kind: home, polygon: [[4, 4], [12, 4], [12, 12], [4, 12]]}
  goal: {kind: survey, polygon: [[28, 4], [36, 4], [36, 12], [28, 12]], loiter_s: 2}
  wall: {kind: restricted, polygon: [[18, 0], [22, 0], [22, 8], [18, 8]]}
mission:
  formula: F (goal & F G home) & G !wall
start:
  position_m: [9, 8]
"""
    + BY_FIELD
)
FIRST_THE_GOAL = (
    ROUND_THE_WALL.replace("F (goal & F G home) & G !wall", "F (goal & F G home) & (!marsh U goal)")
    .replace("kind: restricted", "kind: survey")
    .replace("wall:", "marsh:")
    .replace(
        "polygon: [[18, 0], [22, 0], [22, 8], [18, 8]]",
        "polygons: [{polygon: [[14, 0], [26, 0], [26, 7], [14, 7]]}, "
        "{polygon: [[14, 10], [26, 10], [26, 30], [14, 30]]}]",
    )
)
"""What must not be entered before something else is no restricted region: the automaton alone forbids it."""


PILOT_FROM_S = 6.0
"""After the beginning of the flight, about half way to the goal."""


class Flown:
    """A flight in lock-step with what was truly flown."""

    def __init__(self, plan: FlightPlan, flavour: str, *faults: str, piloted_s: float = 0.0) -> None:
        self.flavour, self.piloted_s = flavour, piloted_s
        self.nearest_m = 1e9
        self.flying_from_s: float | None = None
        self.held_at_m: tuple[float, ...] | None = None
        config = vehicle_of(flavour, drag_per_s=DRAG_PER_S)
        if faults:
            config = replace(config, faults=schedule_of(*faults))
        self.vehicle = LockstepVehicle(config, at_step=self.watch)
        written = io.BytesIO()
        self.result = fly(
            plan, self.vehicle, self.vehicle, FlightRecord(written, mission="by field"), on_progress=self.look
        )
        self.read = parse_record(written.getvalue())
        self.record = [json.loads(line) for line in written.getvalue().splitlines()]

    def look(self, progress: Progress) -> None:
        if progress.stage is Stage.FLY and self.flying_from_s is None:
            self.flying_from_s = self.vehicle.now_s()

    def watch(self, lockstep: LockstepVehicle) -> None:
        if lockstep.vehicle.steps % 10:
            return
        north, east, _ = lockstep.vehicle.truth.position_ned_m
        self.nearest_m = min(self.nearest_m, WALL.distance(Point(START_M[0] + east, START_M[1] + north)))
        if not self.piloted_s or self.flying_from_s is None:
            return
        autopilot, since_s = lockstep.vehicle.autopilot, lockstep.now_s() - self.flying_from_s
        if since_s >= PILOT_FROM_S and self.held_at_m is None:
            autopilot.set_mode(PILOTED[self.flavour])
            self.held_at_m = lockstep.vehicle.truth.position_ned_m
        elif since_s >= PILOT_FROM_S + self.piloted_s:
            self.piloted_s = 0.0
            autopilot.set_mode(Mode.GUIDED)

    def entered(self, from_s: float = 0.0, to_s: float = 1e9) -> list[int]:
        """The triangles that were entered between two times of the vehicle."""
        return [row["triangle"] for row in self.record if row["kind"] == "visit" and from_s <= row["t_s"] <= to_s]

    def said(self) -> list[str]:
        return [row["name"] for row in self.record if row["kind"] == "event"]


@pytest.fixture(scope="module")
def round_the_wall() -> FlightPlan:
    return plan_of(ROUND_THE_WALL)


@pytest.fixture(scope="module", params=["ardupilot", pytest.param("px4", marks=pytest.mark.long)])
def calm(request: pytest.FixtureRequest, round_the_wall: FlightPlan) -> Flown:
    return Flown(round_the_wall, request.param)


def test_in_calm_air_it_does_its_task_and_stands_still_where_it_is_to(calm: Flown) -> None:
    assert calm.result.achieved, calm.result.reason
    assert calm.result.ending is Ending.LANDED
    assert calm.nearest_m > 0.5
    inside = [row for row in calm.record if row["kind"] == "telemetry" and GOAL.contains(Point(row["position_m"][:2]))]
    slow = [row["t_s"] for row in inside if hypot(*row["velocity_m_s"]) < 0.5]
    assert slow[-1] - slow[0] >= 2.0


def test_the_report_tells_what_was_flown_and_of_no_tube(calm: Flown, round_the_wall: FlightPlan) -> None:
    told = summary(round_the_wall, calm.read)
    assert told["flown"]["length_m"] > 40.0
    assert 3.0 < told["flown"]["largest_speed_m_s"] < 6.0
    assert told["flown"]["largest_error_m"] is None
    page = write_page(round_the_wall, calm.read, told, [])
    assert "no tube is proved" in page
    assert "BEYOND" not in page
    assert "within the tube" not in page


def test_the_pictures_show_what_was_flown_and_no_tube(calm: Flown, round_the_wall: FlightPlan) -> None:
    states, signals = (draw(round_the_wall, calm.read) for draw in (tracked_states, control_signals))
    flown_s = calm.read.track.t_s[-1] - (calm.flying_from_s or 0.0)
    for figure, asked in ((states, True), (signals, False)):
        lines = {str(line.get_gid()) for axes in figure.axes for line in axes.lines}
        assert not {"tube", "error"} & lines
        (flown, *_) = (line for axes in figure.axes for line in axes.lines if line.get_gid() == "flown")
        assert np.asarray(flown.get_xdata())[-1] > 0.8 * flown_s - 10.0  # and then it landed
        velocities = [
            np.asarray(line.get_ydata()) for axes in figure.axes for line in axes.lines if line.get_gid() == "asked"
        ]
        assert any(np.isfinite(each).any() for each in velocities) is asked
    path = smoothed_path(round_the_wall)
    assert not [patch for axes in path.axes for patch in axes.patches if patch.get_gid() == "tube"]
    said = " ".join(text.get_text() for text in (*path.texts, *path.axes[0].texts))
    assert "This path is not flown" in said
    assert "roved for every path" not in said


def test_gusts_across_three_triangles_cost_a_way_and_nothing_else(calm: Flown, round_the_wall: FlightPlan) -> None:
    at_s = (calm.flying_from_s or 0.0) + 3.5
    gusts = Flown(round_the_wall, calm.flavour, f"gust, at_s: {at_s}, for_s: 6, north_m_s: 18")
    assert len(set(gusts.entered(at_s, at_s + 8.0)) - set(calm.entered())) >= 3
    assert gusts.result.achieved, gusts.result.reason
    assert gusts.result.ending is Ending.LANDED
    assert gusts.nearest_m > 0.5


@sampled("for_s", [15.0, 60.0], [15.0])
def test_a_pilot_holds_it_and_hands_it_back(calm: Flown, round_the_wall: FlightPlan, for_s: float) -> None:
    held = Flown(round_the_wall, calm.flavour, piloted_s=for_s)
    assert held.held_at_m is not None
    assert not GOAL.contains(Point(START_M[0] + held.held_at_m[1], START_M[1] + held.held_at_m[0]))
    names = held.said()
    assert names.index("held by a pilot") < names.index("handed back")
    assert held.result.achieved, held.result.reason
    assert held.result.ending is Ending.LANDED
    commands = [row for row in held.record if row["kind"] == "event" and row["name"] == "command"]
    held_s, back_s = (
        next(row["t_s"] for row in held.record if row.get("name") == name)
        for name in ("held by a pilot", "handed back")
    )
    assert back_s - held_s == pytest.approx(for_s, abs=2.0)
    assert not [row for row in commands if held_s <= (row["t_s"] or 0.0) <= back_s]  # nobody is fought


@PX4
def test_where_nothing_can_be_completed_it_holds_and_says_so(flavour: str) -> None:
    """Blown into the marsh before it was at the goal: the word is spoiled, though nothing is restricted."""
    plan = plan_of(FIRST_THE_GOAL)
    spoiled = Flown(plan, flavour, "gust, since: takeoff, at_s: 13, for_s: 8, north_m_s: -25")
    assert not spoiled.result.achieved
    assert spoiled.result.ending is Ending.STOPPED
    assert "can no longer be satisfied" in spoiled.result.reason
    assert "left holding" in spoiled.result.reason
    assert spoiled.vehicle.vehicle.autopilot.mode in (Mode.HOLD, Mode.BRAKE)


@PX4
def test_laps_are_counted_by_what_they_must_meet(flavour: str) -> None:
    plan = plan_of(ROUNDS.replace("flight:\n", "flight:\n  guidance: field\n"))
    flown = Flown(plan, flavour)
    assert flown.result.achieved, flown.result.reason
    assert flown.result.laps == 2
    spelled = [name for letter in flown.result.word for name in letter]
    assert spelled[-1] == "home"
    assert min(spelled.count("east"), spelled.count("north")) >= 2


def test_laps_until_somebody_says_that_it_is_enough_end_at_home() -> None:
    plan = plan_of(
        ROUNDS.replace("flight:\n", "flight:\n  guidance: field\n").replace("laps: 2", "laps: until_stopped")
    )
    vehicle, asked = LockstepVehicle(vehicle_of("px4")), iter([INTERRUPTED])

    def enough() -> StopRequest | None:
        return next(asked, None) if vehicle.now_s() > 35.0 else None

    result = fly(plan, vehicle, vehicle, FlightRecord(io.BytesIO(), mission="rounds"), stop_request=enough)
    assert result.ending is Ending.LANDED
    assert result.achieved, result.reason
    assert result.word[-1] == {"home"}
    assert 1 <= result.laps <= 4
