"""The rest of a flight: what was spelled and what is planned from there satisfy the mission together."""

import json
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from itertools import groupby

import numpy as np
import pytest

from mission.errors import NoPlanError, NoRollingStartError, SpecError
from mission.logic.formula.word import LassoWord
from mission.monitor.flight import FlightMonitor
from mission.monitor.stage import Stage
from mission.plan import FlightPlan, plan_from_json, plan_mission, plan_to_json
from mission.plan.rest import Rest, plan_rest, plan_return
from mission.spec.loader import parse_mission
from mission.spec.model import MissionSpec, PolygonShape, Region, RegionKind, Semantics
from mission.verify.plans.checker import claims
from tests.support.small_missions import FLOWN_BRISKLY
from tests.support.usual_cases import sampled

HEAD = """\
name: A rest
domain:
  boundary: [[0, 0], [60, 0], [60, 40], [0, 40]]
regions:
  home: {kind: home, polygon: [[4, 4], [14, 4], [14, 12], [4, 12]]}
  a: {kind: survey, polygon: [[40, 4], [52, 4], [52, 14], [40, 14]], loiter_s: 3}
  b: {kind: survey, polygon: [[42, 26], [54, 26], [54, 36], [42, 36]]}
  c: {kind: area, polygon: [[6, 26], [16, 26], [16, 36], [6, 36]]}
  pond: {kind: restricted, polygon: [[24, 12], [32, 12], [32, 26], [24, 26]]}
"""
TAIL = "start:\n  position_m: [9, 8]\n" + FLOWN_BRISKLY


def mission(what: str) -> MissionSpec:
    return parse_mission((HEAD + what + TAIL).encode())


@cache
def planned(what: str) -> FlightPlan:
    return plan_mission(mission(what))


def flown(plan: FlightPlan, until_s: float) -> Rest:
    """What of a flight that keeps to its plan is behind it after some time."""
    watched = FlightMonitor(plan)
    times = np.arange(0.0, until_s, 0.1)
    for t_s, (x, y) in zip(times.tolist(), plan.trajectory.position(times).tolist(), strict=True):
        watched.report(Stage.FLY, t_s, (x, y))
    x, y = plan.trajectory.position(times[-1:])[0].tolist()
    return Rest(watched.monitor.word, (x, y), flown_s=until_s, laps=watched.monitor.laps)


def moving(plan: FlightPlan, at_s: float) -> Rest:
    """The same, as fast as the vehicle is then."""
    place, velocity, acceleration = (each[0].tolist() for each in plan.trajectory.state([at_s]))
    rest = replace(flown(plan, at_s), place_m=(place[0], place[1]))
    return replace(rest, velocity_m_s=(velocity[0], velocity[1]), acceleration_m_s2=(acceleration[0], acceleration[1]))


def spelled(plan: FlightPlan) -> tuple[frozenset[str], ...]:
    """What a flight spells that keeps to its plan, its first label included."""
    return flown(plan, plan.trajectory.duration_s + 0.1).word


def faults(plan: FlightPlan) -> list[str]:
    return [f"{claim.name}: {claim.fault}" for claim in claims(plan_to_json(plan)) if claim.fault]


ORDERED = "mission:\n  formula: F (a & F (b & F home)) & F c\n"
PAPER = "mission:\n  formula: F (a & F (b & F home)) & F c\n  semantics: paper\n"
TASKS = "mission: {}\ntasks:\n  - ordered_visit: [c, b, a]\n  - visit: [home]\n"
GUARDED = "mission:\n  formula: F b & (!c U b) & F c & F G home\n"


@pytest.mark.parametrize("what", [ORDERED, PAPER, TASKS, GUARDED])
@sampled("share", [0.1, 0.35, 0.6, 0.9], [0.35, 0.9])
def test_what_was_spelled_and_what_is_planned_then_satisfy_the_mission(what: str, share: float) -> None:
    plan = planned(what)
    rest = flown(plan, share * plan.trajectory.duration_s)
    left = plan_rest(plan, rest)
    assert left.certificate.holds
    assert faults(left) == []
    assert plan_to_json(plan_from_json(plan_to_json(left))) == plan_to_json(left)
    onward = spelled(left)
    assert plan.required.satisfied_by(LassoWord(rest.word + onward, onward[-1:]))
    assert left.trajectory.duration_s < plan.trajectory.duration_s * (1.0 - share) + 6.0


@pytest.mark.parametrize("what", [ORDERED, PAPER])
def test_before_anything_is_flown_the_rest_is_the_plan(what: str) -> None:
    plan = planned(what)
    assert plan_to_json(plan_rest(plan, Rest((), plan.start_m))) == plan_to_json(plan)


