"""Complements of Büchi automata, over the letters that really occur.

A plan is proved, and a flight is judged early, by an automaton of the words that must not be. Of a formula that is the
automaton of its negation; an automaton that comes without a formula must be complemented. The words of a map use a
handful of letters, so the complement is taken over these alone, and states that no accepting run over them needs are
taken away first. Then, in the order of what comes cheap:

- *Weak*, where the cycles of a component are all accepting or none is: a word is rejected if every run leaves the
  accepting components again and again. The set of the runs, with those that still owe this, tells when all of them
  have done it (Miyano and Hayashi, "Alternating finite automata on omega-words", 1984). The result is deterministic.
- *Deterministic*, with any number of acceptance sets: a word is rejected if its run ends, or if there are a set and a
  moment after which the run never meets the set. The complement guesses both, with as many states for each set, and
  once more, as the automaton has (Kurshan, "Complementing deterministic Büchi automata in polynomial time", 1987).
- *Any other* is made a deterministic parity automaton (``determinisation``). A word is rejected if the least priority
  that it has again and again is odd: the complement guesses it, and when no lower one will come.
"""

from collections.abc import Iterable, Iterator, Sequence
from typing import Final, Protocol, TypeVar

import numpy as np

from mission.errors import AutomatonSizeError
from mission.logic.automata.automaton import (
    BuchiAutomaton,
    Edge,
    GeneralisedBuchi,
    compile_to_alphabet,
    states_with_nonempty_language,
)
from mission.logic.automata.components import strong_components
from mission.logic.automata.conversion import with_marked_transitions
from mission.logic.automata.degeneralisation import degeneralised
from mission.logic.automata.determinisation import ParityAutomaton, determinised
from mission.logic.automata.diagrams import TooLargeError
from mission.logic.automata.lettered import Alphabet, Lettered, bits_of
from mission.logic.automata.simulation import reduced
from mission.logic.automata.structure import state_based, structure_of
from mission.logic.formula.word import Letter

MAX_STATES: Final = 10_000
"""States of a complement, or of an automaton on the way to it, at which its construction gives up."""

_MAX_TRANSITIONS: Final = 400_000

_State = TypeVar("_State")


def complement(automaton: GeneralisedBuchi, letters: Sequence[Letter]) -> BuchiAutomaton:
    """A Büchi automaton of the words over ``letters`` that ``automaton`` does not accept.

    What it says of words with other letters means nothing.

    Args:
        automaton: Any automaton.
        letters: At least one; what they hold beside the automaton's propositions plays no part.

    Raises:
        AutomatonSizeError: The complement would be too large.
    """
    alphabet = Alphabet.of(automaton.propositions, letters)
    try:
        return _complement(Lettered.of(automaton, alphabet), alphabet)
    except TooLargeError as error:
        raise AutomatonSizeError(
            "the proof of a plan needs the automaton of all words that the mission's automaton does not accept, which "
            f"has more than {MAX_STATES} states or too many transitions; give a smaller automaton, or a deterministic "
            "one"
        ) from error


def _complement(given: Lettered, alphabet: Alphabet) -> BuchiAutomaton:
    found = _of_simple(given, alphabet)
    if found is None:
        structure = structure_of(given.written(alphabet))
        small = state_based(reduced(degeneralised(structure, range(structure.sets))))
        machine = Lettered.of(with_marked_transitions(small), alphabet)
        found = _of_simple(machine, alphabet)
        if found is None:
            found = _explored(_OfParity(determinised(machine, alphabet.size, MAX_STATES)), alphabet)
    return found


def _of_simple(machine: Lettered, alphabet: Alphabet) -> BuchiAutomaton | None:
    """The complement of a weak or of a deterministic automaton; None of another one."""
    lasting = machine.lasting()
    if lasting is not None:
        return _explored(_OfWeak(machine, lasting), alphabet)
    return _explored(_OfDeterministic(machine), alphabet) if machine.deterministic else None


class _Construction(Protocol[_State]):
    """A Büchi automaton whose states are found on the way."""

    def initial(self) -> _State:
        """Where runs begin."""
        ...

    def after(self, state: _State, letter: int) -> Iterable[_State]:
        """What a letter leads to."""
        ...

    def accepting(self, state: _State) -> bool:
        """Whether runs that meet the state again and again are accepting."""
        ...


