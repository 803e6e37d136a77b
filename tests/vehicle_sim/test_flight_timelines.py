"""Whole flights of the bare vehicle, as timelines."""

import numpy as np
import pytest

from tests.support.bare_vehicle import booted, hovering, run, wait_until
from vehicle_sim.autopilot import ArmingReason, Failsafe, LandedState, Mode, Outcome, SpeedAxis
from vehicle_sim.parameters import Flavour
from vehicle_sim.sensors import SensorErrors
from vehicle_sim.signals import FREE, PartialVector, Setpoint
from vehicle_sim.vehicle import Vehicle, VehicleConfig

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4
BOTH = pytest.mark.parametrize("flavour", [AP, PX4])


def said(vehicle: Vehicle) -> list[str]:
    texts = [text.text for text in vehicle.autopilot.texts]
    vehicle.autopilot.texts.clear()
    return texts


def place(vehicle: Vehicle, north: float = 0.0, east: float = 0.0, up: float = 0.0) -> PartialVector:
    n, e, d = vehicle.estimate.position_ned_m
    return (n + north, e + east, d - up)


def mode_of(vehicle: Vehicle) -> Mode:
    return vehicle.autopilot.mode


def landed_state(vehicle: Vehicle) -> LandedState:
    return vehicle.autopilot.landed_state


def offboard(vehicle: Vehicle) -> Setpoint:
    """Bring a hovering PX4 into Offboard and return the setpoint that it flies."""
    setpoint = Setpoint(position_ned_m=place(vehicle, north=5.0))
    run(vehicle, 0.5, setpoint)
    assert vehicle.autopilot.set_mode(Mode.GUIDED) is Outcome.ACCEPTED
    run(vehicle, 1.0, setpoint)
    assert mode_of(vehicle) is Mode.GUIDED
    return setpoint


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
    vehicle.autopilot.set_mode(Mode.RETURN)
    run(vehicle, 65.0)
    assert [text for text in said(vehicle) if text.startswith("PreArm")] == [
        "PreArm: Gyros not calibrated",
        "PreArm: RTL mode not armable",
        "PreArm: RTL mode not armable",
    ]


@pytest.mark.parametrize("mode", [Mode.RETURN, Mode.LAND, Mode.BRAKE])
def test_modes_of_the_way_down_cannot_be_armed_in(mode: Mode) -> None:
    vehicle = booted()
    vehicle.autopilot.set_mode(mode)
    assert vehicle.autopilot.arm() is Outcome.FAILED
    assert vehicle.autopilot.arm(force=True) is Outcome.ACCEPTED


@BOTH
def test_take_off_hover_and_land(flavour: Flavour) -> None:
    vehicle = hovering(flavour, height_m=8.0)
    autopilot = vehicle.autopilot
    assert autopilot.mode is {AP: Mode.GUIDED, PX4: Mode.HOLD}[flavour]
    run(vehicle, 5.0)
    home = autopilot._home_ned_m
    assert home[2] - vehicle.estimate.position_ned_m[2] == pytest.approx(8.0, abs=0.3)
    assert np.hypot(vehicle.truth.position_ned_m[0], vehicle.truth.position_ned_m[1]) < 1.0
    assert autopilot.land() is Outcome.ACCEPTED
    run(vehicle, 2.0)
    assert landed_state(vehicle) is LandedState.LANDING
    touched_s = wait_until(vehicle, lambda v: v.truth.on_ground, within_s=30.0)
    disarmed_s = wait_until(vehicle, lambda v: not v.autopilot.armed, within_s=10.0)
    # Detection takes a second; then ArduPilot disarms at once and PX4 after COM_DISARM_LAND.
    assert disarmed_s - touched_s == pytest.approx({AP: 1.5, PX4: 3.5}[flavour], abs=0.7)
    run(vehicle, 0.6)
    assert landed_state(vehicle) is LandedState.ON_GROUND


