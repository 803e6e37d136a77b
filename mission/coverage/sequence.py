"""All lanes in the order that they are flown in: cells by their tours, then lanes of their own fitted in."""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from mission.coverage.coverage import Pace
from mission.coverage.order import Tours, best_order, settled
from mission.coverage.travel import Travel
from mission.coverage.ways import Network
from mission.errors import GeometryError
from mission.geometry.arrays import BoolArray, FloatArray, IntArray

_NO_WAY: Final = "no way leads to some lanes: free space has parts that do not meet"
_NEIGHBOURS: Final = 8
"""Ends of other lanes to which the ways from a lane of its own are found exactly."""


@dataclass(frozen=True, eq=False)
class Lanes:
    """Lanes as they are found, in no order yet.

    Attributes:
        lanes_m: Shape (n, 2, 2); lanes of a cell stand together, beside their neighbours, and point the same way.
        cell_of: Shape (n,), from 0 without gaps; -1 for lanes of their own.
        part_of: Shape (n,), the part of the ground each lies on.
        chained: Shape (n,), whether the cell is a chain, each lane begun where the last one ended.
    """

    lanes_m: FloatArray
    cell_of: IntArray
    part_of: IntArray
    chained: BoolArray


@dataclass(frozen=True, eq=False)
class Sequence:
    """Flights in order; see ``Travel`` for what a flight is.

    Attributes:
        flights: Shape (n,).
        exact: Whether the order of the cells is proved to be the best.
        travel: The ways: the entry comes after the ends of the lanes, then the exit.
        links_s: Shape (2 n + 2, 2 n + 2), from the end of a flight to the begin of another; last the entry and exit.
        lanes_s: What the lanes take.
    """

    flights: IntArray
    exact: bool
    travel: Travel
    links_s: FloatArray
    lanes_s: float

    @property
    def duration_s(self) -> float:
        """What lanes and ways take, with the turns."""
        entry, leave = len(self.links_s) - 2, len(self.links_s) - 1
        return self.lanes_s + float(self.links_s[[entry, *self.flights], [*self.flights, leave]].sum())

    def settled(self) -> "Sequence":
        """The sequence after all moves of a few lanes, or turns of a stretch, that make it shorter."""
        return replace(self, flights=settled(self.links_s, self.flights))


def sequence(
    lanes: Lanes,
    grounds: list[Network],
    free: Network,
    *,
    entry_m: FloatArray,
    exit_m: FloatArray | None,
    pace: Pace,
) -> Sequence:
    """Order lanes so that they take little time; see ``mission.coverage.order`` for how little.

    Raises:
        GeometryError: No way leads to some.
    """
    ends = lanes.lanes_m.reshape(-1, 2)
    places = np.concatenate((ends, [entry_m] if exit_m is None else [entry_m, exit_m]))
    part_of = np.concatenate((lanes.part_of.repeat(2), np.full(len(places) - len(ends), -1)))
    cells = _tours(lanes)
    corners = _corners(cells, len(ends), len(places))
    travel = Travel(places, part_of, grounds, free, _wanted(lanes, cells, corners, places))
    if not np.isfinite(travel.lengths_m[np.ix_(corners, corners)]).all():
        raise GeometryError(_NO_WAY)
    steps = lanes.lanes_m[:, 1] - lanes.lanes_m[:, 0]
    lengths = np.linalg.norm(steps, axis=1)
    units = steps / lengths[:, None]
    times = travel.times_s(np.stack((units, -units), axis=1).reshape(-1, 2), pace)
    entry, leave = len(ends), None if exit_m is None else len(ends) + 1
    chain, exact = np.empty(0, dtype=np.int64), True
    if cells:
        first, last = (np.array([[tour[end] for tour in tours] for tours in cells]) for end in (0, -1))
        inner = [
            [times[tour[:-1], tour[1:]].sum() + lengths[tour // 2].sum() / pace.speed_m_s for tour in tours]
            for tours in cells
        ]
        costs = Tours(
            np.array(inner),
            times[entry, first],
            times[last[:, :, None, None], first],
            np.zeros(first.shape) if leave is None else times[last, leave],
        )
        order, tour, exact = best_order(costs)
        chain = np.concatenate([cells[i][j] for i, j in zip(order, tour, strict=True)])
    for lane in np.flatnonzero(lanes.cell_of < 0):
        chain = _fitted_in(chain, int(lane), times, entry, leave)
    links = np.full((entry + 2, entry + 2), np.inf)
    links[: entry + 1, :entry] = times[: entry + 1, :entry]
    links[:entry, entry + 1] = 0.0 if leave is None else times[:entry, leave]
    return Sequence(chain, exact, travel, links, float(lengths.sum()) / pace.speed_m_s)


def _tours(lanes: Lanes) -> list[list[IntArray]]:
    """Of each cell its four tours, the second and the fourth those before them flown backwards."""
    found = []
    for cell in range(int(lanes.cell_of.max(initial=-1)) + 1):
        members = np.flatnonzero(lanes.cell_of == cell)
        turns = np.zeros(len(members), dtype=np.int64) if lanes.chained[members[0]] else np.arange(len(members)) % 2
        one = 2 * members + turns
        other = one if lanes.chained[members[0]] else one ^ 1
        found.append([one, one[::-1] ^ 1, other, other[::-1] ^ 1])
    return found


def _corners(cells: list[list[IntArray]], ends: int, places: int) -> IntArray:
    """Places where a tour begins or ends, and those that are no lane's end."""
    found = [tour[end] ^ flip for tours in cells for tour in tours for end, flip in ((0, 0), (-1, 1))]
    return np.concatenate((np.unique(found), np.arange(ends, places))).astype(np.int64)


def _wanted(lanes: Lanes, cells: list[list[IntArray]], corners: IntArray, places: FloatArray) -> BoolArray:
    """Pairs of places whose ways count: between corners of cells, within cells, to neighbours of lanes of their own."""
    wanted = np.zeros((len(places), len(places)), dtype=np.bool_)
    own = np.flatnonzero(lanes.cell_of.repeat(2) < 0)
    wanted[np.ix_(corners, corners)] = True
    for tours in cells:
        for tour in tours[::2]:
            wanted[tour[:-1] ^ 1, tour[1:]] = True
    if len(own):
        distances = np.linalg.norm(places[own, None] - places, axis=2)
        near = np.argsort(distances, axis=1, kind="stable")[:, : _NEIGHBOURS + 1]
        wanted[own[:, None], near] = True
    both: BoolArray = wanted | wanted.T
    np.fill_diagonal(both, False)
    return both


def _fitted_in(chain: IntArray, lane: int, times: FloatArray, entry: int, leave: int | None) -> IntArray:
    """The chain with a lane where it costs least."""
    before = np.concatenate(([entry], chain))
    best, cheapest = chain, np.inf
    for flight in (2 * lane, 2 * lane + 1):
        added = times[before, flight]
        added[:-1] += times[flight, chain] - times[before[:-1], chain]
        if leave is not None:
            added[-1] += times[flight, leave] - (times[before[-1], leave] if len(chain) else 0.0)
        if added.min() < cheapest:
            cheapest, place = float(added.min()), int(added.argmin())
            best = np.insert(chain, place, flight)
    if not np.isfinite(cheapest):
        raise GeometryError(_NO_WAY)
    return best
