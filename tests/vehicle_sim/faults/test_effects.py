"""What each fault does to a vehicle in flight, as timelines: by schedule, and by parameter."""

from dataclasses import replace
from math import degrees, hypot

import numpy as np
import pytest

from tests.support.bare_vehicle import run, wait_until
from tests.support.faults import schedule_of
from vehicle_sim.autopilot import Failsafe, LandedState, Mode, Outcome
from vehicle_sim.battery import BatteryLevel
from vehicle_sim.geodesy import ned_offset_m
from vehicle_sim.parameters import Flavour
from vehicle_sim.signals import GRAVITY_M_S2, EstimatorFlag
from vehicle_sim.vehicle import Vehicle, VehicleConfig

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4
BOTH = pytest.mark.parametrize("flavour", [AP, PX4])


def flying(*faults: str, flavour: Flavour = AP, seed: int = 1, wind_m_s: float = 0.0) -> Vehicle:
    """A vehicle that hovers at 10 m, 20 s after take-off; times of its faults count from take-off."""
    config = VehicleConfig(flavour=flavour, seed=seed, wind_m_s=wind_m_s)
    vehicle = Vehicle(replace(config, faults=schedule_of(*(f"{fault}, since: takeoff" for fault in faults))))
    if flavour is AP:
        vehicle.autopilot.set_mode(Mode.GUIDED)
    wait_until(vehicle, lambda v: not v.autopilot.arming_faults, within_s=30.0)
    assert vehicle.autopilot.arm() is Outcome.ACCEPTED
    assert vehicle.autopilot.takeoff(10.0) is Outcome.ACCEPTED
    lifted_s = wait_until(vehicle, lambda v: v.autopilot.flying, within_s=10.0)
    run(vehicle, 20.0 - (vehicle.time_s - lifted_s))
    assert vehicle.autopilot.landed_state is LandedState.IN_AIR
    return vehicle


def place(vehicle: Vehicle) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return np.array(vehicle.truth.position_ned_m)


def miss(vehicle: Vehicle) -> float:
    """How wrong the estimated horizontal position is."""
    estimate = vehicle.estimate
    assert estimate.origin is not None
    true = ned_offset_m(estimate.origin, vehicle.true_place)
    return hypot(true[0] - estimate.position_ned_m[0], true[1] - estimate.position_ned_m[1])


def largest(vehicle: Vehicle, seconds: float, names: tuple[str, ...]) -> dict[str, float]:
    """The largest test ratios over some time."""
    most = dict.fromkeys(names, 0.0)
    for _ in range(round(seconds * 100)):
        vehicle.step()
        for name in names:
            most[name] = max(most[name], getattr(vehicle.estimate.status, name))
    return most


@BOTH
def test_without_gps_flags_fall_after_five_seconds_and_it_lands(flavour: Flavour) -> None:
    vehicle = flying("gps_loss, at_s: 20", flavour=flavour)
    run(vehicle, 4.0)
    assert vehicle.estimate.status.position_ok
    assert vehicle.autopilot.failsafe is Failsafe.NONE
    wait_until(vehicle, lambda v: not v.estimate.status.position_ok, within_s=2.0)
    flags = vehicle.estimate.status.flags
    assert not flags & EstimatorFlag.POSITION_HORIZONTAL_ABSOLUTE
    assert flags & EstimatorFlag.POSITION_VERTICAL_ABSOLUTE
    wait_until(vehicle, lambda v: v.autopilot.failsafe is Failsafe.ESTIMATOR, within_s=1.0)
    wait_until(vehicle, lambda v: v.autopilot.mode is Mode.LAND, within_s=10.0)
    wait_until(vehicle, lambda v: not v.autopilot.armed, within_s=60.0)
    assert vehicle.truth.on_ground
    readings = vehicle.readings
    assert readings.gps is not None
    assert readings.gps.fix_type == 0


def test_a_gps_that_comes_back_in_time_is_nothing() -> None:
    vehicle = flying("gps_loss, at_s: 20, for_s: 4")
    run(vehicle, 12.0)
    assert vehicle.autopilot.mode is Mode.GUIDED
    assert vehicle.autopilot.failsafe is Failsafe.NONE
    assert miss(vehicle) < 1.0


