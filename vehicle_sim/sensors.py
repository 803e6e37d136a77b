"""The sensors: each samples the true motion at its own rate, with errors of its own from its own seed.

GPS errors are white noise plus a slow first-order Gauss-Markov wander, as those of a good receiver under open sky;
the barometer wanders with the weather; the inertial unit has constant biases; the compass is a little off.
"""

from dataclasses import dataclass
from typing import Final

from vehicle_sim.dynamics.kinematics import to_body
from vehicle_sim.geodesy import geodetic_at
from vehicle_sim.noise import GaussMarkov, Normals
from vehicle_sim.signals import (
    GRAVITY_M_S2,
    BaroReading,
    CompassReading,
    Geodetic,
    GpsReading,
    ImuReading,
    Motion,
    Vector,
)

_IMU, _GPS, _BARO, _COMPASS = 1, 2, 3, 4
_FIELD_NED_GAUSS: Final = (0.21, 0.0, 0.42)


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorErrors:
    """Standard deviations of all sensor errors, correlation times and rates; SI and radians."""

    accelerometer_noise_m_s2: float = 0.05
    accelerometer_bias_m_s2: float = 0.05
    gyro_noise_rad_s: float = 0.002
    gyro_bias_rad_s: float = 0.005
    gps_period_s: float = 0.1
    gps_first_fix_s: float = 3.0
    gps_noise_m: float = 0.2
    gps_vertical_noise_m: float = 0.35
    gps_wander_m: float = 0.2
    gps_vertical_wander_m: float = 0.3
    gps_wander_time_s: float = 60.0
    gps_velocity_noise_m_s: float = 0.08
    baro_period_s: float = 0.1
    baro_noise_m: float = 0.15
    baro_wander_m: float = 0.3
    baro_wander_time_s: float = 200.0
    compass_period_s: float = 0.1
    compass_noise_rad: float = 0.01
    compass_bias_rad: float = 0.01


def _three(normals: Normals, std: float) -> Vector:
    return (std * normals.draw(), std * normals.draw(), std * normals.draw())


def standard_pressure_hpa(altitude_m: float) -> float:
    """Return the pressure of the standard atmosphere (ISO 2533, troposphere) at `altitude_m`."""
    return float(1013.25 * (1.0 - 2.25577e-5 * altitude_m) ** 5.25588)


class Sensors:
    """All sensors of one vehicle; the attributes hold the latest readings (None before the first)."""

    def __init__(self, errors: SensorErrors, *, seed: int, home: Geodetic, step_s: float) -> None:
        """Switch on at vehicle time 0 at `home`, the origin of the true motion."""
        self._errors = errors
        self._home = home
        self._noise = {source: Normals(seed, source) for source in (_IMU, _GPS, _BARO, _COMPASS)}
        self._imu_normals = self._noise[_IMU]
        self._accelerometer_bias = _three(self._imu_normals, errors.accelerometer_bias_m_s2)
        self._gyro_bias = _three(self._imu_normals, errors.gyro_bias_rad_s)
        self._gps_steps = max(1, round(errors.gps_period_s / step_s))
        self._baro_steps = max(1, round(errors.baro_period_s / step_s))
        self._compass_steps = max(1, round(errors.compass_period_s / step_s))
        stds = (errors.gps_wander_m, errors.gps_wander_m, errors.gps_vertical_wander_m)
        period, time_s = self._gps_steps * step_s, errors.gps_wander_time_s
        self._gps_wander = [GaussMarkov(self._noise[_GPS], std=std, time_s=time_s, step_s=period) for std in stds]
        self._baro_wander = GaussMarkov(
            self._noise[_BARO],
            std=errors.baro_wander_m,
            time_s=errors.baro_wander_time_s,
            step_s=self._baro_steps * step_s,
        )
        self._compass_bias = errors.compass_bias_rad * self._noise[_COMPASS].draw()
        self.imu = ImuReading(0.0, (0.0, 0.0, -GRAVITY_M_S2), (0.0, 0.0, 0.0))
        self.gps: GpsReading | None = None
        self.baro: BaroReading | None = None
        self.compass: CompassReading | None = None

    def sample(self, steps: int, time_s: float, motion: Motion) -> None:
        """Take the measurements that are due at step number `steps`."""
        errors, draw = self._errors, self._imu_normals.draw
        force, rates = motion.specific_force_m_s2, motion.rates_rad_s
        bias, drift = self._accelerometer_bias, self._gyro_bias
        a, g = errors.accelerometer_noise_m_s2, errors.gyro_noise_rad_s
        self.imu = ImuReading(
            time_s,
            (force[0] + bias[0] + a * draw(), force[1] + bias[1] + a * draw(), force[2] + bias[2] + a * draw()),
            (rates[0] + drift[0] + g * draw(), rates[1] + drift[1] + g * draw(), rates[2] + drift[2] + g * draw()),
        )
        if steps % self._gps_steps == 0:
            self.gps = self._fix(time_s, motion)
        if steps % self._baro_steps == 0:
            altitude = self._home.alt_m - motion.position_ned_m[2] + self._baro_wander.step()
            altitude += errors.baro_noise_m * self._noise[_BARO].draw()
            self.baro = BaroReading(time_s, standard_pressure_hpa(altitude), 25.0, altitude)
        if steps % self._compass_steps == 0:
            error = self._compass_bias + errors.compass_noise_rad * self._noise[_COMPASS].draw()
            field = to_body(motion.roll_rad, motion.pitch_rad, motion.yaw_rad + error, _FIELD_NED_GAUSS)
            self.compass = CompassReading(time_s, field, motion.yaw_rad + error)

    def _fix(self, time_s: float, motion: Motion) -> GpsReading:
        errors, normals = self._errors, self._noise[_GPS]
        north, east, down = motion.position_ned_m
        wander = [process.step() for process in self._gps_wander]
        place = (
            north + wander[0] + errors.gps_noise_m * normals.draw(),
            east + wander[1] + errors.gps_noise_m * normals.draw(),
            down + wander[2] + errors.gps_vertical_noise_m * normals.draw(),
        )
        velocity = motion.velocity_ned_m_s
        slips = _three(normals, errors.gps_velocity_noise_m_s)
        if time_s < errors.gps_first_fix_s:
            # A receiver that still searches: the numbers are there, and mean nothing.
            return GpsReading(time_s, 1, 0, Geodetic(0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 99.99, 99.99, 99.0, 99.0, 99.0)
        return GpsReading(
            time_s,
            3,
            12,
            geodetic_at(self._home, place),
            (velocity[0] + slips[0], velocity[1] + slips[1], velocity[2] + slips[2]),
            0.7,
            1.0,
            (errors.gps_noise_m**2 + errors.gps_wander_m**2) ** 0.5,
            (errors.gps_vertical_noise_m**2 + errors.gps_vertical_wander_m**2) ** 0.5,
            errors.gps_velocity_noise_m_s,
        )
