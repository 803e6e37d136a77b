"""What is left of a formula is satisfied by exactly the words that complete the beginning, by the definition of LTL."""

from random import Random

import pytest

from mission.errors import AutomatonSizeError
from mission.logic.formula import progression
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.progression import counts_letters, left_of
from mission.logic.formula.syntax import FALSE, TRUE
from mission.logic.formula.word import LassoWord, Letter, satisfies
from tests.support.formulas import random_formula, random_letter, random_word

NAMES = ("a", "b", "c")


def letters(*names: str) -> tuple[Letter, ...]:
    return tuple(frozenset(name.split()) for name in names)


@pytest.mark.parametrize("seed", range(10))
def test_the_beginning_and_a_word_that_satisfies_what_is_left_satisfy_the_formula(seed: int) -> None:
    random = Random(seed)  # noqa: S311 - tests need no secrets
    for _ in range(30):
        formula = random_formula(random, random.randrange(1, 11), NAMES)
        begin = tuple(random_letter(random, NAMES) for _ in range(random.randrange(6)))
        word = random_word(random, NAMES)
        whole = LassoWord(begin + word.prefix, word.suffix)
        assert satisfies(word, left_of(formula, begin)) is satisfies(whole, formula), (formula, begin, word)


@pytest.mark.parametrize(
    ("formula", "word", "left"),
    [
        ("F (a & F (b & F home)) & F c", ("home", "", "a"), "F (b & F home) & F c"),
        ("F (a & F (b & F home)) & F c", ("b", "c", "a", "b"), "F home"),
        ("G F a & G F b", ("a", "b", "", "a"), "G (F a & F b)"),
        ("!a U b", ("", "b"), "true"),
        ("!a U b", ("", "a"), "false"),
        ("X X a", ("",), "X a"),
        ("a W b", ("a", "a"), "a W b"),
        ("b M a", ("a",), "b M a"),
    ],
)
def test_what_is_left_is_written_as_a_reader_would(formula: str, word: tuple[str, ...], left: str) -> None:
    assert str(left_of(parse_formula(formula), letters(*word))) == left


def test_of_nothing_read_nothing_is_changed() -> None:
    formula = parse_formula("a -> F b")
    assert left_of(formula, ()) is formula
    assert left_of(TRUE, letters("a")) is TRUE
    assert left_of(FALSE, letters("a")) is FALSE


def test_long_words_of_laps_leave_no_more_than_short_ones() -> None:
    formula = parse_formula("G F a & G F b & G (a -> X (!a W b))")
    lap = letters("", "a", "a b", "", "b")
    assert left_of(formula, lap * 2_000) is left_of(formula, lap * 2)


def test_what_would_be_too_large_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(progression, "MOST_NODES", 2)
    with pytest.raises(AutomatonSizeError, match="more than 2 parts"):
        left_of(parse_formula("F (a & F b) & F c"), letters("a"))


def test_next_alone_counts_letters() -> None:
    assert counts_letters(parse_formula("F (a & X b)"))
    assert not counts_letters(parse_formula("(a U b) & (a W b) & (a R b) & (a M b) & F a & G b"))
