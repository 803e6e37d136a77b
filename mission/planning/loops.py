"""Loops over triangles, with what each word does to the automaton: the closed walks of best lassos, all of them.

A vertex is a triangle with the action of the word since the loop began (``rounds``), so that each walk is one way, and
a loop of a head (x, q) is a way from x with the empty word to x with an action whose repetition q accepts.
"""

from dataclasses import dataclass

import numpy as np

from mission.errors import SearchSizeError
from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.planning.chains import Ways
from mission.planning.product import Product
from mission.planning.rounds import Rounds
from mission.planning.sweeps import Graph

_MOST_EDGES = 12_000_000


@dataclass(frozen=True, eq=False)
class _Edges:
    sources: IntArray
    controls: IntArray
    targets: IntArray
    weights: FloatArray


class Loops:
    """The loops within some triangles.

    Args:
        product: P.
        kept: (M,) the triangles.
        states: States of A from which loops may begin.
        closing: Whether loops must bring A back to the one state that there is.

    Raises:
        SearchSizeError: There are too many triangles times actions.
    """

    def __init__(self, product: Product, kept: BoolArray, states: IntArray, *, closing: bool = False) -> None:
        system = product.system
        self._triangles = np.flatnonzero(kept)
        letters, letter = np.unique(system.letter_of[self._triangles], return_inverse=True)
        self.rounds = Rounds(product.automaton, letters, states, closing=closing)
        number = np.full(system.size + 1, -1, dtype=np.int64)
        number[self._triangles] = np.arange(len(self._triangles))
        self._number = number
        after = number[system.successors[self._triangles]]
        x, controls = np.nonzero(after >= 0)
        if self.rounds.size * len(x) > _MOST_EDGES:
            raise SearchSizeError(
                f"the best loops are among too many: {len(self._triangles):,} triangles and {self.rounds.size:,} "
                "things that rounds do to the mission's automaton are in question; ask for fewer tasks that recur"
            )
        y = after[x, controls]
        action = self.rounds.table[:, letter[y]]
        before, edge = np.nonzero(action >= 0)
        sources = before * len(self._triangles) + x[edge]
        targets = action[before, edge] * len(self._triangles) + y[edge]
        moves = sources != targets
        edge = edge[moves]
        weights = system.weights[self._triangles[x], controls].astype(np.float64)[edge]
        self._edges = _Edges(sources[moves], controls[edge], targets[moves], weights)
        self._size = self.rounds.size * len(self._triangles)
        self._graph = Graph.from_edges(self._size, sources[moves], targets[moves], weights)
        self._backward = self._graph.reversed

    def costs(self, triangle: int) -> FloatArray:
        """(actions,) the cost of the cheapest loop from a triangle with each action."""
        place = self._number[triangle]
        if place < 0:
            return np.full(self.rounds.size, np.inf)
        found = self._graph.distances(np.array([place])).reshape(self.rounds.size, -1)[:, place]
        found[0] = np.inf  # no loop is empty
        return np.asarray(found)

    def ways(self, triangle: int, actions: IntArray, cost: float) -> Ways:
        """The loops from a triangle of one cost, the least, and of any of ``actions``, as ways."""
        edges, place = self._edges, int(self._number[triangle])
        goals = actions * len(self._triangles) + place
        onward, back = self._graph.distances(np.array([place])), self._backward.distances(goals)
        used = onward[edges.sources] + edges.weights + back[edges.targets] == cost
        vertices = np.flatnonzero(onward + back == cost)
        number = np.full(self._size, -1, dtype=np.int64)
        number[vertices] = np.arange(len(vertices))
        action, at = np.divmod(vertices, len(self._triangles))
        return Ways(
            triangles=self._triangles[at],
            order=action,
            distances=onward[vertices],
            sources=number[edges.sources[used]],
            controls=edges.controls[used],
            targets=number[edges.targets[used]],
            ends=number[goals],
        )
