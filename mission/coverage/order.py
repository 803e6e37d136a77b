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

from mission.geometry.arrays import BoolArray, FloatArray, IntArray

TOURS: Final = 4
MOST_EXACT: Final = 12
"""Cells that are ordered exactly."""
_LONGEST_MOVED: Final = 3
_NOWHERE: Final = 1e6
_SEED: Final = 1
_KICKS: Final = 40
_FEWEST: Final = 4
_FARTHEST: Final = 30
"""Lanes between which two stretches lie that follow each other and are exchanged."""
_NEIGHBOURS: Final = 12
"""Of the links from each, the cheapest, that moves are looked for along."""
_MOST_ROUNDS: Final = 500
_STARTS: Final = 8
_LEAST_GAIN: Final = 1e-7


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
    moves = Moves(links)
    chain, cost = _best_tours(links, cells)
    for _ in range(_MOST_ROUNDS):
        moved, cheaper = _best_tours(links, moves.best(chain) // TOURS)
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
    """The chain after the best moves, until none helps; see ``Moves``."""
    return Moves(links).settled(chain)


def shaken(links: FloatArray, chain: IntArray) -> IntArray:
    """The chain after moves, with short stretches exchanged at random in between, from which moves go on.

    An exchange that does not pay, with all the moves that follow, is taken back (Martin, Otto and Felten, 1991).
    """
    # On the way to a better chain a link may be one that leads nowhere; in the end that costs too much.
    links = np.where(np.isfinite(links), links, _NOWHERE)
    moves, chance = Moves(links), np.random.default_rng(_SEED)
    chain = moves.settled(chain)
    least = _cost(links, chain)
    for _ in range(_KICKS if len(chain) > _FEWEST else 0):
        start = chance.integers(max(1, len(chain) - _FARTHEST + 1))
        begin, first, second = start + np.sort(chance.choice(min(_FARTHEST, len(chain)), 3, replace=False))
        kicked = np.concatenate((chain[:begin], chain[first:second], chain[begin:first], chain[second:]))
        moved = moves.settled(kicked)
        cost = _cost(links, moved)
        if cost < least - _LEAST_GAIN:
            chain, least = moved, cost
    return chain


def _cost(links: FloatArray, chain: IntArray) -> float:
    size = len(links) - 2
    return float(links[[size, *chain], [*chain, size + 1]].sum())


class Moves:
    """Moves of a chain: a few go elsewhere, either way round, or a stretch is flown the other way round.

    Looked at are those of which one new link leads to a near neighbour and is cheaper than an old link at one of its
    ends; what a move without such a link gains would come from nowhere (Lin and Kernighan, 1973).
    """

    def __init__(self, links: FloatArray) -> None:
        """Take links of shape (N + 2, N + 2), the last two the entry and the exit; i and i ^ 1 are the same both ways.

        Of i and i ^ 1 a chain holds at most one.
        """
        self._links, size = links, len(links) - 2
        near = np.argsort(links[: size + 1, :size], axis=1, kind="stable")[:, :_NEIGHBOURS]
        begins, ends = np.arange(size + 1).repeat(near.shape[1]), near.ravel()
        inner = begins < size
        begins, ends = (
            np.concatenate((begins, ends[inner] ^ 1, np.arange(size))),
            np.concatenate((ends, begins[inner] ^ 1, np.full(size, size + 1))),
        )
        self._begins, self._ends = np.divmod(np.unique(begins * (size + 2) + ends), size + 2)
        self._costs = links[self._begins, self._ends]

    def settled(self, chain: IntArray) -> IntArray:
        """The chain, shape (K,), after the best moves, until none gains."""
        for _ in range(_MOST_ROUNDS):
            moved = self.best(chain)
            if moved is chain:
                break
            chain = moved
        return chain

    def best(self, chain: IntArray) -> IntArray:
        """The chain, shape (K,), after the move that gains most; itself where none gains."""
        links, size = self._links, len(self._links) - 2
        ends = np.concatenate(([size], chain, [size + 1]))
        broken = links[ends[:-1], ends[1:]]
        first, last, gap, turn = self._candidates(ends, broken)
        if not len(first):
            return chain
        before, after = ends[first - 1], ends[last + 1]
        enter, leave = np.where(turn, ends[last] ^ 1, ends[first]), np.where(turn, ends[first] ^ 1, ends[last])
        opened, freed = broken[gap], broken[first - 1] + broken[last]
        # Where the gap is beside the stretch, the stretch stays there, and is turned round.
        stays = gap == last
        gains = np.where(
            stays,
            freed - links[before, enter] - links[leave, after],
            freed + opened - links[ends[gap], enter] - links[leave, ends[gap + 1]] - links[before, after],
        )
        if not gains.max() > _LEAST_GAIN:
            return chain
        best = int(gains.argmax())
        begin, end, place = int(first[best]) - 1, int(last[best]), int(gap[best])
        moved, rest = chain[begin:end], np.concatenate((chain[:begin], chain[end:]))
        place = begin if stays[best] else place - len(moved) if place > begin else place
        return np.concatenate((rest[:place], moved[::-1] ^ 1 if turn[best] else moved, rest[place:]))

    def _candidates(self, ends: IntArray, broken: FloatArray) -> tuple[IntArray, IntArray, IntArray, BoolArray]:
        """First and last place of stretches, the place after which each is to go, whether it is turned; shapes (M,)."""
        count, size = len(ends) - 2, len(self._links)
        place, turned = np.full(size, -1), np.zeros(size, dtype=np.bool_)
        place[ends], place[ends[1:-1] ^ 1] = np.arange(count + 2), np.arange(1, count + 1)
        turned[ends[1:-1] ^ 1] = True
        # What the old links cost that begin at each, and that end there.
        begun, ended = np.zeros(size), np.zeros(size)
        begun[ends[:-1]], ended[ends[1:]] = broken, broken
        begun[ends[1:-1] ^ 1], ended[ends[1:-1] ^ 1] = broken[:-1], broken[1:]
        used = (place[self._begins] >= 0) & (place[self._ends] >= 0)
        used &= self._costs < np.maximum(begun[self._begins], ended[self._ends])
        begins, ends_at = self._begins[used], self._ends[used]
        p, q, back, ahead = place[begins], place[ends_at], turned[begins], ~turned[ends_at]
        on, to, fro = ~back & ahead, ~back & ~ahead, back & ahead
        found = [(p[to] + 1, q[to], q[to], True), (p[fro], q[fro] - 1, q[fro] - 1, True)]
        for more in range(_LONGEST_MOVED):
            found += [
                (q[on], q[on] + more, p[on], False),
                (p[on] - more, p[on], q[on] - 1, False),
                (q[to] - more, q[to], p[to], True),
                (p[fro], p[fro] + more, q[fro] - 1, True),
            ]
        first, last, gap = (np.concatenate([row[i] for row in found]) for i in range(3))
        turn = np.repeat([row[3] for row in found], [len(row[0]) for row in found])
        sound = (first >= 1) & (first <= last) & (last <= count)
        sound &= (gap < first - 1) | (gap > last) | ((gap == last) & turn)
        return first[sound], last[sound], gap[sound], turn[sound]
