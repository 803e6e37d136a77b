"""A command whose acknowledgement is lost comes again: the answer is the same, and nothing is done twice.

Ground stations repeat a command up to three times with a growing confirmation number. The same commands may come as
COMMAND_INT.
"""

import math

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import Mode
from vehicle_sim.parameters import Flavour

ACCEPTED = mavlink.MAV_RESULT_ACCEPTED
BOTH = pytest.mark.parametrize("flavour", Flavour)
IN_ONE_FLIGHT: list[tuple[int, tuple[float, ...]]] = [
    (mavlink.MAV_CMD_DO_CHANGE_SPEED, (1, 3.0, -1)),
    (mavlink.MAV_CMD_CONDITION_YAW, (45, 0, 1, 0)),
    (mavlink.MAV_CMD_DO_SET_HOME, (1,)),
    (mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, (30, 100_000)),
    (mavlink.MAV_CMD_COMPONENT_ARM_DISARM, (1,)),
    (mavlink.MAV_CMD_COMPONENT_ARM_DISARM, (0,)),
    (31000, ()),
    (mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, (1,)),
    (mavlink.MAV_CMD_DO_PAUSE_CONTINUE, (0,)),
    (mavlink.MAV_CMD_NAV_LOITER_UNLIM, ()),
    (mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH, ()),
    (mavlink.MAV_CMD_NAV_LAND, ()),
    (mavlink.MAV_CMD_DO_FLIGHTTERMINATION, (1,)),
]


def repeated(station: Station, command: int, params: tuple[float, ...]) -> list[int]:
    """Send a command three times, a quarter of a second apart, with growing confirmation; return the results."""
    results = []
    for confirmation in range(3):
        station.forget()
        seven = (*params, *(0.0,) * (7 - len(params)))
        station.send(mavlink.MAVLink_command_long_message(1, 1, command, confirmation, *seven))
        (ack,) = station.of("COMMAND_ACK")
        assert (ack.command, ack.target_system, ack.target_component) == (command, 255, 190)
        results.append(ack.result)
        station.run(0.25)
    return results


def state_of(station: Station) -> tuple[object, ...]:
    autopilot = station.endpoint.vehicle.autopilot
    return autopilot.mode, autopilot.armed, autopilot.target, autopilot.guidance.limits


@BOTH
def test_a_repeated_command_gets_the_same_answer(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.take_off(6.0)
    station.run(3.0)
    for command, params in IN_ONE_FLIGHT:
        first, *others = repeated(station, command, params)
        assert others == [first, first], command


@BOTH
def test_a_repeated_take_off_is_one_take_off(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.wait_for_position()
    assert repeated(station, mavlink.MAV_CMD_COMPONENT_ARM_DISARM, (1,)) == [ACCEPTED] * 3
    home = station.endpoint.vehicle.autopilot.home
    assert home is not None
    height = 7.0 + (home.alt_m if flavour is Flavour.PX4 else 0.0)
    assert repeated(station, mavlink.MAV_CMD_NAV_TAKEOFF, (0, 0, 0, 0, 0, 0, height)) == [ACCEPTED] * 3
    station.run(12.0)
    assert station.height_m() == pytest.approx(7.0, abs=0.7)


@BOTH
def test_a_repeated_landing_does_not_begin_anew(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.take_off(6.0)
    station.run(2.0)
    assert station.command(mavlink.MAV_CMD_NAV_LAND) == ACCEPTED
    before = state_of(station)
    assert station.command(mavlink.MAV_CMD_NAV_LAND) == ACCEPTED
    assert state_of(station) == before


@BOTH
def test_command_int_does_what_command_long_does(flavour: Flavour) -> None:
    flights = []
    for as_int in (False, True):
        station = Station(endpoint_of(flavour))
        station.take_off(6.0)
        answers = []
        for command, params in IN_ONE_FLIGHT:
            if as_int:
                four = (*params, *(0.0,) * (4 - len(params)))
                result = station.command_int(command, mavlink.MAV_FRAME_GLOBAL, four, (0, 0, 0.0))
            else:
                result = station.command(command, *params)
            station.run(0.2)
            answers.append((result, *state_of(station)))
        flights.append(answers)
    assert flights[0] == flights[1]
    assert {answer[1] for answer in flights[0]} >= {Mode.LAND, Mode.RETURN}


@BOTH
@pytest.mark.parametrize("way", ["long", "int"])
def test_a_command_to_all_is_carried_out_and_one_to_another_is_not(flavour: Flavour, way: str) -> None:
    station = Station(endpoint_of(flavour))
    station.wait_for_position()
    arm = mavlink.MAV_CMD_COMPONENT_ARM_DISARM
    for target, is_armed in ((2, False), (0, True)):
        if way == "long":
            message = mavlink.MAVLink_command_long_message(target, 0, arm, 0, 1, *(0,) * 6)
        else:
            message = mavlink.MAVLink_command_int_message(target, 0, 0, arm, 0, 0, 1, 0, 0, 0, 0, 0, 0)
        station.forget()
        station.send(message)
        assert station.endpoint.vehicle.autopilot.armed is is_armed
        assert len(station.of("COMMAND_ACK")) == int(is_armed)


@BOTH
def test_termination_stops_the_motors_and_it_falls(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.take_off(10.0)
    station.run(3.0)
    height = station.height_m()
    assert station.command(mavlink.MAV_CMD_DO_FLIGHTTERMINATION, 1) == ACCEPTED
    station.run(0.5)
    assert station.endpoint.vehicle.thrust == pytest.approx(0.0, abs=1e-3)
    station.run(1.5)
    assert station.height_m() < height - 7.0
    station.run(3.0)
    assert station.height_m() == pytest.approx(0.0, abs=0.01)
    assert station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1, 21196) != ACCEPTED


@BOTH
def test_a_reposition_that_comes_twice_is_one_flight(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.take_off(6.0)
    home = station.endpoint.vehicle.autopilot.home
    assert home is not None
    x, y = round((home.lat_deg + 2e-4) * 1e7), round(home.lon_deg * 1e7)
    for _ in range(2):
        frame = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT
        result = station.command_int(mavlink.MAV_CMD_DO_REPOSITION, frame, (-1, 1, 0, math.nan), (x, y, 6.0))
        assert result == ACCEPTED
        station.run(0.5)
    station.run(15.0)
    assert station.endpoint.vehicle.truth.position_ned_m[0] == pytest.approx(22.2, abs=2.0)


def test_no_command_of_this_vehicle_takes_long_enough_to_be_in_progress() -> None:
    """Neither autopilot answers IN_PROGRESS to what flies; calibrations are accepted, and tell by texts how they go."""
    for flavour in Flavour:
        station = Station(endpoint_of(flavour))
        station.wait_for_position()
        for command in range(1, 600):
            assert station.command(command, 0) != mavlink.MAV_RESULT_IN_PROGRESS
        assert station.command(mavlink.MAV_CMD_PREFLIGHT_CALIBRATION, 1) == ACCEPTED


@BOTH
def test_modes_that_are_refused_in_flight_leave_the_mode(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    assert station.set_mode(Mode.STABILIZE) == ACCEPTED
    station.run(3.0)
    assert station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1, 21196) == ACCEPTED
    refused = mavlink.MAV_RESULT_TEMPORARILY_REJECTED if flavour is Flavour.PX4 else mavlink.MAV_RESULT_FAILED
    for mode in (Mode.POSITION, Mode.RETURN):
        assert station.set_mode(mode) == refused
        assert station.endpoint.vehicle.autopilot.mode is Mode.STABILIZE
