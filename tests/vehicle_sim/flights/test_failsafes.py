"""Failsafes of the flying vehicle: each failure with each answer, and what ends it."""

import pytest

from tests.support.bare_vehicle import hovering, run, wait_until
from vehicle_sim.autopilot import Failsafe, Mode, Outcome
from vehicle_sim.parameters import Flavour
from vehicle_sim.sensors import SensorErrors
from vehicle_sim.signals import FREE

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4


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
