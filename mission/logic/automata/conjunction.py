"""Conjunctions of deterministic automata, explored side by side on the letters that really occur.

A mission is a conjunction of small parts. Its automaton is their product, of which only states that can be reached are
made, all states that are equally many letters away at once; the parts are kept, for what a whole loop does to the
product is what it does to each part.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import prod
from typing import Final

import numpy as np

from mission.errors import AutomatonSizeError
from mission.logic.automata.periods import counts_rounds
from mission.logic.automata.rabin import DEAD, BoolArray, IntArray, Rabin, both, everything, nothing

MAX_STATES: Final = 40_000
"""States of a conjunction at which its exploration gives up."""

MAX_MARKS: Final = 62
"""Marks that all parts have together, at most."""

MAX_PAIRS: Final = 64
"""Ways to choose a pair of each part, at most."""


@dataclass(frozen=True, eq=False)
class Conjunction:
    """The product of deterministic automata.

    Attributes:
        parts: The automata, at least one.
        whole: Their product, without states that accept nothing; its marks are those of the parts, moved on from part
            to part.
        digits: (Q, parts) the state of each part in each state of the product.
    """

    parts: tuple[Rabin, ...]
    whole: Rabin
    digits: IntArray

    @staticmethod
    def of(parts: Sequence[Rabin]) -> "Conjunction":
        """Explore a product.

        Raises:
            AutomatonSizeError: It has too many states, marks or pairs.
        """
        letters = parts[0].targets.shape[1]
        kept = tuple(part for part in parts if not _accepts_everything(part)) or tuple(parts[:1])
        if any(part.initial == DEAD for part in kept):
            return Conjunction((nothing(letters),), nothing(letters), np.zeros((1, 1), dtype=np.int64))
        widths = [max((max(fin, inf).bit_length() for fin, inf in part.pairs), default=0) for part in kept]
        shifts = np.cumsum([0, *widths]).tolist()
        if shifts[-1] > MAX_MARKS or prod(len(part.pairs) for part in kept) > MAX_PAIRS:
            raise AutomatonSizeError(
                f"what the mission asks for again and again has more than {MAX_MARKS} acceptance sets, or more than "
                f"{MAX_PAIRS} ways to meet them; ask for less of it, or fly parts of it one after the other"
            )
        moved = [
            [(fin << shift, inf << shift) for fin, inf in part.pairs] for part, shift in zip(kept, shifts, strict=False)
        ]
        pairs = tuple(both(moved))
        found = side_by_side([part.targets for part in kept], MAX_STATES)
        if found is None:
            raise AutomatonSizeError(
                f"the parts of the mission together have more than {MAX_STATES} states: too many tasks are to be met "
                "in any order; give some of them an order, or fly parts of the mission one after the other"
            )
        digits, targets = found
        marks = np.zeros(targets.shape, dtype=np.int64)
        for column, (part, shift) in enumerate(zip(kept, shifts, strict=False)):
            marks += part.marks[digits[:, column]] << shift
        return _alive(kept, Rabin(targets, marks, pairs), digits)

    @property
    def size(self) -> int:
        """Number of states, Q."""
        return self.whole.size

    @cached_property
    def repeated(self) -> BoolArray:
        """(Q, letters) whether the word that repeats a letter for ever is accepted from a state."""
        found = np.ones(self.whole.targets.shape, dtype=np.bool_)
        for column, part in enumerate(self.parts):
            found &= accepted_rounds(part, part.targets.T, part.marks.T).T[self.digits[:, column]]
        return found

    @cached_property
    def counting(self) -> frozenset[int]:
        """The parts of which several rounds of a loop may be one of their own."""
        return frozenset(
            number for number, part in enumerate(self.parts) if not part.counter_free and counts_rounds(part)
        )

    def of_parts(self, numbers: Sequence[int], beside: Sequence[Rabin] = ()) -> tuple["Conjunction", IntArray]:
        """The conjunction of some parts, and (Q,) the state of it that each state is a state of.

        Args:
            numbers: The parts.
            beside: Automata of one state each, which accept whatever the conjunction accepts, but not everything.
        """
        parts = [*(self.parts[number] for number in numbers), *beside]
        fewer = Conjunction.of(parts or [everything(self.whole.targets.shape[1])])
        single = np.zeros((self.size, len(beside) if parts else 1), dtype=np.int64)
        digits = np.hstack((self.digits[:, list(numbers)], single))
        number = {row.tobytes(): index for index, row in enumerate(fewer.digits)}
        return fewer, np.array([number[row.tobytes()] for row in np.ascontiguousarray(digits)], dtype=np.int64)

    def in_turn(self) -> "Conjunction":
        """The same words, where there is one pair, by an automaton that waits for its marks in one fixed order.

        It has one mark that must come again and again, and as many times the states as there were.

        Raises:
            AutomatonSizeError: There are several pairs.
        """
        if len(self.whole.pairs) != 1:
            raise AutomatonSizeError("the ways to meet what recurs are too many; ask for fewer of them")
        ((fin, inf),) = self.whole.pairs
        order = [mark for mark in range(inf.bit_length()) if inf >> mark & 1]
        if not order:
            return self
        size = self.size
        rows, marks = [], []
        for waits in range(len(order)):
            level = np.full(self.whole.targets.shape, waits)
            for place in range(waits, len(order)):
                level += (level == place) & (self.whole.marks >> order[place] & 1 > 0)
            done = level == len(order)
            there = self.whole.targets + np.where(done, 0, level) * size
            rows.append(np.where(self.whole.targets == DEAD, DEAD, there))
            marks.append((self.whole.marks & fin) << 1 | done)
        found = Rabin(np.vstack(rows), np.vstack(marks), ((fin << 1, 1),), self.whole.initial).reduced()
        return Conjunction((found,), found, np.arange(found.size)[:, None])


def accepted_rounds(part: Rabin, after: IntArray, marks: IntArray) -> BoolArray:
    """Whether words, each repeated for ever, are accepted from each state of an automaton, (words, Q).

    Args:
        part: The automaton.
        after: (words, Q) the state that each word leads to from each.
        marks: (words, Q) the marks met on the way, as bits.
    """
    after = np.hstack((after, np.full((len(after), 1), DEAD)))  # a last column, which -1 is, too
    marks = np.hstack((marks, np.zeros((len(marks), 1), dtype=np.int64)))
    onward, met, steps = after, marks, 1
    while steps < part.size:  # twice as many rounds at once, until only what recurs is left
        met = met | np.take_along_axis(met, onward, axis=1)
        onward = np.take_along_axis(onward, onward, axis=1)
        steps *= 2
    again = np.take_along_axis(met, onward, axis=1)
    found = np.zeros(after.shape, dtype=np.bool_)
    for fin, inf in part.pairs:
        found |= (again & fin == 0) & (again & inf == inf)
    accepted: BoolArray = (found & (onward != DEAD))[:, :-1]
    return accepted


def _accepts_everything(part: Rabin) -> bool:
    return (
        part.size == 1
        and part.initial != DEAD
        and bool((part.targets == 0).all())
        and (any(inf == 0 and not (part.marks & fin).any() for fin, inf in part.pairs))
    )


def side_by_side(tables: Sequence[IntArray], limit: int) -> tuple[IntArray, IntArray] | None:
    """What deterministic tables that read the same letters reach together, from state 0 of each.

    Args:
        tables: (states, letters) each, the state that a letter leads to; -1 for none.
        limit: Number of states at which to give up.

    Returns:
        (Q, tables) the states that are reached, as those of the tables, and (Q, letters) where letters lead: -1 where
        one table leads nowhere; None where they are too many.
    """
    sizes = [len(table) for table in tables]
    if prod(sizes) >= 1 << MAX_MARKS:
        return None
    places = np.array([prod(sizes[index + 1 :]) for index in range(len(sizes))], dtype=np.int64)
    known = frontier = np.zeros(1, dtype=np.int64)
    rows = []
    while len(frontier):
        digits = frontier[:, None] // places % sizes
        after = np.zeros((len(frontier), tables[0].shape[1]), dtype=np.int64)
        lost = np.zeros(after.shape, dtype=np.bool_)
        for column, table in enumerate(tables):
            entered = table[digits[:, column]]
            lost |= entered == DEAD
            after += entered * places[column]
        after[lost] = DEAD
        rows.append(after)
        found = np.unique(after[~lost])
        frontier = found[~np.isin(found, known, assume_unique=True)]
        known = np.concatenate((known, frontier))
        if len(known) > limit:
            return None
    order = np.argsort(known)
    codes = np.concatenate(rows)
    number = order[np.searchsorted(known[order], codes).clip(max=len(known) - 1)]
    return known[:, None] // places % sizes, np.where(codes == DEAD, DEAD, number)


def _alive(parts: tuple[Rabin, ...], whole: Rabin, digits: IntArray) -> Conjunction:
    alive = whole.alive()
    if not alive[0]:
        letters = whole.targets.shape[1]
        return Conjunction((nothing(letters),), nothing(letters), np.zeros((1, 1), dtype=np.int64))
    number = np.where(alive, np.cumsum(alive) - 1, DEAD)
    targets = np.where(whole.targets == DEAD, DEAD, number[whole.targets])[alive]
    return Conjunction(parts, Rabin(targets, whole.marks[alive], whole.pairs), digits[alive])
