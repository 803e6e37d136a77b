"""Many places on Earth at once; one at a time, and what an offset is: ``geodesy``, which needs no library."""

import numpy as np

from mission.errors import GeometryError
from mission.geometry.arrays import FloatArray
from mission.geometry.geodesy import ECCENTRICITY_SQUARED, REACH_M, SEMI_MAJOR_AXIS_M, LatLon, axes, earth_centred


def enu_offsets_m(from_place: LatLon, places_deg: FloatArray) -> tuple[FloatArray, FloatArray]:
    """East and north of many places, seen from one, shape (N, 2), and how far away each is, shape (N,).

    Args:
        from_place: Where they are seen from.
        places_deg: Latitudes and longitudes, shape (N, 2).
    """
    latitude, longitude = np.radians(places_deg).T
    across = SEMI_MAJOR_AXIS_M / np.sqrt(1.0 - ECCENTRICITY_SQUARED * np.sin(latitude) ** 2)
    around = across * np.cos(latitude)
    height = across * (1.0 - ECCENTRICITY_SQUARED) * np.sin(latitude)
    centred = np.stack((around * np.cos(longitude), around * np.sin(longitude), height), axis=1)
    apart = centred - np.array(earth_centred(from_place))
    offsets: FloatArray = apart @ np.array(axes(from_place)[:2]).T
    return offsets, np.sqrt((apart * apart).sum(axis=1))


def places_at_offsets(from_place: LatLon, offsets_m: FloatArray) -> FloatArray:
    """Latitudes and longitudes of many places, shape (N, 2): the inverse of ``enu_offsets_m``.

    Raises:
        GeometryError: If an offset is longer than ``REACH_M``.
    """
    offsets = np.asarray(offsets_m, dtype=np.float64).reshape(-1, 2)
    if not (np.hypot(*offsets.T) <= REACH_M).all():
        raise GeometryError(f"an offset is longer than {REACH_M / 1000.0:.0f} km")
    east, north, up = np.array(axes(from_place))
    steps = offsets @ np.stack((east, north))
    flat = np.array(earth_centred(from_place)) + steps
    # The quadratic in the depth of ``place_at_offset``.
    stretch = np.array([1.0, 1.0, 1.0 / (1.0 - ECCENTRICITY_SQUARED)])
    a, half_b, c = up**2 @ stretch, flat @ (up * stretch), steps**2 @ stretch
    depth = -c / (half_b + np.sqrt(half_b**2 - a * c))
    x, y, z = (flat + depth[:, None] * up).T
    places: FloatArray = np.degrees(np.stack((np.arctan2(stretch[2] * z, np.hypot(x, y)), np.arctan2(y, x)), axis=1))
    return places
