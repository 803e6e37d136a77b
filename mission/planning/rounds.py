"""What a round of a loop does to the mission's automaton, wherever it begins.

A lasso over triangles repeats one loop for ever, and the automaton may take several rounds until it recurs. So a loop
is judged by what its word does to all states at once: a word *acts* as a function from states to states, with the marks
met on the way from each (the transition monoid; Perrin and Pin, "Infinite Words", 2004, chapter II). Actions that no
continuation tells apart are one: for each state, they make a finite automaton of the words that may be repeated from
there (Angluin and Fisman, "Learning regular omega languages", 2016). Those of a conjunction are made of those of its
parts, one beside the other.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from mission.errors import SearchSizeError
from mission.geometry.arrays import BoolArray, IntArray
from mission.logic.automata.conjunction import Conjunction, accepted_rounds, side_by_side
from mission.logic.automata.rabin import DEAD, Rabin, merged

MAX_ACTIONS: Final = 20_000
"""Actions that are told apart."""


class Rounds:
    """The actions of words over some letters, on the states that these letters lead to from some others.

    Action 0 is that of the empty word; the others are those of all words that do not end every run.

    Args:
        automaton: A.
        letters: (L,) numbers of the letters.
        states: States of A from which loops may begin.
        closing: Whether only words count that lead from the one state there is back to it; where they lead from others
            does not matter then.

    Attributes:
        table: (actions, L) the action of a word with one more letter; -1 where nothing is accepted any more.

    Raises:
        SearchSizeError: There are too many actions.
    """

    def __init__(self, automaton: Conjunction, letters: IntArray, states: IntArray, *, closing: bool = False) -> None:
        self._automaton = automaton
        self._actions = [
            _actions(part, letters, np.unique(automaton.digits[states, number]), closing=closing)
            for number, part in enumerate(automaton.parts)
        ]
        found = side_by_side([actions.table for actions in self._actions], MAX_ACTIONS)
        if found is None:
            raise _too_many()
        self._parts, self.table = found
        self._known: dict[int, BoolArray] = {}

    @property
    def size(self) -> int:
        """Number of actions."""
        return len(self.table)

    def accepted_by(self, number: int, state: int) -> BoolArray:
        """(actions,) whether a word of each action, repeated for ever, is accepted by a part of A from a state of A."""
        accepted = self._actions[number].accepted[:, self._automaton.digits[state, number]]
        return np.asarray(accepted[self._parts[:, number]], dtype=np.bool_)

    def accepted(self, state: int) -> BoolArray:
        """The same for all parts."""
        if state not in self._known:
            found = np.arange(self.size) > 0
            for number in range(len(self._automaton.parts)):
                found &= self.accepted_by(number, state)
            self._known[state] = found
        return self._known[state]


@dataclass(frozen=True, eq=False)
class _Actions:
    """Those of one automaton: ``table`` as that of Rounds; ``accepted`` (actions, Q)."""

    table: IntArray
    accepted: BoolArray


def _actions(part: Rabin, letters: IntArray, starts: IntArray, *, closing: bool) -> _Actions:
    states = starts if closing else _closed(part, letters, starts)
    width = len(states)
    queue = [np.concatenate((states, np.zeros(width, dtype=np.int64)))]
    number: dict[bytes, int] = {}
    rows = []
    for action in queue:
        there, marks = action[:width], action[width:]
        row = []
        for letter in letters.tolist():
            after = np.where(there == DEAD, DEAD, part.targets[there, letter])
            met = np.where(after == DEAD, 0, marks | part.marks[there, letter])
            longer = np.concatenate((after, met))
            key = longer.tobytes()
            if (after == DEAD).all():
                row.append(DEAD)
                continue
            if key not in number:
                number[key] = len(queue)
                queue.append(longer)
            row.append(number[key])
        rows.append(row)
        if len(queue) > MAX_ACTIONS:
            raise _too_many()
    every = np.array(queue)
    after = np.full((len(queue), part.size), DEAD, dtype=np.int64)
    marks = np.zeros_like(after)
    after[:, states], marks[:, states] = every[:, :width], every[:, width:]
    if closing:
        after[:, states] = np.where(after[:, states] == states, states, DEAD)
    accepted = accepted_rounds(part, after, marks)
    table = np.array(rows, dtype=np.int64).reshape(len(queue), len(letters))
    # The empty word is told apart from all others, for no loop spells it.
    told = np.hstack((accepted[:, states], np.arange(len(queue))[:, None] == 0))
    first, classes = merged(table, told)
    kept = table[first]
    return _Actions(np.where(kept == DEAD, DEAD, classes[kept]), accepted[first])


def _closed(part: Rabin, letters: IntArray, states: IntArray) -> IntArray:
    """The states of a part that some letters lead to from some states, these among them, ascending."""
    found = states
    while True:
        more = np.union1d(found, part.targets[found][:, letters])
        more = more[more != DEAD]
        if len(more) == len(found):
            return np.asarray(found, dtype=np.int64)
        found = more


def _too_many() -> SearchSizeError:
    return SearchSizeError(
        f"rounds of the loops in question can do more than {MAX_ACTIONS} different things to the mission's automaton: "
        "ask for fewer tasks that recur"
    )
