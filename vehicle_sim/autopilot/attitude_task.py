"""Flying by an attitude that comes from outside, for whoever brings a position controller of their own.

An attitude is a lean of the thrust to north and east, and a yaw; body rates turn it on, or are asked for alone. With it
comes a climb rate or a thrust. After ArduCopter `ModeGuided::angle_control_run` and PX4's offboard attitude and rates.
"""

from math import cos, hypot, inf, sin
from typing import Final, NamedTuple

from vehicle_sim.autopilot.tasks import GuidedTask
from vehicle_sim.signals import GRAVITY_M_S2, Estimate, Setpoint, Vector

_LONGEST_TICK_S: Final = 0.1


class Attitude(NamedTuple):
    """An attitude and how fast it changes; exactly one of climb rate and thrust is given.

    Attributes:
        roll_pitch_yaw_rad: The attitude, None where only the rates count.
        rates_rad_s: About forward, right and down; None for none.
        turns_on: Whether the rates turn a given attitude on between two messages.
        climb_m_s: Climb rate.
        thrust_m_s2: Specific thrust along body up.
    """

    roll_pitch_yaw_rad: Vector | None
    rates_rad_s: Vector | None
    turns_on: bool
    climb_m_s: float | None = None
    thrust_m_s2: float | None = None


class AttitudeTask(GuidedTask):
    """Fly attitudes; what else a guided vehicle is told ends that."""

    _asked: Attitude | None = None
    _asked_s = inf
    _last_s = inf
    _lean_ne_rad = (0.0, 0.0)
    _yaw_rad = 0.0

    def follow(self, attitude: Attitude, now_s: float, estimate: Estimate) -> None:
        """Fly `attitude` from now on; the lean is kept within the largest tilt."""
        if attitude.roll_pitch_yaw_rad is not None:
            roll, pitch, self._yaw_rad = attitude.roll_pitch_yaw_rad
            self._lean(_lean_ne(roll, pitch, self._yaw_rad))
            self._last_s = now_s
        elif self._asked is None:
            self._last_s = now_s
            self._yaw_rad = estimate.yaw_rad
            self._lean(_lean_ne(estimate.roll_rad, estimate.pitch_rad, estimate.yaw_rad))
        self._asked, self._asked_s = attitude, now_s
        self.in_control = True
        self._renew()

    def take(self, setpoint: Setpoint, now_s: float) -> None:
        """Fly `setpoint` instead."""
        self._asked = None
        super().take(setpoint, now_s)

    def go_to(self, setpoint: Setpoint) -> None:
        """Fly to a place instead."""
        self._asked = None
        super().go_to(setpoint)

    def turn(self, yaw_rad: float) -> None:
        """Look into another direction, until the next attitude names one."""
        self._yaw_rad = yaw_rad
        super().turn(yaw_rad)

    def lifts(self, estimate: Estimate) -> bool:
        """Leave the ground to climb, or by more thrust than weight, in both flavours."""
        asked = self._asked
        if asked is None:
            return super().lifts(estimate)
        return (asked.climb_m_s or 0.0) > 0.0 or (asked.thrust_m_s2 or 0.0) > GRAVITY_M_S2

    def advance(self, now_s: float, estimate: Estimate) -> None:
        """Turn on by the rates; ArduPilot stays level, at the height that it has, once attitudes have ended."""
        asked = self._asked
        if asked is None:
            super().advance(now_s, estimate)
            return
        seconds, self._last_s = min(now_s - self._last_s, _LONGEST_TICK_S), now_s
        if self._stops and now_s - self._asked_s > self._settings.setpoint_timeout_s:
            self._lean_ne_rad = (0.0, 0.0)
            self._asked = asked = Attitude(None, None, turns_on=False, climb_m_s=0.0)
            self._renew()
        if asked.rates_rad_s is not None and (asked.turns_on or asked.roll_pitch_yaw_rad is None):
            roll_rate, pitch_rate, yaw_rate = asked.rates_rad_s
            faster_n, faster_e = _lean_ne(roll_rate, pitch_rate, estimate.yaw_rad)
            north, east = self._lean_ne_rad
            self._lean((north + faster_n * seconds, east + faster_e * seconds))
            self._yaw_rad += yaw_rate * seconds
            self._renew()

    def _lean(self, lean_ne_rad: tuple[float, float]) -> None:
        size, most = hypot(*lean_ne_rad), self._settings.tilt_rad
        share = most / size if size > most else 1.0
        self._lean_ne_rad = (lean_ne_rad[0] * share, lean_ne_rad[1] * share)

    def _renew(self) -> None:
        asked = self._asked
        if asked is not None:
            self.setpoint = Setpoint(
                velocity_ned_m_s=(None, None, None if asked.climb_m_s is None else -asked.climb_m_s),
                yaw_rad=self._yaw_rad,
                yaw_rate_rad_s=None if asked.rates_rad_s is None else asked.rates_rad_s[2],
                lean_ne_rad=self._lean_ne_rad,
                thrust_m_s2=asked.thrust_m_s2,
            )


def _lean_ne(roll: float, pitch: float, yaw_rad: float) -> tuple[float, float]:
    """Turn roll and pitch, or their rates, to leans to north and east."""
    c, s = cos(yaw_rad), sin(yaw_rad)
    return (-pitch * c - roll * s, roll * c - pitch * s)
