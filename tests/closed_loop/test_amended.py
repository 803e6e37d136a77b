"""The mission is changed while it is flown: taken over in flight, refused in words, or held for."""

from itertools import groupby, pairwise
from pathlib import Path

import pytest
from shapely import LineString, Point, Polygon

from mission.fly import FlightOptions
from mission.fly.amendments import GO_ON, Amendment, AmendmentAnswer
from mission.fly.replanner import PlanRequest, SynchronousReplanner
from mission.plan import FlightPlan
from mission.spec.model import MissionSpec
from tests.support.commands import ran
from tests.support.lockstep import LockstepVehicle
from tests.support.replanned import Replanned
from tests.support.small_missions import SMALL, plan_of
from tests.support.usual_cases import ARDUPILOT, PX4
from vehicle_sim.protocol.plan_store import PlanKind

FLAVOURS = pytest.mark.parametrize("flavour", ["ardupilot", "px4"])
AHEAD = Polygon([(20, 0), (23, 0), (23, 13), (20, 13)])
TAKEN_OVER_S = 0.25
"""With a planner that takes 0.1 s: in motion, without a rest before."""

RESTRICT_AHEAD = "restrict popped [[20, 0], [23, 0], [23, 13], [20, 13]]"


@pytest.fixture(scope="module")
def small() -> FlightPlan:
    return plan_of(SMALL)


class Said:
    """Changes at times after the trajectory began, lines or whole files, and what was answered when."""

    def __init__(self, *changes: tuple[float, str]) -> None:
        self.waiting = [*changes]
        self.flown: Replanned | None = None
        self.taken_s: list[float] = []
        self.answers: list[tuple[float, AmendmentAnswer]] = []
        self.kept: list[MissionSpec] = []
        self.legs_before: list[int] = []

    def look(self, flown: Replanned, since_s: float) -> None:
        self.flown, self.since_s = flown, since_s

    def take(self) -> Amendment | None:
        if self.flown is None or not self.waiting or self.since_s < self.waiting[0][0]:
            return None
        _, line = self.waiting.pop(0)
        self.taken_s.append(self.flown.vehicle.now_s())
        is_file = not line or "\n" in line
        return Amendment(f"{len(self.waiting)}", () if is_file else (line,), line if is_file else "")

    def answer(self, _amendment: Amendment, answer: AmendmentAnswer) -> None:
        assert self.flown is not None
        self.answers.append((self.flown.vehicle.now_s(), answer))

    def keep(self, number: int, mission: MissionSpec) -> None:
        assert self.flown is not None
        assert number in self.flown.texts
        self.legs_before.append(len(self.flown.events("leg")))
        self.kept.append(mission)


def flown(plan: FlightPlan, flavour: str, *changes: tuple[float, str], faults: str = "") -> tuple[Replanned, Said]:
    said = Said(*changes)
    return Replanned(plan, flavour, *([faults] if faults else []), at_step=said.look, amendments=said), said


def line_of(flight: Replanned, from_s: float) -> LineString:
    track = flight.record.track
    return LineString(track.position_m[track.t_s >= from_s, :2])


