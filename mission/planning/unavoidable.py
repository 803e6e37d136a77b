"""What every loop must read that an automaton accepts: regions that none can leave out.

Of an automaton with several states it is not plain what its loops cost at least: they may serve it in several rounds,
as one that reads a, c, b serves `G F (a & F (b & F c))`. But none of its loops leaves out a, b or c, and so the best
tour of these is a bound, which is often met.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np

from mission.geometry.arrays import BoolArray, IntArray
from mission.logic.automata.rabin import DEAD, Rabin

_MOST: Final = 500_000  # states times letters


def unavoidable(part: Rabin, letters: Sequence[frozenset[str]]) -> list[BoolArray]:
    """Sets of letters, each the letters with a region, of which every loop that is accepted reads one.

    Args:
        part: An automaton over the numbers of the letters.
        letters: The letters.

    Returns:
        Arrays of shape (letters,), each once; none of an automaton that is too large to be looked at.
    """
    if part.targets.size > _MOST:
        return []
    columns = np.vstack((part.targets, part.marks))
    _, class_of = np.unique(columns, axis=1, return_inverse=True)
    sizes = np.bincount(class_of.reshape(-1))
    found: dict[bytes, BoolArray] = {}
    for name in sorted(set[str]().union(*letters)):
        inside = np.array([name in letter for letter in letters])
        # Without a whole class of letters that are alike gone, nothing changes.
        if (np.bincount(class_of.reshape(-1)[inside], minlength=len(sizes)) == sizes).any():
            found.setdefault(inside.tobytes(), inside)
    return [inside for inside in found.values() if not _loops(part, ~inside)]


def visited(sets: Sequence[BoolArray]) -> Rabin:
    """The automaton of the words that read a letter of each set again and again; at least one set."""
    marks: IntArray = sum(inside.astype(np.int64) << number for number, inside in enumerate(sets)) + np.zeros(1, int)
    return Rabin(
        np.zeros((1, len(marks)), dtype=np.int64), marks[None], ((0, (1 << len(sets)) - 1),), counter_free=True
    )


def _loops(part: Rabin, kept: BoolArray) -> bool:
    """Whether a loop that is accepted is left with some letters alone."""
    fewer = Rabin(np.where(kept, part.targets, DEAD), part.marks, part.pairs, part.initial)
    return any(bool(states.any()) for states in fewer.recurrent)
