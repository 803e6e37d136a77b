"""Generalised Büchi automata over a few numbered letters, as plain tables: the working form for complements."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cache, cached_property, reduce
from operator import or_

import numpy as np

from mission.logic.automata.automaton import GeneralisedBuchi, MarkedEdge, compile_generalised
from mission.logic.automata.components import backward_reachable, strong_components
from mission.logic.automata.guards import Cube, Guard
from mission.logic.formula.word import Letter

Moves = tuple[tuple[int, int], ...]
"""Pairs of a state that is entered and the bits of the acceptance sets that are met."""


@dataclass(frozen=True)
class Alphabet:
    """The letters that occur, as far as an automaton tells them apart."""

    propositions: tuple[str, ...]
    letters: tuple[Letter, ...]

    @staticmethod
    def of(propositions: tuple[str, ...], letters: Iterable[Letter]) -> "Alphabet":
        """Letters cut down to the propositions, each once."""
        names = frozenset(propositions)
        return Alphabet(propositions, tuple(dict.fromkeys(names & letter for letter in letters)))

    @property
    def size(self) -> int:
        """Number of letters."""
        return len(self.letters)

    def guard(self, read: Iterable[int]) -> Guard:
        """The guard that allows, of all letters there are, exactly those of these numbers."""
        return Guard(self.propositions, tuple(self._exact[letter] for letter in sorted(read)))

    def short_guard(self, read: Iterable[int]) -> Guard:
        """A guard that allows, of the letters that occur, exactly those of these numbers; others do not matter."""
        return Guard(self.propositions, tuple(self._short[letter] for letter in sorted(read)))

    @cached_property
    def _exact(self) -> tuple[Cube, ...]:
        whole = (1 << len(self.propositions)) - 1
        holding = (
            bits_of(bit for bit, name in enumerate(self.propositions) if name in letter) for letter in self.letters
        )
        return tuple((holds, whole ^ holds) for holds in holding)

    @cached_property
    def _short(self) -> tuple[Cube, ...]:
        """Cubes of fewer literals that still tell each letter from all others."""
        holding = [holds for holds, _ in self._exact]
        return tuple(_shortened(cube, [bits for bits in holding if bits != cube[0]]) for cube in self._exact)


def _shortened(cube: Cube, others: list[int]) -> Cube:
    """A cube without literals that it does not need to allow none of the other letters; first those that forbid."""
    holds, fails = cube
    for bit in states_of(fails):
        fewer = fails & ~(1 << bit)
        fails = fails if _allows_any(holds, fewer, others) else fewer
    for bit in states_of(holds):
        fewer = holds & ~(1 << bit)
        holds = holds if _allows_any(fewer, fails, others) else fewer
    return holds, fails


def _allows_any(holds: int, fails: int, letters: Iterable[int]) -> bool:
    return any(not holds & ~bits and not fails & bits for bits in letters)


@dataclass(frozen=True)
class Lettered:
    """An automaton without states that no accepting run needs.

    Attributes:
        initial: Initial states, ascending; none where nothing is accepted.
        sets: Number of acceptance sets.
        moves: The moves of each state for each letter.
    """

    initial: tuple[int, ...]
    sets: int
    moves: tuple[tuple[Moves, ...], ...]

    @staticmethod
    def of(automaton: GeneralisedBuchi, alphabet: Alphabet) -> "Lettered":
        """An automaton cut down to the letters of its alphabet, and to the states that matter then."""
        compiled = compile_generalised(automaton, alphabet.letters)
        table: list[list[list[tuple[int, int]]]] = [[[] for _ in alphabet.letters] for _ in range(compiled.states)]
        rows = zip(compiled.sources.tolist(), compiled.letters.tolist(), compiled.targets.tolist(), strict=True)
        for (source, letter, target), marks in zip(rows, compiled.marks, strict=True):
            table[source][letter].append((target, bits_of(np.flatnonzero(marks).tolist())))
        keep = _useful(table, compiled.initial.tolist(), (1 << compiled.sets) - 1)
        number = {state: index for index, state in enumerate(keep)}
        moves = tuple(
            tuple(tuple((number[t], marks) for t, marks in found if t in number) for found in table[state])
            for state in keep
        )
        initial = tuple(number[state] for state in compiled.initial.tolist() if state in number)
        return Lettered(initial, compiled.sets, moves)

    @property
    def size(self) -> int:
        """Number of states."""
        return len(self.moves)

    @property
    def deterministic(self) -> bool:
        """Whether each word has at most one run."""
        return len(self.initial) <= 1 and all(len(found) <= 1 for row in self.moves for found in row)

    @property
    def accepting(self) -> int:
        """Bits of the accepting states, where there is one set and each state's moves are all in it or all not."""
        return bits_of(q for q, row in enumerate(self.moves) if any(marks for found in row for _, marks in found))

    def posts(self) -> Callable[[int, int], int]:
        """A function from bits of states and a letter to the bits of the states that are entered; it remembers."""
        single = [[bits_of(target for target, _ in found) for found in row] for row in self.moves]

        @cache
        def post(runs: int, letter: int) -> int:
            following = 0
            for q in states_of(runs):
                following |= single[q][letter]
            return following

        return post

    def lasting(self) -> int | None:
        """Bits of the states of components in which every run is accepting, where in all others none is.

        Returns:
            None where some component has both cycles that accept and cycles that do not.
        """
        moves = [[move for found in row for move in found] for row in self.moves]
        lasting = 0
        for members in strong_components([[target for target, _ in found] for found in moves], self.initial):
            inside = set(members)
            inner = {q: [move for move in moves[q] if move[0] in inside] for q in members}
            marks = [bits for found in inner.values() for _, bits in found]
            if not marks or reduce(or_, marks) != (1 << self.sets) - 1:
                continue
            if any(_has_cycle_without(inner, k) for k in range(self.sets)):
                return None
            lasting |= bits_of(members)
        return lasting

    def written(self, alphabet: Alphabet) -> GeneralisedBuchi:
        """The automaton as a value; it reads no letter outside the alphabet."""
        read: dict[tuple[int, int, tuple[int, ...]], list[int]] = {}
        for q, row in enumerate(self.moves):
            for letter, found in enumerate(row):
                for target, marks in found:
                    read.setdefault((q, target, tuple(states_of(marks))), []).append(letter)
        edges = tuple(MarkedEdge(q, alphabet.guard(read[q, t, marks]), t, marks) for q, t, marks in sorted(read))
        return GeneralisedBuchi(alphabet.propositions, self.size, self.initial, self.sets, edges)


