"""East and north offsets between places on the WGS 84 ellipsoid.

The offset is the one of a Cartesian frame: the plane that touches the ellipsoid at the first place, x east and y
north, and the second place seen along the vertical of the first. Both directions are closed forms over
Earth-centred coordinates and invert each other exactly; heights are left out. Against distances along the ground an
offset of length d is short by d^3 / 6R^2: 0.4 mm at 5 km, 4 m at 100 km.
"""

import math
from dataclasses import dataclass

from mission.decimals import decimal
from mission.errors import GeometryError

SEMI_MAJOR_AXIS_M = 6_378_137.0
FLATTENING = 1.0 / 298.257_223_563
ECCENTRICITY_SQUARED = FLATTENING * (2.0 - FLATTENING)
"""WGS 84 (NIMA TR8350.2, Table 3.1)."""

REACH_M = 1_000_000.0
"""Places farther apart than this have no offset: a plane says nothing of them."""

PLANE_M = 50_000.0
"""As far from its origin a mission may reach: 0.5 m are missing there against distances along the ground."""

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class LatLon:
    """A place on the ellipsoid, geodetic, degrees.

    Raises:
        GeometryError: If the latitude is not within 90 degrees, or the longitude not within 180.
    """

    latitude_deg: float
    longitude_deg: float

    def __post_init__(self) -> None:
        if not (abs(self.latitude_deg) <= 90.0 and abs(self.longitude_deg) <= 180.0):  # noqa: PLR2004 - the globe
            raise GeometryError(f"no such place on Earth: {self.latitude_deg}, {self.longitude_deg}")


def enu_offset_m(from_place: LatLon, to_place: LatLon) -> tuple[float, float]:
    """East and north of one place, seen from another.

    Raises:
        GeometryError: If they are more than ``REACH_M`` apart.
    """
    start, end = earth_centred(from_place), earth_centred(to_place)
    apart = (end[0] - start[0], end[1] - start[1], end[2] - start[2])
    distance = math.hypot(*apart)
    if distance > REACH_M:
        raise GeometryError(f"the places are {distance / 1000.0:.0f} km apart; {REACH_M / 1000.0:.0f} km is the most")
    east, north, _ = axes(from_place)
    return _dot(east, apart), _dot(north, apart)


def place_at_offset(from_place: LatLon, east_m: float, north_m: float) -> LatLon:
    """The place at an offset: the inverse of ``enu_offset_m``.

    Raises:
        GeometryError: If the offset is longer than ``REACH_M``.
    """
    if not math.hypot(east_m, north_m) <= REACH_M:
        raise GeometryError(
            f"the offset ({decimal(east_m)}, {decimal(north_m)}) m is longer than {REACH_M / 1000.0:.0f} km"
        )
    east, north, up = axes(from_place)
    start = earth_centred(from_place)
    flat = [start[k] + east_m * east[k] + north_m * north[k] for k in range(3)]
    # On the ellipsoid x^2 + y^2 + stretch z^2 is the square of the semi-major axis. Down from the plane to it is a
    # quadratic in the depth; its constant is the excess of the two steps, whose first order vanishes on a tangent.
    stretch = 1.0 / (1.0 - ECCENTRICITY_SQUARED)
    a = up[0] ** 2 + up[1] ** 2 + stretch * up[2] ** 2
    half_b = up[0] * flat[0] + up[1] * flat[1] + stretch * up[2] * flat[2]
    c = east_m**2 + north_m**2 * (north[0] ** 2 + north[1] ** 2 + stretch * north[2] ** 2)
    depth = -c / (half_b + math.sqrt(half_b * half_b - a * c))
    x, y, z = (flat[k] + depth * up[k] for k in range(3))
    return LatLon(math.degrees(math.atan2(stretch * z, math.hypot(x, y))), math.degrees(math.atan2(y, x)))


def curvature_radii_m(latitude_deg: float) -> tuple[float, float]:
    """Radii of curvature of the ellipsoid at a latitude, along the meridian and across it."""
    flat = 1.0 - ECCENTRICITY_SQUARED * math.sin(math.radians(latitude_deg)) ** 2
    across = SEMI_MAJOR_AXIS_M / math.sqrt(flat)
    return across * (1.0 - ECCENTRICITY_SQUARED) / flat, across


def earth_centred(place: LatLon) -> Vector:
    """Earth-centred, Earth-fixed coordinates in metres of a place at height 0."""
    latitude, longitude = math.radians(place.latitude_deg), math.radians(place.longitude_deg)
    across = SEMI_MAJOR_AXIS_M / math.sqrt(1.0 - ECCENTRICITY_SQUARED * math.sin(latitude) ** 2)
    around = across * math.cos(latitude)
    return (
        around * math.cos(longitude),
        around * math.sin(longitude),
        across * (1.0 - ECCENTRICITY_SQUARED) * math.sin(latitude),
    )


def axes(place: LatLon) -> tuple[Vector, Vector, Vector]:
    """Unit vectors east, north and up at a place, Earth-centred."""
    latitude, longitude = math.radians(place.latitude_deg), math.radians(place.longitude_deg)
    sin_lat, cos_lat, sin_lon, cos_lon = (
        math.sin(latitude),
        math.cos(latitude),
        math.sin(longitude),
        math.cos(longitude),
    )
    return (
        (-sin_lon, cos_lon, 0.0),
        (-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat),
        (cos_lat * cos_lon, cos_lat * sin_lon, sin_lat),
    )


def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
