"""What is needed to be true in one place, and no triangle of the map offers."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations, islice, permutations
from typing import Final

import numpy as np

from mission.logic.automata.automaton import (
    BuchiAutomaton,
    CompiledAutomaton,
    compile_to_alphabet,
    states_with_nonempty_language,
)
from mission.logic.formula.word import Letter

_MOST_TOGETHER: Final = 4
_MAX_CANDIDATES: Final = 500


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


def accepts_nothing(automaton: BuchiAutomaton) -> bool:
    """Whether no word whatever is accepted."""
    names = automaton.propositions
    # One letter for each edge keeps every run: an accepting one may read these.
    holding = {next(holds for holds, _ in edge.guard.cubes) for edge in automaton.edges}
    letters = (frozenset(name for bit, name in enumerate(names) if holds >> bit & 1) for holds in sorted(holding))
    return not accepts_something(automaton, tuple(letters))


def missing_letter(automaton: BuchiAutomaton, letters: tuple[Letter, ...]) -> Missing | None:
    """What an automaton asks for that no triangle offers; None where it accepts some word over ``letters``.

    A letter is to blame where something would be accepted if the map had it. Where several would do, the first in
    this order is named: a region without a triangle, regions together, a region outside another, no region at all.
    """
    if accepts_something(automaton, letters):
        return None
    names = automaton.propositions
    seen = tuple(dict.fromkeys(frozenset(names) & letter for letter in letters))
    for added, missing in islice(_candidates(names, seen), _MAX_CANDIDATES):
        if accepts_something(automaton, (*seen, *added)):
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
