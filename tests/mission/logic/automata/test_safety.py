"""Bad prefixes: exactly the finite words that no continuation makes satisfy the formula."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.errors import AutomatonSizeError
from mission.logic.automata import safety
from mission.logic.automata.safety import Safety, safety_of
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.word import LassoWord, satisfies
from tests.support.drawn_cases import tried
from tests.support.required import required

LETTERS = (frozenset[str](), frozenset({"a"}), frozenset({"b"}))
FORMULAS = (
    "G !a",
    "F a",
    "G F a",
    "F G a",
    "!a U b",
    "G (a -> F b)",
    "G (a -> X !a)",
    "G (b -> (b W (!b W a)))",
    "F (a & F b) & G !(a & b)",
    "G F a & G F b & (!b W a)",
    "a & !a",
    "true",
)


def of(formula: str) -> Safety:
    return safety_of(required(formula, LETTERS).whole)


def after(found: Safety, word: tuple[int, ...]) -> int:
    state = found.initial
    for letter in word:
        state = int(found.rows[state, letter])
    return state


def can_go_on(formula: str, words: tuple[tuple[int, ...], ...]) -> list[bool]:
    """For each word whether a lasso after it, short but long enough for these formulas, satisfies the formula."""
    parsed = parse_formula(formula)
    lassos = [
        (prefix, suffix)
        for m in range(3)
        for n in (1, 2)
        for prefix in product(range(3), repeat=m)
        for suffix in product(range(3), repeat=n)
    ]
    return [
        any(
            satisfies(LassoWord(tuple(LETTERS[i] for i in (*word, *prefix)), tuple(LETTERS[i] for i in suffix)), parsed)
            for prefix, suffix in lassos
        )
        for word in words
    ]


@pytest.mark.parametrize("formula", FORMULAS)
def test_a_prefix_is_bad_if_nothing_that_follows_satisfies_the_formula(formula: str) -> None:
    found = of(formula)
    words = tuple(word for length in range(4) for word in product(range(3), repeat=length))
    assert [after(found, word) != found.bad for word in words] == can_go_on(formula, words)


@pytest.mark.parametrize("formula", FORMULAS)
def test_its_refutation_accepts_what_has_a_bad_prefix(formula: str) -> None:
    found = of(formula)
    refutation = found.refutation()
    assert refutation.states == len(found.rows)
    assert len(refutation.sources) == refutation.states * len(LETTERS)  # complete and deterministic
    assert np.flatnonzero(refutation.accepting).tolist() == [found.bad]
    assert (found.rows[found.bad] == found.bad).all()


@given(st.sampled_from(FORMULAS), st.lists(st.integers(0, 2), max_size=5), st.data())
@tried(80)
def test_going_on_from_several_states_is_bad_where_it_is_from_one(
    formula: str, word: list[int], data: st.DataObject
) -> None:
    found = of(formula)
    states = data.draw(st.sets(st.integers(0, found.bad), min_size=1))
    onward = found.after(states)
    bad = any(after(Safety(found.rows, state), tuple(word)) == found.bad for state in states)
    assert (after(onward, tuple(word)) == onward.bad) == bad


def test_what_takes_too_many_states_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    found = of("G (b -> (b W (!b W a)))")
    monkeypatch.setattr(safety, "MAX_STATES", 2)
    with pytest.raises(AutomatonSizeError, match="more than 2 states"):
        found.after({found.initial})
