"""Coordinates that are no metres from a corner of the domain: degrees, and those of a map projection."""

from typing import Any, Final

import numpy as np

from mission.decimals import decimal, measure
from mission.geometry.arrays import FloatArray
from mission.spec.finding import Finding, Path, listed
from mission.spec.schema import MAX_COORDINATE_M

LEAST_EXTENT_M: Final = 1.0
"""A narrower domain is no place to fly in; in degrees, it is a hundred kilometres."""

_MOST_PROJECTED_M: Final = 2.0e7
"""Eastings and northings of the projections in use are less than half the Earth's circumference."""


def pair(point: Any) -> str:  # noqa: ANN401 - two numbers
    """A point as a mission file has it."""
    return f"[{decimal(point[0])}, {decimal(point[1])}]"


def scale_finding(path: Path, points: FloatArray) -> Finding | None:
    """What is wrong with a domain that is too small to be one in metres, shape (N, 2); None where nothing is."""
    extent = float(np.ptp(points, axis=0).max())
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


def projected_finding(data: Any) -> Finding | None:  # noqa: ANN401 - any JSON value
    """One finding for a domain in the coordinates of a map projection, None where it is not in such ones."""
    domain = data.get("domain") if isinstance(data, dict) else None
    for key in ("nodes", "boundary"):
        points = _points(domain.get(key)) if isinstance(domain, dict) else None
        if points is None or not (np.abs(points) > MAX_COORDINATE_M).any(axis=1).all():
            continue
        if np.abs(points).max() > _MOST_PROJECTED_M:
            continue
        zero = np.floor(points.min(axis=0))
        first = pair(points[0] - zero)
        message = (
            f"the points are farther than {decimal(MAX_COORDINATE_M)} m from [0, 0], as those of a map projection are "
            "(easting, northing)"
        )
        hint = f"subtract {pair(zero)} from every point of the file; {pair(points[0])} is then {first}"
        return Finding(("domain", key), message, hint)
    return None


def _points(value: Any) -> FloatArray | None:  # noqa: ANN401 - any JSON value
    """A list of pairs of numbers as an array, None for anything else."""
    try:
        points = np.array(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        return None
    return points if points.ndim == 2 and points.shape[1] == 2 and np.isfinite(points).all() else None  # noqa: PLR2004
