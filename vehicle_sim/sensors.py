"""The sensors: each samples the true motion at its own rate, with errors of its own from its own seed.

GPS errors are white noise plus a slow first-order Gauss-Markov wander, as those of a good receiver under open sky;
a fix arrives late, and says when it was taken. The barometer wanders with the weather; the inertial unit has constant
biases; the compass is a little off. What is wrong beyond that comes as `Conditions`.
"""

from collections import deque
from dataclasses import dataclass
from math import atan2, cos, sin
from typing import Final

from vehicle_sim.dynamics.kinematics import to_body
from vehicle_sim.faults import SOUND, Conditions, SensorState
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

_IMU, _GPS, _BARO, _COMPASS, _GPS_FAULT = 1, 2, 3, 4, 6
_FIELD_NED_GAUSS: Final = (0.21, 0.0, 0.42)
_NONE: Final[Vector] = (0.0, 0.0, 0.0)
_SATELLITES: Final = 10
_FEWEST_SATELLITES: Final = 4
"""Four unknowns, place and time, take four satellites."""

_RECEIVER_GONE_S: Final = 4.0
_HDOP: Final = 0.7
_VDOP: Final = 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorErrors:
    """Standard deviations of all sensor errors, correlation times and rates; SI and radians."""

    accelerometer_noise_m_s2: float = 0.05
    accelerometer_bias_m_s2: float = 0.05
    gyro_noise_rad_s: float = 0.002
    gyro_bias_rad_s: float = 0.005
    gps_period_s: float = 0.2
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


def _sum(first: Vector, second: Vector) -> Vector:
    return first[0] + second[0], first[1] + second[1], first[2] + second[2]


def heading_of(field: Vector, roll_rad: float, pitch_rad: float) -> float:
    """Return the heading that a field in body axes tells a vehicle that knows its roll and pitch."""
    x, y, z = field
    under = y * sin(roll_rad) + z * cos(roll_rad)
    right = y * cos(roll_rad) - z * sin(roll_rad)
    return atan2(-right, x * cos(pitch_rad) + under * sin(pitch_rad))


