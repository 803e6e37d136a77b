"""The tracking law (Eq. 12) and the attitude loop below it.

Per axis, with position error e = p - p* and velocity error e' = v - v*,

    u = a* - e / tau^2 - (2 / tau) e'    =    a* + (2 / tau) (v* - e / (2 tau) - v),

the critically damped law of Eq. 12 with K = [1/tau^2, 2/tau]. The second form is the one computed, because in it the
limits have a meaning: the approach speed |e| / (2 tau) is kept below the speed from which the vehicle can still brake
(it turns into a square root far from the target), so a distant position is reached without overshoot.

A bounded disturbance |d| <= w leaves |e| <= w tau^2. What lasts (steady wind, a bias, the weight of a load) is taken
out by a disturbance observer: the measured acceleration less what tilt and thrust explain, low-passed, is
subtracted. Then w bounds only what is left, the part of the disturbance that is faster than the observer.

The gains are those of a real autopilot: with tau = 0.8 s, 0.63/s from position to velocity and 2.5/s from velocity to
acceleration, in product near ArduCopter's PSC_POSXY_P = 1.0 and PSC_VELXY_P = 2.0. So is the tracking. On a circle of
6 m at 2.1 m/s the rms error (m, the same for both dynamics and in wind of 6 m/s with gusts) is

    setpoints of            here    ArduCopter    PX4
    position, velocity      0.54    0.6           1.3-1.7
    and acceleration        0.13    0.25          1.1-1.7

where the last two columns were seen in their own simulators, with the delays of a link, which count here as nothing.

Neither autopilot limits the sum of what is asked for and what corrects by less than the tilt (``update_xy_controller``
of ArduPilot's AC_PosControl, ``_accelerationControl`` of PX4's PositionControl); the limit of acceleration is for each.

PX4 (MPC_XY_P and MPC_XY_VEL_P_ACC, _I_ACC, _D_ACC) has no observer. Its integral of the velocity error learns a lasting
disturbance in seconds, and through drag, which is one that changes with the velocity, it follows late (``PX4_GAINS``).
"""

from dataclasses import dataclass
from math import cos, exp, hypot, pi, sin, sqrt
from typing import Final

from vehicle_sim.signals import GRAVITY_M_S2, IDLE, Command, Estimate, Guidance, Setpoint

_ATTITUDE_PER_S: Final = 8.0
_RATE_PER_S: Final = 25.0
_TILT_RATE_RAD_S: Final = 3.5
_YAW_PER_S: Final = 2.0
_YAW_RATE_PER_S: Final = 8.0
_MOST_DISTURBANCE_M_S2: Final = 4.0
_MOST_INTEGRAL_M_S2: Final = 8.0
_VERTICAL_RESERVE: Final = 2.0


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackingGains:
    """Gains of the tracking law.

    Attributes:
        tau_s: Time constant of Eq. 12, from which the gains of position and velocity follow where they are not given.
        observer_s: Time constant of the disturbance observer; None for the law without one.
        rotor_s: Time constant of the rotors that the observer reckons with.
        position_per_s: From position to velocity, instead of 1 / (2 tau).
        velocity_per_s: From velocity to acceleration, instead of 2 / tau.
        integral_per_s2: From the integral of the velocity's error to acceleration, level only.
        damping: Share of the measured acceleration that is taken off what is asked for, level only.
        height_per_s: From height to velocity, instead of `position_per_s`.
        climb_per_s: From vertical velocity to acceleration, instead of `velocity_per_s`.
        climb_observer_s: Time constant of the vertical part of the observer, instead of `observer_s`.
    """

    tau_s: float = 0.8
    observer_s: float | None = 1.0
    rotor_s: float = 0.05
    position_per_s: float | None = None
    velocity_per_s: float | None = None
    integral_per_s2: float = 0.0
    damping: float = 0.0
    height_per_s: float | None = None
    climb_per_s: float | None = None
    climb_observer_s: float | None = None


