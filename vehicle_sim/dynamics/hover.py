"""The quadrotor linearised about hover (Eq. 9), natively north-east-down, with attitude, thrust and yaw behind it.

Let eta be the tilt of the thrust vector, an angle with a north and an east component. For yaw psi,

    eta_N = -(pitch cos(psi) + roll sin(psi)),    eta_E = roll cos(psi) - pitch sin(psi),

and Eq. 9 with linear drag against the air, and with the rotational part of Eq. 6 linearised, reads

    p' = v,   v' = g eta - k (v - w),   eta'' = angular acceleration               (each horizontal axis)
    p' = v,   v' = g - T - k_z (v - w),   T' = (T_command - T) / tau_rotor         (down)
    psi'' = angular acceleration.

The axes are independent and time-invariant: yawing does not move the thrust vector, it only turns the body axes in
which roll, pitch and their rates are counted. Commands and wind are held over a step, so one matrix exponential
gives the exact step.
"""

from math import cos, exp, hypot, pi, sin
from typing import Final

import numpy as np
from scipy.linalg import expm

from vehicle_sim.dynamics.airframe import checked_efficiency
from vehicle_sim.dynamics.kinematics import body_rates, specific_force
from vehicle_sim.dynamics.power import carrying_w, moving_w
from vehicle_sim.signals import GRAVITY_M_S2, Command, FourRotors, Motion, Vector

DRAG_PER_S: Final = 0.1
VERTICAL_DRAG_PER_S: Final = 0.2
ROTOR_TIME_S: Final = 0.05
MOST_THRUST_M_S2: Final = 2.0 * GRAVITY_M_S2
MOST_ANGULAR_RAD_S2: Final = 60.0
MOST_YAW_RAD_S2: Final = 10.0
LEVELLING_S: Final = 0.1
LEVEL_RAD: Final = 1e-6
_SOUND: Final[FourRotors] = (1.0, 1.0, 1.0, 1.0)
_LEVER_PER_M: Final = 3.2
"""Angular acceleration about roll or pitch by thrust (m/s^2) where a rotor gives none: m l / 4 Ixx."""

_TWIST_PER_M: Final = 0.11
"""The same about yaw: (drag / lift) m / 4 Izz."""


Vector4 = tuple[float, float, float, float]


