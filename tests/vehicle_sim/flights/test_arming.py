"""Arming and disarming of the bare vehicle, as timelines."""

import pytest

from tests.support.bare_vehicle import booted, hovering, mode_of, offboard, run, said, wait_until
from vehicle_sim.autopilot import ArmingReason, LandedState, Mode, Outcome
from vehicle_sim.autopilot.hand import CENTRED
from vehicle_sim.parameters import Flavour
from vehicle_sim.vehicle import Vehicle, VehicleConfig

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4
BOTH = pytest.mark.parametrize("flavour", [AP, PX4])


@BOTH
def test_arming_is_refused_until_the_estimator_is_ready(flavour: Flavour) -> None:
    vehicle = Vehicle(VehicleConfig(flavour=flavour))
    autopilot = vehicle.autopilot
    if flavour is AP:
        autopilot.set_mode(Mode.GUIDED)
    refusal = {AP: Outcome.FAILED, PX4: Outcome.TEMPORARILY_REJECTED}[flavour]
    assert autopilot.arm() is refusal
    run(vehicle, 5.0)
    said(vehicle)
    assert autopilot.arm() is refusal
    assert ArmingReason.NO_POSITION in [fault.reason for fault in autopilot.arming_faults]
    assert said(vehicle) == [
        {AP: "Arm: Need Position Estimate", PX4: "Arming denied: Resolve system health failures first"}[flavour]
    ]
    run(vehicle, 6.0)
    assert autopilot.ready_to_arm
    assert autopilot.arm() is Outcome.ACCEPTED
    assert autopilot.arm() is Outcome.ACCEPTED


def test_the_reason_is_repeated_every_half_minute() -> None:
    vehicle = Vehicle(VehicleConfig())
    vehicle.battery.consumed_mah = 4000.0
    vehicle.parameters.set("BATT_CRT_MAH", 2000)
    vehicle.autopilot.set_mode(Mode.RETURN)
    run(vehicle, 65.0)
    assert [text for text in said(vehicle) if text.startswith("PreArm")] == [
        "PreArm: Gyros not calibrated",
        "PreArm: Battery 1 below minimum arming voltage",
        "PreArm: Battery 1 below minimum arming voltage",
    ]


@pytest.mark.parametrize("mode", [Mode.RETURN, Mode.LAND, Mode.BRAKE])
def test_modes_of_the_way_down_cannot_be_armed_in(mode: Mode) -> None:
    vehicle = booted()
    vehicle.autopilot.set_mode(mode)
    said(vehicle)
    assert vehicle.autopilot.arm() is Outcome.FAILED
    assert said(vehicle) == [f"Arm: {vehicle.autopilot.rule.name} mode not armable"]
    assert vehicle.autopilot.arm(force=True) is Outcome.ACCEPTED


@pytest.mark.parametrize("way_down", [Mode.LAND, Mode.RETURN])
@pytest.mark.parametrize("before", [Mode.POSITION, Mode.HOLD, Mode.GUIDED])
def test_px4_goes_back_to_the_mode_that_it_was_flown_in_and_can_be_armed_again(before: Mode, way_down: Mode) -> None:
    vehicle = hovering(PX4, height_m=3.0)
    stream = offboard(vehicle) if before is Mode.GUIDED else None
    vehicle.parameters.set("COM_RC_LOSS_T", 35)
    vehicle.autopilot.pilot.move(CENTRED, vehicle.time_s)
    assert vehicle.autopilot.set_mode(before) is Outcome.ACCEPTED
    vehicle.parameters.set("COM_RCL_EXCEPT", 7)
    assert vehicle.autopilot.set_mode(way_down) is Outcome.ACCEPTED
    wait_until(vehicle, lambda v: not v.autopilot.armed, within_s=90.0)
    assert mode_of(vehicle) is before
    vehicle.autopilot.pilot.move(CENTRED, vehicle.time_s)
    run(vehicle, 1.0, stream)
    assert vehicle.autopilot.prearm_faults == ()
    assert vehicle.autopilot.arm() is Outcome.ACCEPTED


