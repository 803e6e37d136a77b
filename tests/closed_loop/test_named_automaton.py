"""A mission that names an automaton, flown in lock-step: achieved where it accepts what was flown, and only there."""

import io
from dataclasses import replace

import pytest

from mission.fly import FlightResult, fly
from mission.link.ending import Ending
from mission.plan import FlightPlan, plan_mission
from mission.report.reading import parse_record
from mission.report.record import FlightRecord
from mission.spec.loader import load_mission, parse_mission
from mission.spec.specification import of_mission
from tests.support.commands import MISSIONS
from tests.support.lockstep import LockstepVehicle, vehicle_of

PAIRS = MISSIONS / "pairs.yaml"


@pytest.fixture(scope="module")
def plan() -> FlightPlan:
    return plan_mission(load_mission(PAIRS))


def flown(plan: FlightPlan) -> tuple[FlightResult, bytes]:
    sink = io.BytesIO()
    vehicle = LockstepVehicle(vehicle_of("px4", seed=2))
    return fly(plan, vehicle, vehicle, FlightRecord(sink, mission="pairs")), sink.getvalue()


def test_what_the_automaton_accepts_is_achieved(plan: FlightPlan) -> None:
    result, data = flown(plan)
    assert result.achieved, result.reason
    assert result.reason == "the word that was flown satisfies the specification"
    verdict = parse_record(data).verdict
    assert verdict is not None
    assert verdict["achieved"]
    letters = [name for letter in result.word for name in letter]
    assert [name for i, name in enumerate(letters) if i == 0 or letters[i - 1] != name] == [
        "home",
        "field",
        "depot",
        "field",
        "depot",
        "home",
    ]


def test_what_it_does_not_accept_is_not(plan: FlightPlan) -> None:
    text = PAIRS.with_name("pairs.hoa").read_text(encoding="utf-8")
    odd = text.replace('an odd number of loads is delivered"', 'an odd number of loads is delivered" {0}')
    odd = odd.replace('and at home" {0}', 'and at home"')
    spec = parse_mission(PAIRS.read_bytes(), "pairs.yaml", lambda _: odd.encode())
    other = replace(plan, spec=spec, required=of_mission(spec, plan.labelling.letters))
    assert other.automaton.accepting == {2}
    result, _ = flown(other)
    assert result.ending is Ending.LANDED
    assert not result.achieved
    assert result.reason == "the word that was flown does not satisfy the specification"
