"""Getting from lane to lane: inside the part of the ground that both are on, else through free space."""

from typing import Final

import numpy as np

from mission.coverage.pace import Pace
from mission.coverage.ways import Network, Ways
from mission.geometry.arrays import FloatArray, IntArray

_NEAR: Final = 1e-6
_FREE: Final = -1
_DIGITS: Final = 6
"""Of seconds: ways that are as long but for rounding are the same."""
_BETWEEN: Final = 1.25
"""What a way between lanes counts, beside those there and back: neighbours are to be photographed in the same light."""


class Travel:
    """Ways between the ends of n lanes, T = 2 n of them, and other places after them, as many as there are.

    A lane flown one way or the other is a flight: flight 2 i begins at the begin of lane i, flight 2 i + 1 at its end.
    So a flight begins at the end of its own number, and flight f ends where flight f ^ 1 begins.

    Attributes:
        places: How many places there are, T + O.
        lengths_m: Shape (P,), of each pair; infinite where there is no way.
    """

    def __init__(
        self, places_m: FloatArray, part_of: IntArray, grounds: list[Network], free: Network, pairs: IntArray
    ) -> None:
        """Find the ways.

        Args:
            places_m: Shape (T + O, 2).
            part_of: Shape (T + O,), part of the ground; -1 for places that lie anywhere.
            grounds: What sees what on each part.
            free: What sees what in free space.
            pairs: Shape (P, 2), places, the lesser first, in ascending order.
        """
        self.places = len(places_m)
        self._pairs = pairs
        self._keys = pairs @ [self.places, 1]
        self.lengths_m = np.full(len(pairs), np.inf)
        self._outwards = np.zeros((len(pairs), 2, 2))
        self._medium = np.full(len(pairs), _FREE)
        self._row = np.zeros(len(pairs), dtype=np.int64)
        self._ways: dict[int, Ways] = {}
        first, second = part_of[pairs].T
        for part, network in enumerate(grounds):
            self._take(part, network, places_m, np.flatnonzero((first == part) & (second == part)))
        self._take(_FREE, free, places_m, np.flatnonzero(~np.isfinite(self.lengths_m)))

    def _take(self, medium: int, network: Network, places_m: FloatArray, chosen: IntArray) -> None:
        ways = network.ways(places_m, self._pairs[chosen])
        self.lengths_m[chosen], self._outwards[chosen] = ways.lengths_m, ways.outwards
        self._medium[chosen], self._row[chosen] = medium, np.arange(len(chosen))
        self._ways[medium] = ways

    def _pair(self, begin: int, end: int) -> int:
        return int(np.searchsorted(self._keys, min(begin, end) * self.places + max(begin, end)))

    def line_m(self, begin: int, end: int) -> FloatArray:
        """The way from a place to another, shape (k, 2), of a pair that was asked for."""
        pair = self._pair(begin, end)
        line = self._ways[int(self._medium[pair])].line_m(int(self._row[pair]))
        return line if begin < end else line[::-1]

    def on_ground(self, begin: int, end: int) -> bool:
        """Whether the way from a place to another stays on the ground."""
        return bool(self._medium[self._pair(begin, end)] != _FREE)

    def times_s(self, headings: FloatArray, pace: Pace) -> FloatArray:
        """What it costs to go on from a flight to another, or to a place: shape (T + O, T + O).

        Infinite where there is no way, or none was asked for.

        Args:
            headings: Unit vectors of flights, shape (T, 2).
            pace: How fast that is, and what corners cost.
        """
        flights = len(headings)
        times = np.full((self.places, self.places), np.inf)
        for direction in (0, 1):
            begin, end = self._pairs[:, direction], self._pairs[:, 1 - direction]
            lane, on = begin < flights, end < flights
            arriving = np.where(lane[:, None], headings[np.where(lane, begin ^ 1, 0)], 0.0)
            onwards = np.where(on[:, None], headings[np.where(on, end, 0)], 0.0)
            near = (self.lengths_m < _NEAR)[:, None]
            leave = np.where(near, arriving, self._outwards[:, direction])
            reach = np.where(near, arriving, -self._outwards[:, 1 - direction])
            leaving = np.where(lane, (arriving * leave).sum(axis=1), np.nan)
            links = pace.link_s(self.lengths_m, leaving, np.where(on, (reach * onwards).sum(axis=1), np.nan))
            more = np.where(lane & on, _BETWEEN - 1.0, 0.0)
            times[np.where(lane, begin ^ 1, begin), end] = links + more * self.lengths_m / pace.speed_m_s
        return np.round(times, _DIGITS)
