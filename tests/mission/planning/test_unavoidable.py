"""Regions that no accepted loop leaves out."""

from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.logic.formula.word import satisfies
from mission.planning.unavoidable import unavoidable, visited
from tests.support.drawn_cases import tried
from tests.support.formulas import random_formula, random_word
from tests.support.required import required

NAMES = ("a", "b", "c")
LETTERS = tuple(frozenset(letter) for letter in ("", "a", "b", "c", "ab", "bc"))


@pytest.mark.parametrize(
    ("formula", "names"),
    [
        ("G F (a & F (b & F c))", "abc"),
        ("F a & G (a -> F b) & G F (b -> F c)", ""),
        ("F a & G (a -> X F b) & G (b -> X F a)", "ab"),
        ("G F a | G F b", ""),
        ("F a & F b", ""),
        ("F G c", "c"),
    ],
)
def test_what_every_loop_visits_is_found(formula: str, names: str) -> None:
    found = unavoidable(required(formula, LETTERS).whole, LETTERS)
    expected = [[name in letter for letter in LETTERS] for name in names]
    assert [inside.tolist() for inside in found] == expected


@tried(100)
@given(seed=st.integers(0, 2**32 - 1))
def test_no_accepted_loop_leaves_it_out(seed: int) -> None:
    random = Random(seed)  # noqa: S311 - no secrets here
    formula = random_formula(random, random.randrange(1, 6), NAMES)
    automaton = required(formula, LETTERS)
    sets = unavoidable(automaton.whole, LETTERS)
    looser = visited(sets) if sets else None
    for _ in range(20):
        word = random_word(random, NAMES)
        if not set(word.prefix + word.suffix) <= set(LETTERS) or not satisfies(word, formula):
            continue
        prefix, loop = ([LETTERS.index(letter) for letter in part] for part in (word.prefix, word.suffix))
        assert automaton.whole.accepts(prefix, loop)
        assert all(inside[loop].any() for inside in sets)
        assert looser is None or looser.accepts(prefix, loop)
