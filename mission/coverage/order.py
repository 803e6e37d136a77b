"""The order of cells, and the corner at which each is begun: a generalised travelling salesman.

Each cell is flown in one of a few ways, its tours, of which exactly one is taken; see Bähnemann and others, "Revisiting
boustrophedon coverage path planning as a generalized traveling salesman problem" (2019). Few cells are solved exactly
by the dynamic programme of Held and Karp over sets of cells and last tours. More are improved from the nearest
neighbours' orders by moving chains of cells and turning stretches round, until no move helps; after each, the best tour
is taken of each cell, which for an order is a shortest path.
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np

from mission.geometry.arrays import FloatArray, IntArray

TOURS: Final = 4
MOST_EXACT: Final = 12
"""Cells that are ordered exactly."""
_LONGEST_MOVED: Final = 3
_MOST_ROUNDS: Final = 500
_STARTS: Final = 8
_LEAST_GAIN: Final = 1e-9


@dataclass(frozen=True, eq=False)
class Tours:
    """What it costs to fly K cells with four tours each; a cell that has fewer has some twice.

    The tours 2 i and 2 i + 1 of a cell are the same both ways, and every cost is the same both ways.

    Attributes:
        inner: Shape (K, 4), each tour.
        start: Shape (K, 4), from the entry to the begin of a tour.
        between: Shape (K, 4, K, 4), from the end of a tour to the begin of another.
        end: Shape (K, 4), from the end of a tour to the exit.
    """

    inner: FloatArray
    start: FloatArray
    between: FloatArray
    end: FloatArray

    def links(self) -> FloatArray:
        """Cost from tour to tour, all cells in one row, then the entry and the exit; shape (4 K + 2, 4 K + 2).

        Half of a tour counts before it and half after, so that a link is the same both ways.
        """
        size = self.inner.size
        links = np.full((size + 2, size + 2), np.inf)
        half = self.inner.reshape(-1) / 2.0
        links[:size, :size] = self.between.reshape(size, size) + half[:, None] + half
        links[size, :size] = self.start.reshape(-1) + half
        links[:size, size + 1] = self.end.reshape(-1) + half
        return links


def best_order(tours: Tours) -> tuple[IntArray, IntArray, bool]:
    """The cheapest order, the tour of each cell in that order, shapes (K,); and whether it is proved to be."""
    exact = len(tours.inner) <= MOST_EXACT
    chain = _exact(tours.links()) if exact else _improved(tours.links())
    return chain // TOURS, chain % TOURS, exact


def _exact(links: FloatArray) -> IntArray:
    size = len(links) - 2
    count = size // TOURS
    cell = np.arange(size) // TOURS
    best = np.full((1 << count, size), np.inf)
    parent = np.full((1 << count, size), -1)
    best[1 << cell, np.arange(size)] = links[size, :size]
    for flown in range(1, (1 << count) - 1):
        inside = (flown >> cell) & 1
        last, following = np.flatnonzero(inside), np.flatnonzero(inside == 0)
        reached = best[flown, last][:, None] + links[last[:, None], following]
        choice = reached.argmin(axis=0)
        cost = reached[choice, np.arange(len(following))]
        target = flown | (1 << cell[following])
        better = cost < best[target, following]
        best[target[better], following[better]] = cost[better]
        parent[target[better], following[better]] = last[choice[better]]
    flown, state = (1 << count) - 1, int((best[-1] + links[:size, -1]).argmin())
    chain = []
    while state >= 0:
        chain.append(state)
        flown, state = flown ^ (1 << (state // TOURS)), int(parent[flown, state])
    return np.array(chain[::-1])


def _improved(links: FloatArray) -> IntArray:
    size = len(links) - 2
    nearest = np.argsort(links[size, :size], kind="stable") // TOURS
    firsts = list(dict.fromkeys(nearest.tolist()))[:_STARTS]
    found = [_with_tours(links, _nearest_first(links, first)) for first in firsts]
    return min(found, key=lambda chain: chain[1])[0]


def _with_tours(links: FloatArray, cells: IntArray) -> tuple[IntArray, float]:
    """Move until no move helps, with the best tours after each: the tours in order, and what they cost."""
    chain, cost = _best_tours(links, cells)
    for _ in range(_MOST_ROUNDS):
        moved, cheaper = _best_tours(links, best_move(links, chain) // TOURS)
        if cheaper >= cost - _LEAST_GAIN:
            break
        chain, cost = moved, cheaper
    return chain, cost


def _nearest_first(links: FloatArray, first: int) -> IntArray:
    """Cells in the order of going always on to the one whose begin is cheapest."""
    size = len(links) - 2
    left = np.ones(size // TOURS, dtype=np.bool_)
    state, cells, choice = size, [], np.arange(size) // TOURS == first
    while left.any():
        state = int(np.where(choice, links[state, :size], np.inf).argmin())
        cells.append(state // TOURS)
        left[cells[-1]] = False
        choice = left.repeat(TOURS)
    return np.array(cells)


def _best_tours(links: FloatArray, cells: IntArray) -> tuple[IntArray, float]:
    """Of cells in an order the tours that cost least together, and that cost: a shortest path through their layers."""
    layers = cells[:, None] * TOURS + np.arange(TOURS)
    costs, choices = links[-2, layers[0]], []
    for before, after in pairwise(layers):
        reached = costs[:, None] + links[before[:, None], after]
        choices.append(reached.argmin(axis=0))
        costs = reached.min(axis=0)
    costs = costs + links[layers[-1], -1]
    tours = [int(costs.argmin())]
    for choice in reversed(choices):
        tours.append(int(choice[tours[-1]]))
    return layers[np.arange(len(layers)), tours[::-1]], float(costs.min())


def settled(links: FloatArray, chain: IntArray) -> IntArray:
    """The chain after the best moves, until none helps; see ``best_move``."""
    for _ in range(_MOST_ROUNDS):
        moved = best_move(links, chain)
        if np.array_equal(moved, chain):
            break
        chain = moved
    return chain


def best_move(links: FloatArray, chain: IntArray) -> IntArray:
    """The chain after the best of all moves: a few go elsewhere, or a stretch is flown the other way round.

    Args:
        links: Shape (N + 2, N + 2), the last two the entry and the exit; i and i ^ 1 are the same both ways.
        chain: Shape (K,), which of the N, in order.
    """
    ends = np.concatenate(([len(links) - 2], chain, [len(links) - 1]))
    count = len(chain)
    before, here, after = ends[:-2], chain, ends[2:]
    broken = links[ends[:-1], ends[1:]]
    # Row i, column j: the stretch from i to j is turned round.
    turned = broken[:-1, None] + broken[1:] - links[before[:, None], here ^ 1] - links[(here ^ 1)[:, None], after]
    turned[np.tril_indices(count, -1)] = -np.inf
    gains, best = _LEAST_GAIN, chain
    if turned.max() > gains:
        begin, end = divmod(int(turned.argmax()), count)
        gains = float(turned.max())
        best = np.concatenate((chain[:begin], chain[begin : end + 1][::-1] ^ 1, chain[end + 1 :]))
    for length in range(1, min(_LONGEST_MOVED, count - 1) + 1):
        # Row i, column j: those from i on go between j - 1 and j, counted as they stand.
        first, last = chain[: count - length + 1], chain[length - 1 :]
        freed = broken[: len(first)] + broken[length:] - links[ends[: len(first)], ends[length + 1 :]]
        inside = np.arange(count + 1) - np.arange(len(first))[:, None]
        for enter, leave, turn in ((first, last, False), (last ^ 1, first ^ 1, True)):
            gain = freed[:, None] + broken - links[ends[:-1], enter[:, None]] - links[leave[:, None], ends[1:]]
            gain[(inside >= 0) & (inside <= length)] = -np.inf
            if gain.max() > gains:
                begin, place = divmod(int(gain.argmax()), count + 1)
                gains = float(gain.max())
                moved = chain[begin : begin + length]
                rest = np.delete(chain, np.arange(begin, begin + length))
                best = np.insert(rest, place - length if place > begin else place, moved[::-1] ^ 1 if turn else moved)
    return best
