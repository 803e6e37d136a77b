"""Domains that are too small for metres, as degrees are, or too large for a plane."""

from typing import Any, Final

import numpy as np

from mission.decimals import decimal, measure
from mission.geometry.arrays import FloatArray
from mission.geometry.geodesy import PLANE_M
from mission.spec.finding import Finding, Path, listed

LEAST_EXTENT_M: Final = 1.0
"""A narrower domain is no place to fly in; in degrees, it is a hundred kilometres."""


def pair(point: Any) -> str:  # noqa: ANN401 - two numbers
    """A point as a mission file has it."""
    return f"[{decimal(point[0])}, {decimal(point[1])}]"


def scale_finding(path: Path, points: FloatArray) -> Finding | None:
    """What is wrong with the size of a domain in metres, of points of shape (N, 2); None where nothing is."""
    extent = float(np.ptp(points, axis=0).max())
    if extent > 2.0 * PLANE_M:
        wide, most = extent / 1000.0, PLANE_M / 1000.0
        message = f"the domain is {wide:.0f} km wide; the plane of a mission ends {most:.0f} km from its middle"
        return Finding(path, message, "correct the point that is far off, or make several missions of it")
    if extent >= LEAST_EXTENT_M:
        return None
    message = f"the domain is {measure(extent)} m wide, less than {decimal(LEAST_EXTENT_M)} m: coordinates are metres"
    if not (np.abs(points) <= 180.0).all() or extent == 0.0:  # noqa: PLR2004 - the globe
        return Finding(path, message, "write all points in metres, x east and y north")
    swapped = listed((pair(point[::-1]) for point in points[:4]), most=4)
    hint = (
        "if these are degrees, write `corners: latitude_longitude` in `domain`, and the latitude first in every point: "
        f"of [longitude, latitude], the first are then {swapped}"
    )
    return Finding(path, f"{message}, and these look like degrees", hint)