@BOTH
def test_armed_and_idle_it_disarms_by_itself(flavour: Flavour) -> None:
    vehicle = booted(flavour)
    assert vehicle.autopilot.arm() is Outcome.ACCEPTED
    started_s = vehicle.time_s
    assert wait_until(vehicle, lambda v: not v.autopilot.armed, within_s=12.0) - started_s == pytest.approx(10, abs=0.1)
    assert vehicle.truth.position_ned_m == (0.0, 0.0, 0.0)


def test_ardupilot_takes_off_only_armed_and_guided_and_only_upwards() -> None:
    vehicle = booted()
    autopilot = vehicle.autopilot
    assert autopilot.takeoff(10.0) is Outcome.FAILED
    autopilot.set_mode(Mode.POSITION)
    autopilot.arm()
    assert autopilot.takeoff(10.0) is Outcome.FAILED
    autopilot.set_mode(Mode.GUIDED)
    assert autopilot.takeoff(-1.0) is Outcome.FAILED
    assert autopilot.takeoff(10.0) is Outcome.ACCEPTED
    assert autopilot.takeoff(10.0) is Outcome.ACCEPTED
    run(vehicle, 1.5)
    assert vehicle.truth.on_ground
    run(vehicle, 2.0)
    assert not vehicle.truth.on_ground


def test_ardupilot_setpoints_do_not_lift_it_from_the_ground_and_px4_ones_do() -> None:
    for flavour, lifts in ((AP, False), (PX4, True)):
        vehicle = booted(flavour)
        climb = Setpoint(position_ned_m=place(vehicle, up=5.0))
        run(vehicle, 1.0, climb)
        vehicle.autopilot.set_mode(Mode.GUIDED)
        assert vehicle.autopilot.arm() is Outcome.ACCEPTED
        run(vehicle, 6.0, climb)
        assert vehicle.truth.on_ground is not lifts


def test_px4_offboard_needs_a_stream_before_and_says_accepted_without() -> None:
    vehicle = hovering(PX4)
    autopilot = vehicle.autopilot
    said(vehicle)
    assert autopilot.set_mode(Mode.GUIDED) is Outcome.ACCEPTED
    assert mode_of(vehicle) is Mode.HOLD
    assert said(vehicle) == ["Switching to Offboard is currently not available"]
    offboard(vehicle)


def test_px4_on_the_ground_changes_to_offboard_and_then_refuses_to_arm() -> None:
    vehicle = booted(PX4)
    assert vehicle.autopilot.set_mode(Mode.GUIDED) is Outcome.ACCEPTED
    assert vehicle.autopilot.mode is Mode.GUIDED
    assert vehicle.autopilot.arm() is Outcome.TEMPORARILY_REJECTED
    assert [fault.reason for fault in vehicle.autopilot.arming_faults] == [ArmingReason.NO_SETPOINTS]


@pytest.mark.parametrize(
    ("action", "mode"),
    [(0, Mode.POSITION), (1, Mode.ALT_HOLD), (2, Mode.MANUAL), (3, Mode.RETURN), (4, Mode.LAND), (5, Mode.HOLD)],
)
def test_px4_acts_when_setpoints_stop(action: int, mode: Mode) -> None:
    vehicle = hovering(PX4)
    vehicle.parameters.set("COM_OBL_RC_ACT", action)
    vehicle.parameters.set("COM_FAIL_ACT_T", 2.0)
    offboard(vehicle)
    last_s = vehicle.time_s
    lost_s = wait_until(vehicle, lambda v: v.autopilot.in_failsafe, within_s=3.0)
    assert lost_s - last_s == pytest.approx(1.05, abs=0.1)
    if mode in (Mode.RETURN, Mode.LAND):
        assert vehicle.autopilot.mode is Mode.HOLD
        run(vehicle, 2.1)
    assert vehicle.autopilot.mode is mode
    assert vehicle.autopilot.failsafe is Failsafe.SETPOINTS_LOST


def test_px4_goes_back_to_offboard_with_the_stream_unless_the_pilot_has_chosen() -> None:
    for pilot_chooses in (False, True):
        vehicle = hovering(PX4)
        setpoint = offboard(vehicle)
        run(vehicle, 2.0)
        assert mode_of(vehicle) is Mode.POSITION
        if pilot_chooses:
            vehicle.autopilot.hold()
        run(vehicle, 1.0, setpoint)
        assert vehicle.autopilot.mode is (Mode.HOLD if pilot_chooses else Mode.GUIDED)
        assert vehicle.autopilot.failsafe is Failsafe.NONE


