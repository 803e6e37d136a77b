"""The product P = T x A (paper, Eq. 25) as a sparse graph, and breadth-first distances in it.

A product state (x, q) is the number ``q * M + x``, so that the states that share an automaton state lie together:
most transitions move the vehicle and leave A where it is. Every transition is found by whole-array indexing, and every
sweep over the graph is one compiled breadth-first search. The transition of P from a state to itself (A does not
change under u_0) is left out of the graph, where it shortens nothing, and asked for with ``stays``.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

from mission.geometry.arrays import BoolArray, IntArray
from mission.logic.automaton import CompiledAutomaton
from mission.planning.transition_system import CONTROLS, TransitionSystem
from mission.spec.model import Semantics

Codes = NDArray[np.int32]
"""Product states, or distances of product states; half the memory of ``IntArray``."""

UNREACHED = -1


@dataclass(frozen=True, eq=False)
class Steps:
    """Transitions of P out of a sequence of states, ordered by state and then by control.

    Attributes:
        rows: (N,) index into the given sequence.
        controls: (N,) the control u of T.
        states: (N,) the product state that is entered.
    """

    rows: IntArray
    controls: IntArray
    states: Codes


class Product:
    """P from one start triangle.

    Args:
        system: T.
        automaton: A, compiled to the letters of T.
        start: The start triangle.
        semantics: Whether A first reads the label of the start triangle (standard) or not (paper).

    Attributes:
        initial: The product states before the first transition, ascending; none where A rejects the start's label.
    """

    def __init__(
        self, system: TransitionSystem, automaton: CompiledAutomaton, start: int, semantics: Semantics
    ) -> None:
        self.system, self.automaton, self.start = system, automaton, start
        choices = _choices(automaton, len(system.letters))
        # _entered[r, q, x]: what A's r-th choice makes of entering triangle x in q; a last column for "no triangle".
        self._entered: Codes = np.full((len(choices), automaton.states, system.size + 1), UNREACHED, dtype=np.int32)
        read = choices[:, :, system.letter_of]
        self._entered[..., :-1] = np.where(
            read == UNREACHED, UNREACHED, read * np.int32(system.size) + np.arange(system.size, dtype=np.int32)
        )
        initial = np.asarray(automaton.initial, dtype=np.int64)
        if semantics is Semantics.STANDARD:
            first = np.unique(self._entered[:, initial, start])
            self.initial: Codes = first[first != UNREACHED]
        else:
            self.initial = np.unique(initial * system.size + start).astype(np.int32)

    @property
    def full_size(self) -> int:
        """Number of states of P, reachable or not."""
        return self.system.size * self.automaton.states

    @cached_property
    def distances(self) -> Codes:
        """Number of transitions from the initial states to each state, (M * Q,); ``UNREACHED`` where none lead."""
        return self.distances_from(self.initial)

    @cached_property
    def reachable_size(self) -> int:
        """Number of states that can be reached."""
        return int(np.count_nonzero(self.distances != UNREACHED))

    @cached_property
    def accepting(self) -> Codes:
        """The accepting states that can be reached, ascending."""
        accepting = np.flatnonzero(self.automaton.accepting)
        which, triangles = np.nonzero(self.distances.reshape(self.automaton.states, -1)[accepting] != UNREACHED)
        return (accepting[which] * self.system.size + triangles).astype(np.int32)

    @cached_property
    def on_loops(self) -> BoolArray:
        """Whether a state lies on a loop that visits another state too, (M * Q,)."""
        indices, begins = self._graph
        _, components = connected_components(_matrix(indices, begins), directed=True, connection="strong")
        several: BoolArray = np.bincount(components)[components] > 1
        return several

    def parts(self, states: Codes) -> tuple[IntArray, IntArray]:
        """The triangles and the automaton states of product states."""
        automaton_states, triangles = np.divmod(states.astype(np.int64), self.system.size)
        return triangles, automaton_states

    def out(self, states: Codes) -> Steps:
        """All transitions that leave each of ``states``, the ones from a state to itself included."""
        x, q = self.parts(states)
        entered = self._entered[:, q[:, None], self.system.successors[x]]  # -1, no triangle, is the last column
        rows, controls, choices = np.nonzero(np.moveaxis(entered, 0, -1) != UNREACHED)
        return Steps(rows, controls, entered[choices, rows, controls])

    def stays(self, states: Codes) -> BoolArray:
        """Whether u_0 leads each of ``states`` back to itself, (N,)."""
        x, q = self.parts(states)
        back: BoolArray = (self._entered[:, q, x] == states).any(axis=0)
        return back

    def distances_from(self, sources: Codes) -> Codes:
        """Number of transitions from the nearest of ``sources`` to each state, (M * Q,)."""
        indices, begins = self._graph
        order, parents = _swept(indices, begins, sources)
        place = np.empty(len(begins), dtype=np.int32)
        place[order] = np.arange(len(order), dtype=np.int32)
        # Found in order, children of early states come early: a level ends where the last one's children end.
        family_ends = np.cumsum(np.bincount(place[parents[order[1:]]], minlength=len(order))) + 1
        ends = [0, 1]
        while ends[-1] > ends[-2]:
            ends.append(int(family_ends[ends[-1] - 1]))
        distances = np.full(len(begins), UNREACHED, dtype=np.int32)
        distances[order] = np.repeat(np.arange(-1, len(ends) - 2, dtype=np.int32), np.diff(ends))
        return distances[:-1]

    def on_shortest_ways(self, distances: Codes, ends: Codes) -> Codes:
        """The states on shortest ways to any of ``ends``, ordered by distance and number.

        Args:
            distances: As from ``distances_from``.
            ends: States, all at one distance.
        """
        indices, begins = self._graph
        before = np.where((distances >= 0) & (distances < distances[ends[0]]), distances, -3)
        ahead = np.repeat(before, np.diff(begins)) + 1 == distances[indices]
        kept = np.zeros(len(indices) + 1, dtype=np.int32)
        np.cumsum(ahead, out=kept[1:])
        backward = _matrix(indices[ahead], kept[begins]).tocsc()  # its columns are the rows of the reversed graph
        order, _ = _swept(backward.indices, backward.indptr, ends)
        found = np.sort(order[1:])
        ordered: Codes = found[np.argsort(distances[found], kind="stable")]
        return ordered

    @cached_property
    def _graph(self) -> tuple[Codes, Codes]:
        """The transitions as rows of a sparse matrix: states entered, and where each state's begin."""
        targets = np.take(self._entered, self.system.successors, axis=2, mode="wrap")  # (choice, q, x, control)
        for choice in targets[..., 0].reshape(len(targets), -1):
            choice[choice == np.arange(self.full_size, dtype=np.int32)] = UNREACHED
        rows = targets[0].reshape(self.full_size, CONTROLS) if len(targets) == 1 else _side_by_side(targets)
        there = rows != UNREACHED
        counts = there[:, 0].astype(np.int32)
        for column in range(1, rows.shape[1]):
            counts += there[:, column]
        begins = np.zeros(self.full_size + 1, dtype=np.int32)
        np.cumsum(counts, out=begins[1:])
        return rows[there], begins


