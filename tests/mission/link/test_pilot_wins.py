"""A pilot takes the vehicle at any moment between two heartbeats, and nothing is commanded over his mode."""

import pytest

from mission.errors import VehicleError
from mission.link.ending import Ending
from mission.monitor.stage import Stage
from tests.support.scripted_vehicle import AP_LAND, LAND, PX4_LAND, SET_MODE, STABILIZE, Script, ScriptedVehicle
from tests.support.sessions import DURATION_S, Driven

FLAVOURS = pytest.mark.parametrize("flavour", ["ardupilot", "px4"])
PX4_POSITION = 0x30000
PILOTED = {"ardupilot": STABILIZE, "px4": PX4_POSITION}
LANDING = {"ardupilot": AP_LAND, "px4": PX4_LAND}


def at(flavour: str, stage: Stage, script: Script | None = None) -> Driven:
    driven = Driven(ScriptedVehicle(flavour, script))
    driven.until(stage)
    return driven


def taken(driven: Driven, flavour: str, *, after_s: float = 0.0) -> Driven:
    """Once a pilot has put it into his mode, after a while."""
    passed(driven, after_s)
    driven.vehicle.mode = PILOTED[flavour]
    driven.vehicle.commands.clear()
    return driven


def passed(driven: Driven, for_s: float) -> None:
    until_s = driven.vehicle.now_s() + for_s
    while driven.vehicle.now_s() < until_s:
        driven.turn()


def modes_asked(driven: Driven) -> list[int]:
    return [each.command for each in driven.vehicle.commands if each.command in (LAND, SET_MODE)]


def beaten(driven: Driven) -> Driven:
    """Up to the first heartbeat that shows the pilot's mode."""
    before = driven.session.vehicle.beats
    while driven.session.vehicle.beats == before:
        driven.turn()
    return driven


@FLAVOURS
@pytest.mark.parametrize("before_s", [1.2, 0.9, 0.6, 0.3, 0.1, 0.02, -0.1, -0.3])
def test_nothing_is_commanded_over_a_pilot_who_comes_about_the_landing(flavour: str, before_s: float) -> None:
    driven = taken(at(flavour, Stage.FLY), flavour, after_s=DURATION_S - before_s)
    driven.fly()
    assert modes_asked(driven) == []
    assert driven.vehicle.mode == PILOTED[flavour]
    assert driven.session.ending is Ending.HANDED_OVER


@FLAVOURS
def test_it_is_not_repeated_over_a_pilot_who_comes_before_its_answer(flavour: str) -> None:
    driven = at(flavour, Stage.LAND, Script())
    driven.vehicle.script.silent_about[LAND] = 20
    while driven.vehicle.mode != LANDING[flavour]:
        driven.turn()
    driven = taken(driven, flavour)
    driven.fly()
    assert modes_asked(driven) == []
    assert driven.session.ending is Ending.HANDED_OVER


@FLAVOURS
@pytest.mark.parametrize("stage", [Stage.CLIMB, Stage.FLY])
def test_one_heartbeat_of_his_is_enough_that_nobody_is_told_to_hold(flavour: str, stage: Stage) -> None:
    driven = beaten(taken(at(flavour, stage), flavour))
    driven.session.stop("interrupted by the user", driven.vehicle.now_s())
    driven.fly()
    assert modes_asked(driven) == []
    assert driven.session.ending is Ending.HANDED_OVER


@FLAVOURS
def test_a_flight_that_fails_meanwhile_says_that_he_has_it(flavour: str) -> None:
    driven = beaten(taken(at(flavour, Stage.FLY), flavour))
    driven.session.give_up(VehicleError("the vehicle failed"), driven.vehicle.now_s())
    assert driven.session.last_words() == []
    with pytest.raises(VehicleError, match="the vehicle failed"):
        driven.fly()
    assert modes_asked(driven) == []
    assert "someone else put the vehicle into" in driven.session.left


@FLAVOURS
def test_a_hold_is_commanded_before_the_next_heartbeat(flavour: str) -> None:
    driven = at(flavour, Stage.FLY)
    passed(driven, 0.5)
    driven.vehicle.commands.clear()
    driven.session.stop("interrupted by the user", driven.vehicle.now_s())
    passed(driven, 0.1)
    assert modes_asked(driven) == [SET_MODE]


@FLAVOURS
def test_a_vehicle_that_beats_no_more_is_told_to_land_all_the_same(flavour: str) -> None:
    driven = at(flavour, Stage.FLY)
    passed(driven, DURATION_S - 0.2)
    driven.vehicle._last[0] = driven.vehicle.now_s() + 4.0
    driven.vehicle.commands.clear()
    passed(driven, 4.5)
    assert modes_asked(driven)[:1] == [LAND]
