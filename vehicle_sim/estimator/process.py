"""How the filter's state goes on, and what it is to begin with.

State (18), NED and relative to the origin where nothing else is said: position P (3), velocity V (3), error B of the
measured acceleration by tilt (2, north and east), bias A of the accelerometers (3, body axes), slow error G of the GPS
(3), error M of the barometer (1), growth D of the tilt's error (2, forward and right), error Y of the heading (1).

With R the rotation from body axes, a the acceleration and g gravity, the acceleration is measured wrong by

    (B, (B_N a_N + B_E a_E) / g) + R A + (-a_E, a_N, 0) Y,    B' = R D,

the linear part of turning the measured force by a wrong attitude. Levelling at rest makes a tilt of the accelerometers'
bias, so at first B = -R A, and both cancel until the body turns: a vehicle that yaws or accelerates finds out what
cannot be told apart at rest. Their noise is integrated exactly over an epoch (Bar-Shalom, Li, Kirubarajan: Estimation
with applications to tracking and navigation, 6.2).

The slow error of the GPS is a state because it cannot be averaged away: without it the filter would claim centimetres
that it does not have. The barometer's error is a random walk, relative to what it showed at the start.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, exp, sin
from typing import Final

import numpy as np
from numpy.typing import NDArray

from vehicle_sim.signals import GRAVITY_M_S2, Vector

Matrix = NDArray[np.float64]

STATES: Final = 18
P, V, B, A = slice(0, 3), slice(3, 6), slice(6, 8), slice(8, 11)
G, M, D, Y = slice(11, 14), 14, slice(15, 17), 17
"""Where each part of the state stands."""

_PH, _VH, _AH = slice(0, 2), slice(3, 5), slice(8, 10)


@dataclass(frozen=True, slots=True, kw_only=True)
class NavigationTuning:
    """What the filter believes of its sensors: standard deviations, correlation time, walks per root second."""

    acceleration_m_s2: float = 0.05
    acceleration_bias_m_s2: float = 0.05
    acceleration_bias_walk: float = 2e-3
    levelling_noise_m_s2: float = 0.0036
    tilt_walk_m_s2: float = 0.0025
    tilt_drift_m_s3: float = 0.0014
    tilt_drift_walk: float = 4e-4
    heading_rad: float = 0.013
    heading_walk_rad: float = 0.001
    velocity_start_m_s: float = 0.05
    gps_noise_m: float = 0.2
    gps_vertical_noise_m: float = 0.35
    gps_wander_m: float = 0.2
    gps_vertical_wander_m: float = 0.3
    gps_wander_time_s: float = 60.0
    gps_velocity_noise_m_s: float = 0.08
    baro_noise_m: float = 0.15
    baro_walk: float = 0.03
    longest_lag_s: float = 0.25
    reset_gps_s: float = 7.0
    levelling_s: float = 5.0


def from_body(attitude_rad: Vector) -> Matrix:
    """Return the rotation (3, 3) from body axes to NED of roll, pitch and yaw."""
    roll, pitch, yaw = attitude_rad
    cr, sr, cp, sp, cy, sy = cos(roll), sin(roll), cos(pitch), sin(pitch), cos(yaw), sin(yaw)
    return np.array(
        [
            [cp * cy, sr * sp * cy - cr * sy, cr * sp * cy + sr * sy],
            [cp * sy, sr * sp * sy + cr * cy, cr * sp * sy - sr * cy],
            [-sp, sr * cp, cr * cp],
        ]
    )


def first_covariance(tuning: NavigationTuning, attitude_rad: Vector, fixes: int) -> Matrix:
    """Return the covariance (18, 18) of a vehicle that was levelled at rest and begins with a mean of `fixes`."""
    # The origin makes the mean of the fixes zero: what that was wrong by is now the error of the position, negated.
    wander = np.array([tuning.gps_wander_m, tuning.gps_wander_m, tuning.gps_vertical_wander_m]) ** 2
    noise = np.array([tuning.gps_noise_m, tuning.gps_noise_m, tuning.gps_vertical_noise_m]) ** 2 / fixes
    covariance = np.zeros((STATES, STATES))
    covariance[P, P] = np.diag(wander + noise)
    covariance[P, G] = covariance[G, P] = -np.diag(wander)
    covariance[G, G] = np.diag(wander)
    covariance[V, V] = np.eye(3) * tuning.velocity_start_m_s**2
    bias, turn = tuning.acceleration_bias_m_s2**2, from_body((0.0, 0.0, attitude_rad[2]))[:2, :2]
    covariance[A, A] = bias * np.eye(3)
    covariance[B, B] = (bias + tuning.levelling_noise_m_s2**2) * np.eye(2)
    covariance[B, _AH], covariance[_AH, B] = -bias * turn, -bias * turn.T
    covariance[D, D] = tuning.tilt_drift_m_s3**2 * np.eye(2)
    covariance[Y, Y] = tuning.heading_rad**2
    # The barometer's zero was taken here, so its error begins as that of the height.
    covariance[M, M] = wander[2] + noise[2] + tuning.baro_noise_m**2
    covariance[2, M] = covariance[M, 2] = wander[2] + noise[2]
    covariance[G.start + 2, M] = covariance[M, G.start + 2] = -wander[2]
    return covariance


class Process:
    """The model of an epoch of some steps, at the end of which measurements are taken."""

    def __init__(self, tuning: NavigationTuning, *, step_s: float) -> None:
        """Know no epoch yet; those that occur are few, and kept."""
        self._tuning = tuning
        self._step_s = step_s
        self._level: dict[int, tuple[Matrix, Matrix]] = {}
        self.input = np.zeros((STATES, 6))
        self.input[:6, :6] = np.eye(6)

    def epoch(self, steps: int, attitude_rad: Vector, pushed: Sequence[float]) -> tuple[Matrix, Matrix]:
        """Return F (18, 18) and Q (18, 18).

        Args:
            steps: Length of the epoch.
            attitude_rad: Roll, pitch and yaw in the middle of it.
            pushed: Position and velocity that the measured acceleration has added over it.
        """
        if steps not in self._level:
            self._level[steps] = self._of_length(steps)
        f, q = self._level[steps]
        f, t, turn = f.copy(), steps * self._step_s, from_body(attitude_rad)
        f[V, A], f[P, A] = -t * turn, -0.5 * t * t * turn
        level = turn[:2, :2]
        f[B, D], f[_VH, D], f[_PH, D] = t * level, -0.5 * t * t * level, -(t**3) / 6.0 * level
        p_n, p_e, _, v_n, v_e, _ = pushed
        f[0, Y], f[1, Y], f[3, Y], f[4, Y] = p_e, -p_n, v_e, -v_n
        f[2, 6], f[2, 7] = -p_n / GRAVITY_M_S2, -p_e / GRAVITY_M_S2
        f[5, 6], f[5, 7] = -v_n / GRAVITY_M_S2, -v_e / GRAVITY_M_S2
        return f, q

    def _of_length(self, steps: int) -> tuple[Matrix, Matrix]:
        """Return what of the model depends on the number of steps alone."""
        tuning, t, three, two = self._tuning, steps * self._step_s, np.eye(3), np.eye(2)
        f = np.eye(STATES)
        f[P, V], f[_PH, B], f[_VH, B] = t * three, -0.5 * t * t * two, -t * two
        decay = exp(-t / tuning.gps_wander_time_s)
        f[G, G] = decay * three
        # White noise of the acceleration, and the random walk of the tilt, both integrated over the epoch.
        white, walk = tuning.acceleration_m_s2**2 * self._step_s, tuning.tilt_walk_m_s2**2
        q = np.zeros((STATES, STATES))
        q[P, P], q[V, V] = white * t**3 / 3.0 * three, white * t * three
        q[P, V] = q[V, P] = white * t**2 / 2.0 * three
        q[_PH, _PH] += walk * t**5 / 20.0 * two
        q[_VH, _VH] += walk * t**3 / 3.0 * two
        q[_PH, _VH] += walk * t**4 / 8.0 * two
        q[_VH, _PH] += walk * t**4 / 8.0 * two
        q[_PH, B] = q[B, _PH] = -walk * t**3 / 6.0 * two
        q[_VH, B] = q[B, _VH] = -walk * t**2 / 2.0 * two
        q[B, B] = walk * t * two
        q[A, A] = tuning.acceleration_bias_walk**2 * t * three
        q[D, D] = tuning.tilt_drift_walk**2 * t * two
        q[Y, Y] = tuning.heading_walk_rad**2 * t
        wander = np.array([tuning.gps_wander_m, tuning.gps_wander_m, tuning.gps_vertical_wander_m]) ** 2
        q[G, G] = np.diag(wander) * (1.0 - decay * decay)
        q[M, M] = tuning.baro_walk**2 * t
        return f, q