def _useful(table: list[list[list[tuple[int, int]]]], initial: list[int], everything: int) -> list[int]:
    """The states that an initial state reaches and from which some word is accepted, ascending."""
    successors = [sorted({target for found in row for target, _ in found}) for row in table]
    heads, reached = list[int](), set[int]()
    for members in strong_components(successors, initial):
        reached.update(members)
        inside = set(members)
        marks = [bits for q in members for found in table[q] for target, bits in found if target in inside]
        if marks and reduce(or_, marks) == everything:
            heads.append(members[0])
    return sorted(backward_reachable(successors, heads) & reached)


def _has_cycle_without(moves: dict[int, list[tuple[int, int]]], k: int) -> bool:
    """Whether some cycle of these moves never meets set ``k``."""
    number = {q: index for index, q in enumerate(moves)}
    plain = [[number[target] for target, bits in found if not bits >> k & 1] for found in moves.values()]
    return any(len(part) > 1 or part[0] in plain[part[0]] for part in strong_components(plain, range(len(plain))))


def bits_of(states: Iterable[int]) -> int:
    """Numbers as the bits of one integer."""
    bits = 0
    for state in states:
        bits |= 1 << state
    return bits


def states_of(bits: int) -> Iterator[int]:
    """The numbers whose bits are set, ascending."""
    while bits:
        lowest = bits & -bits
        yield lowest.bit_length() - 1
        bits ^= lowest
