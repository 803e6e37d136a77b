"""The words that a map can spell, on a graph as small as the question allows."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

from mission.geometry.arrays import BoolArray, IntArray
from mission.logic.automata.rabin import DEAD, Rabin
from mission.logic.formula.word import LassoWord, Letter
from mission.planning.sweeps import Codes
from mission.planning.transition_system import TransitionSystem
from mission.spec.model import Semantics


@dataclass(frozen=True, eq=False)
class CoarseMap:
    """T with neighbouring triangles of one letter drawn together, in each of which the vehicle may stay.

    A formula without ``X`` cannot tell a stay from a way through triangles of one letter, so this graph spells a word
    that satisfies it if and only if T does. The start triangle stays by itself: in the paper's semantics its letter
    is not read, while that of a neighbour with the same letter is.

    Attributes:
        letters: The observations.
        letter_of: (N,) the letter of each node.
        sources: (E,) node that an edge leaves; stays are edges.
        targets: (E,) node that it enters.
        start: Node of the start triangle.
    """

    letters: tuple[Letter, ...]
    letter_of: IntArray
    sources: IntArray
    targets: IntArray
    start: int

    @staticmethod
    def of(system: TransitionSystem, start: int, *, keeps_triangles: bool) -> "CoarseMap":
        """The coarse map of T, or with ``keeps_triangles`` T itself, for formulas with ``X``."""
        rows, controls = np.nonzero(system.successors >= 0)
        ends = system.successors[rows, controls]
        alike = (system.letter_of[rows] == system.letter_of[ends]) & (rows != start) & (ends != start)
        drawn = alike & (not keeps_triangles)
        _, node_of = connected_components(_graph(rows[drawn], ends[drawn], system.size), directed=False)
        letter_of = np.zeros(int(node_of.max()) + 1, dtype=np.int64)
        letter_of[node_of] = system.letter_of
        edges = np.unique(np.column_stack((node_of[rows], node_of[ends])), axis=0).astype(np.int64)
        return CoarseMap(system.letters, letter_of, edges[:, 0], edges[:, 1], int(node_of[start]))

    def closed(self, names: frozenset[str]) -> BoolArray:
        """(N,) whether a node lies in any of the regions ``names``; the start never counts."""
        inside = np.array([bool(names & letter) for letter in self.letters])[self.letter_of]
        inside[self.start] = False
        return np.asarray(inside, dtype=np.bool_)

    def reached(self, closed: BoolArray) -> frozenset[str]:
        """Names of the regions to which a way leads from the start that enters no ``closed`` (N,) node."""
        usable = ~closed[self.targets]
        graph = _graph(self.sources[usable], self.targets[usable], len(self.letter_of))
        nodes = breadth_first_order(graph, self.start, return_predecessors=False)
        return frozenset[str]().union(*(self.letters[i] for i in np.unique(self.letter_of[nodes]).tolist()))

    def edges(self, automaton: Rabin) -> int:
        """How many transitions ``word`` looks at, at most."""
        return automaton.size * len(self.sources)

    def word(self, automaton: Rabin, closed: BoolArray, semantics: Semantics) -> LassoWord | None:
        """A word that ``automaton`` (over the letters of the map) accepts, spelled without ``closed`` (N,) nodes."""
        nodes, state = len(self.letter_of), automaton.initial
        if state != DEAD and semantics is Semantics.STANDARD:
            state = int(automaton.targets[state, self.letter_of[self.start]])
        if state == DEAD:
            return None
        usable = ~closed[self.targets]
        before, after = self.sources[usable], self.targets[usable]
        entered = automaton.targets[:, self.letter_of[after]]
        q, edge = np.nonzero(entered != DEAD)
        sources, targets = q * nodes + before[edge], entered[q, edge] * nodes + after[edge]
        marks, size = automaton.marks[q, self.letter_of[after[edge]]], automaton.size * nodes
        first = state * nodes + self.start
        order, parents = breadth_first_order(_graph(sources, targets, size), first)
        for fin, inf in automaton.pairs:
            kept = marks & fin == 0
            part = _Marked(sources[kept], targets[kept], marks[kept] & inf, size)
            heads = order[part.recurrent(inf)[order]]
            if len(heads):
                head = int(heads[0])
                way = _way(parents, first, head)
                if semantics is Semantics.PAPER:
                    way = way[1:]
                return LassoWord(self._spelled(way, nodes), self._spelled(part.around(head, inf), nodes))
        return None

    def _spelled(self, states: list[int], nodes: int) -> tuple[Letter, ...]:
        return tuple(self.letters[int(self.letter_of[state % nodes])] for state in states)


def _graph(sources: IntArray, targets: IntArray, size: int) -> "csr_array[np.float64, tuple[int, int]]":
    return coo_array((np.ones(len(sources)), (sources, targets)), shape=(size, size)).tocsr()


@dataclass(frozen=True, eq=False)
class _Marked:
    """A graph with marked edges: (E,) vertices that they leave and enter, and marks as bits; and how many vertices."""

    sources: IntArray
    targets: IntArray
    marks: IntArray
    size: int

    @cached_property
    def components(self) -> Codes:
        """(size,) the strongly connected component of each vertex."""
        graph = _graph(self.sources, self.targets, self.size)
        return connected_components(graph, directed=True, connection="strong")[1]

    @cached_property
    def inner(self) -> BoolArray:
        """(E,) whether an edge stays in its component."""
        return np.asarray(self.components[self.sources] == self.components[self.targets])

    def recurrent(self, every: int) -> BoolArray:
        """(size,) whether a loop through the vertex bears all marks of ``every``."""
        borne = np.full(self.size, -1)
        of_edge = self.components[self.sources[self.inner]]
        borne[of_edge] = 0
        np.bitwise_or.at(borne, of_edge, self.marks[self.inner])
        found: BoolArray = (borne == every)[self.components]
        return found

    def around(self, head: int, every: int) -> list[int]:
        """The vertices of such a loop from ``head``, in which it ends."""
        inside = self.inner & (self.components[self.sources] == self.components[head])
        sources, targets, marks = self.sources[inside], self.targets[inside], self.marks[inside]
        graph, way, left = _graph(sources, targets, self.size), [head], every
        while left or len(way) == 1 or way[-1] != head:
            order, parents = breadth_first_order(graph, way[-1])
            place = np.full(self.size, self.size)
            place[order] = np.arange(len(order))
            wanted = np.flatnonzero(marks & left if left else targets == head)
            nearest = int(wanted[np.argmin(place[sources[wanted]])])
            way += [*_way(parents, way[-1], int(sources[nearest]))[1:], int(targets[nearest])]
            left &= ~int(marks[nearest])
        return way[1:]


def _way(parents: Codes, begin: int, end: int) -> list[int]:
    """The states from ``begin`` to ``end`` along a breadth-first tree, both included."""
    way = [end]
    while way[-1] != begin:
        way.append(int(parents[way[-1]]))
    return way[::-1]