PX4_GAINS: Final = TrackingGains(
    observer_s=None,
    position_per_s=0.95,
    velocity_per_s=1.8,
    integral_per_s2=0.4,
    damping=0.2,
    height_per_s=1.0,
    climb_per_s=4.0,
    climb_observer_s=2.0,
)
"""Those of PX4 as it comes."""

NAMED_GAINS: Final = {"observer": TrackingGains(), "px4": PX4_GAINS}
"""The gains that a vehicle can be started with."""


def approach_speed(distance_m: float, *, gain_per_s: float, braking_m_s2: float) -> float:
    """Return the speed towards a target `distance_m` away: proportional near it, a square root beyond.

    The two pieces join with equal slope, and on the root the speed falls with exactly `braking_m_s2`.
    """
    near_m = braking_m_s2 / (gain_per_s * gain_per_s)
    if distance_m <= near_m:
        return gain_per_s * distance_m
    return sqrt(2.0 * braking_m_s2 * (distance_m - 0.5 * near_m))


def _blend(time_s: float | None, step_s: float) -> float:
    """Return what one step takes over of a value that is low-passed with this time constant; without one nothing."""
    return 0.0 if time_s is None else 1.0 - exp(-step_s / time_s)


def _clipped(value: float, most: float) -> float:
    return max(-most, min(value, most))


def _shortened(north: float, east: float, most: float) -> tuple[float, float]:
    size = hypot(north, east)
    return (north, east) if size <= most else (north * most / size, east * most / size)


def wrap(angle_rad: float) -> float:
    """Return the angle in (-pi, pi] that looks the same way."""
    wrapped = (angle_rad + pi) % (2.0 * pi) - pi
    return pi if wrapped == -pi else wrapped


