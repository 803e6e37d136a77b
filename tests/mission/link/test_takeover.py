"""A pilot who is waited for has the vehicle, whatever it says of its battery meanwhile."""

from mission.link.ending import Ending
from mission.link.session import Session
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
