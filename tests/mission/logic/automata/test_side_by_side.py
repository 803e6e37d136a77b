"""Products that are made where they are looked at, against the whole intersection."""

from functools import reduce
from random import Random

import pytest

from mission.logic.automata import side_by_side
from mission.logic.automata.automaton import (
    GeneralisedBuchi,
    compile_generalised,
    compile_to_alphabet,
    states_with_nonempty_language,
)
from mission.logic.automata.combination import intersection
from mission.logic.automata.conversion import with_accepting_states
from mission.logic.automata.side_by_side import SideBySide
from mission.logic.automata.translate import translate_generalised
from mission.logic.formula.parser import parse_formula
from tests.support.automata import random_automaton

LETTERS = (frozenset[str](), frozenset({"a"}), frozenset({"b"}), frozenset({"a", "b"}))


def together(*parts: GeneralisedBuchi) -> SideBySide:
    return SideBySide([compile_generalised(part, LETTERS) for part in parts])


def living(parts: list[GeneralisedBuchi], word: list[int]) -> bool:
    """Whether the intersection of all accepts something that begins with a word."""
    whole = compile_to_alphabet(with_accepting_states(reduce(intersection, parts)), LETTERS)
    alive = states_with_nonempty_language(whole)
    here = {state for state in whole.initial.tolist() if alive[state]}
    rows = list(zip(whole.sources.tolist(), whole.letters.tolist(), whole.targets.tolist(), strict=True))
    for letter in word:
        here = {target for source, read, target in rows if source in here and read == letter and alive[target]}
    return bool(here)


@pytest.mark.parametrize("seed", range(4))
def test_something_is_accepted_exactly_where_the_intersection_accepts_it(seed: int) -> None:
    random, outcomes = Random(seed), set[bool]()  # noqa: S311 - no secrets here
    for _ in range(40):
        parts = [random_automaton(random, random.randint(1, 3), random.randrange(3), 1.3, 4) for _ in range(3)]
        word = [random.randrange(4) for _ in range(random.randrange(5))]
        product = together(*parts)
        states = reduce(product.after, word, product.initial)
        assert bool(states) is living(parts, word)
        outcomes.add(bool(states))
    assert outcomes == {True, False}


def test_parts_that_accept_may_accept_nothing_together() -> None:
    assert not together(*(translate_generalised(parse_formula(text)) for text in ("F a", "G !a"))).initial
    assert together(*(translate_generalised(parse_formula(text)) for text in ("F a", "F G !a"))).initial


def test_beyond_the_bound_it_is_left_open(monkeypatch: pytest.MonkeyPatch) -> None:
    parts = [translate_generalised(parse_formula(text)) for text in ("X X X X a", "X X X X !a")]
    assert not together(*parts).initial
    monkeypatch.setattr(side_by_side, "MAX_STATES", 3)
    assert together(*parts).initial
