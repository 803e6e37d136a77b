"""Deterministic automata with Rabin conditions, over a few numbered letters.

A word has one run at most, so nothing is guessed: what a search finds in a product with such an automaton are the words
themselves. Conditions are generalised: of each pair, transitions of the set ``fin`` are taken finitely often, and those
of every set of ``inf`` again and again; one pair suffices. Büchi, co-Büchi, parity and weak automata are of this kind.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from itertools import product
from operator import or_

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
Pair = tuple[int, int]
"""The bits of marks that must come finitely often, any of them; and of those that must come again and again, each."""

DEAD = -1


@dataclass(frozen=True, eq=False)
class Rabin:
    """A deterministic automaton.

    Attributes:
        targets: (Q, letters) the state that each letter leads to; -1 where nothing is accepted any more.
        marks: (Q, letters) the marks of the transition, as bits.
        pairs: The condition; without a pair nothing is accepted.
        initial: The state before the first letter, -1 where nothing is accepted.
        counter_free: Whether a word that is repeated is known to lead to one state in the end.
    """

    targets: IntArray
    marks: IntArray
    pairs: tuple[Pair, ...]
    initial: int = 0
    counter_free: bool = False

    @property
    def size(self) -> int:
        """Number of states, Q."""
        return len(self.targets)

    @cached_property
    def recurrent(self) -> tuple[BoolArray, ...]:
        """For each pair, (Q,) whether a loop through the state, of any letters, satisfies it."""
        return tuple(_recurrent(self.targets, self.marks, pair) for pair in self.pairs)

    def over(self, classes: IntArray) -> "Rabin":
        """The same over more letters: ``classes`` (letters,) says which of its own each of these is to it."""
        return Rabin(self.targets[:, classes], self.marks[:, classes], self.pairs, self.initial, self.counter_free)

    def reduced(self) -> "Rabin":
        """Without states that are unreachable or accept nothing, and with states of one behaviour as one."""
        trimmed = self._trimmed()
        kept, number = merged(trimmed.targets, trimmed.marks)
        targets = np.where(trimmed.targets[kept] == DEAD, DEAD, number[trimmed.targets[kept]])
        initial = DEAD if trimmed.initial == DEAD else int(number[trimmed.initial])
        return Rabin(targets, trimmed.marks[kept], trimmed.pairs, initial, self.counter_free)

    def _trimmed(self) -> "Rabin":
        """Reachable states in the order of a breadth-first search; marks only where they can come again."""
        alive = self.alive()
        if self.initial == DEAD or not alive[self.initial]:
            return nothing(self.targets.shape[1])
        sources, targets = _edges(np.where(self.targets == DEAD, DEAD, np.where(alive[self.targets], self.targets, -1)))
        order = breadth_first_order(_graph(sources, targets, self.size), self.initial, return_predecessors=False)
        number = np.full(self.size + 1, DEAD, dtype=np.int64)
        number[order] = np.arange(len(order))
        number[:-1][~alive] = DEAD
        components = _components(sources, targets, self.size)
        rows = self.targets[order]
        again = (rows != DEAD) & (components[order][:, None] == components[rows]) & (number[rows] != DEAD)
        pairs = tuple(pair for pair, found in zip(self.pairs, self.recurrent, strict=True) if found[order].any())
        used = reduce(or_, (fin | inf for fin, inf in pairs), 0)
        return Rabin(number[rows], np.where(again, self.marks[order] & used, 0), pairs)

    def accepts(self, prefix: Sequence[int], loop: Sequence[int]) -> bool:
        """Whether the word that reads the letters of a prefix, and those of a loop (one at least) for ever, is one."""
        state = self.initial
        for letter in prefix:
            state = DEAD if state == DEAD else int(self.targets[state, letter])
        met: dict[int, int] = {}  # what each round that began in a state bore
        while state != DEAD and state not in met:
            begin, met[state] = state, 0
            for letter in loop:
                if state != DEAD:
                    met[begin] |= int(self.marks[state, letter])
                    state = int(self.targets[state, letter])
        if state == DEAD:
            return False
        rounds = list(met)
        borne = reduce(or_, (met[begin] for begin in rounds[rounds.index(state) :]), 0)
        return any(borne & fin == 0 and borne & inf == inf for fin, inf in self.pairs)

    def alive(self) -> BoolArray:
        """(Q,) whether some word is accepted from each state."""
        heads = np.flatnonzero(np.any([np.zeros(self.size, dtype=np.bool_), *self.recurrent], axis=0))
        sources, targets = _edges(self.targets)
        backward = _graph(np.append(targets, np.full(len(heads), self.size)), np.append(sources, heads), self.size + 1)
        found = np.zeros(self.size + 1, dtype=np.bool_)
        found[breadth_first_order(backward, self.size, return_predecessors=False)] = True
        return found[:-1]


def nothing(letters: int) -> Rabin:
    """The automaton that accepts nothing."""
    return Rabin(np.full((1, letters), DEAD, dtype=np.int64), np.zeros((1, letters), dtype=np.int64), (), DEAD)


def everything(letters: int) -> Rabin:
    """The automaton that accepts everything."""
    none = np.zeros((1, letters), dtype=np.int64)
    return Rabin(none, none, ((1, 0),), counter_free=True)


def merged(targets: IntArray, told: IntArray | BoolArray) -> tuple[IntArray, IntArray]:
    """The coarsest classes of states that agree on what is told of them and on the classes that letters lead to.

    Args:
        targets: (Q, letters) the states that letters lead to; -1 for none.
        told: (Q, n) what members of a class agree on.

    Returns:
        (classes,) the first state of each class, in whose order they are numbered, and (Q,) the class of each state.
    """
    classes, count = np.zeros(len(targets), dtype=np.int64), 0
    while True:
        keys = np.hstack((classes[:, None], np.where(targets == DEAD, DEAD, classes[targets]), told))
        _, first, finer = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        classes = np.argsort(np.argsort(first))[finer.reshape(-1)]
        if len(first) == count:
            return np.sort(first), classes
        count = len(first)


def both(pairs: Sequence[Sequence[Pair]]) -> Iterator[Pair]:
    """The pairs of a conjunction of conditions, whose marks are different ones."""
    for chosen in product(*pairs):
        yield sum(fin for fin, _ in chosen), sum(inf for _, inf in chosen)


def _recurrent(targets: IntArray, marks: IntArray, pair: Pair) -> BoolArray:
    fin, inf = pair
    usable = (targets != DEAD) & (marks & fin == 0)
    sources, letters = np.nonzero(usable)
    ends, borne = targets[sources, letters], marks[sources, letters] & inf
    components = _components(sources, ends, len(targets))
    inner = components[sources] == components[ends]
    met = np.zeros(len(targets), dtype=np.int64)
    np.bitwise_or.at(met, components[sources[inner]], borne[inner])
    cyclic = np.zeros(len(targets), dtype=np.bool_)
    cyclic[components[sources[inner]]] = True
    found: BoolArray = (cyclic & (met == inf))[components]
    return found


def _edges(targets: IntArray) -> tuple[IntArray, IntArray]:
    sources, letters = np.nonzero(targets != DEAD)
    return sources, targets[sources, letters]


def _graph(sources: IntArray, targets: IntArray, size: int) -> "csr_array[np.float64, tuple[int, int]]":
    once = np.divmod(np.unique(sources * size + targets), size)  # scipy's searches need each edge once
    return csr_array((np.ones(len(once[0])), once), shape=(size, size))


def _components(sources: IntArray, targets: IntArray, size: int) -> IntArray:
    _, components = connected_components(_graph(sources, targets, size), directed=True, connection="strong")
    return np.asarray(components, dtype=np.int64)
