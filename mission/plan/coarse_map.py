"""The words that a map can spell, on a graph as small as the question allows."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

from mission.geometry.arrays import BoolArray, IntArray
from mission.logic.automata.automaton import CompiledAutomaton
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

    def word(self, automaton: CompiledAutomaton, closed: BoolArray, semantics: Semantics) -> LassoWord | None:
        """A word that ``automaton`` (over the letters of the map) accepts, spelled without ``closed`` (N,) nodes."""
        nodes, root = len(self.letter_of), automaton.states * len(self.letter_of)
        froms, tos = [np.full(0, root)], [np.full(0, root)]
        for letter in range(len(self.letters)):
            entering = (self.letter_of[self.targets] == letter) & ~closed[self.targets]
            reading = automaton.letters == letter
            froms.append(np.add.outer(automaton.sources[reading] * nodes, self.sources[entering]).ravel())
            tos.append(np.add.outer(automaton.targets[reading] * nodes, self.targets[entering]).ravel())
        begin = automaton.initial
        if semantics is Semantics.STANDARD:
            read = automaton.letters == self.letter_of[self.start]
            begin = np.unique(automaton.targets[read & np.isin(automaton.sources, automaton.initial)])
        sources = np.concatenate((*froms, np.full(len(begin), root)))
        targets = np.concatenate((*tos, begin * nodes + self.start))
        graph = _graph(sources, targets, root + 1)
        order, parents = breadth_first_order(graph, root)
        order = order[1:]
        heads = order[automaton.accepting[order // nodes] & _on_loops(graph, sources, targets)[order]]
        if not len(heads):
            return None
        head = int(heads[0])
        way = _way(parents, root, head)[1:]
        after, back = breadth_first_order(graph, head)
        closing = set(sources[targets == head].tolist())
        last = next(state for state in after.tolist() if state in closing)
        around = [*_way(back, head, last)[1:], head]
        if semantics is Semantics.PAPER:
            way = way[1:]
        return LassoWord(self._spelled(way, nodes), self._spelled(around, nodes))

    def _spelled(self, states: list[int], nodes: int) -> tuple[Letter, ...]:
        return tuple(self.letters[int(self.letter_of[state % nodes])] for state in states)


def _graph(sources: IntArray, targets: IntArray, size: int) -> "csr_array[np.float64, tuple[int, int]]":
    return coo_array((np.ones(len(sources)), (sources, targets)), shape=(size, size)).tocsr()


def _on_loops(graph: "csr_array[np.float64, tuple[int, int]]", sources: IntArray, targets: IntArray) -> BoolArray:
    _, components = connected_components(graph, directed=True, connection="strong")
    loops: BoolArray = np.bincount(components)[components] > 1
    loops[sources[sources == targets]] = True
    return loops


def _way(parents: Codes, begin: int, end: int) -> list[int]:
    """The states from ``begin`` to ``end`` along a breadth-first tree, both included."""
    way = [end]
    while way[-1] != begin:
        way.append(int(parents[way[-1]]))
    return way[::-1]