def _explored(construction: _Construction[_State], alphabet: Alphabet) -> BuchiAutomaton:
    """The part of a construction that can be reached, without states that accept nothing."""
    queue = [construction.initial()]
    number = {queue[0]: 0}
    read: dict[tuple[int, int], list[int]] = {}
    transitions = 0
    for source, state in enumerate(queue):
        for letter in range(alphabet.size):
            for target in construction.after(state, letter):
                if target not in number:
                    number[target] = len(queue)
                    queue.append(target)
                read.setdefault((source, number[target]), []).append(letter)
                transitions += 1
        if len(queue) > MAX_STATES or transitions > _MAX_TRANSITIONS:
            raise TooLargeError
    accepting = frozenset(index for index, state in enumerate(queue) if construction.accepting(state))
    edges = tuple(Edge(source, alphabet.short_guard(read[source, target]), target) for source, target in sorted(read))
    return _trimmed(BuchiAutomaton(alphabet.propositions, len(queue), (0,), accepting, edges), alphabet)


def _trimmed(automaton: BuchiAutomaton, alphabet: Alphabet) -> BuchiAutomaton:
    """Without states from which nothing is accepted; one that has no edge where that is all of them."""
    alive = states_with_nonempty_language(compile_to_alphabet(automaton, alphabet.letters))
    if not alive[0]:
        return BuchiAutomaton(automaton.propositions, 1, (0,), frozenset(), ())
    number = {state: index for index, state in enumerate(np.flatnonzero(alive).tolist())}
    return BuchiAutomaton(
        automaton.propositions,
        len(number),
        (0,),
        frozenset(number[state] for state in automaton.accepting if state in number),
        tuple(
            Edge(number[edge.source], edge.guard, number[edge.target])
            for edge in automaton.edges
            if edge.source in number and edge.target in number
        ),
    )


class _OfDeterministic:
    """States are (0, q): the run is in q; (k, q): it is in q and will not meet set k - 1 again; (0, -1): it ended."""

    def __init__(self, machine: Lettered) -> None:
        self._machine = machine

    def initial(self) -> tuple[int, int]:
        return (0, self._machine.initial[0] if self._machine.initial else -1)

    def after(self, state: tuple[int, int], letter: int) -> Iterator[tuple[int, int]]:
        guess, q = state
        found = self._machine.moves[q][letter] if q >= 0 else ()
        if not found:
            if guess == 0:
                yield (0, -1)
            return
        ((target, marks),) = found
        if guess == 0:
            yield (0, target)
            yield from ((k + 1, target) for k in range(self._machine.sets))
        elif not marks >> guess - 1 & 1:
            yield (guess, target)

    def accepting(self, state: tuple[int, int]) -> bool:
        return state[0] > 0 or state[1] < 0


class _OfWeak:
    """States are pairs of bits: where runs are; and which of them have not left the accepting components yet."""

    def __init__(self, machine: Lettered, lasting: int) -> None:
        self._post = machine.posts()
        self._initial = bits_of(machine.initial)
        self._lasting = lasting

    def initial(self) -> tuple[int, int]:
        return (self._initial, self._initial & self._lasting)

    def after(self, state: tuple[int, int], letter: int) -> Iterator[tuple[int, int]]:
        runs, owing = state
        following = self._post(runs, letter)
        yield following, (self._post(owing, letter) if owing else following) & self._lasting

    def accepting(self, state: tuple[int, int]) -> bool:
        return not state[1]


class _OfParity:
    """States are (q, 0, False); and, once no lower priority than the odd p will come, (q, p, whether it just came)."""

    def __init__(self, machine: ParityAutomaton) -> None:
        self._moves = machine.moves
        edges = [(source, *move) for source, row in enumerate(machine.moves) for move in row]
        self._odd = sorted({priority for _, _, priority in edges if priority % 2})
        # For each odd priority, the components without a lower one in which it can come again and again.
        self._home: dict[tuple[int, int], int] = {}
        for odd in self._odd:
            above = [[target for target, priority in row if priority >= odd] for row in machine.moves]
            parts = strong_components(above, range(len(above)))
            home = {state: index for index, part in enumerate(parts) for state in part}
            good = {home[q] for q, target, priority in edges if priority == odd and home[q] == home[target]}
            self._home.update({(state, odd): part for state, part in home.items() if part in good})

    def initial(self) -> tuple[int, int, bool]:
        return (0, 0, False)

    def after(self, state: tuple[int, int, bool], letter: int) -> Iterator[tuple[int, int, bool]]:
        q, guess, _ = state
        target, priority = self._moves[q][letter]
        if not guess:
            yield (target, 0, False)
            yield from ((target, odd, False) for odd in self._odd if (target, odd) in self._home)
        elif priority >= guess and self._home.get((target, guess)) == self._home[q, guess]:
            yield (target, guess, priority == guess)

    def accepting(self, state: tuple[int, int, bool]) -> bool:
        return state[2]