def test_ardupilot_stops_but_stays_guided_when_velocities_stop() -> None:
    vehicle = hovering()
    run(vehicle, 4.0, Setpoint(velocity_ned_m_s=(2.0, 0.0, 0.0)))
    last_s = vehicle.time_s
    run(vehicle, 2.5)
    assert vehicle.estimate.velocity_ned_m_s[0] == pytest.approx(2.0, abs=0.3)
    stopped_s = wait_until(vehicle, lambda v: abs(v.truth.velocity_ned_m_s[0]) < 0.2, within_s=5.0)
    assert stopped_s - last_s == pytest.approx(4.3, abs=0.7)
    assert vehicle.autopilot.mode is Mode.GUIDED
    assert not vehicle.autopilot.in_failsafe


def test_ardupilot_goes_on_to_a_position_that_was_sent_once() -> None:
    vehicle = hovering()
    target = place(vehicle, north=25.0)
    vehicle.autopilot.setpoint(Setpoint(position_ned_m=target))
    run(vehicle, 15.0)
    assert vehicle.estimate.position_ned_m[0] == pytest.approx(target[0], abs=0.3)


def test_ten_metres_take_ardupilot_about_four_seconds() -> None:
    vehicle = hovering()
    target = place(vehicle, north=10.0)
    assert target[0] is not None
    started_s, goal = vehicle.time_s, target[0]
    vehicle.autopilot.setpoint(Setpoint(position_ned_m=target))
    reached_s = wait_until(vehicle, lambda v: v.estimate.position_ned_m[0] > goal - 1.0, within_s=10.0)
    assert reached_s - started_s == pytest.approx(4.0, abs=1.0)
    run(vehicle, 6.0)
    assert vehicle.estimate.position_ned_m[0] == pytest.approx(goal, abs=0.3)


def test_setpoints_outside_guided_are_ignored() -> None:
    vehicle = hovering()
    vehicle.autopilot.set_mode(Mode.POSITION)
    before = vehicle.autopilot.target
    assert not vehicle.autopilot.setpoint(Setpoint(position_ned_m=place(vehicle, north=50.0)))
    assert vehicle.autopilot.target == before


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


@BOTH
def test_return_climbs_flies_home_and_lands_there(flavour: Flavour) -> None:
    vehicle = hovering(flavour, height_m=6.0, wind_m_s=3.0)
    autopilot = vehicle.autopilot
    name = {AP: "RTL_ALT", PX4: "RTL_RETURN_ALT"}[flavour]
    vehicle.parameters.set(name, {AP: 1200.0, PX4: 12.0}[flavour])
    autopilot.reposition(place(vehicle, north=30.0, east=-20.0))
    run(vehicle, 15.0)
    assert np.hypot(*vehicle.truth.position_ned_m[:2]) > 30.0
    assert autopilot.return_to_launch() is Outcome.ACCEPTED
    highest = 0.0
    deadline_s = vehicle.time_s + 90.0
    while autopilot.armed and vehicle.time_s < deadline_s:
        vehicle.step()
        highest = min(highest, vehicle.truth.position_ned_m[2])
    assert not autopilot.armed
    assert -highest == pytest.approx(12.0, abs=1.5)
    assert np.hypot(*vehicle.truth.position_ned_m[:2]) < 1.5


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


