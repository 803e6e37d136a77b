"""The full quadrotor: Eq. 6 as corrected, without its small angles, natively north-east-down.

With body axes forward-right-down, R(q) from body to local axes, its third column b, the body rates w = (p, q, r), the
specific thrust T = U1/m, and rotors that carry the angular momentum H = Ip (O2 - O1 + O4 - O3) along body down,

    p' = v,    v' = g e_d - T b - D (v - wind),    D u = k u + (k_z - k) (u . b) b
    Ixx p' = (Iyy - Izz) q r - q H + U2
    Iyy q' = (Izz - Ixx) p r + p H + U3
    Izz r' = (Ixx - Iyy) p q + U4 - H'
    O_i'   = (O_i,command - O_i) / tau_rotor.

Attitude is a unit quaternion. Eq. 6 is what remains of it where body rates are taken for Euler rates. The terms with H
come from -w x h and are those of the corrected Eq. 6; the paper's U3 and U4 count about left and up, so they have the
opposite sign here (see `rotors`). H' is the reaction to rotors that change their speed. Drag is that of the rotors,
linear in the air's velocity in body axes, with the factors of the hover model.

A step is explicit midpoint for rates and velocity, the exponential map of the mean rate for attitude, and exact for the
rotors: second order. Near the flight that a survey needs it differs from the exact solution by less than a millimetre
after ten seconds at steps of 10 ms (tests hold it to that).
"""

from math import asin, atan2, cos, exp, sin, sqrt
from typing import Final

from vehicle_sim.dynamics.airframe import checked_efficiency
from vehicle_sim.dynamics.hover import DRAG_PER_S, LEVEL_RAD, LEVELLING_S, VERTICAL_DRAG_PER_S
from vehicle_sim.dynamics.kinematics import body_rates, specific_force
from vehicle_sim.dynamics.rotors import SURVEY_ROTORS, RotorSet
from vehicle_sim.signals import GRAVITY_M_S2, Command, FourRotors, Motion, Vector

_STILL: Final[Vector] = (0.0, 0.0, 0.0)
_ALONG: Final = VERTICAL_DRAG_PER_S - DRAG_PER_S

Quaternion = tuple[float, float, float, float]


def quaternion_of(roll_rad: float, pitch_rad: float, yaw_rad: float) -> Quaternion:
    """Return (w, x, y, z) of the rotation from body to local axes by yaw, pitch, roll in this order."""
    cr, sr = cos(roll_rad / 2), sin(roll_rad / 2)
    cp, sp = cos(pitch_rad / 2), sin(pitch_rad / 2)
    cy, sy = cos(yaw_rad / 2), sin(yaw_rad / 2)
    return (
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    )


def angles_of(attitude: Quaternion) -> Vector:
    """Return roll, pitch and yaw of a unit quaternion from body to local axes."""
    w, x, y, z = attitude
    return (
        atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
        asin(max(-1.0, min(2.0 * (w * y - z * x), 1.0))),
        atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)),
    )


def turned(attitude: Quaternion, rotation_rad: Vector) -> Quaternion:
    """Return `attitude` turned by a small rotation vector in body axes: the exponential map, to order six."""
    w, x, y, z = attitude
    a, b, c = 0.5 * rotation_rad[0], 0.5 * rotation_rad[1], 0.5 * rotation_rad[2]
    n = a * a + b * b + c * c
    k, s = 1.0 - n * (0.5 - n / 24.0), 1.0 - n * (1.0 / 6.0 - n / 120.0)
    a, b, c = a * s, b * s, c * s
    w, x, y, z = (
        k * w - a * x - b * y - c * z,
        k * x + a * w + c * y - b * z,
        k * y + b * w + a * z - c * x,
        k * z + c * w + b * x - a * y,
    )
    # One step of Newton's towards unit length, which is never far.
    unit = 1.5 - 0.5 * (w * w + x * x + y * y + z * z)
    return (unit * w, unit * x, unit * y, unit * z)