def test_px4_goes_back_after_a_failsafe_has_brought_it_down() -> None:
    vehicle = hovering(PX4, height_m=3.0)
    vehicle.parameters.set("COM_OBL_RC_ACT", 4)
    setpoint = offboard(vehicle)
    wait_until(vehicle, lambda v: not v.autopilot.armed, within_s=30.0)
    assert mode_of(vehicle) is Mode.GUIDED
    assert vehicle.autopilot.arm() is Outcome.TEMPORARILY_REJECTED
    run(vehicle, 0.5, setpoint)
    assert vehicle.autopilot.arm() is Outcome.ACCEPTED


def test_ardupilot_stays_in_the_mode_of_the_landing_and_says_nothing_until_it_is_armed() -> None:
    vehicle = hovering(height_m=3.0)
    vehicle.autopilot.land()
    wait_until(vehicle, lambda v: not v.autopilot.armed, within_s=30.0)
    said(vehicle)
    run(vehicle, 35.0)
    assert mode_of(vehicle) is Mode.LAND
    assert said(vehicle) == []
    assert vehicle.autopilot.prearm_faults == ()
    assert vehicle.autopilot.arm() is Outcome.FAILED
    assert said(vehicle) == ["Arm: LAND mode not armable"]
    vehicle.autopilot.set_mode(Mode.GUIDED)
    assert vehicle.autopilot.arm() is Outcome.ACCEPTED


@BOTH
def test_armed_and_idle_it_disarms_by_itself(flavour: Flavour) -> None:
    vehicle = booted(flavour)
    assert vehicle.autopilot.arm() is Outcome.ACCEPTED
    started_s = vehicle.time_s
    assert wait_until(vehicle, lambda v: not v.autopilot.armed, within_s=12.0) - started_s == pytest.approx(10, abs=0.1)
    assert vehicle.truth.position_ned_m == (0.0, 0.0, 0.0)


@BOTH
def test_in_the_air_only_force_disarms_and_then_it_falls(flavour: Flavour) -> None:
    vehicle = hovering(flavour)
    assert vehicle.autopilot.disarm() is {AP: Outcome.FAILED, PX4: Outcome.TEMPORARILY_REJECTED}[flavour]
    assert vehicle.autopilot.disarm(force=True) is Outcome.ACCEPTED
    wait_until(vehicle, lambda v: v.truth.on_ground, within_s=5.0)
    wait_until(vehicle, lambda v: v.autopilot.landed_state is LandedState.ON_GROUND, within_s=5.0)


def test_termination_is_for_good() -> None:
    vehicle = hovering()
    assert vehicle.autopilot.terminate() is Outcome.ACCEPTED
    run(vehicle, 5.0)
    assert vehicle.autopilot.arm(force=True) is Outcome.FAILED


@pytest.mark.parametrize(
    ("checks", "outcome"),
    [(1, Outcome.FAILED), (1 << 8, Outcome.FAILED), (1 << 3, Outcome.ACCEPTED), (0, Outcome.ACCEPTED)],
)
def test_ardupilot_can_be_told_not_to_look_at_the_battery(checks: int, outcome: Outcome) -> None:
    vehicle = booted()
    vehicle.parameters.set("BATT_CRT_MAH", 4990)
    vehicle.parameters.set("BATT_FS_CRT_ACT", 0)
    vehicle.parameters.set("ARMING_CHECK", checks)
    vehicle.battery.consumed_mah = 50.0
    run(vehicle, 0.5)
    vehicle.autopilot.set_mode(Mode.GUIDED)
    assert vehicle.autopilot.arm() is outcome
    assert ("Arm: Battery 1 below minimum arming voltage" in said(vehicle)) is (outcome is Outcome.FAILED)


def test_the_mode_is_looked_at_whatever_is_skipped() -> None:
    vehicle = booted()
    vehicle.parameters.set("ARMING_CHECK", 0)
    vehicle.autopilot.set_mode(Mode.LAND)
    assert vehicle.autopilot.arm() is Outcome.FAILED
