"""Where a draft lies: points of a drawing, in metres of the mission's plane, and as they are written."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from mission.decimals import decimal
from mission.errors import Fault, SpecError
from mission.geometry.arrays import FloatArray
from mission.geometry.geodesy import PLANE_M, LatLon, place_at_offset
from mission.geometry.places import enu_offsets_m
from mission.interchange.features import Point
from mission.spec.geography import middle_of

_FAR_M: Final = 10_000.0
_DEGREE_DIGITS: Final = 7
_METRE_DIGITS: Final = 2


@dataclass(frozen=True)
class Frame:
    """The plane of a draft.

    Attributes:
        origin: Where its zero lies on Earth; None for drawings in metres.
        shift_m: What is taken from coordinates in metres, so that they are near zero.
    """

    origin: LatLon | None
    shift_m: Point = (0.0, 0.0)

    def metres(self, points: Sequence[Point]) -> FloatArray:
        """Points of a drawing, in metres of the plane, shape (N, 2)."""
        places = np.array(points, dtype=np.float64).reshape(-1, 2)
        if self.origin is None:
            shifted: FloatArray = places - self.shift_m
            return shifted
        return enu_offsets_m(self.origin, places[:, ::-1])[0]

    def as_drawn(self, point: Point) -> str:
        """A point of a drawing as the mission file has it, with the digits that the drawing has, to a tenth of a mm."""
        if self.origin is None:
            return f"[{decimal(point[0] - self.shift_m[0])}, {decimal(point[1] - self.shift_m[1])}]"
        return f"[{decimal(point[1])}, {decimal(point[0])}]"

    def as_made(self, point_m: FloatArray) -> str:
        """A point in metres that no drawing has, as the mission file has it, to a centimetre."""
        east, north = (float(value) for value in point_m)
        if self.origin is None:
            return f"[{decimal(round(east, _METRE_DIGITS))}, {decimal(round(north, _METRE_DIGITS))}]"
        place = place_at_offset(self.origin, east, north)
        latitude, longitude = (round(value, _DEGREE_DIGITS) for value in (place.latitude_deg, place.longitude_deg))
        return f"[{decimal(latitude)}, {decimal(longitude)}]"


def frame_of(points: Iterable[Point], *, in_degrees: bool) -> Frame:
    """The frame of all points that are drawn: about their middle, in degrees; about their corner, in metres far away.

    Raises:
        SpecError: They reach farther than the plane of a mission.
    """
    places = np.array(list(points), dtype=np.float64)
    if not in_degrees:
        low, high = places.min(axis=0), places.max(axis=0)
        apart_m = float(np.hypot(*(high - low)))
        far = bool((np.abs(places) > _FAR_M).any())
        frame = Frame(None, (float(np.floor(low[0])), float(np.floor(low[1]))) if far else (0.0, 0.0))
    else:
        origin = middle_of(places[:, ::-1])
        apart_m = 2.0 * float(enu_offsets_m(origin, places[:, ::-1])[1].max())
        frame = Frame(origin)
    if apart_m > PLANE_M:
        message = (
            f"what is drawn is {apart_m / 1000.0:.0f} km wide; the plane of a mission ends at {PLANE_M / 1000.0:.0f} km"
        )
        hint = "make several missions of it" + (", or say --metres if these are no degrees" if in_degrees else "")
        raise SpecError((Fault(0, 0, "", message, hint),))
    return frame