def test_a_stay_that_was_begun_is_due() -> None:
    plan = planned(ORDERED)
    begin_s = float(plan.trajectory.time_at(plan.stops[0][0])[0])
    begun = plan_rest(plan, flown(plan, begin_s + 1.0))
    over = plan_rest(plan, flown(plan, begin_s + 3.5))
    assert "F a" in begun.spec.formula
    assert "a" not in {name for letter in spelled(over)[1:] for name in letter} | set(over.spec.formula.split())


def test_what_was_violated_is_said() -> None:
    plan = planned(GUARDED)
    with pytest.raises(NoPlanError, match="what was flown so far violates the mission"):
        plan_rest(plan, Rest((frozenset(("home",)), frozenset(), frozenset("c")), (20.0, 30.0)))


def test_a_place_in_what_is_restricted_is_refused() -> None:
    plan = planned(ORDERED)
    with pytest.raises(SpecError, match="restricted region"):
        plan_rest(plan, Rest((frozenset(("home",)), frozenset()), (28.0, 18.0)))


def test_another_formula_holds_from_now_on() -> None:
    plan = planned(PAPER)
    rest = flown(plan, 0.4 * plan.trajectory.duration_s)
    other = plan_rest(plan, rest, replace(plan.spec, formula="F c"))
    assert other.spec.semantics is Semantics.STANDARD
    assert other.start_m == rest.place_m
    assert frozenset("c") in spelled(other)


def test_a_region_that_pops_up_is_kept_out_of() -> None:
    plan = planned(ORDERED)
    rest = flown(plan, 0.1 * plan.trajectory.duration_s)
    box = PolygonShape(((30.0, 2.0), (36.0, 2.0), (36.0, 8.0), (30.0, 8.0)))
    amended = replace(plan.spec, regions=(*plan.spec.regions, Region("crane", RegionKind.RESTRICTED, box)))
    left = plan_rest(plan, rest, amended)
    assert faults(left) == []
    assert not any("crane" in letter for letter in spelled(left))
    assert "crane" in {name for letter in left.labelling.letters for name in letter}


def test_a_region_that_pops_up_ahead_is_flown_round_without_a_rest() -> None:
    plan = planned(ORDERED)
    rest = moving(plan, 3.0)
    x, y = np.array(rest.place_m) + 11.0 * np.array(rest.velocity_m_s) / np.hypot(*rest.velocity_m_s)
    box = PolygonShape(((x - 2.0, y - 2.0), (x + 2.0, y - 2.0), (x + 2.0, y + 2.0), (x - 2.0, y + 2.0)))
    amended = replace(plan.spec, regions=(*plan.spec.regions, Region("crane", RegionKind.RESTRICTED, box)))
    left = plan_rest(plan, rest, amended)
    law = left.trajectory.legs[0].law
    assert faults(left) == []
    assert law.knots_t_s[law.rates == 0.0][0] > 6.0  # where a survey asks for a stay


def test_another_origin_is_refused() -> None:
    plan = planned(ORDERED)
    placed = parse_mission(("origin: {latitude_deg: 47, longitude_deg: 8}\n" + HEAD + ORDERED + TAIL).encode())
    with pytest.raises(SpecError, match="another origin"):
        plan_rest(plan, flown(plan, 3.0), placed)


@pytest.mark.parametrize("share", [0.2, 0.5])
def test_a_return_violates_nothing_and_ends_at_home(share: float) -> None:
    plan = planned(GUARDED)
    rest = flown(plan, share * plan.trajectory.duration_s)
    back = plan_return(plan, rest)
    assert back.certificate.holds
    assert faults(back) == []
    onward = spelled(back)
    assert onward[-1] == frozenset(("home",))
    if frozenset("b") not in rest.word:
        assert frozenset("c") not in onward
    assert back.stops == ()


def test_without_a_home_the_return_ends_where_the_flight_began() -> None:
    head = HEAD.replace("home: {kind: home,", "home: {kind: area,")
    plan = plan_mission(parse_mission((head + ORDERED + TAIL).encode()))
    back = plan_return(plan, flown(plan, 8.0))
    assert float(np.abs(back.trajectory.position([back.trajectory.duration_s])[0] - plan.start_m).max()) < 2.0


