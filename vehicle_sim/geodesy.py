"""Local north-east-down offsets on WGS 84 (NIMA TR8350.2), for distances that a multicopter flies.

Horizontal offsets are those of the tangent plane at the origin, taken on the ellipsoid raised to the origin's
altitude; down is the difference of altitudes, as autopilots count it, so level flight stays level.
"""

from math import cos, degrees, radians, sin, sqrt

from vehicle_sim.signals import Geodetic, Vector

_SEMI_MAJOR_M = 6378137.0
_FLATTENING = 1.0 / 298.257223563
_ECCENTRICITY_SQUARED = _FLATTENING * (2.0 - _FLATTENING)


def _prime_vertical_m(sin_lat: float) -> float:
    return _SEMI_MAJOR_M / sqrt(1.0 - _ECCENTRICITY_SQUARED * sin_lat * sin_lat)


def ned_offset_m(origin: Geodetic, point: Geodetic) -> Vector:
    """Return north, east, down in metres from `origin` to `point`.

    The chord between both places, both at the origin's altitude, projected on the tangent plane at the origin.
    """
    lat_0, lat = radians(origin.lat_deg), radians(point.lat_deg)
    d_lon = radians((point.lon_deg - origin.lon_deg + 180.0) % 360.0 - 180.0)
    sin_0, cos_0, sin_1, cos_1 = sin(lat_0), cos(lat_0), sin(lat), cos(lat)
    n_0, n_1 = _prime_vertical_m(sin_0), _prime_vertical_m(sin_1)
    h = origin.alt_m
    # Earth-centred, with the x axis through the origin's meridian.
    x = (n_1 + h) * cos_1 * cos(d_lon) - (n_0 + h) * cos_0
    y = (n_1 + h) * cos_1 * sin(d_lon)
    polar = 1.0 - _ECCENTRICITY_SQUARED
    z = (n_1 * polar + h) * sin_1 - (n_0 * polar + h) * sin_0
    return (-sin_0 * x + cos_0 * z, y, origin.alt_m - point.alt_m)


def geodetic_at(origin: Geodetic, offset_ned_m: Vector) -> Geodetic:
    """Return the place at `offset_ned_m` from `origin`: the inverse of `ned_offset_m` to below a micrometre.

    A few fixed-point steps with the radii of curvature; meant for offsets up to some hundred kilometres and
    latitudes that a multicopter flies at (not the poles themselves).
    """
    north, east, down = offset_ned_m
    sin_0, cos_0 = sin(radians(origin.lat_deg)), cos(radians(origin.lat_deg))
    n_0 = _prime_vertical_m(sin_0)
    meridional_m = n_0**3 * (1.0 - _ECCENTRICITY_SQUARED) / _SEMI_MAJOR_M**2 + origin.alt_m
    parallel_m = (n_0 + origin.alt_m) * cos_0
    lat, lon = origin.lat_deg, origin.lon_deg
    for _ in range(6):
        got_north, got_east, _down = ned_offset_m(origin, Geodetic(lat, lon, origin.alt_m))
        miss_north, miss_east = north - got_north, east - got_east
        lat += degrees(miss_north / meridional_m)
        lon += degrees(miss_east / parallel_m)
        if abs(miss_north) + abs(miss_east) < 1e-8:  # noqa: PLR2004 - metres, far below a degree's last float digit
            break
    return Geodetic(lat, (lon + 180.0) % 360.0 - 180.0, origin.alt_m - down)
