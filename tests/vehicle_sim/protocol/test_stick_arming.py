"""Arming and disarming by sticks, and what sticks that are missing, or not down, keep from arming."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import ArmingReason, Mode, Outcome
from vehicle_sim.parameters import Flavour

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4
FULL, DOWN = 1000, 0
SECONDS = {AP: 3.0, PX4: 1.0}
BY_HAND = {AP: Mode.STABILIZE, PX4: Mode.STABILIZE}
BOTH = pytest.mark.parametrize("flavour", Flavour)


def waiting(flavour: Flavour, mode: Mode | None = None) -> Station:
    """Return a station whose vehicle could be armed, in a mode by hand."""
    station = Station(endpoint_of(flavour))
    station.run(12.0)
    station.endpoint.vehicle.autopilot.set_mode(mode or BY_HAND[flavour])
    station.endpoint.vehicle.autopilot.texts.clear()
    return station


def hold(station: Station, seconds: float, *, r: int = 0, z: int = DOWN, x: int = 0) -> None:
    for _ in range(round(seconds * 10)):
        station.send(mavlink.MAVLink_manual_control_message(1, x, 0, z, r, 0))
        station.run(0.1)


def is_armed(station: Station) -> bool:
    return station.endpoint.vehicle.autopilot.armed


def texts(station: Station) -> list[str]:
    return [text.text.rstrip("\t") for text in station.of("STATUSTEXT")]


@BOTH
def test_throttle_down_and_full_right_arms_and_full_left_disarms(flavour: Flavour) -> None:
    station = waiting(flavour)
    hold(station, SECONDS[flavour] - 0.4, r=FULL)
    hold(station, 0.3)
    hold(station, SECONDS[flavour] - 0.4, r=FULL)
    assert not is_armed(station)
    hold(station, 0.8, r=FULL)
    assert is_armed(station)
    hold(station, SECONDS[flavour] + 0.4, r=-FULL)
    assert not is_armed(station)
    said = {AP: ["Arming motors", "Disarming motors"], PX4: ["Armed by Stick gesture", "Disarmed by Stick gesture"]}
    assert [text for text in texts(station) if "rm" in text and "PreArm" not in text][-2:] == said[flavour]


@pytest.mark.parametrize(
    ("flavour", "parameter", "value", "arms", "disarms"),
    [
        (AP, "ARMING_RUDDER", 0, False, False),
        (AP, "ARMING_RUDDER", 1, True, False),
        (PX4, "MAN_ARM_GESTURE", 0, False, False),
    ],
)
def test_parameters_forbid_it(flavour: Flavour, parameter: str, value: int, *, arms: bool, disarms: bool) -> None:
    station = waiting(flavour)
    station.endpoint.vehicle.parameters.set(parameter, value)
    hold(station, 4.0, r=FULL)
    autopilot = station.endpoint.vehicle.autopilot
    assert autopilot.armed is arms
    hold(station, 0.3)
    assert autopilot.arm() is Outcome.ACCEPTED
    hold(station, 4.0, r=-FULL)
    assert autopilot.armed is not disarms


@pytest.mark.parametrize(
    ("flavour", "sticks"),
    [(AP, {"z": 200}), (PX4, {"z": 200}), (PX4, {"x": 300}), (AP, {"r": 800}), (PX4, {"r": 800})],
)
def test_other_positions_are_no_gesture(flavour: Flavour, sticks: dict[str, int]) -> None:
    station = waiting(flavour)
    hold(station, 4.0, **{"r": FULL, **sticks})
    assert not station.endpoint.vehicle.autopilot.armed


@pytest.mark.parametrize(
    ("flavour", "mode", "refusal"),
    [
        (AP, Mode.GUIDED, "Arm: GUIDED mode not armable"),
        (PX4, Mode.HOLD, "Arming denied: switch to manual mode first"),
    ],
)
def test_sticks_do_not_arm_in_modes_without_them(flavour: Flavour, mode: Mode, refusal: str) -> None:
    station = waiting(flavour, mode)
    hold(station, 4.0, r=FULL)
    assert not station.endpoint.vehicle.autopilot.armed
    assert texts(station).count(refusal) == 1
    assert station.endpoint.vehicle.autopilot.arm() is Outcome.ACCEPTED


@pytest.mark.parametrize(
    ("mode", "z", "refusal"),
    [
        (Mode.STABILIZE, 500, "Arming denied: high throttle"),
        (Mode.POSITION, 700, "Arming denied: throttle above center"),
        (Mode.POSITION, 500, ""),
    ],
)
def test_px4_looks_at_the_throttle_whoever_arms(mode: Mode, z: int, refusal: str) -> None:
    station = waiting(PX4, mode)
    hold(station, 0.5, z=z)
    outcome = station.endpoint.vehicle.autopilot.arm()
    station.run(0.1)
    assert (outcome is Outcome.ACCEPTED) is not bool(refusal)
    assert not refusal or refusal in texts(station)


def test_px4_wants_sticks_in_modes_that_are_flown_by_them() -> None:
    station = waiting(PX4)
    autopilot = station.endpoint.vehicle.autopilot
    assert [fault.reason for fault in autopilot.arming_faults] == [ArmingReason.NO_STICKS]
    assert autopilot.arm() is Outcome.TEMPORARILY_REJECTED
    station.forget()
    station.run(31.0)
    assert not [text for text in texts(station) if text.startswith("Preflight Fail")]
    hold(station, 0.5)
    assert autopilot.arm() is Outcome.ACCEPTED
    station.run(1.0)
    assert autopilot.set_mode(Mode.POSITION) is Outcome.TEMPORARILY_REJECTED
    hold(station, 0.2)
    assert autopilot.set_mode(Mode.POSITION) is Outcome.ACCEPTED


def in_the_air(mode: Mode) -> Station:
    station = Station(endpoint_of(AP))
    station.take_off(5.0)
    assert station.set_mode(mode) == mavlink.MAV_RESULT_ACCEPTED
    return station


@pytest.mark.parametrize(("mode", "disarms"), [(Mode.STABILIZE, True), (Mode.POSITION, False)])
def test_in_the_air_sticks_disarm_only_where_the_throttle_is_thrust(mode: Mode, *, disarms: bool) -> None:
    station = in_the_air(mode)
    autopilot = station.endpoint.vehicle.autopilot
    for _ in range(16):
        station.send(mavlink.MAVLink_manual_control_message(1, 0, 0, DOWN, -FULL, 0))
        if not autopilot.armed or not autopilot.flying:
            break
        station.run(0.2)
    assert autopilot.armed is not disarms