def _choices(automaton: CompiledAutomaton, letters: int) -> Codes:
    """A's transitions as functions, (R, Q, letters): the state that each of at most R choices leads to."""
    keys = automaton.sources * letters + automaton.letters
    order = np.lexsort((automaton.targets, keys))
    keys = keys[order]
    rank = np.arange(len(keys)) - np.searchsorted(keys, keys)
    choices = np.full((int(rank.max(initial=0)) + 1, automaton.states * letters), UNREACHED, dtype=np.int32)
    choices[rank, keys] = automaton.targets[order]
    return choices.reshape(-1, automaton.states, letters)


def _side_by_side(targets: Codes) -> Codes:
    """From one table for each choice of A to one row for each state."""
    rows: Codes = np.moveaxis(targets, 0, -1).reshape(targets[0, ..., 0].size, -1)
    return rows


def _matrix(indices: Codes, begins: Codes) -> "csr_array[np.float64, tuple[int, int]]":
    size = len(begins) - 1
    ones = np.broadcast_to(np.float64(1.0), len(indices))  # one number in memory: no search reads it
    return csr_array((ones, indices, begins), shape=(size, size))


def _swept(indices: Codes, begins: Codes, sources: Codes) -> tuple[Codes, Codes]:
    """Breadth-first order from a state of its own, numbered last, that leads to all of ``sources``; and the parents."""
    graph = _matrix(np.append(indices, sources), np.append(begins, np.int32(begins[-1] + len(sources))))
    order, parents = breadth_first_order(graph, len(begins) - 1)
    return order, parents
