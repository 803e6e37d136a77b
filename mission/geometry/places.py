"""Many places on Earth at once; one at a time, and what an offset is: ``geodesy``."""

import numpy as np

from mission.errors import GeometryError
from mission.geometry.arrays import FloatArray
from mission.geometry.geodesy import ECCENTRICITY_SQUARED, REACH_M, SEMI_MAJOR_AXIS_M, LatLon


def places_at_offsets(from_place: LatLon, offsets_m: FloatArray) -> FloatArray:
    """Latitudes and longitudes in degrees, shape (P, 2), at offsets east and north of a place, shape (P, 2).

    Raises:
        GeometryError: If an offset is longer than ``REACH_M``.
    """
    offsets = np.asarray(offsets_m, dtype=np.float64).reshape(-1, 2)
    if not (np.hypot(*offsets.T) <= REACH_M).all():
        raise GeometryError(f"an offset is longer than {REACH_M / 1000.0:.0f} km")
    latitude, longitude = np.radians((from_place.latitude_deg, from_place.longitude_deg))
    east = np.array([-np.sin(longitude), np.cos(longitude), 0.0])
    north = np.array([-np.sin(latitude) * np.cos(longitude), -np.sin(latitude) * np.sin(longitude), np.cos(latitude)])
    up = np.cross(east, north)
    # With z stretched to it the ellipsoid is a sphere; the same steps as for one place, `geodesy` says why.
    stretch = np.array([1.0, 1.0, 1.0 / (1.0 - ECCENTRICITY_SQUARED)])
    across = SEMI_MAJOR_AXIS_M / np.sqrt(1.0 - ECCENTRICITY_SQUARED * np.sin(latitude) ** 2)
    start = across * up / stretch
    flat = start + offsets @ np.stack((east, north))
    a = up * stretch @ up
    half_b = flat @ (up * stretch)
    step = flat - start
    c = (step**2) @ stretch
    depth = -c / (half_b + np.sqrt(half_b**2 - a * c))
    x, y, z = (flat + depth[:, None] * up).T
    places: FloatArray = np.degrees(np.stack((np.arctan2(stretch[2] * z, np.hypot(x, y)), np.arctan2(y, x)), axis=1))
    return places
