"""Which states of a deterministic automaton are no worse than others: step by step, or by what they accept.

Step by step is direct simulation (Dill, Hu and Wong-Toi, "Checking for language inclusion using simulation preorders",
1991). What a state accepts, and another one does not, shows in the product of the automaton with itself: some loop is
accepting on one side and not on the other (Clarke, Draghicescu and Kurshan, "A unified approach for showing language
containment and equivalence between various types of omega-automata", 1993).
"""

from dataclasses import dataclass
from functools import reduce
from operator import or_
from typing import Final

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

from mission.logic.automata.rabin import DEAD, BoolArray, IntArray, Pair, Rabin

_MOST_SIMULATED: Final = 400
"""States above which only equal ones are taken to simulate each other."""

_MOST_INCLUDED: Final = 60
"""States above which what they accept is compared by simulation alone."""

_MOST_LOOPS: Final = 1_000
"""Sets of loops that are looked at before accepting is compared by simulation alone."""


def simulated(part: Rabin) -> BoolArray:
    """(Q, Q) whether the second state simulates the first.

    It does if for each letter on which the other's run goes on, its own does with at least the marks that must come
    again and none of those that must not but the other's, and enters a state that simulates the one that the other
    enters. Then the other's word is accepted from it, and stays so when letters that lead to simulating states are
    read in between, ever so often, if these have none of the marks that must not come again.
    """
    order = np.eye(part.size, dtype=np.bool_)
    if part.size > _MOST_SIMULATED:
        return order
    fin, inf = (reduce(or_, (pair[place] for pair in part.pairs), 0) for place in (0, 1))
    sources, letters = np.nonzero(part.targets != DEAD)
    component = _components(sources, part.targets[sources, letters], part.size)
    # What is taken once only has no marks that matter: all of it counts as the worst, so that more is simulated.
    again = component[:, None] == component[part.targets]
    borne = np.where(again, part.marks, fin & ~inf)
    order = np.ones_like(order)
    for entered, marks in zip(part.targets.T, borne.T, strict=True):
        worse = (marks[:, None] & inf & ~marks[None]) | (marks[None] & fin & ~marks[:, None])
        order &= (entered == DEAD)[:, None] | ((entered != DEAD)[None] & (worse == 0))
    while True:
        before = order.copy()
        for entered in part.targets.T:
            order &= (entered == DEAD)[:, None] | before[entered[:, None], entered[None]]
        if (order == before).all():
            return order


def included(part: Rabin) -> BoolArray:
    """(Q, Q) whether every word that the first state accepts is accepted from the second, too.

    Of large automata, whether the second state simulates the first: then it is so.
    """
    if part.size > _MOST_INCLUDED:
        return simulated(part)
    size, letters = part.size, part.targets.shape[1]
    lost = size  # the second run has ended
    second = np.vstack((np.where(part.targets == DEAD, lost, part.targets), np.full(letters, lost)))
    marks = np.vstack((part.marks, np.zeros(letters, dtype=np.int64)))
    one, other, letter = (each.reshape(-1) for each in np.indices((size, size + 1, letters)))
    kept = part.targets[one, letter] != DEAD
    one, other, letter = one[kept], other[kept], letter[kept]
    product = _Product(
        sources=one * (size + 1) + other,
        targets=part.targets[one, letter] * (size + 1) + second[other, letter],
        of_one=part.marks[one, letter],
        of_other=marks[other, letter],
        ended=other == lost,
        size=size * (size + 1),
        pairs=part.pairs,
    )
    heads = product.heads()
    if heads is None:
        return simulated(part)
    told_apart = product.leading_to(heads).reshape(size, size + 1)[:, :size]
    return ~told_apart


@dataclass(frozen=True, eq=False)
class _Product:
    """Pairs of states and what a letter does to both.

    Attributes:
        sources: (E,) the pair before each edge.
        targets: (E,) the pair after it.
        of_one: (E,) marks of the first run.
        of_other: (E,) marks of the second.
        ended: (E,) whether the second run has ended: then it accepts nothing.
        size: Number of pairs.
        pairs: The condition of both.
    """

    sources: IntArray
    targets: IntArray
    of_one: IntArray
    of_other: IntArray
    ended: BoolArray
    size: int
    pairs: tuple[Pair, ...]

    def heads(self) -> BoolArray | None:
        """Pairs on loops that are accepting for the first run and not for the second; None where they are too many."""
        found = np.zeros(self.size, dtype=np.bool_)
        waiting = [(np.flatnonzero(self.of_one & fin == 0), inf) for fin, inf in self.pairs]
        for _ in range(_MOST_LOOPS):
            if not waiting:
                return found
            edges, inf = waiting.pop()
            component = _components(self.sources[edges], self.targets[edges], self.size)
            inner = edges[component[self.sources[edges]] == component[self.targets[edges]]]
            order = inner[np.argsort(component[self.sources[inner]], kind="stable")]
            cuts = np.flatnonzero(np.diff(component[self.sources[order]])) + 1
            for loops in np.split(order, cuts) if len(order) else []:
                if int(np.bitwise_or.reduce(self.of_one[loops])) & inf == inf:
                    waiting.extend((fewer, inf) for fewer in self._rejected(loops, found))
        return None

    def _rejected(self, loops: IntArray, found: BoolArray) -> list[IntArray]:
        """Mark pairs on loops that the second run does not accept; or fewer of the loops, where it might not."""
        met = int(np.bitwise_or.reduce(self.of_other[loops]))
        accepting = [inf for fin, inf in self.pairs if not met & fin and met & inf == inf]
        if not accepting or self.ended[loops[0]]:
            found[self.sources[loops]] = True
            return []
        marks = [1 << bit for bit in range(accepting[0].bit_length()) if accepting[0] >> bit & 1]
        return [loops[self.of_other[loops] & mark == 0] for mark in marks]

    def leading_to(self, heads: BoolArray) -> BoolArray:
        """The pairs that lead to some of them."""
        ends = np.flatnonzero(heads)
        rows = np.append(self.targets, np.full(len(ends), self.size))
        columns = np.append(self.sources, ends)
        graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(self.size + 1, self.size + 1)).tocsr()
        found = np.zeros(self.size + 1, dtype=np.bool_)
        found[breadth_first_order(graph, self.size, return_predecessors=False)] = True
        return found[:-1]


def _components(sources: IntArray, targets: IntArray, size: int) -> IntArray:
    graph = coo_array((np.ones(len(sources)), (sources, targets)), shape=(size, size)).tocsr()
    _, component = connected_components(graph, directed=True, connection="strong")
    return component.astype(np.int64)