def test_gps_off_and_on_again_by_parameter_on_the_ground() -> None:
    vehicle = Vehicle(VehicleConfig())
    wait_until(vehicle, lambda v: v.estimate.status.position_ok, within_s=20.0)
    vehicle.parameters.set("SIM_GPS1_ENABLE", 0)
    run(vehicle, 6.0)
    assert not vehicle.estimate.status.position_ok
    assert vehicle.autopilot.arm() is Outcome.ACCEPTED  # STABILIZE asks for no position
    vehicle.autopilot.disarm()
    vehicle.autopilot.set_mode(Mode.GUIDED)
    assert vehicle.autopilot.arm() is Outcome.FAILED
    vehicle.parameters.set("SIM_GPS1_ENABLE", 1)
    run(vehicle, 1.0)
    assert vehicle.estimate.status.position_ok


def test_a_short_jump_is_refused_as_an_outlier() -> None:
    vehicle = flying("gps_jump, at_s: 20, for_s: 0.6, north_m: 30")
    before = place(vehicle)
    ratios = largest(vehicle, 0.9, ("position_horizontal_ratio",))
    assert ratios["position_horizontal_ratio"] > 1.0
    assert miss(vehicle) < 1.0
    run(vehicle, 3.0)
    assert not vehicle.estimate.status.gps_glitch
    assert vehicle.autopilot.mode is Mode.GUIDED
    assert np.linalg.norm(place(vehicle) - before) < 1.0


def test_a_jump_that_lasts_is_believed_after_seven_seconds() -> None:
    vehicle = flying("gps_jump, at_s: 20, north_m: 15, east_m: -8")
    vehicle.parameters.set("FS_EKF_ACTION", 0)
    run(vehicle, 6.0)
    assert vehicle.estimate.status.gps_glitch
    assert miss(vehicle) < 1.5
    wait_until(vehicle, lambda v: miss(v) > 10.0, within_s=3.0)
    run(vehicle, 10.0)
    # It now flies to where it thinks that it was: the truth is as far off as the fix.
    assert place(vehicle)[:2] == pytest.approx((-15.0, 8.0), abs=1.5)
    assert vehicle.estimate.status.position_ok


def test_a_jump_makes_ardupilot_land_by_its_test_ratio() -> None:
    vehicle = flying("gps_jump, at_s: 20, north_m: 15")
    wait_until(vehicle, lambda v: v.autopilot.failsafe is Failsafe.ESTIMATOR, within_s=3.0)
    assert vehicle.autopilot.mode is Mode.LAND


def test_a_slow_drift_misleads_without_any_sign() -> None:
    vehicle = flying("gps_drift, at_s: 20, ramp_s: 3, east_m_s: 0.3")
    before = place(vehicle)
    ratios = largest(vehicle, 30.0, ("position_horizontal_ratio", "velocity_ratio"))
    assert max(ratios.values()) < 1.0
    assert vehicle.autopilot.failsafe is Failsafe.NONE
    assert 6.5 < before[1] - place(vehicle)[1] < 10.0


def test_a_glitch_by_parameter_is_in_degrees() -> None:
    vehicle = flying()
    vehicle.parameters.set("SIM_GPS1_GLTCH_X", 0.0002)
    run(vehicle, 0.4)
    gps = vehicle.readings.gps
    assert gps is not None
    assert ned_offset_m(vehicle.true_place, gps.position)[0] == pytest.approx(22.2, abs=1.5)
    assert vehicle.estimate.status.gps_glitch


def test_noise_beyond_belief_is_refused_more_often_than_not() -> None:
    vehicle = flying("gps_noise, at_s: 20, noise_m: 8, for_s: 3")
    assert largest(vehicle, 3.0, ("position_horizontal_ratio",))["position_horizontal_ratio"] > 1.0
    assert miss(vehicle) < 2.0


def test_few_satellites_make_it_less_sure_and_too_few_are_no_fix() -> None:
    vehicle = flying()
    sure_m = vehicle.estimate.status.horizontal_accuracy_m
    vehicle.parameters.set("SIM_GPS1_NUMSATS", 4)
    run(vehicle, 10.0)
    gps = vehicle.readings.gps
    assert gps is not None
    assert (gps.fix_type, gps.satellites) == (3, 4)
    assert gps.hdop > 1.0
    assert vehicle.estimate.status.horizontal_accuracy_m > sure_m
    vehicle.parameters.set("SIM_GPS1_NUMSATS", 3)
    wait_until(vehicle, lambda v: v.autopilot.failsafe is Failsafe.ESTIMATOR, within_s=8.0)


