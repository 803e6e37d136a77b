"""Three-valued verdicts on a word while it is being spelled, and how far it has come.

A finite word is judged by its infinite continuations (Bauer, Leucker and Schallhart, "Runtime verification for LTL and
TLTL", 2011): it is *true* if all of them satisfy the formula, *false* if none does, and *open* otherwise. With a Büchi
automaton for the formula and one for its negation, both cleared of states from which nothing is accepted, the word is
false when the first has no run left on it, and true when the second has none. Continuations are over the letters of
the domain; that not every sequence of them can be flown is left out of account, so open may be said for a word whose
fate the map has sealed.
"""

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

from mission.logic.automata.automaton import CompiledAutomaton, states_with_nonempty_language
from mission.logic.automata.components import strong_components


class Verdict(StrEnum):
    """What is known of all continuations of a word."""

    TRUE = "true"
    FALSE = "false"
    OPEN = "open"


@dataclass(frozen=True)
class Progress:
    """How far the automaton of the formula has come.

    Attributes:
        done: Letters that brought it nearer to where it accepts for ever.
        total: How many of them the whole way takes at least.
        awaited: Region names any of which would bring it nearer; empty where none is needed, or any letter would do.
    """

    done: int
    total: int
    awaited: tuple[str, ...]


class _Runs:
    """The states that the runs of an automaton on one word have reached; dead ones are left out."""

    def __init__(self, automaton: CompiledAutomaton) -> None:
        alive = states_with_nonempty_language(automaton)
        self._targets: dict[tuple[int, int], set[int]] = {}
        rows = zip(automaton.sources.tolist(), automaton.letters.tolist(), automaton.targets.tolist(), strict=True)
        for source, letter, target in rows:
            if alive[source] and alive[target]:
                self._targets.setdefault((source, letter), set()).add(target)
        self.states = {state for state in automaton.initial.tolist() if alive[state]}

    def read(self, letter: int) -> None:
        """Go on by one letter, an index into the alphabet."""
        self.states = {target for state in self.states for target in self._targets.get((state, letter), ())}

    def edges(self) -> Iterable[tuple[int, int, int]]:
        """Every transition between living states as (source, letter, target)."""
        return ((source, letter, target) for (source, letter), found in self._targets.items() for target in found)


class FormulaWatch:
    """Reads a word letter by letter and says what is known of it.

    Args:
        automaton: Of the formula, over ``letters``.
        refutation: Of its negation, over the same.
        letters: The alphabet, sets of region names.
    """

    def __init__(
        self, automaton: CompiledAutomaton, refutation: CompiledAutomaton, letters: tuple[frozenset[str], ...]
    ) -> None:
        self._runs, self._refuting = _Runs(automaton), _Runs(refutation)
        self._letters = letters
        self._forwards: dict[int, list[tuple[int, int]]] = {}
        for source, letter, target in self._runs.edges():
            self._forwards.setdefault(source, []).append((letter, target))
        self._distance = self._distances(automaton)
        self._total = min((self._distance[state] for state in self._runs.states), default=0)

    def read(self, letter: int) -> None:
        """Go on by one letter, an index into the alphabet."""
        self._runs.read(letter)
        self._refuting.read(letter)

    @property
    def verdict(self) -> Verdict:
        """What is known of every continuation of the word read so far."""
        if not self._runs.states:
            return Verdict.FALSE
        return Verdict.OPEN if self._refuting.states else Verdict.TRUE

    @property
    def progress(self) -> Progress:
        """How far it has come, and what it waits for."""
        if not self._runs.states:
            return Progress(0, self._total, ())
        left = min(self._distance[state] for state in self._runs.states)
        done = max(0, self._total - left)
        if self.verdict is Verdict.TRUE:
            return Progress(self._total, self._total, ())
        return Progress(done, self._total, self._awaited())

    def _distances(self, automaton: CompiledAutomaton) -> dict[int, int]:
        """Letters from each living state to an accepting state that recurs."""
        successors = [[target for _, target in self._forwards.get(q, [])] for q in range(automaton.states)]
        backwards: dict[int, list[int]] = {}
        for source, targets in enumerate(successors):
            for target in targets:
                backwards.setdefault(target, []).append(source)
        recurring = [
            state
            for component in strong_components(successors, sorted(self._forwards))
            if len(component) > 1 or component[0] in successors[component[0]]
            for state in component
            if automaton.accepting[state]
        ]
        distance = dict.fromkeys(recurring, 0)
        queue = deque(recurring)
        while queue:
            state = queue.popleft()
            for source in backwards.get(state, ()):
                if source not in distance:
                    distance[source] = distance[state] + 1
                    queue.append(source)
        return distance

    def _awaited(self) -> tuple[str, ...]:
        """Names whose letters shorten the way to the next accepting state from where the best runs are."""
        ways = [
            (self._distance[target], letter)
            for state in self._runs.states
            for letter, target in self._forwards.get(state, [])
        ]
        nearest = min((distance for distance, _ in ways), default=0)
        helpful = {self._letters[letter] for distance, letter in ways if distance == nearest}
        # A letter that merely has more regions than one that helps as well asks for nothing new.
        fewest = [letter for letter in helpful if not any(other < letter for other in helpful)]
        return tuple(sorted({name for letter in fewest for name in letter}))