@pytest.mark.parametrize("at_s", [1.0, 4.0, 9.0])
@pytest.mark.parametrize("make", [plan_rest, plan_return])
def test_a_plan_goes_on_in_the_motion_that_the_vehicle_has(
    at_s: float, make: Callable[[FlightPlan, Rest], FlightPlan]
) -> None:
    plan = planned(ORDERED)
    left = make(plan, moving(plan, at_s))
    due = plan.trajectory.state([at_s])
    for begins, was in zip(left.trajectory.state([0.0]), due, strict=True):
        assert begins == pytest.approx(was, abs=1e-6)
    assert left.onward is not None
    assert faults(left) == []
    assert plan_to_json(plan_from_json(plan_to_json(left))) == plan_to_json(left)


def test_who_is_too_fast_slows_down_to_what_the_mission_asks_for() -> None:
    plan = planned(ORDERED)
    rest = moving(plan, 3.0)
    vx, vy = rest.velocity_m_s
    left = plan_rest(plan, replace(rest, velocity_m_s=(1.04 * vx, 1.04 * vy)))
    speeds = np.hypot(*left.trajectory.state(np.linspace(0.0, left.trajectory.duration_s, 2000))[1].T)
    assert speeds[0] > 1.03 * plan.spec.flight.speed_m_s
    assert (speeds <= plan.spec.flight.speed_m_s + 1e-9)[200:].all()
    assert faults(left) == []


def test_who_has_to_turn_back_halts_first_on_the_way_ahead() -> None:
    plan = planned(ORDERED)
    rest = moving(plan, 3.0)
    left = plan_rest(plan, rest, replace(plan.spec, formula="F G home", tasks=()))
    law = left.trajectory.legs[0].law
    halts_s = float(law.knots_t_s[law.rates == 0.0][0])
    away_m = np.array(left.trajectory.state([halts_s])[0][0]) - rest.place_m
    assert away_m @ rest.velocity_m_s == pytest.approx(np.hypot(*away_m) * np.hypot(*rest.velocity_m_s))
    assert halts_s < 4.0
    assert faults(left) == []


def test_a_beginning_in_motion_that_was_tampered_with_is_found() -> None:
    left = plan_rest(planned(ORDERED), moving(planned(ORDERED), 4.0))
    data = json.loads(plan_to_json(left))
    for onward in ([[0.0, 0.0], [0.0, 0.0]], None, [data["onward"][0], [0.0, 0.5]]):
        found = [claim.name for claim in claims(json.dumps({**data, "onward": onward})) if claim.fault]
        assert found == ["time law"]


def test_where_there_is_no_room_to_go_on_in_motion_that_is_said() -> None:
    plan = planned(ORDERED)
    rest = replace(flown(plan, 4.0), velocity_m_s=(0.0, -4.0), place_m=(30.0, 2.0))
    with pytest.raises(NoRollingStartError):
        plan_rest(plan, rest)


@pytest.mark.parametrize(
    ("place_m", "near"), [((23.8, 18.0), "pond"), ((30.0, 0.2), "the boundary"), ((23.9, 12.0), "pond")]
)
def test_where_the_tube_has_no_room_that_is_said(place_m: tuple[float, float], near: str) -> None:
    plan = planned(ORDERED)
    with pytest.raises(NoPlanError, match=f"has no room there beside {near}"):
        plan_rest(plan, replace(flown(plan, 3.0), place_m=place_m))


def test_after_the_last_lap_the_rest_is_the_return() -> None:
    plan = planned("mission:\n  formula: G F a & G F c\n  laps: 2\n")
    rest = flown(plan, 0.4 * plan.trajectory.duration_s)
    onward, over = plan_rest(plan, replace(rest, laps=1)), plan_rest(plan, replace(rest, laps=2))
    assert onward.trajectory.laps == 1
    assert over.trajectory.lap is None
    assert spelled(over)[-1] == frozenset(("home",))
    assert faults(over) == []


@pytest.mark.parametrize(
    ("laps", "due", "word"),
    [
        (0, ("c",), "c b c home"),
        (0, (), "b c b home"),
        (1, ("c",), "c home"),
        (1, (), "home"),
    ],
)
def test_of_a_lap_under_way_what_it_has_not_met_comes_first(laps: int, due: tuple[str, ...], word: str) -> None:
    plan = planned("mission:\n  formula: G F b & G F c\n  laps: 2\n")
    rest = replace(flown(plan, 0.4 * plan.trajectory.duration_s), laps=laps, due=tuple(map(frozenset, due)))
    left = plan_rest(plan, rest)
    assert faults(left) == []
    visited = [name for letter in spelled(left)[1:] for name in sorted(letter)]
    assert [name for name, _ in groupby(visited)] == word.split()
