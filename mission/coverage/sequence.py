"""All lanes in the order that they are flown in: cells by their tours, then lanes of their own fitted in."""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from scipy.sparse import coo_array
from scipy.spatial import KDTree

from mission.coverage.order import Tours, best_order, settled, shaken
from mission.coverage.pace import Pace
from mission.coverage.travel import Travel
from mission.coverage.ways import Network
from mission.errors import GeometryError
from mission.geometry.arrays import BoolArray, FloatArray, IntArray

_NO_WAY: Final = "no way leads to some lanes: free space has parts that do not meet"
_NEIGHBOURS: Final = 10
"""Ends of other lanes to which ways from the end of a lane are found, at first."""
_MORE: Final = 8
MOST_ALONE: Final = 10
"""So few lanes are ordered one by one, and exactly."""


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
        cells: How many cells they are in; the order of one's lanes leaves little to be found.
    """

    flights: IntArray
    exact: bool
    travel: Travel
    links_s: FloatArray
    lanes_s: float
    cells: int

    @property
    def duration_s(self) -> float:
        """What lanes and ways take, with the turns."""
        entry, leave = len(self.links_s) - 2, len(self.links_s) - 1
        return self.lanes_s + float(self.links_s[[entry, *self.flights], [*self.flights, leave]].sum())

    def settled(self) -> "Sequence":
        """The sequence after all moves of a few lanes, or turns of a stretch, that make it shorter."""
        return replace(self, flights=settled(self.links_s, self.flights))

    def shaken(self) -> "Sequence":
        """The same, with what is found from some worse sequences beside it."""
        return replace(self, flights=shaken(self.links_s, self.flights)) if self.cells > 1 else self.settled()


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
    if len(lanes.lanes_m) <= MOST_ALONE:
        alone = np.ones(len(lanes.lanes_m), dtype=np.bool_)
        lanes = replace(lanes, cell_of=np.arange(len(alone)), chained=alone)
    ends = lanes.lanes_m.reshape(-1, 2)
    places = np.concatenate((ends, [entry_m] if exit_m is None else [entry_m, exit_m]))
    part_of = np.concatenate((lanes.part_of.repeat(2), np.full(len(places) - len(ends), -1)))
    cells = _tours(lanes)
    corners = _corners(cells, len(ends), len(places))
    steps = lanes.lanes_m[:, 1] - lanes.lanes_m[:, 0]
    lengths = np.linalg.norm(steps, axis=1)
    units = (steps / lengths[:, None]).repeat(2, axis=0) * np.tile([[1.0], [-1.0]], (len(lengths), 1))
    entry, leave = len(ends), None if exit_m is None else len(ends) + 1
    own = np.flatnonzero(lanes.cell_of < 0)
    neighbours, chain = _NEIGHBOURS, None
    while chain is None:
        travel = Travel(places, part_of, grounds, free, _wanted(cells, corners, own, places, neighbours))
        if not np.isfinite(travel.lengths_m).all():
            raise GeometryError(_NO_WAY)
        times = travel.times_s(units, pace)
        chain, exact = _cells_in_order(cells, times, lengths / pace.speed_m_s, entry, leave)
        for lane in own:
            chain = None if chain is None else _fitted_in(chain, int(lane), times, entry, leave)
        neighbours *= _MORE
    links = np.full((entry + 2, entry + 2), np.inf)
    links[: entry + 1, :entry] = times[: entry + 1, :entry]
    links[:entry, entry + 1] = 0.0 if leave is None else times[:entry, leave]
    return Sequence(chain, exact, travel, links, float(lengths.sum()) / pace.speed_m_s, len(cells))


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


def _cells_in_order(
    cells: list[list[IntArray]], times: FloatArray, lasts_s: FloatArray, entry: int, leave: int | None
) -> tuple[IntArray, bool]:
    """The flights of all cells in the best order, and whether it is proved to be that."""
    if not cells:
        return np.empty(0, dtype=np.int64), True
    first, last = (np.array([[tour[end] for tour in tours] for tours in cells]) for end in (0, -1))
    inner = [[times[tour[:-1], tour[1:]].sum() + lasts_s[tour // 2].sum() for tour in tours] for tours in cells]
    costs = Tours(
        np.array(inner),
        times[entry, first],
        times[last[:, :, None, None], first],
        np.zeros(first.shape) if leave is None else times[last, leave],
    )
    order, tour, exact = best_order(costs)
    return np.concatenate([cells[i][j] for i, j in zip(order, tour, strict=True)]), exact


def _wanted(
    cells: list[list[IntArray]], corners: IntArray, own: IntArray, places: FloatArray, neighbours: int
) -> IntArray:
    """Pairs of places whose ways count, (P, 2): corners of cells, within cells, and places that are near each other.

    A lane of its own is fitted in between two that follow each other in a cell: where one of them is near to one of its
    ends, ways lead from both to both.
    """
    count = len(places)
    beside = [np.stack((tour[:-1] ^ 1, tour[1:]), axis=1) for tours in cells for tour in tours[::2]]
    mates = np.concatenate((np.empty((0, 2), dtype=np.int64), *beside))
    near = KDTree(places).query(places, k=min(neighbours + 1, count))[1].reshape(count, -1)
    found = [mates, np.stack((corners.repeat(len(corners)), np.tile(corners, len(corners))), axis=1)]
    found.append(np.stack((np.arange(near.size) // near.shape[1], near.ravel()), axis=1))
    if len(own):
        graph = coo_array((np.ones(len(mates)), mates.T), shape=(count, count))
        ends = np.concatenate((2 * own, 2 * own + 1))
        rows = np.arange(len(ends)).repeat(near.shape[1])
        to = coo_array((np.ones(len(rows)), (rows, near[ends].ravel())), shape=(len(ends), count)).tocsr()
        row, place = (to + to @ (graph + graph.T)).nonzero()
        found += [np.stack((ends[row] ^ flip, place), axis=1) for flip in (0, 1)]
    pairs = np.sort(np.concatenate(found), axis=1)
    keys = np.unique(pairs[pairs[:, 0] < pairs[:, 1]] @ [count, 1])
    return np.stack(np.divmod(keys, count), axis=1)


def _fitted_in(chain: IntArray, lane: int, times: FloatArray, entry: int, leave: int | None) -> IntArray | None:
    """The chain with a lane where it costs least; None where no way to it is known."""
    before = np.concatenate(([entry], chain))
    best, cheapest = None, np.inf
    for flight in (2 * lane, 2 * lane + 1):
        added = times[before, flight]
        added[:-1] += times[flight, chain] - times[before[:-1], chain]
        if leave is not None:
            added[-1] += times[flight, leave] - (times[before[-1], leave] if len(chain) else 0.0)
        if added.min() < cheapest:
            cheapest, place = float(added.min()), int(added.argmin())
            best = np.insert(chain, place, flight)
    return best
