"""What is needed to be true in one place, and no triangle of the map offers."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import chain, combinations, islice, permutations
from typing import Final

import numpy as np

from mission.logic.automata.automaton import (
    BuchiAutomaton,
    CompiledAutomaton,
    compile_to_alphabet,
    states_with_nonempty_language,
)
from mission.logic.automata.rabin import DEAD, Rabin
from mission.logic.formula.word import Letter

_MOST_TOGETHER: Final = 4
_MAX_CANDIDATES: Final = 500
_MAX_WORK: Final = 5_000_000  # transitions that are looked at for all candidates
_MOST_NAMES: Final = 11


@dataclass(frozen=True)
class Missing:
    """A letter that the map lacks.

    Attributes:
        asked: What is asked for, after "asks for" or "asks to".
        lacking: Why that cannot be had.
        regions: The regions that this is about.
    """

    asked: str
    lacking: str
    regions: tuple[str, ...]


Over = Callable[[tuple[Letter, ...]], Rabin]
"""From letters to a deterministic automaton over their numbers; it may raise AutomatonSizeError."""


def accepts_nothing(over: Over, names: tuple[str, ...]) -> bool | None:
    """Whether no word whatever over some propositions is accepted; None where they are too many."""
    if len(names) > _MOST_NAMES:
        return None
    chosen = chain.from_iterable(combinations(names, size) for size in range(len(names) + 1))
    return over(tuple(map(frozenset, chosen))).initial == DEAD


def missing_letter(over: Over, names: tuple[str, ...], letters: tuple[Letter, ...]) -> Missing:
    """What is asked for that no triangle offers, where no word over ``letters`` is accepted.

    A letter is to blame where something would be accepted if the map had it. Where several would do, the first in
    this order is named: a region without a triangle, regions together, a region outside another, no region at all.
    """
    seen = tuple(dict.fromkeys(frozenset(names) & letter for letter in letters))
    candidates = list(islice(_candidates(names, seen), _MAX_CANDIDATES))
    every = tuple(dict.fromkeys(chain(seen, *(added for added, _ in candidates))))
    number = {letter: index for index, letter in enumerate(every)}
    whole = over(every)
    affordable = 0 if whole.initial == DEAD else _MAX_WORK // (whole.size * (len(seen) + 1))
    for added, missing in candidates[:affordable]:
        columns = np.array(sorted({number[letter] for letter in (*seen, *added)}))
        if whole.over(columns).alive()[whole.initial]:
            return missing
    return Missing("places", "no triangle has the labels for them", ())


def violated_by_first(compiled: CompiledAutomaton, letter: int) -> bool:
    """Whether no accepted word over the letters of an automaton begins with ``letter``."""
    alive = states_with_nonempty_language(compiled)
    first = (compiled.letters == letter) & np.isin(compiled.sources, compiled.initial)
    return not alive[compiled.targets[first]].any()


def accepts_something(automaton: BuchiAutomaton, letters: tuple[Letter, ...]) -> bool:
    """Whether an automaton accepts some word over ``letters``."""
    compiled = compile_to_alphabet(automaton, letters)
    return bool(states_with_nonempty_language(compiled)[compiled.initial].any())


def _candidates(names: tuple[str, ...], seen: tuple[Letter, ...]) -> Iterator[tuple[list[Letter], Missing]]:
    for name in names:
        if not any(name in letter for letter in seen):
            yield [frozenset({name})], Missing(name, f"no triangle has the label {name}", (name,))
    for size in range(2, min(len(names), _MOST_TOGETHER) + 1):
        for together in combinations(names, size):
            letter = frozenset(together)
            if not any(letter <= other for other in seen):
                listed = f"{', '.join(together[:-1])} and {together[-1]}"
                whole = "both" if len(together) == 2 else "all of them"  # noqa: PLR2004 - a pair
                yield [letter], Missing(f"{listed} at once", f"no triangle lies in {whole}", together)
    for inner, outer in permutations(names, 2):
        within = [letter for letter in seen if inner in letter]
        if within and all(outer in letter for letter in within):
            lacking = f"every triangle of {inner} lies in {outer}"
            yield [letter - {outer} for letter in within], Missing(f"{inner} outside {outer}", lacking, (inner, outer))
    if frozenset() not in seen:
        listed = ", ".join(sorted(names))
        yield [frozenset()], Missing(f"a place outside {listed}", "no triangle lies there", tuple(sorted(names)))