@ARDUPILOT
def test_a_restricted_region_ahead_is_flown_around(
    small: FlightPlan, flavour: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    flight, said = flown(small, flavour, (1.0, RESTRICT_AHEAD))
    assert flight.result.achieved, flight.result.reason
    [(_, answer)] = said.answers
    assert answer.accepted, answer.words
    [leg] = flight.events("leg")
    assert leg["t_s"] - said.taken_s[0] < TAKEN_OVER_S
    assert line_of(flight, said.taken_s[0]).distance(AHEAD) > 0.0
    assert flight.entered() == ["home", "goal", "home"]
    assert [region.name for region in said.kept[0].regions] == ["home", "goal", "pond", "popped"]
    assert said.legs_before == [0]  # whoever is killed after the record tells of a plan has all that it was made from
    # Each part is judged by what was asked for then.
    told = ran(capsys, "verify", "--flight", str(flight.written(tmp_path, SMALL)))
    assert told.code == 0, told.out + told.err
    assert "part      2 of 2" in told.out
    assert "from popped" in told.out


class Slower(SynchronousReplanner):
    """A planner that takes longer than it did."""

    def ask(self, request: PlanRequest) -> None:
        """Plan."""
        usual_s, self.takes_s = self.takes_s, 2.0
        super().ask(request)
        self.takes_s = usual_s


@ARDUPILOT
def test_where_the_plan_is_late_the_vehicle_comes_to_rest_before_what_is_restricted(
    small: FlightPlan, flavour: str
) -> None:
    said = Said((1.0, RESTRICT_AHEAD))
    flight = Replanned(
        small, flavour, at_step=said.look, amendments=said, replanner=lambda vehicle: Slower(vehicle.now_s)
    )
    assert flight.result.achieved, flight.result.reason
    [(_, answer)] = said.answers
    assert answer.accepted, answer.words
    assert [event["reason"] for event in flight.events("asked again")] == ["the plan came too late"]
    assert line_of(flight, said.taken_s[0]).distance(AHEAD) > 0.0
    [leg] = flight.events("leg")
    before = [row for row in flight.lines if row["kind"] == "telemetry" and said.taken_s[0] < row["t_s"] < leg["t_s"]]
    assert max(abs(each) for each in before[-1]["velocity_m_s"]) < 0.3


@pytest.mark.usefixtures("every_setpoint")
def test_on_a_late_link_another_plan_begins_where_what_was_sent_before_it_ends(small: FlightPlan) -> None:
    """What was sent cannot be called back: a second of it is on its way, or was flown and not told yet."""
    flight, said = flown(small, "px4", (0.2, RESTRICT_AHEAD), faults="link, delay_s: 0.5, since: boot")
    assert flight.result.achieved, flight.result.reason
    assert said.answers[0][1].accepted, said.answers
    assert line_of(flight, said.taken_s[0]).distance(AHEAD) > 0.0
    setpoints = [row for row in flight.lines if row["kind"] == "setpoint" and row["trajectory_s"] is not None]
    for before, after in pairwise(setpoints):
        if after["t_s"] - before["t_s"] < 0.1:
            assert max(abs(a - b) for a, b in zip(before["position_m"], after["position_m"], strict=True)) < 0.2
    assert flight.result.largest_error_m <= small.certificate.tube_m


class Preparing(SynchronousReplanner):
    """A planner that prepares for what it foresees."""

    def __init__(self, vehicle: LockstepVehicle, prepares_s: float) -> None:
        super().__init__(vehicle.now_s)
        self._prepares_s, self.from_s, self.asked_s = prepares_s, 0.0, list[float]()

    @property
    def ready(self) -> bool:
        """Whether it is over."""
        return self._now_s() >= self.from_s

    def foresee(self, mission: bytes) -> None:
        """Take a while."""
        assert b"popped" in mission
        self.from_s = self._now_s() + self._prepares_s

    def ask(self, request: PlanRequest) -> None:
        """Plan."""
        self.asked_s.append(self._now_s())
        super().ask(request)


@ARDUPILOT
@pytest.mark.parametrize("prepares_s", [0.3, 8.0])
def test_a_plan_is_asked_for_once_it_is_prepared_or_the_vehicle_must_stop(
    small: FlightPlan, flavour: str, prepares_s: float
) -> None:
    said, planners = Said((1.0, RESTRICT_AHEAD)), list[Preparing]()

    def replanner(vehicle: LockstepVehicle) -> Preparing:
        planners.append(Preparing(vehicle, prepares_s))
        return planners[0]

    flight = Replanned(small, flavour, at_step=said.look, amendments=said, replanner=replanner)
    assert flight.result.achieved, flight.result.reason
    assert line_of(flight, said.taken_s[0]).distance(AHEAD) > 0.0
    [leg], [asked_s] = flight.events("leg"), planners[0].asked_s
    assert asked_s < said.taken_s[0] + 2.0
    assert (asked_s >= planners[0].from_s) == (prepares_s < 1.0)
    assert (leg["t_s"] - asked_s < TAKEN_OVER_S) == (prepares_s < 1.0)  # in motion, or at rest


@PX4
def test_one_under_the_vehicle_stops_it_until_it_is_told_to_go_on(small: FlightPlan, flavour: str) -> None:
    under = "restrict under [[6, 5], [12, 5], [12, 11], [6, 11]]"
    flight, said = flown(small, flavour, (0.8, under), (12.0, GO_ON))
    (refused_s, refused), (_, onward) = said.answers
    assert not refused.accepted
    assert "the vehicle holds" in refused.words
    assert "under" in refused.words
    assert onward.accepted
    still = [
        row for row in flight.lines if row["kind"] == "telemetry" and refused_s + 3.0 < row["t_s"] < said.taken_s[1]
    ]
    assert max(Point(row["position_m"]).distance(Point(still[0]["position_m"])) for row in still) < 0.5
    assert flight.result.achieved, flight.result.reason
    assert flight.entered() == ["home", "goal", "home"]


@ARDUPILOT
def test_what_cannot_be_met_is_refused_and_the_old_task_stands(small: FlightPlan, flavour: str) -> None:
    higher = SMALL.replace("altitude_m: 6", "altitude_m: 40")  # it would be far from its setpoints at once
    flight, said = flown(
        small,
        flavour,
        (1.0, "formula F (goal & F pond)"),
        (3.0, "fly faster"),
        (3.5, "drop gaol"),
        (4.0, "laps 2"),
        (4.5, GO_ON),
        (5.0, higher),
        (5.5, ""),
    )
    answers = [answer for _, answer in said.answers]
    assert [answer.accepted for answer in answers] == [False] * 7
    assert answers[5].words == "a flight keeps its altitude, 6 m"
    assert "nothing waits" in answers[4].words
    assert "no laps are flown" in answers[3].words
    assert "pond" in answers[0].words
    assert "old plan is flown on" in answers[0].words
    assert "`fly` is no change" in answers[1].words
    assert "there is no region `gaol`" in answers[2].words
    assert len(flight.result.plans) == 1
    assert flight.result.achieved, flight.result.reason


@pytest.mark.usefixtures("every_setpoint")
def test_another_formula_holds_from_then_on_without_a_jump(small: FlightPlan) -> None:
    flight, said = flown(small, "ardupilot", (2.0, "formula F G home & G !goal"))
    [(_, answer)] = said.answers
    assert answer.accepted, answer.words
    assert flight.result.achieved, flight.result.reason
    assert set(flight.entered()) == {"home"}
    rows = [row for row in flight.lines if row["kind"] == "setpoint" and row["trajectory_s"] is not None]
    for before, after in pairwise(rows):
        passed_s = after["t_s"] - before["t_s"]
        for axis in (0, 1):
            mean = 0.5 * (before["velocity_m_s"][axis] + after["velocity_m_s"][axis])
            assert after["position_m"][axis] - before["position_m"][axis] == pytest.approx(mean * passed_s, abs=5e-3)
            assert abs(after["acceleration_m_s2"][axis] - before["acceleration_m_s2"][axis]) < 0.6


def test_what_another_formula_forbids_is_not_entered_while_it_is_planned_for(small: FlightPlan) -> None:
    """The old plan leads there sooner than there is another one."""
    said = Said((2.4, "formula F G home & G !goal"))
    flight = Replanned(
        small,
        "px4",
        at_step=said.look,
        amendments=said,
        replanner=lambda vehicle: SynchronousReplanner(vehicle.now_s, 4.0),
    )
    [(_, answer)] = said.answers
    assert answer.accepted, answer.words
    assert flight.result.achieved, flight.result.reason
    assert set(flight.entered()) == {"home"}


@FLAVOURS
def test_the_geofence_follows(small: FlightPlan, flavour: str) -> None:
    """What is restricted is fenced off; where it no longer is the vehicle is not stopped."""
    areas: dict[float, int] = {}

    def look(flight: Replanned, since_s: float) -> None:
        said.look(flight, since_s)
        areas[since_s] = len(flight.vehicle.vehicle.autopilot.guard.fence.plan.areas)

    said = Said((1.0, RESTRICT_AHEAD), (9.0, "drop popped"))
    flight = Replanned(small, flavour, at_step=look, amendments=said, options=FlightOptions(fence=True))
    assert [answer.accepted for _, answer in said.answers] == [True, True]
    assert flight.result.achieved, flight.result.reason
    assert [count for count, _ in groupby(areas.values())] == [2, 3, 2]
    assert len(flight.events("geofence renewed")) == 2
    assert line_of(flight, said.taken_s[1]).intersects(AHEAD)
    assert not flight.vehicle.endpoint._plans.store.plans[PlanKind.FENCE]
