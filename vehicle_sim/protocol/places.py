"""Places of the global frames of MAVLink: which numbers are one, and what their height counts from."""

from math import isfinite
from typing import Final

from vehicle_sim.protocol.dialect import mavlink
from vehicle_sim.signals import Geodetic

AMSL_FRAMES: Final = frozenset((mavlink.MAV_FRAME_GLOBAL, mavlink.MAV_FRAME_GLOBAL_INT))
HOME_FRAMES: Final = frozenset((mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT))
TERRAIN_FRAMES: Final = frozenset((mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT, mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT_INT))
GLOBAL_FRAMES: Final = AMSL_FRAMES | HOME_FRAMES | TERRAIN_FRAMES

_POLE_DEG: Final = 90.0
_ANTIMERIDIAN_DEG: Final = 180.0
_HIGHEST_M: Final = 1e6
"""Above or below sea level; the difference of two such altitudes still fits a field of 32 bits in millimetres."""


def is_latitude(lat_deg: float) -> bool:
    """Whether a latitude is one on earth."""
    return abs(lat_deg) <= _POLE_DEG


def is_longitude(lon_deg: float) -> bool:
    """Whether a longitude is one on earth."""
    return abs(lon_deg) <= _ANTIMERIDIAN_DEG


def is_place(lat_deg: float, lon_deg: float) -> bool:
    """Whether latitude and longitude name a place on earth; two zeros are fields that nobody has filled in."""
    return is_latitude(lat_deg) and is_longitude(lon_deg) and (lat_deg, lon_deg) != (0.0, 0.0)


def altitude_m(height_m: float, frame: int, home: Geodetic | None) -> float | None:
    """Return the altitude above sea level of a height in a global frame.

    None where it is none, as one of more than a million metres, or where it counts from an unknown home. The ground is
    flat and at home's altitude, so heights above terrain are heights above home.
    """
    if frame not in GLOBAL_FRAMES or not isfinite(height_m):
        return None
    if frame not in AMSL_FRAMES:
        if home is None:
            return None
        height_m += home.alt_m
    return height_m if abs(height_m) <= _HIGHEST_M else None


def global_place(lat_deg: float, lon_deg: float, height_m: float, frame: int, home: Geodetic | None) -> Geodetic | None:
    """Return a place given in a global frame; None where it is none, or its height is no `altitude_m`."""
    alt_m = altitude_m(height_m, frame, home)
    return None if alt_m is None or not is_place(lat_deg, lon_deg) else Geodetic(lat_deg, lon_deg, alt_m)