def test_speed_and_yaw_on_request() -> None:
    vehicle = hovering()
    autopilot = vehicle.autopilot
    assert autopilot.change_speed(1.5) is Outcome.ACCEPTED
    assert autopilot.change_speed(0.0) is Outcome.FAILED
    assert autopilot.change_speed(0.5, SpeedAxis.UP) is Outcome.ACCEPTED
    autopilot.reposition(place(vehicle, north=12.0, up=3.0))
    run(vehicle, 4.0)
    speed = vehicle.truth.velocity_ned_m_s
    assert speed[0] == pytest.approx(1.5, abs=0.15)
    assert -speed[2] == pytest.approx(0.5, abs=0.1)
    assert autopilot.turn(1.2) is Outcome.ACCEPTED
    run(vehicle, 5.0)
    assert vehicle.truth.yaw_rad == pytest.approx(1.2, abs=0.1)
    assert autopilot.turn(-0.7, relative=True) is Outcome.ACCEPTED
    run(vehicle, 5.0)
    assert vehicle.truth.yaw_rad == pytest.approx(0.5, abs=0.1)
    assert hovering(PX4).autopilot.turn(1.0) is Outcome.UNSUPPORTED


def test_pause_stops_and_resume_goes_on() -> None:
    vehicle = hovering()
    target = place(vehicle, north=80.0)
    assert target[0] is not None
    vehicle.autopilot.setpoint(Setpoint(position_ned_m=target))
    run(vehicle, 4.0)
    assert vehicle.autopilot.pause() is Outcome.ACCEPTED
    run(vehicle, 6.0)
    stopped = vehicle.estimate.position_ned_m[0]
    assert stopped < target[0] - 10.0
    assert vehicle.autopilot.resume() is Outcome.ACCEPTED
    run(vehicle, 20.0)
    assert vehicle.estimate.position_ned_m[0] == pytest.approx(target[0], abs=0.3)


def test_holding_brakes_without_coming_back() -> None:
    vehicle = hovering()
    run(vehicle, 6.0, Setpoint(velocity_ned_m_s=(8.0, 0.0, 0.0)))
    assert vehicle.autopilot.hold() is Outcome.ACCEPTED
    farthest = 0.0
    for _ in range(1000):
        vehicle.step()
        farthest = max(farthest, vehicle.truth.position_ned_m[0])
    assert farthest - vehicle.truth.position_ned_m[0] < 0.5
    assert abs(vehicle.truth.velocity_ned_m_s[0]) < 0.2


def test_home_is_where_it_was_armed_unless_it_was_set() -> None:
    vehicle = hovering()
    autopilot = vehicle.autopilot
    first = autopilot.home
    revision = autopilot.home_revision
    assert autopilot.set_home() is Outcome.ACCEPTED
    assert autopilot.home != first
    assert autopilot.home_revision == revision + 1
    kept = autopilot.home
    autopilot.land()
    wait_until(vehicle, lambda v: not v.autopilot.armed, within_s=40.0)
    autopilot.set_mode(Mode.GUIDED)
    autopilot.arm()
    assert autopilot.home == kept


@pytest.mark.parametrize("wind_m_s", [0.0, 8.0])
def test_wind_does_not_carry_it_away(wind_m_s: float) -> None:
    vehicle = hovering(wind_m_s=wind_m_s)
    run(vehicle, 10.0)
    start = np.array(vehicle.truth.position_ned_m)
    run(vehicle, 20.0)
    assert np.linalg.norm(np.array(vehicle.truth.position_ned_m) - start) < 1.0


@BOTH
def test_the_same_seed_gives_the_same_flight(flavour: Flavour) -> None:
    def flown(seed: int) -> list[object]:
        vehicle = hovering(flavour, seed=seed, wind_m_s=4.0)
        vehicle.autopilot.reposition(place(vehicle, north=5.0))
        rows: list[object] = []
        for _ in range(200):
            vehicle.step()
            rows.append((vehicle.truth, vehicle.estimate, vehicle.readings, vehicle.battery.voltage_v))
        return rows

    assert flown(3) == flown(3)
    assert flown(3) != flown(4)


def test_estimator_failure_in_flight_makes_it_land() -> None:
    vehicle = hovering()
    vehicle._sensors._errors = SensorErrors(gps_first_fix_s=1e9)
    wait_until(vehicle, lambda v: v.autopilot.failsafe is Failsafe.ESTIMATOR, within_s=10.0)
    assert vehicle.autopilot.mode is Mode.LAND
    assert vehicle.autopilot.target is not None
    assert vehicle.autopilot.target.position_ned_m == FREE
    wait_until(vehicle, lambda v: not v.autopilot.armed, within_s=60.0)
