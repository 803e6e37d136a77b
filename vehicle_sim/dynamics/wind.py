"""Wind: a steady part and gusts about it.

Each component of the gusts is a first-order Gauss-Markov process, the longitudinal form of Dryden's spectrum
(MIL-F-8785C) for a vehicle that moves slowly through the air, discretised exactly.
"""

from math import cos, radians, sin
from typing import Final

from vehicle_sim.noise import GaussMarkov, Normals
from vehicle_sim.signals import Vector

_GUST_TIME_S: Final = 3.0
_VERTICAL_SHARE: Final = 0.5


def blowing_from(speed_m_s: float, direction_deg: float, rise_deg: float = 0.0) -> Vector:
    """Return the velocity (NED, m/s) of a wind by the meteorologists' convention: where it comes from.

    `rise_deg` is the angle by which it blows upwards.
    """
    bearing, rise = radians(direction_deg), radians(rise_deg)
    level = speed_m_s * cos(rise)
    return (-level * cos(bearing), -level * sin(bearing), -speed_m_s * sin(rise) if rise_deg else 0.0)


class Wind:
    """The velocity of the air at the vehicle, NED, m/s."""

    def __init__(self, normals: Normals, *, gust_m_s: float, step_s: float) -> None:
        """Blow with `steady_ned_m_s` (none at first) and gusts of deviation `gust_m_s` (half of it vertically)."""
        self.steady_ned_m_s: Vector = (0.0, 0.0, 0.0)
        # Air that has never been disturbed needs no random numbers.
        self._gusty = gust_m_s > 0.0
        self._gusts = [
            GaussMarkov(normals, std=share * gust_m_s, time_s=_GUST_TIME_S, step_s=step_s)
            for share in (1.0, 1.0, _VERTICAL_SHARE)
        ]

    def set_gusts(self, gust_m_s: float) -> None:
        """Change the standard deviation of the gusts; they grow into it within their correlation time."""
        self._gusty = self._gusty or gust_m_s > 0.0
        for gust, share in zip(self._gusts, (1.0, 1.0, _VERTICAL_SHARE), strict=True):
            gust.std = share * gust_m_s

    def step(self) -> Vector:
        """Go on by one step and return the velocity of the air."""
        steady = self.steady_ned_m_s
        if not self._gusty:
            return steady
        north, east, down = self._gusts
        return (steady[0] + north.step(), steady[1] + east.step(), steady[2] + down.step())
