"""The product P = T x A (paper, Eq. 25): its transitions, and what of it can be reached.

A product state (x, q) is the number ``x * Q + q``. Transitions are not stored: both directions are computed for whole
sets of states at once from the arrays of T and A.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mission.geometry.arrays import BoolArray, IntArray
from mission.logic.automaton import CompiledAutomaton
from mission.planning.transition_system import TransitionSystem
from mission.spec.model import Semantics

UNREACHED = -1


@dataclass(frozen=True, eq=False)
class Steps:
    """Transitions of P out of, or into, a set of states.

    Attributes:
        rows: (N,) index into the given set.
        controls: (N,) the control u of T.
        states: (N,) the product state at the other end.
    """

    rows: IntArray
    controls: IntArray
    states: IntArray


class _Table:
    """Ragged rows: for each key the ascending values paired with it."""

    def __init__(self, keys: IntArray, values: IntArray, size: int) -> None:
        order = np.lexsort((values, keys))
        self._values = values[order]
        self._counts = np.bincount(keys, minlength=size)
        self._starts = np.cumsum(self._counts) - self._counts

    def take(self, keys: IntArray) -> tuple[IntArray, IntArray]:
        """All values of the ``keys`` (K,): index of the key and the value, both (N,)."""
        counts = self._counts[keys]
        rows = np.repeat(np.arange(len(keys)), counts)
        offsets = np.arange(len(rows)) - np.repeat(np.cumsum(counts) - counts, counts)
        return rows, self._values[self._starts[keys][rows] + offsets]


class Product:
    """P from one start triangle.

    Args:
        system: T.
        automaton: A, compiled to the letters of T.
        start: The start triangle.
        semantics: Whether A first reads the label of the start triangle (standard) or not (paper).
    """

    def __init__(
        self, system: TransitionSystem, automaton: CompiledAutomaton, start: int, semantics: Semantics
    ) -> None:
        self.system, self.automaton, self.start = system, automaton, start
        letters = len(system.letters)
        width = automaton.states * letters
        self._letters = letters
        self._forward = _Table(automaton.sources * letters + automaton.letters, automaton.targets, width)
        self._backward = _Table(automaton.targets * letters + automaton.letters, automaton.sources, width)
        across = system.successors[:, 1:]
        flows = np.flatnonzero(across.ravel() >= 0)
        self._entering = _Table(across.ravel()[flows], flows, system.size)
        initial = np.asarray(automaton.initial)
        if semantics is Semantics.STANDARD:
            _, initial = self.read(initial, np.full(len(initial), system.letter_of[start]))
        self.initial = start * automaton.states + np.unique(initial)

    @property
    def full_size(self) -> int:
        """Number of states of P, reachable or not."""
        return self.system.size * self.automaton.states

    @cached_property
    def distances(self) -> IntArray:
        """Number of transitions from the initial states to each state, (M * Q,); ``UNREACHED`` where none lead."""
        return self.distances_from(self.initial, self.full_size)

    @cached_property
    def reachable_size(self) -> int:
        """Number of states that can be reached."""
        return int(np.count_nonzero(self.distances != UNREACHED))

    def parts(self, states: IntArray) -> tuple[IntArray, IntArray]:
        """The triangles and the automaton states of product states."""
        return states // self.automaton.states, states % self.automaton.states

    def read(self, states: IntArray, letters: IntArray) -> tuple[IntArray, IntArray]:
        """What reading a letter in each of ``states`` (K,) leads to: index into them, and the state entered."""
        return self._forward.take(states * self._letters + letters)

    def out(self, states: IntArray) -> Steps:
        """All transitions that leave ``states``."""
        x, q = self.parts(states)
        targets = self.system.successors[x]
        rows, controls = np.nonzero(targets >= 0)
        entered = targets[rows, controls]
        again, reached = self.read(q[rows], self.system.letter_of[entered])
        return Steps(rows[again], controls[again], entered[again] * self.automaton.states + reached)

    def into(self, states: IntArray) -> Steps:
        """All transitions that enter ``states``."""
        x, q = self.parts(states)
        moved, flows = self._entering.take(x)
        rows = np.concatenate((np.arange(len(x)), moved))
        left = np.concatenate((x, flows // 3))
        controls = np.concatenate((np.zeros(len(x), dtype=np.int64), flows % 3 + 1))
        again, sources = self._backward.take(q[rows] * self._letters + self.system.letter_of[x[rows]])
        return Steps(rows[again], controls[again], left[again] * self.automaton.states + sources)

    def distances_from(self, states: IntArray, most: int) -> IntArray:
        """Breadth-first distances from a set of states, as far as ``most`` transitions; (M * Q,)."""
        distances = np.full(self.full_size, UNREACHED, dtype=np.int64)
        frontier = states
        distances[frontier] = 0
        for level in range(1, most + 1):
            entered = self.out(frontier).states
            frontier = np.unique(entered[distances[entered] == UNREACHED])
            if not len(frontier):
                break
            distances[frontier] = level
        return distances

    def stays(self, states: IntArray) -> BoolArray:
        """Whether u_0 leads each of ``states`` back to itself, (N,)."""
        x, q = self.parts(states)
        rows, reached = self.read(q, self.system.letter_of[x])
        found = np.zeros(len(states), dtype=np.bool_)
        found[rows[reached == q[rows]]] = True
        return found
