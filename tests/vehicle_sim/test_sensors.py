import numpy as np
import pytest

from vehicle_sim.geodesy import ned_offset_m
from vehicle_sim.sensors import SensorErrors, Sensors, standard_pressure_hpa
from vehicle_sim.signals import (
    GRAVITY_M_S2,
    BaroReading,
    CompassReading,
    Geodetic,
    GpsReading,
    ImuReading,
    Motion,
)

Row = tuple[ImuReading, GpsReading | None, BaroReading | None, CompassReading | None]

HOME = Geodetic(47.4, 8.5, 488.0)
MOVING = Motion(
    (120.0, -40.0, -30.0),
    (3.0, 1.0, -0.5),
    (0.0, 0.0, 0.0),
    0.05,
    -0.1,
    0.7,
    (0.1, -0.2, 0.3),
    (0.4, 0.2, -GRAVITY_M_S2),
    False,
)


def sampled(seed: int, steps: int, errors: SensorErrors | None = None) -> list[Row]:
    sensors = Sensors(SensorErrors() if errors is None else errors, seed=seed, home=HOME, step_s=0.01)
    rows = []
    for step in range(1, steps + 1):
        sensors.sample(step, step * 0.01, MOVING)
        rows.append((sensors.imu, sensors.gps, sensors.baro, sensors.compass))
    return rows


def test_each_sensor_keeps_its_own_rate() -> None:
    rows = sampled(1, 1000)
    rates = [len({reading.time_s for reading in column if reading is not None}) for column in zip(*rows, strict=True)]
    assert rates == [1000, 50, 100, 100]


def test_equal_seeds_give_equal_readings() -> None:
    assert sampled(7, 500) == sampled(7, 500)
    assert sampled(7, 500) != sampled(8, 500)


def test_one_sensor_does_not_depend_on_another() -> None:
    usual = sampled(7, 600)
    rare = sampled(7, 600, SensorErrors(baro_period_s=0.5, compass_period_s=1.0))
    assert [row[1] for row in usual] == [row[1] for row in rare]
    assert [row[0] for row in usual] == [row[0] for row in rare]


def test_no_fix_before_the_receiver_has_found_its_satellites() -> None:
    gps = [row[1] for row in sampled(1, 400)]
    assert {reading.fix_type for reading in gps if reading is not None and reading.time_s < 3.0} == {1}
    assert {reading.fix_type for reading in gps if reading is not None and reading.time_s > 3.0} == {3}


def test_errors_have_their_deviations() -> None:
    errors = SensorErrors(gps_wander_time_s=1.0, baro_wander_time_s=1.0)
    rows = sampled(2, 40_000, errors)
    gps = {row[1].time_s: row[1] for row in rows if row[1] is not None and row[1].fix_type == 3}
    miss = np.array([ned_offset_m(HOME, reading.position) for reading in gps.values()]) - MOVING.position_ned_m
    assert np.allclose(miss.std(axis=0), np.hypot((0.2, 0.2, 0.35), (0.2, 0.2, 0.3)), rtol=0.1)
    slip = np.array([reading.velocity_ned_m_s for reading in gps.values()]) - MOVING.velocity_ned_m_s
    assert np.allclose(slip.std(axis=0), 0.08, rtol=0.1)
    force = np.array([row[0].specific_force_m_s2 for row in rows])
    assert np.allclose(force.std(axis=0), 0.05, rtol=0.05)
    assert np.allclose(force.mean(axis=0), MOVING.specific_force_m_s2, atol=4 * 0.05)
    baro = np.array([row[2].altitude_m for row in rows if row[2] is not None])
    assert baro.mean() == pytest.approx(518.0, abs=0.1)


def test_pressure_is_that_of_the_standard_atmosphere() -> None:
    assert standard_pressure_hpa(0.0) == pytest.approx(1013.25)
    assert standard_pressure_hpa(1000.0) == pytest.approx(898.76, abs=0.1)
    assert standard_pressure_hpa(5000.0) == pytest.approx(540.20, abs=0.3)
