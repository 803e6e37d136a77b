"""Lower bounds of the tours of a component, from distances to and from its acceptance marks alone.

A tour is a closed walk that bears every mark. Whatever the order in which it first bears them, the way from one mark
to the next costs at least what the cheapest way between *any* transitions with these marks does. Shortest tours of
such a table (Held and Karp, "A dynamic programming approach to sequencing problems", 1962) are therefore lower bounds,
and so are tours of the table that pass through a given state having borne given marks.
"""

from dataclasses import dataclass

import numpy as np

from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.planning.recurrence import Component, recurrent
from mission.planning.sweeps import Graph


@dataclass(frozen=True, eq=False)
class Marked:
    """A component with its distances to and from each mark.

    Attributes:
        component: The component.
        sets: Number of marks, K.
        graph: Its transitions.
        to: (K, n) cost of the cheapest walk from a state up to and with a transition that bears a mark.
        since: (K, n) cost of the cheapest walk to a state from the end of a transition that bears it.
        between: (K, K) cost of the cheapest walk from the end of one that bears the first mark up to and with one that
            bears the second; 0 where one transition bears both.
    """

    component: Component
    sets: int
    graph: Graph
    to: FloatArray
    since: FloatArray
    between: FloatArray

    @staticmethod
    def of(component: Component, sets: int) -> "Marked":
        """Measure a component: two sweeps for each mark."""
        weights = component.weights
        graph = Graph.from_edges(component.size, component.sources, component.targets, weights)
        backward = graph.reversed
        to, since, between = [], [], np.full((sets, sets), np.inf)
        for mark in range(sets):
            bears = _bearing(component, mark)
            rooted = backward.with_root(component.sources[bears], weights[bears])
            to.append(rooted.distances(np.array([component.size]))[:-1])
            since.append(graph.distances(np.unique(component.targets[bears])))
        for first in range(sets):
            bears = _bearing(component, first)
            for second in range(sets):
                onward = to[second][component.targets[bears]]
                both = component.marks[bears] >> second & 1 > 0
                between[first, second] = np.where(both & (first != second), 0.0, onward).min()
        return Marked(component, sets, graph, np.array(to), np.array(since), between)

    def anchors(self) -> tuple[int, IntArray]:
        """A mark, and states through one of which every tour goes just after a transition that bears it.

        A tour whose transitions do not all bear the mark enters it by a transition that follows one without it. The
        mark with the fewest such states is taken.
        """
        component = self.component
        chosen: list[IntArray] = []
        for mark in range(self.sets):
            bears = _bearing(component, mark)
            if self._tours_within(bears):
                entering = bears
            else:
                after_none = np.zeros(component.size, dtype=np.bool_)
                after_none[component.targets[~bears]] = True
                entering = bears & after_none[component.sources]
            chosen.append(np.unique(component.targets[entering]))
        best = min(range(self.sets), key=lambda mark: (len(chosen[mark]), mark))
        return best, chosen[best]

    def _tours_within(self, bears: BoolArray) -> bool:
        """Whether some tour is made of the given transitions alone."""
        component = self.component
        order = np.argsort(component.sources[bears], kind="stable")
        graph = Graph.from_edges(
            component.size, component.sources[bears], component.targets[bears], component.weights[bears]
        )
        return bool(recurrent(graph, component.marks[bears][order], (1 << self.sets) - 1).any())


@dataclass(frozen=True, eq=False)
class TourTable:
    """Shortest tours of the table between marks that begin and end at one of them, in parts.

    Attributes:
        marked: The component.
        anchor: The mark at which tours begin and end.
        first: ``first[S][j]``: least cost from the anchor until the marks of the set S have been borne, j as the last.
        rest: ``rest[R][i]``: least cost from having borne i until the marks of R have been, i and at last the anchor
            among them.
    """

    marked: Marked
    anchor: int
    first: FloatArray
    rest: FloatArray

    @staticmethod
    def of(marked: Marked, anchor: int) -> "TourTable":
        """Fill both tables, set by set in ascending order."""
        sets, between = marked.sets, marked.between
        first, rest = np.full((1 << sets, sets), np.inf), np.full((1 << sets, sets), np.inf)
        rest[1 << anchor, anchor] = 0.0
        for chosen in range(1, 1 << sets):
            members = [mark for mark in range(sets) if chosen >> mark & 1]
            for mark in members:
                others = chosen & ~(1 << mark)
                if not others:
                    first[chosen, mark] = between[anchor, mark]
                    continue
                first[chosen, mark] = (first[others] + between[:, mark]).min()
                if mark != anchor and others >> anchor & 1:
                    rest[chosen, mark] = (between[mark] + rest[others]).min()
        return TourTable(marked, anchor, first, rest)

    def order(self) -> list[int]:
        """The marks in the order of a shortest tour of the table, the anchor last."""
        left, mark, order = (1 << self.marked.sets) - 1, self.anchor, list[int]()
        while not order or mark != self.anchor:
            mark = int(np.argmin(self.marked.between[mark] + self.rest[left]))
            order.append(mark)
            left &= ~(1 << mark)
        return order

    def through(self, states: IntArray) -> FloatArray:
        """(2^K, n): bound of the tours through ``states`` (n,) that have borne just a set of marks since the anchor."""
        to, since = self.marked.to[:, states], self.marked.since[:, states]
        every = (1 << self.marked.sets) - 1
        bounds = np.empty((every + 1, len(states)))
        for borne in range(every + 1):
            before = since[self.anchor] if not borne else _least(self.first[borne], since)
            left = every & ~borne | 1 << self.anchor
            bounds[borne] = before + _least(self.rest[left], to)
        return bounds


def _least(costs: FloatArray, ways: FloatArray) -> FloatArray:
    """The least sum over the marks of a cost (K,) and a way (K, n), shape (n,)."""
    used = np.flatnonzero(np.isfinite(costs))
    if not len(used):
        return np.full(ways.shape[1], np.inf)
    least: FloatArray = (costs[used, None] + ways[used]).min(axis=0)
    return least


def _bearing(component: Component, mark: int) -> BoolArray:
    bears: BoolArray = component.marks >> mark & 1 > 0
    return bears
