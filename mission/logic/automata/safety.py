"""What a formula forbids in finite time: the bad prefixes of its words.

A finite word is a *bad prefix* where no infinite continuation over the given letters satisfies the formula (Kupferman
and Vardi, "Model checking of safety properties", 2001). After a bad prefix the three-valued monitor says false; as long
as a word has none, nothing was violated so far.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np

from mission.errors import AutomatonSizeError
from mission.logic.automata.automaton import CompiledAutomaton, GeneralisedBuchi, IntArray, MarkedEdge
from mission.logic.automata.lettered import Alphabet
from mission.logic.automata.rabin import DEAD, Rabin
from mission.logic.formula.word import Letter

MAX_STATES: Final = 4096
"""Sets of automaton states that are told apart."""

_States = frozenset[int]


@dataclass(frozen=True, eq=False)
class Safety:
    """A complete deterministic automaton that knows bad prefixes.

    Attributes:
        rows: Shape (S, letters), the state after each letter; the last state is that after a bad prefix.
        initial: The state before the first letter, the last one where nothing satisfies the formula.
    """

    rows: IntArray
    initial: int

    @property
    def bad(self) -> int:
        """The state after a bad prefix; every letter leads back to it."""
        return len(self.rows) - 1

    def refutation(self) -> CompiledAutomaton:
        """A Büchi automaton of the words that have a bad prefix."""
        states, letters = self.rows.shape
        return CompiledAutomaton(
            states=states,
            sources=np.repeat(np.arange(states), letters),
            letters=np.tile(np.arange(letters), states),
            targets=self.rows.ravel(),
            initial=np.array([self.initial]),
            accepting=np.arange(states) == self.bad,
        )

    def unviolated(self, letters: tuple[Letter, ...]) -> GeneralisedBuchi:
        """An automaton of the words over ``letters`` without a bad prefix; with one, it has no run.

        Raises:
            ValueError: Nothing satisfies the formula.
        """
        if self.initial == self.bad:
            raise ValueError("every word has a bad prefix")
        alphabet = Alphabet.of(tuple(sorted(frozenset().union(*letters))), letters)
        read: dict[tuple[int, int], list[int]] = {}
        for (state, letter), after in np.ndenumerate(self.rows[: self.bad]):
            if after != self.bad:
                read.setdefault((state, int(after)), []).append(letter)
        edges = tuple(MarkedEdge(q, alphabet.short_guard(read[q, after]), after, ()) for q, after in sorted(read))
        return GeneralisedBuchi(alphabet.propositions, self.bad, (self.initial,), 0, edges)

    def watched(self) -> Rabin:
        """A deterministic automaton of all words, which moves on with what may still become of them."""
        return Rabin(self.rows, np.zeros_like(self.rows), ((1, 0),), self.initial)

    def after(self, states: Iterable[int]) -> "Safety":
        """The same for words that go on from these states, whichever of them it is: bad where it is for one of them.

        Raises:
            AutomatonSizeError: As in ``safety_of``.
        """
        lost: _States = frozenset((self.bad,))

        def follow(here: _States, letter: int) -> _States:
            reached = frozenset(self.rows[sorted(here), letter].tolist())
            return lost if self.bad in reached else reached

        start = frozenset(states)
        return _explored(lost if self.bad in start else start, lost, self.rows.shape[1], follow)


def safety_of(automaton: Rabin) -> Safety:
    """The bad prefixes of the language of a deterministic automaton all of whose states accept something."""
    lost = automaton.size
    rows = np.vstack((automaton.targets, np.full(automaton.targets.shape[1], DEAD)))
    if automaton.initial == DEAD:
        rows = rows[-1:]
        lost = 0
    return Safety(np.where(rows == DEAD, lost, rows), lost if automaton.initial == DEAD else automaton.initial)


def _explored(start: _States, lost: _States, letters: int, follow: Callable[[_States, int], _States]) -> Safety:
    """The table of everything that can be reached from ``start``, with ``lost`` last."""
    found = [start] if start != lost else []
    numbers = {state: i for i, state in enumerate(found)}
    rows: list[list[int]] = []
    for here in found:  # grows meanwhile
        row = []
        for letter in range(letters):
            reached = follow(here, letter)
            if reached != lost and reached not in numbers:
                if len(found) >= MAX_STATES:
                    raise AutomatonSizeError(f"what is forbidden in finite time needs more than {MAX_STATES} states")
                numbers[reached] = len(found)
                found.append(reached)
            row.append(numbers.get(reached, -1))
        rows.append(row)
    rows.append([-1] * letters)
    table = np.array(rows, dtype=np.int64).reshape(len(rows), letters)
    table[table < 0] = len(found)
    return Safety(table, numbers.get(start, len(found)))