class Controller:
    """Turns guidance and estimate into commands for the airframe, once a step.

    Attributes:
        command: The newest command.
        tilt_ne_rad: The lean to north and east that it is meant to bring about.
        yaw_rad: The yaw.
    """

    def __init__(self, gains: TrackingGains, *, step_s: float) -> None:
        """Start idle."""
        self._step_s = step_s
        self._position_per_s = gains.position_per_s or 0.5 / gains.tau_s
        self._velocity_per_s = gains.velocity_per_s or 2.0 / gains.tau_s
        self._integral_per_step = gains.integral_per_s2 * step_s
        self._damping = gains.damping
        self._integral = (0.0, 0.0)
        self._height_per_s = gains.height_per_s or self._position_per_s
        self._climb_per_s = gains.climb_per_s or self._velocity_per_s
        self._observe = _blend(gains.observer_s, step_s)
        self._observe_climb = _blend(gains.climb_observer_s or gains.observer_s, step_s)
        self._rotor = 1.0 - exp(-step_s / gains.rotor_s)
        self._idle = True
        self._disturbance = (0.0, 0.0, 0.0)
        self._thrust_m_s2 = 0.0
        self.yaw_rad = 0.0
        self.command = IDLE
        self.tilt_ne_rad = (0.0, 0.0)

    @property
    def disturbance_ned_m_s2(self) -> tuple[float, float, float]:
        """The disturbance that the observer sees, or that the integral has learned."""
        if self._integral_per_step:
            return (-self._integral[0], -self._integral[1], self._disturbance[2])
        return self._disturbance

    def step(self, estimate: Estimate, guidance: Guidance) -> Command:
        """Return the command for the next step."""
        setpoint = guidance.setpoint
        if setpoint is None:
            self._idle = True
            self.command = IDLE
            self.tilt_ne_rad, self.yaw_rad = (0.0, 0.0), estimate.yaw_rad
            return IDLE
        if self._idle:
            self._idle = False
            self._disturbance = (0.0, 0.0, 0.0)
            self._integral = (0.0, 0.0)
            self._thrust_m_s2 = 0.0
            self.yaw_rad = estimate.yaw_rad
        cos_yaw, sin_yaw = cos(estimate.yaw_rad), sin(estimate.yaw_rad)
        roll, pitch = estimate.roll_rad, estimate.pitch_rad
        tilt_n, tilt_e = -(pitch * cos_yaw + roll * sin_yaw), roll * cos_yaw - pitch * sin_yaw
        self._watch_disturbance(estimate, tilt_n, tilt_e)
        lean = setpoint.lean_ne_rad
        wanted_n, wanted_e = self._tilt(estimate, setpoint, guidance) if lean is None else lean
        self.tilt_ne_rad = (wanted_n, wanted_e)
        # Attitude loop, in the axes in which the tilt does not depend on yaw.
        rate_n, rate_e = _ATTITUDE_PER_S * (wanted_n - tilt_n), _ATTITUDE_PER_S * (wanted_e - tilt_e)
        size = hypot(rate_n, rate_e)
        if size > _TILT_RATE_RAD_S:
            rate_n, rate_e = rate_n * _TILT_RATE_RAD_S / size, rate_e * _TILT_RATE_RAD_S / size
        p, q, r = estimate.rates_rad_s
        up_n = _RATE_PER_S * (rate_n + q * cos_yaw + p * sin_yaw)
        up_e = _RATE_PER_S * (rate_e - p * cos_yaw + q * sin_yaw)
        thrust = self._thrust(estimate, setpoint, guidance)
        self._thrust_m_s2 += self._rotor * (thrust - self._thrust_m_s2)
        turn = self._turn(estimate.yaw_rad, r, setpoint, guidance.limits.yaw_rate_rad_s)
        self.command = Command(thrust, (up_e * cos_yaw - up_n * sin_yaw, -(up_n * cos_yaw + up_e * sin_yaw), turn))
        return self.command

    def _watch_disturbance(self, estimate: Estimate, tilt_n: float, tilt_e: float) -> None:
        a_n, a_e, a_d = estimate.acceleration_ned_m_s2
        d_n, d_e, d_d = self._disturbance
        k, most = self._observe, _MOST_DISTURBANCE_M_S2
        d_n += k * (a_n - GRAVITY_M_S2 * tilt_n - d_n)
        d_e += k * (a_e - GRAVITY_M_S2 * tilt_e - d_e)
        d_d += self._observe_climb * (a_d - GRAVITY_M_S2 + self._thrust_m_s2 - d_d)
        self._disturbance = (max(-most, min(d_n, most)), max(-most, min(d_e, most)), max(-most, min(d_d, most)))

    def _tilt(self, estimate: Estimate, setpoint: Setpoint, guidance: Guidance) -> tuple[float, float]:
        """Return the tilt (north, east) that the horizontal axes ask for."""
        limits = guidance.limits
        place, speed, push = setpoint.position_ned_m, setpoint.velocity_ned_m_s, setpoint.acceleration_ned_m_s2
        here, going = estimate.position_ned_m, estimate.velocity_ned_m_s
        miss_n = 0.0 if place[0] is None else place[0] - here[0]
        miss_e = 0.0 if place[1] is None else place[1] - here[1]
        distance = hypot(miss_n, miss_e)
        approach = brake = 0.0
        if distance > 0.0:
            gain, braking = self._position_per_s, limits.braking_m_s2
            towards = approach_speed(distance, gain_per_s=gain, braking_m_s2=braking)
            approach = towards / distance
            # Along the root the speed is known to fall; where it joins the line this has faded away.
            closing = (going[0] * miss_n + going[1] * miss_e) / distance
            if closing > 0.0 and towards < limits.speed_m_s and gain * towards > braking:
                brake = braking * min(closing / towards, 1.0) * (1.0 - braking / (gain * gain * distance)) / distance
        wanted_n, wanted_e = (speed[0] or 0.0) + approach * miss_n, (speed[1] or 0.0) + approach * miss_e
        size = hypot(wanted_n, wanted_e)
        if size > limits.speed_m_s:
            wanted_n, wanted_e = wanted_n * limits.speed_m_s / size, wanted_e * limits.speed_m_s / size
        steered_n, steered_e = (place[i] is not None or speed[i] is not None for i in (0, 1))
        most = limits.acceleration_m_s2
        u_n, u_e = _shortened(
            self._velocity_per_s * (wanted_n - going[0]) if steered_n else 0.0,
            self._velocity_per_s * (wanted_e - going[1]) if steered_e else 0.0,
            most,
        )
        # What is asked for is limited, and what corrects the vehicle's errors comes on top of it, up to the tilt.
        push_n, push_e = _shortened((push[0] or 0.0) - brake * miss_n, (push[1] or 0.0) - brake * miss_e, most)
        u_n, u_e = u_n + push_n, u_e + push_e
        # An axis that nothing is asked of stays level, and drifts with the wind.
        asked_n, asked_e = steered_n or push[0] is not None, steered_e or push[1] is not None
        if self._integral_per_step:
            miss_n, miss_e = (wanted_n - going[0] if steered_n else 0.0), (wanted_e - going[1] if steered_e else 0.0)
            self._learn(miss_n, miss_e)
            u_n, u_e = u_n + self._integral[0], u_e + self._integral[1]
        if self._damping:
            felt = estimate.acceleration_ned_m_s2
            u_n, u_e = u_n - self._damping * felt[0], u_e - self._damping * felt[1]
        tilt_n = (u_n - self._disturbance[0]) / GRAVITY_M_S2 if asked_n else 0.0
        tilt_e = (u_e - self._disturbance[1]) / GRAVITY_M_S2 if asked_e else 0.0
        size = hypot(tilt_n, tilt_e)
        if size > limits.tilt_rad:
            tilt_n, tilt_e = tilt_n * limits.tilt_rad / size, tilt_e * limits.tilt_rad / size
        return tilt_n, tilt_e

    def _learn(self, miss_n_m_s: float, miss_e_m_s: float) -> None:
        """Add the velocity's error to the integral, as far as that may grow."""
        k, (sum_n, sum_e) = self._integral_per_step, self._integral
        most = _MOST_INTEGRAL_M_S2
        self._integral = (_clipped(sum_n + k * miss_n_m_s, most), _clipped(sum_e + k * miss_e_m_s, most))

    def _thrust(self, estimate: Estimate, setpoint: Setpoint, guidance: Guidance) -> float:
        """Return the specific thrust that the down axis asks for."""
        if setpoint.thrust_m_s2 is not None:
            return setpoint.thrust_m_s2
        limits = guidance.limits
        place, speed, push = (
            setpoint.position_ned_m[2],
            setpoint.velocity_ned_m_s[2],
            setpoint.acceleration_ned_m_s2[2],
        )
        wanted = speed or 0.0
        if place is not None:
            miss = place - estimate.position_ned_m[2]
            rate = approach_speed(
                abs(miss), gain_per_s=self._height_per_s, braking_m_s2=limits.vertical_acceleration_m_s2
            )
            wanted += rate if miss > 0.0 else -rate
        wanted = max(-limits.climb_m_s, min(wanted, limits.descent_m_s))
        u = push or 0.0
        if place is not None or speed is not None or push is None:
            u += self._climb_per_s * (wanted - estimate.velocity_ned_m_s[2])
        most = _VERTICAL_RESERVE * limits.vertical_acceleration_m_s2
        u = max(-most, min(u, most))
        return max(0.0, GRAVITY_M_S2 - u + self._disturbance[2])

    def _turn(self, yaw_rad: float, rate_rad_s: float, setpoint: Setpoint, limit_rad_s: float) -> float:
        """Return the angular acceleration about the down axis."""
        ahead = setpoint.yaw_rate_rad_s or 0.0
        if setpoint.yaw_rad is not None:
            self.yaw_rad = setpoint.yaw_rad
        else:
            self.yaw_rad += ahead * self._step_s
        wanted = ahead + _YAW_PER_S * wrap(self.yaw_rad - yaw_rad)
        wanted = max(-limit_rad_s, min(wanted, limit_rad_s))
        return _YAW_RATE_PER_S * (wanted - rate_rad_s)