def test_a_stuck_receiver_is_found_out_once_the_vehicle_moves() -> None:
    vehicle = flying("gps_stuck, at_s: 20")
    n, e, d = vehicle.estimate.position_ned_m
    vehicle.autopilot.reposition((n + 40.0, e, d))
    assert max(largest(vehicle, 6.0, ("position_horizontal_ratio", "velocity_ratio")).values()) > 1.0


def test_a_late_fix_is_as_good_as_an_early_one_and_a_too_late_one_is_none() -> None:
    for lag_ms, flies_on in ((0, True), (240, True), (400, False)):
        vehicle = flying()
        vehicle.parameters.set("SIM_GPS1_LAG_MS", lag_ms)
        run(vehicle, 1.0)
        n, e, d = vehicle.estimate.position_ned_m
        vehicle.autopilot.reposition((n + 30.0, e, d))
        worst = 0.0
        for _ in range(700):
            vehicle.step()
            worst = max(worst, miss(vehicle))
        assert (vehicle.autopilot.mode is Mode.GUIDED) is flies_on, lag_ms
        assert worst < (1.2 if flies_on else 4.0), lag_ms


def test_a_gust_pushes_by_a_bounded_amount_and_is_held_against() -> None:
    vehicle = flying("gust, at_s: 20, for_s: 4, east_m_s: 10")
    start, farthest = place(vehicle), 0.0
    for _ in range(400):
        vehicle.step()
        farthest = max(farthest, place(vehicle)[1] - start[1])
    # The drag of 10 m/s accelerates by 1 m/s^2; held with tau = 0.8 s, less than 1 m/s^2 tau^2 is left.
    assert 0.1 < farthest < 0.64 + 0.3
    run(vehicle, 6.0)
    assert np.linalg.norm(place(vehicle) - start) < 0.6


def test_a_steady_wind_begins_in_flight_and_tilts_the_vehicle() -> None:
    vehicle = flying("wind, at_s: 20, ramp_s: 2, north_m_s: -8")
    run(vehicle, 10.0)
    assert -vehicle.truth.pitch_rad == pytest.approx(0.1 * 8.0 / GRAVITY_M_S2, abs=0.02)


@pytest.mark.parametrize("name", ["SIM_ACC1_BIAS_X", "SIM_ACC1_BIAS_Y"])
def test_a_bias_of_the_accelerometers_is_seen_in_the_innovations_and_learnt(name: str) -> None:
    calm, shaken = flying(), flying()
    shaken.parameters.set(name, 0.2)
    quiet = largest(calm, 5.0, ("velocity_ratio",))["velocity_ratio"]
    loud = largest(shaken, 5.0, ("velocity_ratio",))["velocity_ratio"]
    assert loud > 1.3 * quiet
    run(shaken, 40.0)
    assert shaken.autopilot.mode is Mode.GUIDED
    assert miss(shaken) < 1.5
    assert largest(shaken, 5.0, ("velocity_ratio",))["velocity_ratio"] < 0.9


def test_a_bias_of_the_gyro_is_seen_in_the_innovations_and_learnt() -> None:
    vehicle = flying()
    quiet = largest(vehicle, 5.0, ("velocity_ratio",))["velocity_ratio"]
    vehicle.parameters.set("SIM_GYR1_BIAS_X", 0.004)
    assert largest(vehicle, 10.0, ("velocity_ratio",))["velocity_ratio"] > 1.3 * quiet
    run(vehicle, 40.0)
    assert vehicle.autopilot.mode is Mode.GUIDED
    assert abs(vehicle.estimate.rates_rad_s[0] - vehicle.truth.rates_rad_s[0]) < 0.01
    assert abs(vehicle.estimate.roll_rad - vehicle.truth.roll_rad) < 0.03


def test_a_bias_that_no_filter_can_explain_makes_it_land() -> None:
    vehicle = flying()
    vehicle.parameters.set("SIM_GYR1_BIAS_Y", 0.03)
    wait_until(vehicle, lambda v: v.autopilot.failsafe is Failsafe.ESTIMATOR, within_s=15.0)
    assert vehicle.autopilot.mode is Mode.LAND


def test_a_field_of_the_vehicle_turns_the_heading() -> None:
    vehicle = flying()
    ratio = vehicle.estimate.status.compass_ratio
    # 80 mGauss to the right of a horizontal field of 210 turn it by 21 degrees.
    vehicle.parameters.set("SIM_MAG1_OFS_Y", 93.0)
    run(vehicle, 0.3)
    assert vehicle.estimate.status.compass_ratio > ratio + 0.3
    run(vehicle, 15.0)
    wrong = degrees(vehicle.estimate.yaw_rad - vehicle.truth.yaw_rad)
    assert wrong == pytest.approx(-21.0, abs=4.0)
    assert miss(vehicle) < 1.5


