"""Getting from lane to lane: inside the part of the ground that both are on, else through free space."""

from typing import Final

import numpy as np

from mission.coverage.coverage import Pace
from mission.coverage.ways import Network, Ways
from mission.geometry.arrays import BoolArray, FloatArray, IntArray

_NEAR: Final = 1e-6
_FREE: Final = -1


class Travel:
    """Ways between the ends of n lanes, T = 2 n of them, and other places after them, as many as there are.

    A lane flown one way or the other is a flight: flight 2 i begins at the begin of lane i, flight 2 i + 1 at its end.
    So a flight begins at the end of its own number, and flight f ends where flight f ^ 1 begins.

    Attributes:
        lengths_m: Shape (T + P, T + P), infinite where there is no way.
        leaving: Shape (T + P, T + P, 2), unit vector in which the way from i to j leaves i.
    """

    def __init__(
        self, places_m: FloatArray, part_of: IntArray, grounds: list[Network], free: Network, wanted: BoolArray
    ) -> None:
        """Find the ways.

        Args:
            places_m: Shape (T + P, 2).
            part_of: Shape (T + P,), part of the ground; -1 for places that lie anywhere.
            grounds: What sees what on each part.
            free: What sees what in free space.
            wanted: Shape (T + P, T + P), symmetric: the pairs that count.
        """
        count = len(places_m)
        self.lengths_m = np.full((count, count), np.inf)
        self.leaving = np.zeros((count, count, 2))
        self._medium = np.full((count, count), _FREE)
        self._ways: dict[int, tuple[Ways, IntArray]] = {}
        for part, network in enumerate(grounds):
            inside = np.flatnonzero(part_of == part)
            if len(inside):
                self._take(part, network.ways(places_m[inside], wanted[np.ix_(inside, inside)]), inside)
        rest = wanted & ~np.isfinite(self.lengths_m)
        outside = np.flatnonzero(rest.any(axis=1))
        if len(outside):
            self._take(_FREE, free.ways(places_m[outside], rest[np.ix_(outside, outside)]), outside)

    def _take(self, medium: int, ways: Ways, places: IntArray) -> None:
        fresh = ~np.isfinite(self.lengths_m[np.ix_(places, places)]) & np.isfinite(ways.lengths_m)
        first, second = places[np.nonzero(fresh)[0]], places[np.nonzero(fresh)[1]]
        self.lengths_m[first, second] = ways.lengths_m[fresh]
        self.leaving[first, second] = ways.leaving[fresh]
        self._medium[first, second] = medium
        self._ways[medium] = ways, places

    def line_m(self, begin: int, end: int) -> FloatArray:
        """The way from a place to another, shape (k, 2)."""
        ways, places = self._ways[int(self._medium[begin, end])]
        first, second = np.searchsorted(places, [begin, end])
        return ways.line_m(int(first), int(second))

    def on_ground(self, begin: int, end: int) -> bool:
        """Whether the way from a place to another stays on the ground."""
        return bool(self._medium[begin, end] != _FREE)

    def times_s(self, headings: FloatArray, pace: Pace) -> FloatArray:
        """What it costs to go on from a flight to another, or to a place: shape (T + P, T + P).

        Args:
            headings: Unit vectors of flights, shape (T, 2).
            pace: How fast that is, and what corners cost.
        """
        flights, count = len(headings), len(self.lengths_m)
        at = np.arange(count)
        at[:flights] ^= 1
        lengths = self.lengths_m[at]
        near = lengths < _NEAR
        arriving = np.zeros((count, 2))
        arriving[:flights] = headings
        leave = np.where(near[..., None], arriving, self.leaving[at])
        reach = np.where(near[..., None], arriving[:, None], -np.swapaxes(self.leaving, 0, 1)[at])
        times = lengths / pace.speed_m_s
        times[:flights] += pace.corner_s(arriving[:flights, None], leave[:flights])
        times[:, :flights] += pace.corner_s(reach[:, :flights], arriving[:flights])
        return times
