"""A pilot who is waited for has the vehicle, whatever it says of its battery meanwhile."""

import pytest

from mission.link.ending import Ending
from mission.link.px4 import PX4
from mission.link.session import Session
from mission.link.takeover import how_left
from mission.link.values import Heartbeat, LandedState
from mission.link.vehicle_state import VehicleState
from mission.monitor.stage import Stage
from tests.support.scripted_vehicle import RTL, STABILIZE, ScriptedVehicle
from tests.support.sessions import Driven


def piloted(since_s: float) -> Driven:
    """A flight whose pilot has had the vehicle for so long when its battery is low."""
    vehicle = ScriptedVehicle("ardupilot")
    driven = Driven(vehicle, Session(needs_origin=False, waits_for_pilot=True))
    driven.until(Stage.FLY)
    vehicle.mode = STABILIZE
    for passing_s in (since_s, 8.0):
        until_s = vehicle.now_s() + passing_s
        while vehicle.now_s() < until_s:
            driven.turn()
        vehicle.failsafe = True
        vehicle.say("Battery Failsafe")
    return driven


def test_a_failsafe_that_is_told_of_later_did_not_bring_the_pilot() -> None:
    driven = piloted(since_s=8.0)
    assert driven.session.ending is None
    assert driven.session.pilot.words == "someone else put the vehicle into STABILIZE"


def test_one_that_is_told_of_a_little_late_did() -> None:
    driven = piloted(since_s=3.0)
    assert driven.session.ending is Ending.FAILSAFE


def test_another_mode_that_comes_with_it_is_the_failsafe_s() -> None:
    driven = piloted(since_s=8.0)
    driven.vehicle.mode = RTL
    driven.fly()
    assert driven.session.ending is Ending.FAILSAFE
    assert "a failsafe put the vehicle into RTL" in driven.session.ending_reason


@pytest.mark.parametrize(
    ("armed", "landed", "stage", "words"),
    [
        (True, LandedState.ON_GROUND, Stage.TAKE_OFF, "that its motors stop was not confirmed"),
        (True, LandedState.IN_AIR, Stage.CLIMB, "the vehicle is left holding in AUTO.LOITER"),
        (False, LandedState.ON_GROUND, Stage.ARM, "that its motors stay off was not confirmed"),
        (False, LandedState.ON_GROUND, Stage.CHECKS, ""),
    ],
)
def test_how_it_is_left_is_said_by_what_was_heard_last(
    armed: bool,  # noqa: FBT001 - a test's parameter
    landed: LandedState,
    stage: Stage,
    words: str,
) -> None:
    vehicle = VehicleState()
    vehicle.take(Heartbeat(2, 12, 128 * armed, PX4.hold_mode, 4), 0.0)
    vehicle.landed = landed
    assert how_left(PX4, vehicle, stage).startswith(words or "\0") == bool(words)
