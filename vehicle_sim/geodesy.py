"""Local north-east-down offsets on WGS 84 (NIMA TR8350.2), for distances that a multicopter flies.

Horizontal offsets are those of the tangent plane at the origin, taken on the ellipsoid raised to the origin's
altitude; down is the difference of altitudes, as autopilots count it, so level flight stays level.
"""

from functools import lru_cache
from math import cos, degrees, radians, sin, sqrt

from vehicle_sim.signals import Geodetic, Vector

_SEMI_MAJOR_M = 6378137.0
_FLATTENING = 1.0 / 298.257223563
_ECCENTRICITY_SQUARED = _FLATTENING * (2.0 - _FLATTENING)
_POLAR = 1.0 - _ECCENTRICITY_SQUARED


def _prime_vertical_m(sin_lat: float) -> float:
    return _SEMI_MAJOR_M / sqrt(1.0 - _ECCENTRICITY_SQUARED * sin_lat * sin_lat)


@lru_cache(maxsize=64)
def _plane_at(lat_deg: float, alt_m: float) -> tuple[float, float, float, float]:
    """Return what depends on the origin alone: sine and cosine of its latitude, distances from axis and equator.

    Few origins are asked for, again and again: the estimator's, and home.
    """
    lat = radians(lat_deg)
    sin_0, cos_0 = sin(lat), cos(lat)
    n_0 = _prime_vertical_m(sin_0)
    return sin_0, cos_0, (n_0 + alt_m) * cos_0, (n_0 * _POLAR + alt_m) * sin_0


@lru_cache(maxsize=64)
def _radii_m(lat_deg: float, alt_m: float) -> tuple[float, float]:
    """Return the radii of a meridian and of a parallel of latitude."""
    lat = radians(lat_deg)
    n_0 = _prime_vertical_m(sin(lat))
    return n_0**3 * _POLAR / _SEMI_MAJOR_M**2 + alt_m, (n_0 + alt_m) * cos(lat)


def ned_offset_m(origin: Geodetic, point: Geodetic) -> Vector:
    """Return north, east, down in metres from `origin` to `point`.

    The chord between both places, both at the origin's altitude, projected on the tangent plane at the origin.
    """
    lat_deg, lon_deg, h = origin
    sin_0, cos_0, x_0, z_0 = _plane_at(lat_deg, h)
    lat = radians(point.lat_deg)
    d_lon = radians((point.lon_deg - lon_deg + 180.0) % 360.0 - 180.0)
    sin_1, cos_1 = sin(lat), cos(lat)
    n_1 = _prime_vertical_m(sin_1)
    # Earth-centred, with the x axis through the origin's meridian.
    x = (n_1 + h) * cos_1 * cos(d_lon) - x_0
    y = (n_1 + h) * cos_1 * sin(d_lon)
    z = (n_1 * _POLAR + h) * sin_1 - z_0
    return (-sin_0 * x + cos_0 * z, y, h - point.alt_m)


def geodetic_at(origin: Geodetic, offset_ned_m: Vector) -> Geodetic:
    """Return the place at `offset_ned_m` from `origin`: the inverse of `ned_offset_m` to below a micrometre.

    A few fixed-point steps with the radii of curvature; meant for offsets up to some hundred kilometres and
    latitudes that a multicopter flies at (not the poles themselves).
    """
    north, east, down = offset_ned_m
    meridional_m, parallel_m = _radii_m(origin.lat_deg, origin.alt_m)
    # The first step starts from the origin itself, whose offset is nothing.
    lat, lon = origin.lat_deg + degrees(north / meridional_m), origin.lon_deg + degrees(east / parallel_m)
    for _ in range(5):
        got_north, got_east, _down = ned_offset_m(origin, Geodetic(lat, lon, origin.alt_m))
        miss_north, miss_east = north - got_north, east - got_east
        lat += degrees(miss_north / meridional_m)
        lon += degrees(miss_east / parallel_m)
        if abs(miss_north) + abs(miss_east) < 1e-8:  # noqa: PLR2004 - metres, far below a degree's last float digit
            break
    return Geodetic(lat, (lon + 180.0) % 360.0 - 180.0, origin.alt_m - down)
