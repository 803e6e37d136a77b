"""The product P = T x A (paper, Eq. 25) as a sparse graph, and distances in it.

A product state (x, q) is the number ``q * M + x``, so that the states that share an automaton state lie together:
most transitions move the vehicle and leave A where it is. Every transition is found by whole-array indexing. The
transition of P from a state to itself (A does not change under u_0) is left out of the graph, where it shortens
nothing.

A is deterministic, a conjunction of small automata: each way over triangles has one run in P, or none.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mission.errors import SearchSizeError
from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.logic.automata.conjunction import Conjunction
from mission.logic.automata.rabin import DEAD
from mission.planning.sweeps import Codes, Graph
from mission.planning.transition_system import TransitionSystem
from mission.planning.unavoidable import unavoidable, visited
from mission.spec.model import Semantics

MOST_SETS = 12
"""Sets of what must come again and again for which the best of all tours is looked for."""

MAX_STATES = 12_000_000
"""States of P at which its construction gives up."""


@dataclass(frozen=True, eq=False)
class Steps:
    """Transitions of P out of a sequence of states, ordered by state and then by control.

    Attributes:
        rows: (N,) index into the given sequence.
        controls: (N,) the control u of T.
        states: (N,) the product state that is entered.
        marks: (N,) the marks of the transition, as bits.
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
        automaton: A, over the numbers of the letters of T.
        start: The start triangle.
        semantics: Whether A first reads the label of the start triangle (standard) or not (paper).

    Attributes:
        initial: The product state before the first transition; none where A rejects the start's label.

    Raises:
        SearchSizeError: It has too many states.
    """

    def __init__(self, system: TransitionSystem, automaton: Conjunction, start: int, semantics: Semantics) -> None:
        self.system, self.automaton, self.start, self._semantics = system, automaton, start, semantics
        if self.full_size > MAX_STATES:
            raise SearchSizeError(
                f"{system.size:,} triangles times {automaton.size:,} states of the mission's automaton are more than "
                f"the search takes, {MAX_STATES:,}: give tasks that may be met in any order an order, fly them in "
                "several missions, or make the triangles of the domain fewer"
            )
        whole = automaton.whole
        read = whole.targets[:, system.letter_of].astype(np.int32)
        # _entered[q, x]: what entering triangle x in q makes of P's state; a last column for "no triangle".
        self._entered: Codes = np.full((whole.size, system.size + 1), DEAD, dtype=np.int32)
        triangles = np.arange(system.size, dtype=np.int32)
        self._entered[:, :-1] = np.where(read == DEAD, DEAD, read * np.int32(system.size) + triangles)
        if whole.initial == DEAD:
            first = DEAD
        elif semantics is Semantics.STANDARD:
            first = int(self._entered[whole.initial, start])
        else:
            first = whole.initial * system.size + start
        self.initial: Codes = np.array([first] if first != DEAD else [], dtype=np.int32)

    @property
    def full_size(self) -> int:
        """Number of states of P, reachable or not."""
        return self.system.size * self.automaton.size

    @cached_property
    def distances(self) -> FloatArray:
        """Cost of the cheapest way from the initial state to each state, (M * Q,); infinite where none leads."""
        return self.graph.distances(self.initial)

    @cached_property
    def nearest(self) -> FloatArray:
        """Cost of the cheapest way to each triangle, in whatever state of A, (M,)."""
        least: FloatArray = self.distances.reshape(self.automaton.size, -1).min(axis=0)
        return least

    def projected(self, numbers: Sequence[int], *, implied: bool) -> tuple["Product", FloatArray]:
        """The product with some parts of A alone, and the distances in P of what each of its states stands for.

        Args:
            numbers: The parts.
            implied: Whether loops must visit, besides, the regions that no loop can leave out that A accepts.
        """
        automaton, states = self.automaton.of_parts(numbers)
        if implied:
            known = {inside.tobytes() for inside in unavoidable(automaton.whole, self.system.letters)}
            room = MOST_SETS - max((inf.bit_count() for _, inf in automaton.whole.pairs), default=0)
            sets = [inside for inside in self._unavoidable if inside.tobytes() not in known][: max(0, room)]
            if sets:
                automaton, states = self.automaton.of_parts(numbers, [visited(sets)])
        distances = np.full((automaton.size, self.system.size), np.inf)
        np.minimum.at(distances, states, self.distances.reshape(self.automaton.size, -1))
        return self.along(automaton), distances.reshape(-1)

    @cached_property
    def _unavoidable(self) -> list[BoolArray]:
        return unavoidable(self.automaton.whole, self.system.letters)

    def along(self, automaton: Conjunction) -> "Product":
        """The product of the same flights with another automaton."""
        return Product(self.system, automaton, self.start, self._semantics)

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
        entered = self._entered[q[:, None], self.system.successors[x]]  # -1, no triangle, is the last column
        rows, controls = np.nonzero(entered != DEAD)
        targets = entered[rows, controls]
        letters = self.system.letter_of[self.parts(targets)[0]]
        marks = self.automaton.whole.marks[q[rows], letters]
        return Steps(rows, controls, targets, marks, self.system.weights[x[rows], controls])

    @cached_property
    def graph(self) -> Graph:
        """The transitions as a graph."""
        system = self.system
        rows, controls = system.transitions
        targets = np.take(self._entered, system.successors[rows, controls], axis=1)  # (q, transition of T)
        own = np.arange(self.automaton.size, dtype=np.int32)[:, None] * np.int32(system.size) + rows.astype(np.int32)
        there = (targets != DEAD) & (targets != own)
        kept = np.zeros(there.size + 1, dtype=np.int32)
        np.cumsum(there, out=kept[1:])
        first = np.searchsorted(rows, np.arange(system.size))
        begins = np.append(kept[(np.arange(self.automaton.size)[:, None] * len(rows) + first).ravel()], kept[-1])
        if system.uniform:
            return Graph(targets[there], begins, float(system.weights[0, 0]))
        costs = np.broadcast_to(system.weights[rows, controls].astype(np.float64), targets.shape)
        return Graph(targets[there], begins, costs[there])
