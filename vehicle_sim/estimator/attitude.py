"""Attitude reference: gyros integrated as roll, pitch and yaw, levelled at rest, corrected by filter and compass."""

from math import atan2, cos, hypot, pi, sin
from typing import Final

from vehicle_sim.signals import GRAVITY_M_S2, CompassReading, ImuReading, Vector

_ALIGNMENT_S: Final = 2.0
_COMPASS_GAIN: Final = 0.05


def wrapped(angle_rad: float) -> float:
    """Return the angle in [-pi, pi) that looks the same way."""
    return (angle_rad + pi) % (2.0 * pi) - pi


class AttitudeReference:
    """Roll, pitch and yaw of a vehicle that stood still for its first two seconds.

    While it stands, the gyros' biases are averaged and the accelerometers level it. `acceleration_ned_m_s2` is the
    measured specific force turned into the local frame, plus gravity.
    """

    def __init__(self, *, step_s: float) -> None:
        """Begin to align."""
        self._step_s = step_s
        self._samples = 0
        self._force_sum = [0.0, 0.0, 0.0]
        self._rate_sum = [0.0, 0.0, 0.0]
        self.bias_rad_s: Vector = (0.0, 0.0, 0.0)
        self._force_bias: Vector = (0.0, 0.0, 0.0)
        self._has_heading = False
        self.aligned = False
        self.roll_rad = 0.0
        self.pitch_rad = 0.0
        self.yaw_rad = 0.0
        self.rates_rad_s: Vector = (0.0, 0.0, 0.0)
        self.acceleration_ned_m_s2: Vector = (0.0, 0.0, 0.0)
        self.compass_miss_rad = 0.0
        self.tilt_miss_rad = 0.0

    @property
    def angles_rad(self) -> Vector:
        """Roll, pitch and yaw."""
        return self.roll_rad, self.pitch_rad, self.yaw_rad

    def step(self, imu: ImuReading) -> None:
        """Take one measurement of the inertial unit."""
        if not self.aligned:
            self._align(imu)
            return
        bias, measured, dt = self.bias_rad_s, imu.rates_rad_s, self._step_s
        p, q, r = measured[0] - bias[0], measured[1] - bias[1], measured[2] - bias[2]
        last = self.rates_rad_s
        self.rates_rad_s = (p, q, r)
        # The turn since the last measurement is by the mean of both: trapezoids, because rates change within a step.
        p, q, r = 0.5 * (p + last[0]), 0.5 * (q + last[1]), 0.5 * (r + last[2])
        sin_roll, cos_roll = sin(self.roll_rad), cos(self.roll_rad)
        sin_pitch, cos_pitch = sin(self.pitch_rad), cos(self.pitch_rad)
        turn = (q * sin_roll + r * cos_roll) / cos_pitch
        self.roll_rad += (p + sin_pitch * turn) * dt
        self.pitch_rad += (q * cos_roll - r * sin_roll) * dt
        yaw = self.yaw_rad + turn * dt
        self.yaw_rad = yaw if -pi <= yaw < pi else wrapped(yaw)
        self._turn_force(imu.specific_force_m_s2)

    def _turn_force(self, force: Vector) -> None:
        bias = self._force_bias
        x, y, z = force[0] - bias[0], force[1] - bias[1], force[2] - bias[2]
        sin_roll, cos_roll = sin(self.roll_rad), cos(self.roll_rad)
        sin_pitch, cos_pitch = sin(self.pitch_rad), cos(self.pitch_rad)
        sin_yaw, cos_yaw = sin(self.yaw_rad), cos(self.yaw_rad)
        under = y * sin_roll + z * cos_roll
        right = y * cos_roll - z * sin_roll
        ahead = x * cos_pitch + under * sin_pitch
        self.acceleration_ned_m_s2 = (
            ahead * cos_yaw - right * sin_yaw,
            ahead * sin_yaw + right * cos_yaw,
            under * cos_pitch - x * sin_pitch + GRAVITY_M_S2,
        )

    def _align(self, imu: ImuReading) -> None:
        self._samples += 1
        for axis in range(3):
            self._force_sum[axis] += imu.specific_force_m_s2[axis]
            self._rate_sum[axis] += imu.rates_rad_s[axis]
        if self._samples * self._step_s < _ALIGNMENT_S or not self._has_heading:
            return
        x, y, z = self._force_sum
        self.bias_rad_s = (
            self._rate_sum[0] / self._samples,
            self._rate_sum[1] / self._samples,
            self._rate_sum[2] / self._samples,
        )
        self.roll_rad = atan2(-y, -z)
        self.pitch_rad = atan2(x, hypot(y, z))
        self.aligned = True

    def take_compass(self, compass: CompassReading) -> None:
        """Draw yaw towards the compass: slowly, because the gyro is smooth and the compass is true."""
        if not self._has_heading:
            self._has_heading = True
            self.yaw_rad = wrapped(compass.heading_rad)
        self.compass_miss_rad = wrapped(compass.heading_rad - self.yaw_rad)
        self.yaw_rad = wrapped(self.yaw_rad + _COMPASS_GAIN * self.compass_miss_rad)

    def tilt(self, north_rad: float, east_rad: float) -> None:
        """Tilt the estimated thrust vector by small angles towards north and east."""
        self.tilt_miss_rad = hypot(north_rad, east_rad)
        cos_yaw, sin_yaw = cos(self.yaw_rad), sin(self.yaw_rad)
        self.roll_rad += east_rad * cos_yaw - north_rad * sin_yaw
        self.pitch_rad -= north_rad * cos_yaw + east_rad * sin_yaw

    def trim(self, roll_rad_s: float, pitch_rad_s: float, force_m_s2: Vector) -> None:
        """Count so much more as biases: of the gyros of roll and pitch, and of the accelerometers."""
        rates, force = self.bias_rad_s, self._force_bias
        self.bias_rad_s = (rates[0] + roll_rad_s, rates[1] + pitch_rad_s, rates[2])
        self._force_bias = (force[0] + force_m_s2[0], force[1] + force_m_s2[1], force[2] + force_m_s2[2])
