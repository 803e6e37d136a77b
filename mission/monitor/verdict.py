"""Three-valued verdicts on a word while it is being spelled, and how far it has come.

A finite word is judged by its infinite continuations (Bauer, Leucker and Schallhart, "Runtime verification for LTL and
TLTL", 2011): it is *true* if all of them satisfy the specification, *false* if none does, and *open* otherwise. It is
false when a deterministic automaton of all of it, without states that accept nothing, has no run on it, which may be
where each conjunct alone could still be satisfied; and true when an automaton of the words that violate it, cleared of
states from which nothing is accepted, has no run left. Continuations are over the letters of the domain; that not every
sequence of them can be flown is left out of account, so open may be said for a word whose fate the map has sealed.
"""

from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum

from mission.logic.automata.automaton import CompiledAutomaton, states_with_nonempty_language
from mission.logic.automata.components import strong_components
from mission.logic.automata.rabin import DEAD, Rabin


class Verdict(StrEnum):
    """What is known of all continuations of a word."""

    TRUE = "true"
    FALSE = "false"
    OPEN = "open"


@dataclass(frozen=True)
class Progress:
    """How far the automata of the conjuncts have come.

    Attributes:
        done: Letters that brought them nearer to where they accept for ever.
        total: How many of them the whole way takes at least.
        awaited: Region names any of which would bring one nearer; empty where none is needed, or any letter would do.
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
        automata: Of the conjuncts of the specification, over ``letters``.
        whole: Of all of it, over the same, each of its states accepting something.
        refutation: Of what violates it, over the same.
        letters: The alphabet, sets of region names.
    """

    def __init__(
        self,
        automata: Sequence[CompiledAutomaton],
        whole: Rabin,
        refutation: CompiledAutomaton,
        letters: tuple[frozenset[str], ...],
    ) -> None:
        self._whole, self._state = whole, int(whole.initial)
        self._parts = [_Part(automaton, letters) for automaton in automata]
        self._refuting = _Runs(refutation)

    def read(self, letter: int) -> None:
        """Go on by one letter, an index into the alphabet."""
        if self._state != DEAD:
            self._state = int(self._whole.targets[self._state, letter])
        for part in self._parts:
            part.read(letter)
        self._refuting.read(letter)

    @property
    def verdict(self) -> Verdict:
        """What is known of every continuation of the word read so far."""
        if self._state == DEAD:
            return Verdict.FALSE
        return Verdict.OPEN if self._refuting.states else Verdict.TRUE

    @property
    def progress(self) -> Progress:
        """How far it has come, and what it waits for: of all conjuncts together."""
        total = sum(part.total for part in self._parts)
        verdict = self.verdict
        if verdict is not Verdict.OPEN:
            return Progress(total if verdict is Verdict.TRUE else 0, total, ())
        waiting = [part for part in self._parts if part.left] or self._parts
        names = {name for part in waiting for name in part.awaited}
        done = sum(max(0, part.total - part.left) for part in self._parts)
        return Progress(done, total, tuple(sorted(names)))


class _Part:
    """How far the automaton of one conjunct has come.

    Attributes:
        total: Letters to where it accepts for ever, from the start.
    """

    def __init__(self, automaton: CompiledAutomaton, letters: tuple[frozenset[str], ...]) -> None:
        self._runs, self._letters = _Runs(automaton), letters
        self._forwards: dict[int, list[tuple[int, int]]] = {}
        for source, letter, target in self._runs.edges():
            self._forwards.setdefault(source, []).append((letter, target))
        self._distance = self._distances(automaton)
        self.total = self.left

    def read(self, letter: int) -> None:
        """Go on by one letter."""
        self._runs.read(letter)

    @property
    def left(self) -> int:
        """Letters that are still needed."""
        return min((self._distance[state] for state in self._runs.states), default=0)

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

    @property
    def awaited(self) -> tuple[str, ...]:
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
