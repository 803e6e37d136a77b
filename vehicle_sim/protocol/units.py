"""From the vehicle's SI numbers to the integers of MAVLink fields."""

from math import isfinite, pi, tau
from typing import Final

E7: Final = 1e7
"""Degrees of latitude and longitude travel as this many-fold integers."""

_INT16: Final = 32767
_LARGEST_EXACT: Final = 2.0**24
"""Above it single precision no longer tells whole numbers apart."""


def clamp(value: float, low: int, high: int) -> int:
    """Round to a whole number between both bounds."""
    return low if value <= low else high if value >= high else round(value)


def clamp16(value: float) -> int:
    """Round to what a signed field of 16 bits holds; its least value is left alone, it often means unknown."""
    return -_INT16 if value <= -_INT16 else _INT16 if value >= _INT16 else round(value)


def wrapped(angle_rad: float) -> float:
    """Return the angle in [-pi, pi)."""
    return (angle_rad + pi) % tau - pi


def heading_deg(yaw_rad: float) -> float:
    """Return the compass heading in degrees, 0 to 360."""
    return yaw_rad % tau * (180.0 / pi)


def whole_number(value: float) -> int | None:
    """Return the whole number that a parameter of a command holds exactly, None where it holds none."""
    if not isfinite(value) or not 0.0 <= value <= _LARGEST_EXACT or value != int(value):
        return None
    return int(value)
