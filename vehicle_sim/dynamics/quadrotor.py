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

A step is exact for the rotors and their mean thrust and torques, explicit midpoint for rates and velocity, and the
exponential map of Magnus' expansion for attitude: second order. After ten
seconds of manoeuvre without feedback, at steps of 10 ms, rates and attitude differ from a fine solution by less than
3e-4 (rad/s, rad), and the place, which integrates gravity along that angle twice, by less than 0.1 m.
"""

from math import asin, atan2, cos, exp, sin, sqrt
from typing import Final

from vehicle_sim.dynamics.airframe import checked_efficiency
from vehicle_sim.dynamics.hover import DRAG_PER_S, LEVEL_RAD, LEVELLING_S, VERTICAL_DRAG_PER_S
from vehicle_sim.dynamics.kinematics import body_rates, specific_force
from vehicle_sim.dynamics.power import moving_w
from vehicle_sim.dynamics.rotors import SURVEY_ROTORS, RotorSet, thrust_and_torques
from vehicle_sim.signals import GRAVITY_M_S2, Command, FourRotors, Motion, Vector

_STILL: Final[Vector] = (0.0, 0.0, 0.0)

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

    def __init__(
        self,
        *,
        step_s: float,
        yaw_rad: float = 0.0,
        drag_per_s: float = DRAG_PER_S,
        rotors: RotorSet = SURVEY_ROTORS,
    ) -> None:
        """Stand still with resting rotors, looking to `yaw_rad`; `drag_per_s` is across the rotors' axis."""
        self._step_s = step_s
        self._drag_per_s, self._along_per_s = drag_per_s, VERTICAL_DRAG_PER_S - drag_per_s
        self._rotors = rotors
        # What is left of a speed's miss after half a step and after a step, and its mean and mean square over both.
        halves, wholes = 0.5 * step_s / rotors.response_s, step_s / rotors.response_s
        self._left = (exp(-halves), exp(-wholes))
        self._half = ((1.0 - exp(-halves)) / halves, (1.0 - exp(-2.0 * halves)) / (2.0 * halves))
        self._whole = ((1.0 - exp(-wholes)) / wholes, (1.0 - exp(-2.0 * wholes)) / (2.0 * wholes))
        ixx, iyy, izz = rotors.inertia_kg_m2
        self._spread = ((iyy - izz) / ixx, (izz - ixx) / iyy, (ixx - iyy) / izz)
        ip = rotors.rotor_inertia_kg_m2
        self._gyro = (ip / ixx, ip / iyy, ip / izz)
        # The front rotor's part in Eq. 7; for roll, the left one's is the same as the front one's for pitch.
        lift, _, lever, twist = thrust_and_torques(
            (1.0, 0.0, 0.0, 0.0), lift=rotors.lift, drag=rotors.drag, arm_m=rotors.arm_m
        )
        self._lift = lift / rotors.mass_kg
        self._torque = (lever / ixx, lever / iyy, twist / izz)
        self._most_speeds: FourRotors = (rotors.most_speed_rad_s,) * 4
        self._speeds: FourRotors = (0.0, 0.0, 0.0, 0.0)
        self._attitude = quaternion_of(0.0, 0.0, yaw_rad)
        self._on_ground = True
        self._wind = _STILL
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
        """Electrical power: drag torque times speed of each rotor, over the motors' efficiency, and thrust's work."""
        w, x, y, z = self._attitude
        v, wind = self.motion.velocity_ned_m_s, self._wind
        sinking = (
            2.0 * (x * z + w * y) * (v[0] - wind[0])
            + 2.0 * (y * z - w * x) * (v[1] - wind[1])
            + (1.0 - 2.0 * (x * x + y * y)) * (v[2] - wind[2])
        )
        turning_w = self._rotors.drag * sum(speed**3 for speed in self._speeds) / self._rotors.motor_efficiency
        return turning_w + (0.0 if self._on_ground else moving_w(-self.thrust_m_s2 * sinking))

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
        self._wind = wind_ned_m_s
        o1, o2, o3, o4 = command.outputs
        m1, m2, m3, m4 = self._most_speeds
        wanted = (
            m1 * sqrt(min(max(o1, 0.0), 1.0)),
            m2 * sqrt(min(max(o2, 0.0), 1.0)),
            m3 * sqrt(min(max(o3, 0.0), 1.0)),
            m4 * sqrt(min(max(o4, 0.0), 1.0)),
        )
        before, left = self._speeds, self._left[1]
        a, b, c, d = wanted
        self._speeds = (
            a + left * (before[0] - a),
            b + left * (before[1] - b),
            c + left * (before[2] - c),
            d + left * (before[3] - d),
        )
        if self._on_ground and self.thrust_m_s2 <= GRAVITY_M_S2:
            self.motion = self._standing()
        else:
            self._on_ground = False
            self.motion = self._moving(before, wanted, wind_ned_m_s)
        return self.motion

    def _moving(self, before: FourRotors, wanted: FourRotors, wind: Vector) -> Motion:
        dt, was, half = self._step_s, self.motion, 0.5 * self._step_s
        o1, o2, o3, o4 = wanted
        e1, e2, e3, e4 = before[0] - o1, before[1] - o2, before[2] - o3, before[3] - o4
        # Mean squares of the speeds over the first half of the step, then over all of it.
        mean, square = self._half
        s1, s2 = o1 * (o1 + 2.0 * mean * e1) + square * e1 * e1, o2 * (o2 + 2.0 * mean * e2) + square * e2 * e2
        s3, s4 = o3 * (o3 + 2.0 * mean * e3) + square * e3 * e3, o4 * (o4 + 2.0 * mean * e4) + square * e4 * e4
        spin, miss = before[1] - before[0] + before[3] - before[2], e2 - e1 + e4 - e3
        slowed, stopped = miss * (self._left[0] - 1.0), miss * (self._left[1] - 1.0)
        (x, y, z), (gx, gy, back), (fx, fy, fz) = self._spread, self._gyro, self._torque
        p0, q0, r0 = was.rates_rad_s
        p1 = p0 + half * (x * q0 * r0 - gx * q0 * spin + fx * (s4 - s2))
        q1 = q0 + half * (y * p0 * r0 + gy * p0 * spin + fy * (s1 - s3))
        r1 = r0 + half * (z * p0 * q0 + fz * (s1 - s2 + s3 - s4)) - back * slowed
        mean, square = self._whole
        s1, s2 = o1 * (o1 + 2.0 * mean * e1) + square * e1 * e1, o2 * (o2 + 2.0 * mean * e2) + square * e2 * e2
        s3, s4 = o3 * (o3 + 2.0 * mean * e3) + square * e3 * e3, o4 * (o4 + 2.0 * mean * e4) + square * e4 * e4
        spin += slowed
        p2 = p0 + dt * (x * q1 * r1 - gx * q1 * spin + fx * (s4 - s2))
        q2 = q0 + dt * (y * p1 * r1 + gy * p1 * spin + fy * (s1 - s3))
        r2 = r0 + dt * (z * p1 * q1 + fz * (s1 - s2 + s3 - s4)) - back * stopped
        start, sixth, twelfth = self._attitude, dt / 6.0, dt * dt / 12.0
        rotation = (
            sixth * (p0 + 4.0 * p1 + p2) + twelfth * (q0 * r2 - r0 * q2),
            sixth * (q0 + 4.0 * q1 + q2) + twelfth * (r0 * p2 - p0 * r2),
            sixth * (r0 + 4.0 * r1 + r2) + twelfth * (p0 * q2 - q0 * p2),
        )
        self._attitude = end = turned(start, rotation)
        place, going, acceleration = self._carried(start, end, self._lift * (s1 + s2 + s3 + s4), wind)
        if place[2] >= 0.0 and going[2] >= 0.0:
            return self._touched_down(place)
        roll, pitch, yaw = angles_of(end)
        force = specific_force(roll, pitch, yaw, acceleration)
        return Motion(place, going, acceleration, roll, pitch, yaw, (p2, q2, r2), force, False)

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
        k, along, half = self._drag_per_s, self._along_per_s, 0.5 * dt
        push = thrust + along * (un * bn + ue * be + ud * bd)
        un, ue = un + half * (-push * bn - k * un), ue + half * (-push * be - k * ue)
        ud += half * (GRAVITY_M_S2 - push * bd - k * ud)
        push = thrust + along * (un * bn + ue * be + ud * bd)
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