def discretise(a: np.ndarray, b: np.ndarray, step_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Return (Phi (n, n), Gamma (n, m)) of x' = a x + b u for inputs held over `step_s` (zero-order hold)."""
    n, m = b.shape
    block = np.zeros((n + m, n + m))
    block[:n, :n], block[:n, n:] = a, b
    whole = expm(block * step_s)
    return whole[:n, :n], whole[:n, n:]


def horizontal_model(drag_per_s: float = DRAG_PER_S) -> tuple[np.ndarray, np.ndarray]:
    """Return A (4, 4) and B (4, 2) of one horizontal axis: state (p, v, eta, eta'), inputs (eta'', wind)."""
    a = np.array(
        [[0.0, 1.0, 0.0, 0.0], [0.0, -drag_per_s, GRAVITY_M_S2, 0.0], [0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 0.0]]
    )
    return a, np.array([[0.0, 0.0], [0.0, drag_per_s], [0.0, 0.0], [1.0, 0.0]])


def vertical_model() -> tuple[np.ndarray, np.ndarray]:
    """Return A (3, 3) and B (3, 3) of the down axis: state (p, v, T), inputs (T command, gravity, wind)."""
    a = np.array([[0.0, 1.0, 0.0], [0.0, -VERTICAL_DRAG_PER_S, -1.0], [0.0, 0.0, -1.0 / ROTOR_TIME_S]])
    return a, np.array([[0.0, 0.0, 0.0], [0.0, 1.0, VERTICAL_DRAG_PER_S], [1.0 / ROTOR_TIME_S, 0.0, 0.0]])


def _clip(value: float, bound: float) -> float:
    return -bound if value < -bound else min(value, bound)


class Hover:
    """One vehicle, standing at the origin on level ground; `motion` is its true state after the last step."""

    def __init__(self, *, step_s: float, yaw_rad: float = 0.0, drag_per_s: float = DRAG_PER_S) -> None:
        """Stand still, looking to `yaw_rad`; `drag_per_s` is k of the horizontal axes."""
        self._step_s = step_s
        phi, gamma = discretise(*horizontal_model(drag_per_s), step_s)
        # Upper triangular: only what is not zero by structure is multiplied.
        self._across = (
            *(float(phi[i, j]) for i, j in ((0, 1), (0, 2), (0, 3), (1, 1), (1, 2), (1, 3))),
            *(float(value) for value in gamma[:2].ravel()),
            *(float(value) for value in gamma[2:, 0]),
        )
        phi, gamma = discretise(*vertical_model(), step_s)
        self._along = (
            *(float(phi[i, j]) for i, j in ((0, 1), (0, 2), (1, 1), (1, 2), (2, 2))),
            *(float(value) for value in gamma[:2].ravel()),
            float(gamma[2, 0]),
        )
        self._north = (0.0, 0.0, 0.0, 0.0)
        self._east = (0.0, 0.0, 0.0, 0.0)
        self._down = (0.0, 0.0, 0.0)
        self._yaw_rad = yaw_rad
        self._yaw_rate_rad_s = 0.0
        self._on_ground = True
        self._efficiency = _SOUND
        self._wind: Vector = (0.0, 0.0, 0.0)
        self.motion = self._standing()

    @property
    def thrust_m_s2(self) -> float:
        """Specific thrust that the rotors give now."""
        return self._down[2]

    @property
    def outputs(self) -> FourRotors:
        """The share of the greatest thrust, which the rotors bear evenly here."""
        share = self._down[2] / MOST_THRUST_M_S2
        return (share, share, share, share)

    @property
    def power_w(self) -> float:
        """Electrical power of the thrust, of which the linear model knows the upright part alone, and of its work."""
        v_n, v_e, v_d = self.motion.velocity_ned_m_s
        w_n, w_e, w_d = self._wind
        up, north, east = self._down[2], GRAVITY_M_S2 * self._north[2], GRAVITY_M_S2 * self._east[2]
        work = 0.0 if self._on_ground else north * (v_n - w_n) + east * (v_e - w_e) - up * (v_d - w_d)
        return carrying_w(hypot(up, north, east) / GRAVITY_M_S2) + moving_w(work)

    def weaken(self, efficiency: FourRotors) -> None:
        """Let each rotor give only this share of its part of the thrust.

        What the rotors lack together is missing from the thrust; what they lack unevenly turns the vehicle, as much as
        it would turn the quadrotor (Eq. 7 with even thrust). The limits of thrust and angular acceleration stay.

        Raises:
            ValueError: A share does not lie in [0, 1].
        """
        self._efficiency = _SOUND if efficiency == _SOUND else checked_efficiency(efficiency)

    def step(self, command: Command, wind_ned_m_s: Vector) -> Motion:
        """Go on by one step under `command`, held and limited to what the rotors can do."""
        self._wind = wind_ned_m_s
        roll_up, pitch_up, yaw_up = command.angular_acceleration_rad_s2
        roll_up, pitch_up = _clip(roll_up, MOST_ANGULAR_RAD_S2), _clip(pitch_up, MOST_ANGULAR_RAD_S2)
        thrust = min(max(command.thrust_m_s2, 0.0), MOST_THRUST_M_S2)
        if self._efficiency is not _SOUND:
            front, right, rear, left = self._efficiency
            roll_up += _LEVER_PER_M * thrust * (left - right)
            pitch_up += _LEVER_PER_M * thrust * (front - rear)
            yaw_up += _TWIST_PER_M * thrust * (front - right + rear - left)
            thrust *= 0.25 * (front + right + rear + left)
        down = self._step_down(thrust, wind_ned_m_s[2])
        if self._on_ground and down[1] <= 0.0 and down[2] > GRAVITY_M_S2:
            self._on_ground = False
        if self._on_ground:
            self._down = (0.0, 0.0, down[2])
            self._north, self._east = self._levelled(self._north), self._levelled(self._east)
            self.motion = self._standing()
            return self.motion
        cos_yaw, sin_yaw = cos(self._yaw_rad), sin(self._yaw_rad)
        before = self.motion
        self._north = self._step_across(self._north, -(pitch_up * cos_yaw + roll_up * sin_yaw), wind_ned_m_s[0])
        self._east = self._step_across(self._east, roll_up * cos_yaw - pitch_up * sin_yaw, wind_ned_m_s[1])
        self._down = down
        dt, rate, yaw_up = self._step_s, self._yaw_rate_rad_s, _clip(yaw_up, MOST_YAW_RAD_S2)
        yaw = self._yaw_rad + rate * dt + 0.5 * yaw_up * dt * dt
        self._yaw_rad = yaw - 2.0 * pi if yaw > pi else yaw + 2.0 * pi if yaw <= -pi else yaw
        self._yaw_rate_rad_s = rate + yaw_up * dt
        if down[0] >= 0.0 and down[1] >= 0.0:
            self._touch_down()
        self.motion = self._moving(before)
        return self.motion

    def _step_across(self, state: tuple[float, float, float, float], up: float, wind: float) -> Vector4:
        p, v, eta, rate = state
        pv, pe, pr, vv, ve, vr, pu, pw, vu, vw, eu, ru = self._across
        return (
            p + pv * v + pe * eta + pr * rate + pu * up + pw * wind,
            vv * v + ve * eta + vr * rate + vu * up + vw * wind,
            eta + self._step_s * rate + eu * up,
            rate + ru * up,
        )

    def _step_down(self, thrust: float, wind: float) -> Vector:
        p, v, t = self._down
        pv, pt, vv, vt, tt, pu, pg, pw, vu, vg, vw, tu = self._along
        return (
            p + pv * v + pt * t + pu * thrust + pg * GRAVITY_M_S2 + pw * wind,
            vv * v + vt * t + vu * thrust + vg * GRAVITY_M_S2 + vw * wind,
            tt * t + tu * thrust,
        )

    def _touch_down(self) -> None:
        """Stand where the ground was met: friction holds the vehicle, and its legs level it from now on."""
        self._on_ground = True
        self._north = (self._north[0], 0.0, self._north[2], 0.0)
        self._east = (self._east[0], 0.0, self._east[2], 0.0)
        self._down = (0.0, 0.0, self._down[2])
        self._yaw_rate_rad_s = 0.0

    def _levelled(self, state: Vector4) -> Vector4:
        """One step of levelling: no jump, so that the gyroscopes feel all of it."""
        p, _, eta, _ = state
        level = eta * exp(-self._step_s / LEVELLING_S) if abs(eta) > LEVEL_RAD else 0.0
        return (p, 0.0, level, (level - eta) / self._step_s)

    def _standing(self) -> Motion:
        (p_n, _, eta_n, rate_n), (p_e, _, eta_e, rate_e) = self._north, self._east
        c, s = cos(self._yaw_rad), sin(self._yaw_rad)
        roll, pitch = eta_e * c - eta_n * s, -(eta_n * c + eta_e * s)
        still = (0.0, 0.0, 0.0)
        return Motion(
            (p_n, p_e, 0.0),
            still,
            still,
            roll,
            pitch,
            self._yaw_rad,
            body_rates(roll, pitch, (rate_e * c - rate_n * s, -(rate_n * c + rate_e * s), 0.0)),
            specific_force(roll, pitch, self._yaw_rad, still),
            True,
        )

    def _moving(self, before: Motion) -> Motion:
        p_n, v_n, eta_n, rate_n = self._north
        p_e, v_e, eta_e, rate_e = self._east
        p_d, v_d, _ = self._down
        dt = self._step_s
        was = before.velocity_ned_m_s
        acceleration = ((v_n - was[0]) / dt, (v_e - was[1]) / dt, (v_d - was[2]) / dt)
        yaw, yaw_rate = self._yaw_rad, self._yaw_rate_rad_s
        c, s = cos(yaw), sin(yaw)
        roll, pitch = eta_e * c - eta_n * s, -(eta_n * c + eta_e * s)
        # Euler rates: the body axes turn under the thrust vector while the vehicle yaws.
        roll_rate = rate_e * c - rate_n * s + yaw_rate * pitch
        pitch_rate = -(rate_n * c + rate_e * s) - yaw_rate * roll
        return Motion(
            (p_n, p_e, p_d),
            (v_n, v_e, v_d),
            acceleration,
            roll,
            pitch,
            yaw,
            body_rates(roll, pitch, (roll_rate, pitch_rate, yaw_rate)),
            specific_force(roll, pitch, yaw, acceleration),
            self._on_ground,
        )