def test_without_a_compass_the_gyro_keeps_the_heading_for_a_while() -> None:
    vehicle = flying("compass_loss, at_s: 20")
    run(vehicle, 20.0)
    assert abs(vehicle.estimate.yaw_rad - vehicle.truth.yaw_rad) < 0.05


def test_a_barometer_that_jumps_is_refused_and_one_that_drifts_is_outvoted() -> None:
    jump = flying("baro_jump, at_s: 20, up_m: 15")
    height = -place(jump)[2]
    assert largest(jump, 5.0, ("position_vertical_ratio",))["position_vertical_ratio"] > 1.0
    assert -place(jump)[2] == pytest.approx(height, abs=1.0)
    drift = flying("baro_drift, at_s: 20, up_m_s: 0.1")
    height = -place(drift)[2]
    run(drift, 60.0)
    assert -place(drift)[2] == pytest.approx(height, abs=2.0)


@pytest.mark.parametrize("fault", ["baro_loss", "baro_stuck"])
def test_the_height_is_kept_without_a_barometer(fault: str) -> None:
    vehicle = flying(f"{fault}, at_s: 20")
    height = -place(vehicle)[2]
    baro = vehicle.readings.baro
    run(vehicle, 20.0)
    later = vehicle.readings.baro
    assert baro is not None
    assert later is not None
    assert baro.altitude_m == later.altitude_m
    assert -place(vehicle)[2] == pytest.approx(height, abs=1.5)


def test_a_weak_motor_tilts_and_shifts_it_but_it_flies_on() -> None:
    vehicle = flying("motor, at_s: 20, rotor: 1, efficiency: 0.7")
    start = place(vehicle)
    disturbed = 0.0
    for _ in range(500):
        vehicle.step()
        disturbed = max(disturbed, hypot(vehicle.truth.roll_rad, vehicle.truth.pitch_rad))
    assert 0.02 < disturbed < 0.4
    assert 0.02 < np.linalg.norm(place(vehicle) - start) < 1.0
    assert vehicle.autopilot.mode is Mode.GUIDED


def test_all_motors_at_half_thrust_cannot_carry_it_much_longer() -> None:
    vehicle = flying()
    vehicle.parameters.set("SIM_ENGINE_MUL", 0.45)
    vehicle.parameters.set("SIM_ENGINE_FAIL", 15)
    wait_until(vehicle, lambda v: v.truth.on_ground, within_s=30.0)


@BOTH
def test_a_battery_can_be_emptied(flavour: Flavour) -> None:
    vehicle = flying("battery, at_s: 21, voltage_v: 10.35", flavour=flavour)
    for name, value in {AP: {"BATT_FS_LOW_ACT": 1}, PX4: {"COM_LOW_BAT_ACT": 2, "COM_FAIL_ACT_T": 0}}[flavour].items():
        vehicle.parameters.set(name, value)
    full = vehicle.battery.remaining
    run(vehicle, 2.0)
    assert vehicle.battery.remaining < 0.15 < full
    wait_until(vehicle, lambda v: v.battery.level >= BatteryLevel.LOW, within_s=15.0)
    run(vehicle, 1.0)
    assert vehicle.autopilot.mode is Mode.LAND


def test_equal_seeds_and_schedules_give_equal_flights() -> None:
    faults = ("gust, at_s: 20, for_s: 3, north_m_s: 5", "gps_noise, at_s: 20, noise_m: 2")

    def flight() -> list[object]:
        vehicle = flying(*faults, wind_m_s=2.0)
        rows: list[object] = []
        for _ in range(200):
            vehicle.step()
            rows.append((vehicle.truth, vehicle.estimate, vehicle.readings))
        return rows

    assert flight() == flight()


def test_a_fault_that_is_over_leaves_the_noise_of_all_sensors_as_it_was() -> None:
    usual = Vehicle(VehicleConfig())
    noisy = Vehicle(VehicleConfig(faults=schedule_of("gps_noise, at_s: 1, for_s: 3, noise_m: 5")))
    for vehicle in (usual, noisy):
        run(vehicle, 6.0)
    assert usual.readings == noisy.readings