class Quadrotor:
    """One vehicle, standing at the origin on level ground; `motion` is its true state after the last step."""

    def __init__(self, *, step_s: float, yaw_rad: float = 0.0, rotors: RotorSet = SURVEY_ROTORS) -> None:
        """Stand still with resting rotors, looking to `yaw_rad`."""
        self._step_s = step_s
        self._rotors = rotors
        self._half, self._whole = exp(-0.5 * step_s / rotors.response_s), exp(-step_s / rotors.response_s)
        ixx, iyy, izz = rotors.inertia_kg_m2
        self._spread = ((iyy - izz) / ixx, (izz - ixx) / iyy, (ixx - iyy) / izz)
        self._gyro = (rotors.rotor_inertia_kg_m2 / ixx, rotors.rotor_inertia_kg_m2 / iyy)
        self._reaction = rotors.rotor_inertia_kg_m2 / (izz * step_s)
        self._lift = rotors.lift / rotors.mass_kg
        self._tilting = (rotors.lift * rotors.arm_m / ixx, rotors.lift * rotors.arm_m / iyy)
        self._turning = rotors.drag / izz
        self._most_speeds: FourRotors = (rotors.most_speed_rad_s,) * 4
        self._speeds: FourRotors = (0.0, 0.0, 0.0, 0.0)
        self._attitude = quaternion_of(0.0, 0.0, yaw_rad)
        self._on_ground = True
        self.motion = Motion(
            _STILL, _STILL, _STILL, 0.0, 0.0, yaw_rad, _STILL, specific_force(0.0, 0.0, yaw_rad, _STILL), True
        )

    @property
    def speeds_rad_s(self) -> FourRotors:
        """Speeds of the rotors."""
        return self._speeds

    @property
    def attitude(self) -> Quaternion:
        """Unit quaternion (w, x, y, z) from body to local axes."""
        return self._attitude

    @property
    def thrust_m_s2(self) -> float:
        """Specific thrust that the rotors give now."""
        a, b, c, d = self._speeds
        return self._lift * (a * a + b * b + c * c + d * d)

    @property
    def outputs(self) -> FourRotors:
        """Thrust of each rotor as a share of what a sound one can give."""
        most = self._rotors.most_speed_rad_s
        a, b, c, d = self._speeds
        return ((a / most) ** 2, (b / most) ** 2, (c / most) ** 2, (d / most) ** 2)

    @property
    def power_w(self) -> float:
        """Electrical power: drag torque times speed of each rotor, over the motors' efficiency."""
        return self._rotors.drag * sum(speed**3 for speed in self._speeds) / self._rotors.motor_efficiency

    def weaken(self, efficiency: FourRotors) -> None:
        """Let each rotor reach only this share of the thrust that it is asked for: it turns slower, also in drag.

        Raises:
            ValueError: A share does not lie in [0, 1].
        """
        most = self._rotors.most_speed_rad_s
        a, b, c, d = checked_efficiency(efficiency)
        self._most_speeds = (most * sqrt(a), most * sqrt(b), most * sqrt(c), most * sqrt(d))

    def step(self, command: Command, wind_ned_m_s: Vector) -> Motion:
        """Go on by one step with the rotors' `outputs` of `command`, limited to 0 to 1, and in wind."""
        before = self._speeds
        half, after = self._spin(command.outputs)
        if self._on_ground and self.thrust_m_s2 <= GRAVITY_M_S2:
            self.motion = self._standing()
        else:
            self._on_ground = False
            self.motion = self._moving(before, half, after, wind_ned_m_s)
        return self.motion

    def _spin(self, outputs: FourRotors) -> tuple[FourRotors, FourRotors]:
        """Bring the rotors to the end of the step; return their speeds in the middle and at the end of it."""
        o1, o2, o3, o4 = outputs
        m1, m2, m3, m4 = self._most_speeds
        w1, w2 = m1 * sqrt(min(max(o1, 0.0), 1.0)), m2 * sqrt(min(max(o2, 0.0), 1.0))
        w3, w4 = m3 * sqrt(min(max(o3, 0.0), 1.0)), m4 * sqrt(min(max(o4, 0.0), 1.0))
        a, b, c, d = self._speeds
        a, b, c, d = a - w1, b - w2, c - w3, d - w4
        half, whole = self._half, self._whole
        self._speeds = after = (w1 + whole * a, w2 + whole * b, w3 + whole * c, w4 + whole * d)
        return (w1 + half * a, w2 + half * b, w3 + half * c, w4 + half * d), after

    def _moving(self, before: FourRotors, half: FourRotors, after: FourRotors, wind: Vector) -> Motion:
        dt, was = self._step_s, self.motion
        a0, b0, c0, d0 = before
        a1, b1, c1, d1 = half
        a2, b2, c2, d2 = after
        # Squares: averages over the first half of the step (trapezium) and over all of it (Simpson).
        s0, r0, t0, u0 = a0 * a0, b0 * b0, c0 * c0, d0 * d0
        s1, r1, t1, u1 = a1 * a1, b1 * b1, c1 * c1, d1 * d1
        s, r = (s0 + 4.0 * s1 + a2 * a2) / 6.0, (r0 + 4.0 * r1 + b2 * b2) / 6.0
        t, u = (t0 + 4.0 * t1 + c2 * c2) / 6.0, (u0 + 4.0 * u1 + d2 * d2) / 6.0
        spin0, spin1, spin2 = b0 - a0 + d0 - c0, b1 - a1 + d1 - c1, b2 - a2 + d2 - c2
        (x, y, z), (gx, gy), (fx, fy), fz = self._spread, self._gyro, self._tilting, self._turning
        p0, q0, w0 = was.rates_rad_s
        h, back = 0.25 * dt, self._reaction
        p1 = p0 + 2.0 * h * (x * q0 * w0 - gx * q0 * spin0) + h * fx * (u0 + u1 - r0 - r1)
        q1 = q0 + 2.0 * h * (y * p0 * w0 + gy * p0 * spin0) + h * fy * (s0 + s1 - t0 - t1)
        w1 = w0 + 2.0 * h * z * p0 * q0 + h * fz * (s0 + s1 - r0 - r1 + t0 + t1 - u0 - u1) - dt * back * (spin1 - spin0)
        p2 = p0 + dt * (x * q1 * w1 - gx * q1 * spin1 + fx * (u - r))
        q2 = q0 + dt * (y * p1 * w1 + gy * p1 * spin1 + fy * (s - t))
        w2 = w0 + dt * (z * p1 * q1 + fz * (s - r + t - u) - back * (spin2 - spin0))
        start = self._attitude
        sixth = dt / 6.0
        rotation = (sixth * (p0 + 4.0 * p1 + p2), sixth * (q0 + 4.0 * q1 + q2), sixth * (w0 + 4.0 * w1 + w2))
        self._attitude = end = turned(start, rotation)
        place, going, acceleration = self._carried(start, end, self._lift * (s + r + t + u), wind)
        if place[2] >= 0.0 and going[2] >= 0.0:
            return self._touched_down(place)
        roll, pitch, yaw = angles_of(end)
        force = specific_force(roll, pitch, yaw, acceleration)
        return Motion(place, going, acceleration, roll, pitch, yaw, (p2, q2, w2), force, False)

    def _carried(
        self, start: Quaternion, end: Quaternion, thrust: float, wind: Vector
    ) -> tuple[Vector, Vector, Vector]:
        """Return position, velocity and mean acceleration after a step from attitude `start` to `end`."""
        dt, was = self._step_s, self.motion
        qw, qx, qy, qz = start
        ew, ex, ey, ez = end
        # Mean of the third columns of both rotation matrices: body down in local axes.
        bn = qx * qz + qw * qy + ex * ez + ew * ey
        be = qy * qz - qw * qx + ey * ez - ew * ex
        bd = 1.0 - qx * qx - qy * qy - ex * ex - ey * ey
        vn, ve, vd = was.velocity_ned_m_s
        un, ue, ud = vn - wind[0], ve - wind[1], vd - wind[2]
        k, half = DRAG_PER_S, 0.5 * dt
        push = thrust + _ALONG * (un * bn + ue * be + ud * bd)
        un, ue = un + half * (-push * bn - k * un), ue + half * (-push * be - k * ue)
        ud += half * (GRAVITY_M_S2 - push * bd - k * ud)
        push = thrust + _ALONG * (un * bn + ue * be + ud * bd)
        an, ae, ad = -push * bn - k * un, -push * be - k * ue, GRAVITY_M_S2 - push * bd - k * ud
        pn, pe, pd = was.position_ned_m
        return (
            (pn + dt * (vn + half * an), pe + dt * (ve + half * ae), pd + dt * (vd + half * ad)),
            (vn + dt * an, ve + dt * ae, vd + dt * ad),
            (an, ae, ad),
        )

    def _touched_down(self, place: Vector) -> Motion:
        self._on_ground = True
        was = self.motion
        stop = tuple(-v / self._step_s for v in was.velocity_ned_m_s)
        acceleration = (stop[0], stop[1], stop[2])
        force = specific_force(was.roll_rad, was.pitch_rad, was.yaw_rad, acceleration)
        return was._replace(
            position_ned_m=(place[0], place[1], 0.0),
            velocity_ned_m_s=_STILL,
            acceleration_ned_m_s2=acceleration,
            rates_rad_s=_STILL,
            specific_force_m_s2=force,
            on_ground=True,
        )

    def _standing(self) -> Motion:
        """One step on the ground, which levels without a jump, so that the gyroscopes feel all of it."""
        was = self.motion
        left = exp(-self._step_s / LEVELLING_S)
        roll = was.roll_rad * left if abs(was.roll_rad) > LEVEL_RAD else 0.0
        pitch = was.pitch_rad * left if abs(was.pitch_rad) > LEVEL_RAD else 0.0
        self._attitude = quaternion_of(roll, pitch, was.yaw_rad)
        dt = self._step_s
        rates = body_rates(roll, pitch, ((roll - was.roll_rad) / dt, (pitch - was.pitch_rad) / dt, 0.0))
        force = specific_force(roll, pitch, was.yaw_rad, _STILL)
        return Motion(was.position_ned_m, _STILL, _STILL, roll, pitch, was.yaw_rad, rates, force, True)
