"""Whatever fails on this side of the link, the vehicle is told to hold, or to land, before it is left alone."""

import errno
import os
from typing import TYPE_CHECKING

import pytest

from mission.errors import FlightError, LinkError, SpecError
from mission.fly import FlightOptions
from mission.link.session import Session
from mission.monitor.stage import Stage
from mission.plan import FlightPlan
from mission.report.record import FlightRecord
from tests.support.scripted_flight import Flight
from tests.support.scripted_vehicle import BRAKE, LAND, PX4_HOLD, SET_MODE, ScriptedVehicle
from tests.support.small_missions import SMALL, plan_of

if TYPE_CHECKING:
    from collections.abc import Callable

FULL = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@pytest.fixture(scope="module")
def plan() -> FlightPlan:
    return plan_of(SMALL)


def raising(error: BaseException) -> "Callable[..., None]":
    def fail(*_arguments: object) -> None:
        raise error

    return fail


@pytest.mark.parametrize(
    ("flavour", "error"),
    [("ardupilot", FULL), ("px4", ZeroDivisionError("by zero")), ("ardupilot", SystemExit(3))],
    ids=repr,
)
def test_any_error_in_flight_leaves_the_vehicle_holding(plan: FlightPlan, flavour: str, error: BaseException) -> None:
    vehicle = ScriptedVehicle(flavour)
    flight = Flight(vehicle, plan)
    flight.at_stage[Stage.FLY] = raising(error)
    with pytest.raises(FlightError, match=rf"{type(error).__name__}.*; the vehicle is left holding in") as caught:
        flight.run()
    assert caught.value.exit_code == 4
    assert caught.value.__cause__ is error
    assert vehicle.mode == (PX4_HOLD if vehicle.px4 else BRAKE)
    record = flight.record
    assert record.verdict is not None
    assert record.verdict["reason"] == str(caught.value)
    failure = next(event for event in record.events if event.text == "failure")
    assert type(error).__name__ in failure.values["traceback"][-1]


def test_a_vehicle_that_may_be_landed_is_landed(plan: FlightPlan) -> None:
    vehicle = ScriptedVehicle("ardupilot")
    flight = Flight(vehicle, plan)
    flight.options = FlightOptions(land_when_stopped=True)
    flight.at_stage[Stage.FLY] = raising(FULL)
    with pytest.raises(FlightError, match="No space left on device"):
        flight.run()
    assert not vehicle.armed
    assert vehicle.height_m < 0.1


def test_a_landing_goes_on(plan: FlightPlan) -> None:
    vehicle = ScriptedVehicle("ardupilot")
    flight = Flight(vehicle, plan)
    flight.at_stage[Stage.TOUCH_DOWN] = raising(FULL)
    with pytest.raises(FlightError):
        flight.run()
    assert not vehicle.armed
    assert SET_MODE not in [c.command for c in vehicle.commands[-2:]]


def test_bad_input_that_shows_in_flight_only_is_a_failure_of_the_flight(plan: FlightPlan) -> None:
    flight = Flight(ScriptedVehicle("ardupilot"), plan)
    flight.at_stage[Stage.FLY] = raising(SpecError(()))
    with pytest.raises(FlightError):
        flight.run()
    assert flight.vehicle.mode == BRAKE