class Sensors:
    """All sensors of one vehicle.

    `imu`, `gps`, `baro` and `compass` are the latest readings (None before the first), `new_gps`, `new_baro` and
    `new_compass` are what has arrived at this step.
    """

    def __init__(self, errors: SensorErrors, *, seed: int, home: Geodetic, step_s: float) -> None:
        """Switch on at vehicle time 0 at `home`, the origin of the true motion."""
        self._errors = errors
        self._home = home
        self._step_s = step_s
        self._noise = {source: Normals(seed, source) for source in (_IMU, _GPS, _BARO, _COMPASS, _GPS_FAULT)}
        self._imu_normals = self._noise[_IMU]
        self._own_accelerometer_bias = _three(self._imu_normals, errors.accelerometer_bias_m_s2)
        self._own_gyro_bias = _three(self._imu_normals, errors.gyro_bias_rad_s)
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
        self._gps_drifted: Vector = _NONE
        self._baro_drifted_m = 0.0
        self._on_its_way: deque[tuple[int, GpsReading]] = deque()
        self.imu = ImuReading(0.0, (0.0, 0.0, -GRAVITY_M_S2), (0.0, 0.0, 0.0))
        self.gps: GpsReading | None = None
        self.baro: BaroReading | None = None
        self.compass: CompassReading | None = None
        self.new_gps: GpsReading | None = None
        self.new_baro: BaroReading | None = None
        self.new_compass: CompassReading | None = None
        self.suffer(SOUND)

    def suffer(self, conditions: Conditions) -> None:
        """Be as wrong as `conditions` say from now on."""
        self._conditions = conditions
        self._accelerometer_bias = _sum(self._own_accelerometer_bias, conditions.accelerometer_bias_m_s2)
        self._gyro_bias = _sum(self._own_gyro_bias, conditions.gyro_bias_rad_s)
        self._lag_steps = round(conditions.gps_lag_s / self._step_s)

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
        self.new_gps = self.new_baro = self.new_compass = None
        if steps % self._gps_steps == 0:
            self._measure_place(steps, time_s, motion)
        if self._on_its_way and self._on_its_way[0][0] <= steps:
            self.gps = self.new_gps = self._on_its_way.popleft()[1]
        if steps % self._baro_steps == 0:
            self._measure_pressure(time_s, motion)
        if steps % self._compass_steps == 0:
            self._measure_field(time_s, motion)

    def _measure_pressure(self, time_s: float, motion: Motion) -> None:
        now = self._conditions
        altitude = self._home.alt_m - motion.position_ned_m[2] + self._baro_wander.step()
        altitude += self._errors.baro_noise_m * self._noise[_BARO].draw()
        drift = now.baro_drift_m_s * self._baro_steps * self._step_s
        self._baro_drifted_m = self._baro_drifted_m + drift if drift else 0.0
        altitude += now.baro_offset_m + self._baro_drifted_m
        if now.baro is SensorState.SILENT:
            return
        if now.baro is SensorState.STUCK and self.baro is not None:
            altitude = self.baro.altitude_m
        self.baro = self.new_baro = BaroReading(time_s, standard_pressure_hpa(altitude), 25.0, altitude)

    def _measure_field(self, time_s: float, motion: Motion) -> None:
        now, roll, pitch = self._conditions, motion.roll_rad, motion.pitch_rad
        heading = motion.yaw_rad + self._compass_bias + self._errors.compass_noise_rad * self._noise[_COMPASS].draw()
        if now.compass is SensorState.SILENT:
            return
        field = to_body(roll, pitch, heading, _FIELD_NED_GAUSS)
        if now.field_offset_gauss != _NONE:
            field = _sum(field, now.field_offset_gauss)
            heading = heading_of(field, roll, pitch)
        if now.compass is SensorState.STUCK and self.compass is not None:
            field, heading = self.compass.field_gauss, self.compass.heading_rad
        self.compass = self.new_compass = CompassReading(time_s, field, heading)

    def _measure_place(self, steps: int, time_s: float, motion: Motion) -> None:
        """Take a fix, and send it on its way."""
        fix, now = self._fix(time_s, motion), self._conditions
        if now.gps is SensorState.SILENT:
            if self.gps is not None and time_s - self.gps.time_s > _RECEIVER_GONE_S:
                self.gps = _no_fix(time_s, 0, 0)
            return
        if now.gps is SensorState.STUCK and self.gps is not None:
            fix = self.gps._replace(time_s=time_s)
        arrival = steps + self._lag_steps
        # A lag that has just shrunk lets no fix overtake another.
        self._on_its_way.append((max(arrival, self._on_its_way[-1][0] if self._on_its_way else 0), fix))

    def _fix(self, time_s: float, motion: Motion) -> GpsReading:
        errors, normals, now = self._errors, self._noise[_GPS], self._conditions
        north, east, down = motion.position_ned_m
        wander = [process.step() for process in self._gps_wander]
        noise = _three(normals, 1.0)
        slips = _three(normals, errors.gps_velocity_noise_m_s)
        drift, period_s = now.gps_drift_ned_m_s, self._gps_steps * self._step_s
        self._gps_drifted = (
            _NONE
            if drift == _NONE
            else _sum(self._gps_drifted, (drift[0] * period_s, drift[1] * period_s, drift[2] * period_s))
        )
        if time_s < errors.gps_first_fix_s or now.gps_satellites < _FEWEST_SATELLITES:
            # A receiver that still searches: the numbers are there, and mean nothing.
            return _no_fix(time_s, 1, now.gps_satellites if time_s >= errors.gps_first_fix_s else 0)
        dilution = (_SATELLITES / now.gps_satellites) ** 0.5
        level, height = errors.gps_noise_m * dilution, errors.gps_vertical_noise_m * dilution
        place = (north + wander[0] + level * noise[0], east + wander[1] + level * noise[1], down + wander[2])
        place = _sum((place[0], place[1], place[2] + height * noise[2]), now.gps_offset_ned_m)
        place = _sum(place, self._gps_drifted)
        if now.gps_noise_m > 0.0:
            place = _sum(place, _three(self._noise[_GPS_FAULT], now.gps_noise_m))
        where, glitch = geodetic_at(self._home, place), now.gps_glitch
        if glitch != _NONE:
            where = Geodetic(where.lat_deg + glitch[0], where.lon_deg + glitch[1], where.alt_m + glitch[2])
        velocity = _sum(_sum(motion.velocity_ned_m_s, slips), _sum(drift, now.gps_velocity_error_ned_m_s))
        return GpsReading(
            time_s,
            3,
            now.gps_satellites,
            where,
            velocity,
            _HDOP * dilution,
            _VDOP * dilution,
            (level**2 + errors.gps_wander_m**2) ** 0.5,
            (height**2 + errors.gps_vertical_wander_m**2) ** 0.5,
            errors.gps_velocity_noise_m_s,
        )


def _no_fix(time_s: float, fix_type: int, satellites: int) -> GpsReading:
    return GpsReading(time_s, fix_type, satellites, Geodetic(0.0, 0.0, 0.0), _NONE, 99.99, 99.99, 99.0, 99.0, 99.0)
