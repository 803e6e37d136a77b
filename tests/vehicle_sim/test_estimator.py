from dataclasses import replace

import numpy as np
import pytest

from tests.support.bare_vehicle import booted, hovering, run, wait_until
from vehicle_sim.estimator import Estimator, EstimatorTuning
from vehicle_sim.geodesy import geodetic_at, ned_offset_m
from vehicle_sim.sensors import SensorErrors, Sensors
from vehicle_sim.signals import EstimatorFlag, GpsReading
from vehicle_sim.vehicle import Vehicle, VehicleConfig


def flown_error(vehicle: Vehicle) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Error of position and velocity (6), both counted from the estimator's own origin."""
    estimate = vehicle.estimate
    assert estimate.origin is not None
    place = ned_offset_m(estimate.origin, vehicle.true_place)
    return np.array([*place, *vehicle.truth.velocity_ned_m_s]) - [
        *estimate.position_ned_m,
        *estimate.velocity_ned_m_s,
    ]


def test_no_position_before_the_origin_and_no_trust_before_it_has_settled() -> None:
    vehicle = Vehicle(VehicleConfig())
    assert vehicle.estimate.origin is None
    aligned_s = wait_until(vehicle, lambda v: v.estimate.status.attitude_ok, within_s=5.0)
    assert vehicle.estimate.status.flags == EstimatorFlag.ATTITUDE | EstimatorFlag.CONSTANT_POSITION
    origin_s = wait_until(vehicle, lambda v: v.estimate.origin is not None, within_s=15.0)
    assert not vehicle.estimate.status.position_ok
    trusted_s = wait_until(vehicle, lambda v: v.estimate.status.position_ok, within_s=5.0)
    assert (aligned_s, origin_s, trusted_s) == pytest.approx((2.0, 8.1, 9.7), abs=0.15)


def test_the_origin_is_what_the_gps_said_then_not_the_truth() -> None:
    vehicle = Vehicle(VehicleConfig(seed=4))
    fixes: list[GpsReading] = []
    while (origin := vehicle.estimate.origin) is None:
        vehicle.step()
        gps = vehicle.readings.gps
        if gps is not None and gps.fix_type == 3 and (not fixes or gps is not fixes[-1]):
            fixes.append(gps)
    assert origin == pytest.approx(np.mean([fix.position for fix in fixes], axis=0))
    off = ned_offset_m(vehicle.config.home, origin)
    assert 0.01 < np.hypot(off[0], off[1]) < 2.0


def test_hovering_is_known_to_a_third_of_a_metre() -> None:
    errors = []
    for seed in range(8):
        vehicle = hovering(seed=seed)
        run(vehicle, 5.0)
        errors.append(flown_error(vehicle))
    rms = np.sqrt(np.mean(np.square(errors), axis=0))
    assert np.hypot(rms[0], rms[1]) < 0.5
    assert np.all(rms[3:] < 0.1)


def shifted(gps: GpsReading, north_m: float) -> GpsReading:
    return gps._replace(position=geodetic_at(gps.position, (north_m, 0.0, 0.0)))


class Bench:
    """Sensors and estimator on a table: readings can be tampered with on their way."""

    def __init__(self, seed: int = 1) -> None:
        self.vehicle = Vehicle(VehicleConfig(seed=seed))
        self.sensors = Sensors(SensorErrors(), seed=seed, home=self.vehicle.config.home, step_s=0.01)
        self.estimator = Estimator(EstimatorTuning(), step_s=0.01)
        self.steps = 0

    def run(self, seconds: float, *, gps_north_m: float | None = 0.0) -> None:
        """Let time pass with the GPS shifted to the north, or silent."""
        for _ in range(round(seconds * 100)):
            self.steps += 1
            time_s = self.steps * 0.01
            self.sensors.sample(self.steps, time_s, self.vehicle.truth)
            gps = self.sensors.new_gps if gps_north_m is not None else None
            self.estimator.step(
                time_s,
                self.sensors.imu,
                gps if gps is None or not gps_north_m else shifted(gps, gps_north_m),
                self.sensors.new_baro,
                self.sensors.new_compass,
            )


def test_outliers_are_refused_and_leave_the_estimate_alone() -> None:
    bench = Bench()
    bench.run(15.0)
    before = bench.estimator.estimate.position_ned_m
    bench.run(1.0, gps_north_m=30.0)
    estimate = bench.estimator.estimate
    assert estimate.status.gps_glitch
    assert estimate.status.position_ok
    assert np.allclose(estimate.position_ned_m, before, atol=0.4)
    bench.run(0.5)
    assert not bench.estimator.estimate.status.gps_glitch


def test_a_position_that_insists_is_believed_in_the_end() -> None:
    bench = Bench()
    bench.run(15.0)
    bench.run(20.0, gps_north_m=30.0)
    estimate = bench.estimator.estimate
    assert estimate.position_ned_m[0] == pytest.approx(30.0, abs=1.5)
    assert estimate.status.position_ok


def test_without_gps_the_position_is_no_longer_vouched_for() -> None:
    bench = Bench()
    bench.run(15.0)
    bench.run(4.0, gps_north_m=None)
    assert bench.estimator.estimate.status.position_ok
    bench.run(2.0, gps_north_m=None)
    status = bench.estimator.estimate.status
    assert not status.position_ok
    assert status.height_ok
    bench.run(2.0)
    assert bench.estimator.estimate.status.position_ok


def test_a_tilt_error_is_found_while_flying() -> None:
    errors = replace(SensorErrors(), accelerometer_bias_m_s2=0.2)
    vehicle = Vehicle(VehicleConfig(seed=3, sensor_errors=errors))
    wait_until(vehicle, lambda v: v.estimate.status.position_ok, within_s=20.0)
    run(vehicle, 20.0)
    # Standing level, the tilt that explains the bias of the accelerometers is the best that any filter can find.
    assert abs(vehicle.estimate.acceleration_ned_m_s2[0]) < 0.2
    assert np.hypot(*vehicle.estimate.velocity_ned_m_s[:2]) < 0.1


def test_equal_seeds_give_equal_estimates() -> None:
    assert booted(seed=5).estimate == booted(seed=5).estimate
    assert booted(seed=5).estimate != booted(seed=6).estimate