@pytest.mark.parametrize("broken", ["_take", "advance", "events", "outgoing"])
def test_a_session_that_fails_again_and_again_still_tells_the_vehicle_to_hold(
    plan: FlightPlan, broken: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    vehicle = ScriptedVehicle("ardupilot")
    flight = Flight(vehicle, plan)
    error = ZeroDivisionError("by zero")
    flight.at_stage[Stage.FLY] = lambda: monkeypatch.setattr(Session, broken, raising(error))
    with pytest.raises(FlightError, match="ZeroDivisionError"):
        flight.run()
    assert vehicle.mode == BRAKE


def test_a_link_that_breaks_is_a_link_failure_and_says_that_holding_was_not_confirmed(plan: FlightPlan) -> None:
    vehicle = ScriptedVehicle("ardupilot")
    flight = Flight(vehicle, plan)
    broken = LinkError("cannot send over udpout:10.1.2.3:14550: network is unreachable")
    flight.at_stage[Stage.FLY] = lambda: setattr(vehicle, "send", raising(broken))
    with pytest.raises(LinkError, match=r"unreachable; that it holds was not confirmed: .* in GUIDED"):
        flight.run()


def test_a_vehicle_that_answers_nothing_more_is_told_to_hold(plan: FlightPlan) -> None:
    vehicle = ScriptedVehicle("ardupilot")
    flight = Flight(vehicle, plan)
    vehicle.script.deaf_to[LAND] = 99
    with pytest.raises(LinkError, match="never answered the command to land; the vehicle is left holding in BRAKE"):
        flight.run()
    assert vehicle.mode == BRAKE


def test_a_vehicle_that_is_heard_no_more_may_still_hear(plan: FlightPlan) -> None:
    vehicle = ScriptedVehicle("ardupilot")
    flight = Flight(vehicle, plan)
    flight.at_stage[Stage.FLY] = lambda: setattr(vehicle, "_push", lambda _frame: None)
    with pytest.raises(LinkError, match=r"nothing was heard .*; that it holds was not confirmed"):
        flight.run()
    assert vehicle.mode == BRAKE


def test_an_error_before_take_off_stays_what_it_is_and_the_vehicle_is_left_alone(plan: FlightPlan) -> None:
    vehicle = ScriptedVehicle("ardupilot")
    flight = Flight(vehicle, plan)
    flight.at_stage[Stage.READY] = raising(ZeroDivisionError("by zero"))
    with pytest.raises(ZeroDivisionError):
        flight.run()
    assert {c.command for c in vehicle.commands} <= {511, 512}


class FullDisk:
    """A record that cannot be written between two lines, as with a disk that somebody makes room on again."""

    def __init__(self, record: FlightRecord, *, first: int, last: int) -> None:
        self.record, self.lines = record, 0
        self.first, self.last = first, last

    def write(self, kind: str, t_s: float | None, **values: object) -> None:
        self.lines += 1
        if self.first <= self.lines <= self.last:
            raise FULL
        self.record.write(kind, t_s, **values)


@pytest.mark.parametrize("last", [800, 10**9])
def test_a_record_that_cannot_be_written_costs_a_warning_and_not_the_flight(plan: FlightPlan, last: int) -> None:
    flight = Flight(ScriptedVehicle("ardupilot"), plan)
    flight.recorder = lambda record: FullDisk(record, first=300, last=last)
    result = flight.run()
    assert result.achieved
    assert result.reason.endswith(" lines of the record could not be written")
    assert flight.warnings == ["the record cannot be written: no space left on device; the flight goes on without it"]
    lost = [event.values["lines"] for event in flight.record.events if event.text == "lines lost"]
    assert lost == ([501] if last == 800 else [])


def test_a_way_out_that_is_interrupted_says_how_the_vehicle_is_left(
    plan: FlightPlan, monkeypatch: pytest.MonkeyPatch
) -> None:
    vehicle = ScriptedVehicle("ardupilot")
    flight = Flight(vehicle, plan)

    def fail() -> None:
        monkeypatch.setattr(vehicle, "receive", raising(KeyboardInterrupt()))
        raise FULL

    flight.at_stage[Stage.FLY] = fail
    with pytest.raises(KeyboardInterrupt):
        flight.run()
    left = "that it holds was not confirmed: it was last heard in GUIDED"
    assert flight.warnings == [left]
    assert flight.record.verdict is not None
    assert flight.record.verdict["reason"] == f"{FULL}; its end was not waited for; {left}"
    assert vehicle.mode == BRAKE  # it was told to
