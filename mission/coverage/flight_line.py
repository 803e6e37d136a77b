"""Flights in order, made lanes and ways that follow each other without a gap."""

from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely

from mission.coverage.sequence import Sequence
from mission.geometry.arrays import BoolArray, FloatArray

_STRAIGHT: Final = 1.0 - 1e-9
_BAND_M: Final = 1e-6
_OVERLAP_M: Final = 1e-3


@dataclass(frozen=True, eq=False)
class FlightLine:
    """Lanes and ways.

    Attributes:
        lanes_m: Shape (n, 2, 2), in the order flown.
        ways_m: Polylines: to the first lane, between lanes, and from the last where an exit is wanted.
    """

    lanes_m: FloatArray
    ways_m: list[FloatArray]

    @property
    def whole_m(self) -> FloatArray:
        """All of it, shape (p, 2)."""
        pieces = [piece for way, lane in zip(self.ways_m, self.lanes_m, strict=False) for piece in (way, lane)]
        return np.concatenate(pieces + self.ways_m[len(self.lanes_m) :])


def flight_line(order: Sequence, lanes_m: FloatArray, own: BoolArray) -> FlightLine:
    """Lay out flights.

    Args:
        order: The flights and the ways.
        lanes_m: Shape (n, 2, 2), as flights are numbered.
        own: Shape (n,), the lanes of their own, along rims. Where the way there, or from there, goes straight on over
            the ground, it becomes part of such a lane: it is flown anyway, and a camera is not switched in a turn.
    """
    flights, travel, count = order.flights, order.travel, len(lanes_m)
    ends = lanes_m.reshape(-1, 2)
    flown = np.stack((ends[flights], ends[flights ^ 1]), axis=1)
    begins = [2 * count, *(flights ^ 1)]
    targets = [*flights, *range(2 * count + 1, travel.places)]
    ways = [travel.line_m(begin, end) for begin, end in zip(begins, targets, strict=False)]
    for place in np.flatnonzero(own[flights // 2]):
        if place > 0 and travel.on_ground(begins[place], targets[place]):
            others = np.delete(flown, place, axis=0)
            flown[place, 0], ways[place] = _taken(flown[place], ways[place], others)
        if place < count - 1 and travel.on_ground(begins[place + 1], targets[place + 1]):
            others = np.delete(flown, place, axis=0)
            flown[place, 1], back = _taken(flown[place, ::-1], ways[place + 1][::-1], others)
            ways[place + 1] = back[::-1]
    return FlightLine(flown, ways)


def _taken(lane: FloatArray, way: FloatArray, others: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Where a lane begins that takes the last piece of the way there, if it goes straight on; and what is left."""
    last, length = way[-2:], np.linalg.norm(way[-1] - way[-2])
    along = (lane[1] - lane[0]) / np.linalg.norm(lane[1] - lane[0])
    band = shapely.buffer(shapely.linestrings(last), _BAND_M, cap_style="flat")
    flown = shapely.length(shapely.intersection(band, shapely.linestrings(others)))
    if (last[1] - last[0]) @ along < _STRAIGHT * length or flown.max(initial=0.0) > _OVERLAP_M:
        return lane[0], way
    return last[0], np.concatenate((way[:-1], last[:1]))
