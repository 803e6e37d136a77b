"""Failsafes of the flying vehicle: each failure with each answer, and what ends it."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.bare_vehicle import booted, hovering, run, wait_until
from tests.support.dangers import Endangered, Fault
from vehicle_sim.autopilot import Failsafe, Mode, Outcome
from vehicle_sim.autopilot.hand import CENTRED
from vehicle_sim.autopilot.mission_items import Command, Datum, MissionItem, Place
from vehicle_sim.parameters import Flavour
from vehicle_sim.sensors import SensorErrors
from vehicle_sim.signals import FREE

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4
BOTH = pytest.mark.parametrize("flavour", [AP, PX4])
Modes = list[tuple[float, Mode]]

GRID: list[tuple[Flavour, Fault, dict[str, float], Modes]] = [
    (AP, Fault.SETPOINTS, {}, []),
    (AP, Fault.STICKS, {"FS_THR_ENABLE": 0}, []),
    (AP, Fault.STICKS, {"FS_THR_ENABLE": 1}, [(1.0, Mode.RETURN)]),
    (AP, Fault.STICKS, {"FS_THR_ENABLE": 3, "RC_FS_TIMEOUT": 4}, [(4.0, Mode.LAND)]),
    (AP, Fault.STICKS, {"FS_THR_ENABLE": 7}, [(1.0, Mode.BRAKE)]),
    (AP, Fault.GROUND, {"FS_GCS_ENABLE": 0}, []),
    (AP, Fault.GROUND, {"FS_GCS_ENABLE": 1}, [(4.5, Mode.RETURN)]),
    (AP, Fault.FENCE, {"FENCE_ACTION": 0}, []),
    (AP, Fault.FENCE, {"FENCE_ACTION": 1}, [(0.05, Mode.RETURN)]),
    (AP, Fault.FENCE, {"FENCE_ACTION": 2}, [(0.05, Mode.LAND)]),
    (AP, Fault.FENCE, {"FENCE_ACTION": 4}, [(0.05, Mode.BRAKE)]),
    (AP, Fault.WIND, {}, []),
    (PX4, Fault.SETPOINTS, {"COM_OBL_RC_ACT": 0}, [(1.0, Mode.POSITION)]),
    (PX4, Fault.SETPOINTS, {"COM_OBL_RC_ACT": 5}, [(1.0, Mode.HOLD)]),
    (PX4, Fault.STICKS, {}, [(0.5, Mode.HOLD), (5.5, Mode.RETURN)]),
    (PX4, Fault.STICKS, {"NAV_RCL_ACT": 1}, [(0.5, Mode.HOLD)]),
    (PX4, Fault.STICKS, {"NAV_RCL_ACT": 3, "COM_FAIL_ACT_T": 0, "COM_RC_LOSS_T": 2}, [(2.0, Mode.LAND)]),
    (PX4, Fault.STICKS, {"COM_RCL_EXCEPT": 4}, []),
    (PX4, Fault.STICKS, {"COM_RCL_EXCEPT": 3}, [(0.5, Mode.HOLD), (5.5, Mode.RETURN)]),
    (PX4, Fault.GROUND, {"NAV_DLL_ACT": 2, "COM_DL_LOSS_T": 5}, [(4.5, Mode.HOLD), (9.5, Mode.RETURN)]),
    (PX4, Fault.BATTERY_LOW, {"COM_LOW_BAT_ACT": 3}, []),
    (PX4, Fault.BATTERY_CRITICAL, {"COM_LOW_BAT_ACT": 0}, []),
    (PX4, Fault.BATTERY_CRITICAL, {"COM_LOW_BAT_ACT": 3}, [(0.05, Mode.HOLD), (5.0, Mode.RETURN)]),
    (PX4, Fault.BATTERY_EMERGENCY, {"COM_LOW_BAT_ACT": 3}, [(0.05, Mode.HOLD), (5.0, Mode.LAND)]),
    (PX4, Fault.FENCE, {"GF_ACTION": 1}, []),
    (PX4, Fault.FENCE, {"GF_ACTION": 3}, [(0.05, Mode.HOLD), (5.0, Mode.RETURN)]),
    (PX4, Fault.WIND, {"COM_WIND_MAX": 8, "COM_WIND_MAX_ACT": 2}, [(3.0, Mode.HOLD)]),
]
"""Failure, parameters, and the modes that follow with the seconds after which each is entered."""


@pytest.mark.parametrize(("flavour", "fault", "parameters", "modes"), GRID)
def test_each_failure_leads_where_the_parameters_say(
    flavour: Flavour, fault: Fault, parameters: dict[str, float], modes: Modes
) -> None:
    one = Endangered(flavour, sticks=fault is Fault.STICKS, **parameters)
    one.begin(fault)
    one.fly(11.0)
    assert [mode for _, mode in one.modes] == [mode for _, mode in modes]
    # Heartbeats come once a second: when the last one came is known to half of that. The wind needs time to be felt.
    unsure_s = {Fault.GROUND: 0.6, Fault.WIND: 3.0}.get(fault, 0.2)
    assert [time_s for time_s, _ in one.modes] == [pytest.approx(time_s, abs=unsure_s) for time_s, _ in modes]
    # A breach of the fence is no failsafe to ArduPilot.
    if modes and (flavour, fault) != (AP, Fault.FENCE):
        assert one.system_status in (mavlink.MAV_STATE_CRITICAL, mavlink.MAV_STATE_EMERGENCY)


@BOTH
def test_sticks_that_were_never_there_are_not_missed(flavour: Flavour) -> None:
    one = Endangered(flavour)
    one.fly(12.0)
    assert one.modes == []


@BOTH
def test_sticks_that_were_gone_when_it_was_armed_are_not_missed_until_they_come_back(flavour: Flavour) -> None:
    vehicle = booted(flavour)

    def be_there() -> None:
        """Be heard for a moment: as ArduPilot by the radio, as PX4 by a joystick."""
        if flavour is AP:
            vehicle.parameters.set("SIM_RC_FAIL", 0)
            run(vehicle, 0.1)
            vehicle.parameters.set("SIM_RC_FAIL", 1)
        vehicle.autopilot.pilot.move(CENTRED, vehicle.time_s)

    be_there()
    run(vehicle, 3.0)
    if flavour is AP:
        vehicle.autopilot.set_mode(Mode.GUIDED)
    assert vehicle.autopilot.arm() is Outcome.ACCEPTED
    assert vehicle.autopilot.takeoff(8.0) is Outcome.ACCEPTED
    run(vehicle, 15.0)
    assert vehicle.autopilot.failsafe is Failsafe.NONE
    be_there()
    wait_until(vehicle, lambda v: v.autopilot.failsafe is Failsafe.STICKS_LOST, within_s=1.2)


@BOTH
def test_loss_and_return_of_sticks_are_told_and_the_pilot_takes_over(flavour: Flavour) -> None:
    one = Endangered(flavour, sticks=True)
    one.begin(Fault.STICKS)
    one.fly(7.0)
    assert one.now() is Mode.RETURN
    one.end(Fault.STICKS)
    one.fly(1.0)
    assert one.now() is Mode.RETURN
    texts = {
        AP: ["Radio Failsafe", "Radio Failsafe Cleared"],
        PX4: ["Failsafe activated: Manual control lost", "Failsafe activated, entering Hold for 5 seconds"],
    }
    assert [text for text in one.station.texts() if "ailsafe" in text] == texts[flavour]
    one.station.set_mode(Mode.POSITION)
    one.fly(2.0)
    assert one.now() is Mode.POSITION
    assert one.system_status == mavlink.MAV_STATE_ACTIVE


def test_setpoints_of_px4_that_end_after_the_sticks_lead_to_what_is_set_for_the_sticks() -> None:
    for sticks_too, mode in ((False, Mode.POSITION), (True, Mode.RETURN)):
        one = Endangered(PX4, sticks=True, COM_RCL_EXCEPT=4)
        if sticks_too:
            one.begin(Fault.STICKS)
            one.fly(2.0)
        assert one.modes == []
        one.begin(Fault.SETPOINTS)
        one.fly(2.0)
        assert [entered for _, entered in one.modes] == [mode]


def test_missions_of_px4_go_on_without_sticks_where_they_may() -> None:
    for exceptions, modes in ((1, []), (2, [Mode.HOLD, Mode.RETURN])):
        one = Endangered(PX4, sticks=True, COM_RCL_EXCEPT=exceptions)
        there = one.vehicle.autopilot.home
        assert there is not None
        far = MissionItem(command=Command.WAYPOINT, place=Place(there.lat_deg + 0.01, there.lon_deg, 20.0, Datum.HOME))
        one.vehicle.autopilot.load_mission((far,))
        assert one.vehicle.autopilot.set_mode(Mode.AUTO) is Outcome.ACCEPTED
        one.fly(1.0)
        one.forget()
        one.begin(Fault.STICKS)
        one.fly(7.0)
        assert [entered for _, entered in one.modes] == modes


@pytest.mark.parametrize(
    ("flavour", "parameter", "value", "timeout_s", "mode"),
    [
        (AP, "FS_GCS_ENABLE", 0, None, Mode.GUIDED),
        (AP, "FS_GCS_ENABLE", 1, 5.0, Mode.RETURN),
        (AP, "FS_GCS_ENABLE", 5, 5.0, Mode.LAND),
        (AP, "FS_GCS_ENABLE", 7, 5.0, Mode.BRAKE),
        (PX4, "NAV_DLL_ACT", 0, None, Mode.HOLD),
        (PX4, "NAV_DLL_ACT", 2, 15.0, Mode.RETURN),
        (PX4, "NAV_DLL_ACT", 3, 15.0, Mode.LAND),
    ],
)
def test_silence_of_the_ground_station(
    flavour: Flavour, parameter: str, value: int, timeout_s: float | None, mode: Mode
) -> None:
    vehicle = hovering(flavour)
    vehicle.parameters.set(parameter, value)
    last_s = vehicle.time_s
    vehicle.autopilot.heartbeat_from_ground(255, last_s)
    if timeout_s is None:
        run(vehicle, 20.0)
    else:
        acted_s = wait_until(vehicle, lambda v: v.autopilot.mode is mode, within_s=20.0)
        assert acted_s - last_s == pytest.approx(timeout_s, abs=0.2)
        assert vehicle.autopilot.failsafe is Failsafe.GROUND_LOST
    assert vehicle.autopilot.mode is mode


def test_only_the_named_ground_station_counts_for_ardupilot() -> None:
    vehicle = hovering()
    vehicle.parameters.set("FS_GCS_ENABLE", 1)
    vehicle.autopilot.heartbeat_from_ground(255, vehicle.time_s)
    for _ in range(60):
        vehicle.autopilot.heartbeat_from_ground(245, vehicle.time_s)
        run(vehicle, 0.1)
    assert vehicle.autopilot.mode is Mode.RETURN


def test_a_pilot_overrides_a_failsafe_and_keeps_the_mode() -> None:
    vehicle = hovering()
    vehicle.parameters.set("FS_GCS_ENABLE", 1)
    vehicle.autopilot.heartbeat_from_ground(255, vehicle.time_s)
    wait_until(vehicle, lambda v: v.autopilot.mode is Mode.RETURN, within_s=6.0)
    assert vehicle.autopilot.set_mode(Mode.POSITION) is Outcome.ACCEPTED
    run(vehicle, 5.0)
    assert vehicle.autopilot.mode is Mode.POSITION
    assert vehicle.autopilot.in_failsafe


@pytest.mark.parametrize(
    ("flavour", "changes", "mode"),
    [
        (AP, {"BATT_LOW_MAH": 4990, "BATT_FS_LOW_ACT": 2}, Mode.RETURN),
        (AP, {"BATT_CRT_MAH": 4990, "BATT_FS_CRT_ACT": 1}, Mode.LAND),
        (AP, {"BATT_LOW_MAH": 4990}, Mode.GUIDED),
        (AP, {"BATT_LOW_VOLT": 12.5, "BATT_FS_LOW_ACT": 1, "BATT_LOW_TIMER": 2}, Mode.LAND),
        (PX4, {"BAT_CRIT_THR": 0.5, "BAT1_CAPACITY": 200, "COM_LOW_BAT_ACT": 2, "COM_FAIL_ACT_T": 0}, Mode.LAND),
        (PX4, {"BAT_LOW_THR": 0.5, "BAT1_CAPACITY": 200, "COM_LOW_BAT_ACT": 2}, Mode.HOLD),
    ],
)
def test_battery_levels(flavour: Flavour, changes: dict[str, float], mode: Mode) -> None:
    vehicle = hovering(flavour)
    for name, value in changes.items():
        vehicle.parameters.set(name, value)
    wait_until(vehicle, lambda v: v.autopilot.in_failsafe, within_s=60.0)
    run(vehicle, 0.2)
    assert vehicle.autopilot.mode is mode


def test_estimator_failure_in_flight_makes_it_land() -> None:
    vehicle = hovering()
    vehicle._sensors._errors = SensorErrors(gps_first_fix_s=1e9)
    wait_until(vehicle, lambda v: v.autopilot.failsafe is Failsafe.ESTIMATOR, within_s=10.0)
    assert vehicle.autopilot.mode is Mode.LAND
    assert vehicle.autopilot.target is not None
    assert vehicle.autopilot.target.position_ned_m == FREE
    wait_until(vehicle, lambda v: not v.autopilot.armed, within_s=60.0)
