"""Deterministic automata read lasso words as LTL is defined."""

from random import Random

from hypothesis import given
from hypothesis import strategies as st

from mission.logic.automata.determined import parts_of
from mission.logic.formula.word import satisfies
from tests.support.drawn_cases import tried
from tests.support.formulas import random_formula, random_word

NAMES = ("a", "b")
LETTERS = tuple(frozenset(letter) for letter in ("", "a", "b", "ab"))


@tried(60)
@given(seed=st.integers(0, 2**32 - 1))
def test_a_word_is_accepted_where_it_satisfies_the_formula(seed: int) -> None:
    random = Random(seed)  # noqa: S311 - no secrets here
    formula = random_formula(random, random.randrange(1, 6), NAMES)
    parts = parts_of(formula, LETTERS)
    for _ in range(10):
        word = random_word(random, NAMES)
        prefix, loop = ([LETTERS.index(letter) for letter in part] for part in (word.prefix, word.suffix))
        assert all(part.accepts(prefix, loop) for part in parts) is satisfies(word, formula), f"{formula} on {word}"
