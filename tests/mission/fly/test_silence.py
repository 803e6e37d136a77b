"""A vehicle that goes silent in part, or for a while: asked again, then held; a gap that ends goes by one rule."""

import re
from collections.abc import Callable
from itertools import groupby
from typing import Any

import numpy as np
import pytest

from mission.errors import LinkError
from mission.monitor.stage import Stage
from mission.plan import FlightPlan
from mission.report.page import page
from mission.report.summary import summary
from tests.support.scripted_flight import Flight
from tests.support.scripted_vehicle import BRAKE, PX4_HOLD, ScriptedVehicle
from tests.support.small_missions import SMALL, plan_of

SET_MESSAGE_INTERVAL, LOCAL_POSITION_NED = 511, 32


@pytest.fixture(scope="module")
def plan() -> FlightPlan:
    return plan_of(SMALL)


def only(vehicle: ScriptedVehicle, passes: Callable[[str], bool]) -> None:
    """Let only these messages of the vehicle pass from now on."""
    emit = vehicle._emit

    def filtered(message: Any) -> None:  # noqa: ANN401 - pymavlink ships no types
        if passes(message.get_type()):
            emit(message)

    vehicle._emit = filtered  # type: ignore[method-assign]


@pytest.mark.parametrize(
    ("flavour", "passing"),
    [("ardupilot", {"HEARTBEAT"}), ("px4", {"HEARTBEAT", "ATTITUDE", "ESTIMATOR_STATUS", "COMMAND_ACK"})],
)
def test_a_vehicle_that_tells_its_position_no_more_is_asked_and_then_told_to_hold(
    plan: FlightPlan, flavour: str, passing: set[str]
) -> None:
    vehicle = ScriptedVehicle(flavour)
    flight = Flight(vehicle, plan)
    since: list[float] = []

    def pass_little() -> None:
        since.append(vehicle.now_s())
        only(vehicle, passing.__contains__)

    flight.at_stage[Stage.FLY] = pass_little
    asked = len(vehicle.commands)
    with pytest.raises(
        LinkError, match=r"not told its position for 5\.\d s, .* asked to; .* left holding in"
    ) as caught:
        flight.run()
    assert caught.value.exit_code == 4
    assert vehicle.mode == (PX4_HOLD if vehicle.px4 else BRAKE)
    assert vehicle.now_s() - since[0] < 8.0
    again = [c for c in vehicle.commands[asked:] if c.command == SET_MESSAGE_INTERVAL]
    assert len([c for c in again if c.param1 == LOCAL_POSITION_NED]) >= 3


def test_streams_that_the_vehicle_has_dropped_are_asked_for_again_and_the_flight_goes_on(plan: FlightPlan) -> None:
    vehicle = ScriptedVehicle("ardupilot")
    flight = Flight(vehicle, plan)
    flight.at_stage[Stage.FLY] = vehicle._streams.clear
    assert flight.run().achieved


def test_a_vehicle_that_tells_its_mode_no_more_is_told_to_hold(plan: FlightPlan) -> None:
    vehicle = ScriptedVehicle("ardupilot")
    flight = Flight(vehicle, plan)
    flight.at_stage[Stage.FLY] = lambda: only(vehicle, lambda kind: kind != "HEARTBEAT")
    with pytest.raises(LinkError, match=r"not told its mode for 10\.\d s.*; that it holds was not confirmed"):
        flight.run()
    assert vehicle.mode == BRAKE


@pytest.mark.parametrize(
    ("gap_s", "first"), [(4.7, "LOCAL_POSITION_NED"), (4.7, "ATTITUDE"), (4.7, "HEARTBEAT"), (2.1, "ATTITUDE")]
)
def test_a_gap_that_ends_is_survived_whatever_is_heard_first_after_it(
    plan: FlightPlan, gap_s: float, first: str
) -> None:
    vehicle = ScriptedVehicle("ardupilot")
    flight = Flight(vehicle, plan)

    def go() -> None:
        now_s = vehicle.now_s()
        vehicle.gone = True
        vehicle.script.at[now_s + gap_s] = lambda _: come_back()

    def come_back() -> None:
        vehicle.gone = False
        emit = vehicle._emit
        only(vehicle, lambda kind: kind == first)
        vehicle.script.at[vehicle.now_s() + 0.2] = lambda _: setattr(vehicle, "_emit", emit)

    flight.at_stage[Stage.FLY] = go
    result = flight.run()
    assert result.achieved, result.reason


@pytest.mark.usefixtures("every_setpoint")
def test_after_a_gap_the_trajectory_goes_on_from_where_it_stood_and_everyone_is_told(plan: FlightPlan) -> None:
    vehicle = ScriptedVehicle("ardupilot")
    flight = Flight(vehicle, plan)

    def freeze() -> None:
        began_s = vehicle.now_s() + 2.0
        vehicle.script.at |= {
            began_s: lambda _: setattr(vehicle, "gone", True),
            began_s + 4.2: lambda _: setattr(vehicle, "gone", False),
        }

    flight.at_stage[Stage.FLY] = freeze
    result = flight.run()
    assert result.achieved
    assert [letter for letter, _ in groupby(result.word)] == [letter for letter, _ in groupby(plan.certificate.word)]
    record = flight.record
    steps_m = np.hypot(*np.diff(record.setpoints.position_m, axis=0).T[:2])
    assert steps_m.max() < 0.5
    on_it_s = record.setpoints.trajectory_s[~np.isnan(record.setpoints.trajectory_s)]
    assert np.diff(on_it_s).max() < 0.2
    gaps = [event.values for event in record.events if event.text == "gap"]
    assert sorted(gap["missing"] for gap in gaps) == ["position", "setpoint"]
    assert all(gap["for_s"] == pytest.approx(4.2, abs=0.3) for gap in gaps)
    said = r"satisfies the specification; where it was is unknown for 4\.\d s, the trajectory paused for 4\.\d s"
    assert re.search(said, result.reason)
    assert record.verdict is not None
    assert record.verdict["reason"] == result.reason
    numbers = summary(plan, record)
    html = page(plan, record, numbers, ())
    assert len(numbers["flown"]["gaps"]) == 2
    assert "Pauses of the trajectory" in html
    assert "Gaps between positions" in html
