"""What several automata accept together: their product, of which only what is looked at is made.

A conjunction of small formulas has small automata, and an automaton of all of them that may be exponentially larger.
Whether some word is accepted by all from here on needs less: the states that can be reached are searched, depth first,
until a component is found in which every acceptance set is met (Couvreur, "On-the-fly verification of linear temporal
logic", 1999); what was found out of each state on the way is remembered.
"""

from collections.abc import Iterable, Iterator, Sequence
from itertools import product
from typing import Final

import numpy as np

from mission.logic.automata.automaton import CompiledGeneralised
from mission.logic.automata.lettered import bits_of

MAX_STATES: Final = 100_000
"""States that are searched; whether those that remain then accept anything is left open, as if they did."""

States = frozenset[tuple[int, ...]]

_Moves = tuple[tuple[int, int], ...]  # states that are entered and the acceptance sets that are met, as bits


class SideBySide:
    """Runs of several automata on one word, over numbered letters.

    Attributes:
        initial: The states of all before the first letter from which some word is accepted by all.
    """

    def __init__(self, parts: Sequence[CompiledGeneralised]) -> None:
        self._moves: list[dict[tuple[int, int], _Moves]] = []
        self._letters = sorted({letter for part in parts for letter in part.letters.tolist()})
        shift = 0
        for part in parts:
            found: dict[tuple[int, int], list[tuple[int, int]]] = {}
            rows = zip(part.sources.tolist(), part.letters.tolist(), part.targets.tolist(), part.marks, strict=True)
            for source, letter, target, marks in rows:
                bits = bits_of(np.flatnonzero(marks).tolist()) << shift
                found.setdefault((source, letter), []).append((target, bits))
            self._moves.append({key: tuple(moves) for key, moves in found.items()})
            shift += part.sets
        self._everything = (1 << shift) - 1
        self._accepts: dict[tuple[int, ...], bool] = {}
        self.initial = self._living(product(*(part.initial.tolist() for part in parts)))

    def after(self, states: States, letter: int) -> States:
        """The states that a letter leads to from some, and from which some word is accepted by all."""
        return self._living(target for state in states for target, _ in self._steps(state, letter))

    def _living(self, states: Iterable[tuple[int, ...]]) -> States:
        return frozenset(state for state in set(states) if self._accepting(state))

    def _steps(self, state: tuple[int, ...], letter: int) -> Iterator[tuple[tuple[int, ...], int]]:
        found = [moves.get((q, letter), ()) for moves, q in zip(self._moves, state, strict=True)]
        for chosen in product(*found):
            yield tuple(target for target, _ in chosen), sum(bits for _, bits in chosen)

    def _onward(self, state: tuple[int, ...]) -> Iterator[tuple[tuple[int, ...], int]]:
        return iter(dict.fromkeys(step for letter in self._letters for step in self._steps(state, letter)))

    def _accepting(self, start: tuple[int, ...]) -> bool:
        """Whether some word is accepted by all from a state on."""
        accepts = self._accepts
        if start in accepts:
            return accepts[start]
        number = {start: 0}
        path = [start]  # states of components that are not known to accept nothing
        roots = [(0, 0, 0)]  # of each such component: its first state, the marks inside, and those on the way to it
        pending = [(start, self._onward(start))]
        while pending:
            state, rest = pending[-1]
            for target, marks in rest:
                if accepts.get(target) is False:
                    continue
                if target in number:
                    roots[-1] = _merged(roots, number[target], marks)
                elif target not in accepts and len(accepts) + len(number) < MAX_STATES:
                    number[target] = len(path)
                    path.append(target)
                    roots.append((number[target], 0, marks))
                    pending.append((target, self._onward(target)))
                    break
                if target not in number or roots[-1][1] == self._everything:
                    accepts.update(dict.fromkeys(path, True))
                    return True
            else:
                pending.pop()
                if roots[-1][0] == number[state]:
                    roots.pop()
                    accepts.update(dict.fromkeys(path[number[state] :], False))
                    for dead in path[number[state] :]:
                        del number[dead]
                    del path[len(number) :]
        return False


def _merged(roots: list[tuple[int, int, int]], first: int, marks: int) -> tuple[int, int, int]:
    """The component that a way back to state ``first`` makes of the last ones; all but it are taken away."""
    while roots[-1][0] > first:
        _, inside, entering = roots.pop()
        marks |= inside | entering
    begin, inside, entering = roots[-1]
    return begin, inside | marks, entering
