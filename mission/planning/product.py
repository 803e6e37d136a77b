"""The product P = T x A (paper, Eq. 25) as a sparse graph, and distances in it.

A product state (x, q) is the number ``q * M + x``, so that the states that share an automaton state lie together:
most transitions move the vehicle and leave A where it is. Every transition is found by whole-array indexing. The
transition of P from a state to itself (A does not change under u_0) is left out of the graph, where it shortens
nothing.

A has acceptance sets of transitions, any number of them (generalised Büchi); a Büchi automaton with accepting states
has one, the transitions that leave these. The sets that a transition belongs to are the bits of its ``marks``.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.logic.automata.automaton import CompiledAutomaton, CompiledGeneralised, generalised
from mission.planning.sweeps import Codes, Graph
from mission.planning.transition_system import CONTROLS, TransitionSystem
from mission.spec.model import Semantics

ABSENT = -1


@dataclass(frozen=True, eq=False)
class Steps:
    """Transitions of P out of a sequence of states, ordered by state and then by control.

    Attributes:
        rows: (N,) index into the given sequence.
        controls: (N,) the control u of T.
        states: (N,) the product state that is entered.
        marks: (N,) the acceptance sets that the transition belongs to, as bits.
        weights: (N,) what it costs.
    """

    rows: IntArray
    controls: IntArray
    states: Codes
    marks: IntArray
    weights: IntArray


class Product:
    """P from one start triangle.

    Args:
        system: T.
        automaton: A, compiled to the letters of T.
        start: The start triangle.
        semantics: Whether A first reads the label of the start triangle (standard) or not (paper).

    Attributes:
        initial: The product states before the first transition, ascending; none where A rejects the start's label.
        automaton: A with acceptance sets.
        all_marks: The bits of all acceptance sets, at least one: without any, every transition bears the first.
    """

    def __init__(
        self,
        system: TransitionSystem,
        automaton: CompiledAutomaton | CompiledGeneralised,
        start: int,
        semantics: Semantics,
    ) -> None:
        self.automaton = automaton if isinstance(automaton, CompiledGeneralised) else generalised(automaton)
        self.system, self.start = system, start
        self.all_marks = (1 << max(1, self.automaton.sets)) - 1
        choices, self._choice_marks = _choices(self.automaton, len(system.letters))
        # _entered[r, q, x]: what A's r-th choice makes of entering triangle x in q; a last column for "no triangle".
        shape = (len(choices), self.automaton.states, system.size + 1)
        self._entered: Codes = np.full(shape, ABSENT, dtype=np.int32)
        read = choices[:, :, system.letter_of]
        self._entered[..., :-1] = np.where(
            read == ABSENT, ABSENT, read * np.int32(system.size) + np.arange(system.size, dtype=np.int32)
        )
        initial = np.asarray(self.automaton.initial, dtype=np.int64)
        if semantics is Semantics.STANDARD:
            first = np.unique(self._entered[:, initial, start])
            self.initial: Codes = first[first != ABSENT]
        else:
            self.initial = np.unique(initial * system.size + start).astype(np.int32)

    @property
    def full_size(self) -> int:
        """Number of states of P, reachable or not."""
        return self.system.size * self.automaton.states

    @cached_property
    def distances(self) -> FloatArray:
        """Cost of the cheapest way from the initial states to each state, (M * Q,); infinite where none leads."""
        return self.graph.distances(self.initial)

    @cached_property
    def reachable_size(self) -> int:
        """Number of states that can be reached."""
        return int(np.count_nonzero(np.isfinite(self.distances)))

    def parts(self, states: IntArray | Codes) -> tuple[IntArray, IntArray]:
        """The triangles and the automaton states of product states."""
        automaton_states, triangles = np.divmod(states.astype(np.int64), self.system.size)
        return triangles, automaton_states

    def out(self, states: IntArray | Codes) -> Steps:
        """All transitions that leave each of ``states``, the ones from a state to itself included."""
        x, q = self.parts(states)
        entered = self._entered[:, q[:, None], self.system.successors[x]]  # -1, no triangle, is the last column
        rows, controls, choices = np.nonzero(np.moveaxis(entered, 0, -1) != ABSENT)
        targets = entered[choices, rows, controls]
        letters = self.system.letter_of[self.parts(targets)[0]]
        marks = self._choice_marks[choices, q[rows], letters]
        return Steps(rows, controls, targets, marks, self.system.weights[x[rows], controls])

    def accepting_stays(self, states: IntArray | Codes) -> BoolArray:
        """Whether u_0 for ever, at each of ``states``, is an accepting loop of one transition, (N,)."""
        x, q = self.parts(states)
        back = self._entered[:, q, x] == states
        marks = self._choice_marks[:, q, self.system.letter_of[x]]
        accepting: BoolArray = (back & (marks == self.all_marks)).any(axis=0)
        return accepting

    @cached_property
    def graph(self) -> Graph:
        """The transitions as a graph."""
        targets = np.take(self._entered, self.system.successors, axis=2, mode="wrap")  # (choice, q, x, control)
        for choice in targets[..., 0].reshape(len(targets), -1):
            choice[choice == np.arange(self.full_size, dtype=np.int32)] = ABSENT
        rows = targets[0].reshape(self.full_size, CONTROLS) if len(targets) == 1 else _side_by_side(targets)
        there = rows != ABSENT
        counts = there[:, 0].astype(np.int32)
        for column in range(1, rows.shape[1]):
            counts += there[:, column]
        begins = np.zeros(self.full_size + 1, dtype=np.int32)
        np.cumsum(counts, out=begins[1:])
        if self.system.uniform:
            return Graph(rows[there], begins, float(self.system.weights[0, 0]))
        # One weight for each entry of ``rows``: the choices of one control lie side by side.
        repeated = np.repeat(self.system.weights.astype(np.float64), len(targets), axis=1)
        weights = np.broadcast_to(repeated, (self.automaton.states, *repeated.shape)).reshape(rows.shape)
        return Graph(rows[there], begins, weights[there])


def mark_bits(automaton: CompiledGeneralised) -> IntArray:
    """The marks of A's transitions as bits, (N,); the first bit of each where A has no acceptance set."""
    if not automaton.sets:
        return np.ones(len(automaton.sources), dtype=np.int64)
    return np.asarray(automaton.marks @ (np.int64(1) << np.arange(automaton.sets, dtype=np.int64)))


def _choices(automaton: CompiledGeneralised, letters: int) -> tuple[Codes, IntArray]:
    """A's transitions as functions, (R, Q, letters): where each of at most R choices leads to, and its marks."""
    keys = automaton.sources * letters + automaton.letters
    order = np.lexsort((automaton.targets, keys))
    keys = keys[order]
    rank = np.arange(len(keys)) - np.searchsorted(keys, keys)
    shape = (int(rank.max(initial=0)) + 1, automaton.states * letters)
    choices = np.full(shape, ABSENT, dtype=np.int32)
    choices[rank, keys] = automaton.targets[order]
    marks = np.zeros(shape, dtype=np.int64)
    marks[rank, keys] = mark_bits(automaton)[order]
    return choices.reshape(-1, automaton.states, letters), marks.reshape(-1, automaton.states, letters)


def _side_by_side(targets: Codes) -> Codes:
    """From one table for each choice of A to one row for each state."""
    rows: Codes = np.moveaxis(targets, 0, -1).reshape(targets[0, ..., 0].size, -1)
    return rows
