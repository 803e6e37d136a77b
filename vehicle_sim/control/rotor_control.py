"""From thrust and angular accelerations to rotors: the innermost loop of a quadrotor, and its mixer.

The tracking law asks for angular accelerations as if they came at once. Rotors lag by tens of milliseconds, so for
each axis this loop compares what was asked for, a*, with what the gyros show, a, and asks the mixer for

    a* + G (a* - a) + (1 + G) i,    i' = a* / T_i:

the middle term speeds the lag of the rotors up (1 + G) times, the way the D term of a rate controller does, and the
integral takes out what lasts, such as a weak rotor. It stands still while the mixer is at its limits.

Yaw has no such term: there the reaction to rotors that change their speed comes at once, several times as strong as
the drag that follows. What is asked of yaw is low-passed instead, as autopilots do it.

Thrust is raised by tilt, because the tracking law asks for what counts downwards.
"""

from math import cos, exp, tau
from typing import Final

from vehicle_sim.dynamics.rotors import SURVEY_ROTORS, RotorSet, mix, squares_for
from vehicle_sim.signals import IDLE, Command, Estimate, Vector

_SPEED_UP: Final = 1.0
_GYRO_FILTER_S: Final = 1.0 / (tau * 20.0)
_YAW_FILTER_S: Final = 1.0 / (tau * 2.5)
_INTEGRAL_S: Final = 1.0
_MOST_INTEGRAL_RAD_S2: Final = 20.0
_MOST_YAW_INTEGRAL_RAD_S2: Final = 2.0
_LEAST_OUTPUT: Final = 0.0225
_LEAST_UPRIGHT: Final = 0.5


class RotorControl:
    """Turns the commands of one vehicle's controller into the outputs of its rotors, once a step."""

    def __init__(self, *, step_s: float, rotors: RotorSet = SURVEY_ROTORS) -> None:
        """Start idle, for an airframe with `rotors`."""
        self._step_s = step_s
        self._blend = 1.0 - exp(-step_s / _GYRO_FILTER_S)
        self._yaw_blend = 1.0 - exp(-step_s / _YAW_FILTER_S)
        ixx, iyy, izz = rotors.inertia_kg_m2
        factors = {"lift": rotors.lift, "drag": rotors.drag, "arm_m": rotors.arm_m}
        most = rotors.most_speed_rad_s**2
        # What one m/s^2 of thrust, and one rad/s^2 about each axis, take of the front rotor; for roll, of the left one.
        self._thrust_share = squares_for((rotors.mass_kg, 0.0, 0.0, 0.0), **factors)[0] / most
        self._roll_share = squares_for((0.0, ixx, 0.0, 0.0), **factors)[3] / most
        self._pitch_share = squares_for((0.0, 0.0, iyy, 0.0), **factors)[0] / most
        self._yaw_share = squares_for((0.0, 0.0, 0.0, izz), **factors)[0] / most
        self._idle()

    def _idle(self) -> None:
        self._rates: Vector | None = None
        self._measured = (0.0, 0.0)
        self._turning = 0.0
        self._integral: Vector = (0.0, 0.0, 0.0)

    @property
    def integral_rad_s2(self) -> Vector:
        """Angular acceleration about each body axis that the loop has learnt to add."""
        return self._integral

    def step(self, command: Command, estimate: Estimate) -> Command:
        """Return `command` with the outputs of the rotors."""
        if command is IDLE:
            if self._rates is not None:
                self._idle()
            return command
        p, q, _ = rates = estimate.rates_rad_s
        was, k = self._rates or rates, self._blend / self._step_s
        self._rates = rates
        mx, my = self._measured
        mx += k * (p - was[0]) - self._blend * mx
        my += k * (q - was[1]) - self._blend * my
        self._measured = (mx, my)
        ax, ay, az = command.angular_acceleration_rad_s2
        ix, iy, iz = self._integral
        self._turning += self._yaw_blend * (az + iz - self._turning)
        upright = max(cos(estimate.roll_rad) * cos(estimate.pitch_rad), _LEAST_UPRIGHT)
        g = _SPEED_UP
        outputs, fits = mix(
            self._thrust_share * command.thrust_m_s2 / upright,
            self._roll_share * ((1.0 + g) * (ax + ix) - g * mx),
            self._pitch_share * ((1.0 + g) * (ay + iy) - g * my),
            self._yaw_share * self._turning,
            least=_LEAST_OUTPUT,
        )
        if fits:
            rate, most, most_yaw = self._step_s / _INTEGRAL_S, _MOST_INTEGRAL_RAD_S2, _MOST_YAW_INTEGRAL_RAD_S2
            self._integral = (
                max(-most, min(ix + rate * ax, most)),
                max(-most, min(iy + rate * ay, most)),
                max(-most_yaw, min(iz + rate * az, most_yaw)),
            )
        return command._replace(outputs=outputs)
