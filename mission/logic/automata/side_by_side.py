"""What several automata accept together: their product over the letters that really occur.

A conjunction of small formulas has small automata. Their product is explored once, so that nothing has to be searched
for while a word is read: from which of its states some word is accepted by all shows on its components.
"""

from collections.abc import Iterable, Sequence
from functools import reduce
from itertools import product
from operator import or_
from typing import Final

import numpy as np

from mission.logic.automata.automaton import CompiledGeneralised
from mission.logic.automata.components import backward_reachable, strong_components
from mission.logic.automata.lettered import bits_of

MAX_STATES: Final = 20_000
"""States that are explored; whether those beyond accept anything is left open for good, as if they did."""

_Moves = tuple[tuple[int, int], ...]  # states that are entered and the acceptance sets that are met, as bits


class SideBySide:
    """Runs of several automata on one word, over numbered letters.

    Attributes:
        initial: The states before the first letter from which some word is accepted by all.
    """

    def __init__(self, parts: Sequence[CompiledGeneralised]) -> None:
        shifts = np.cumsum([0, *(part.sets for part in parts)]).tolist()
        moves = [_moves(part, shift) for part, shift in zip(parts, shifts, strict=False)]
        letters = sorted({letter for part in parts for letter in part.letters.tolist()})
        queue = list(product(*(part.initial.tolist() for part in parts)))
        initial = range(len(queue))
        number = {state: index for index, state in enumerate(queue)}
        self._after: list[dict[int, frozenset[int]]] = []
        edges: list[dict[int, int]] = []  # of each state: the states that are entered, and all marks on the way
        for state in queue:
            if len(queue) > MAX_STATES:
                break
            row: dict[int, frozenset[int]] = {}
            entered: dict[int, int] = {}
            for letter in letters:
                found = set()
                for chosen in product(*(table.get((q, letter), ()) for table, q in zip(moves, state, strict=True))):
                    target = tuple(following for following, _ in chosen)
                    if target not in number:
                        number[target] = len(queue)
                        queue.append(target)
                    found.add(number[target])
                    marks = reduce(or_, (bits for _, bits in chosen), 0)
                    entered[number[target]] = entered.get(number[target], 0) | marks
                row[letter] = frozenset(found)
            self._after.append(row)
            edges.append(entered)
        self._living = self._accepting(edges, len(queue), (1 << shifts[-1]) - 1)
        self.initial = self._living.intersection(initial)

    @staticmethod
    def _accepting(edges: list[dict[int, int]], size: int, everything: int) -> frozenset[int]:
        """The states from which some word is accepted by all, and those that were not explored."""
        successors: list[list[int]] = [*map(list, edges), *([] for _ in range(size - len(edges)))]
        heads = list(range(len(edges), size))
        for members in strong_components(successors, range(size)):
            inside = frozenset(members)
            entered = [edges[state] for state in members if state < len(edges)]
            marks = [bits for found in entered for target, bits in found.items() if target in inside]
            if marks and reduce(or_, marks) == everything:
                heads.append(members[0])
        return frozenset(backward_reachable(successors, heads))

    def after(self, states: Iterable[int], letter: int) -> frozenset[int]:
        """The states that a letter leads to from some, and from which some word is accepted by all."""
        found = set[int]()
        for state in states:
            found |= self._after[state].get(letter, frozenset()) if state < len(self._after) else {state}
        return self._living.intersection(found)


def _moves(part: CompiledGeneralised, shift: int) -> dict[tuple[int, int], _Moves]:
    """What each state does at each letter; the acceptance sets count from ``shift`` on."""
    found: dict[tuple[int, int], list[tuple[int, int]]] = {}
    rows = zip(part.sources.tolist(), part.letters.tolist(), part.targets.tolist(), part.marks, strict=True)
    for source, letter, target, marks in rows:
        found.setdefault((source, letter), []).append((target, bits_of(np.flatnonzero(marks).tolist()) << shift))
    return {key: tuple(moves) for key, moves in found.items()}
