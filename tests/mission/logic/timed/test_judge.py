"""Bounds in seconds: against the definition on random timed words, by hand, and as another monitor judges."""

from fractions import Fraction
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mission.logic.formula.parser import parse_timed_formula
from mission.logic.formula.syntax import Formula
from mission.logic.formula.word import LassoWord, satisfies
from mission.logic.timed.behaviour import Behaviour, Piece, behaviour_of, from_to, staying
from mission.logic.timed.judge import satisfied
from mission.logic.timed.rewriting import positive, untimed
from mission.logic.timed.time_sets import AFTER, BEFORE
from tests.support.formulas import random_formula
from tests.support.timed_words import (
    TimedWord,
    counted,
    counting,
    holds,
    random_timed,
    random_window,
    random_word,
)

NAMES = ("a", "b")
chance = st.randoms(use_true_random=False)


def piece(place: int, letter: frozenset[str], unit: Fraction = Fraction(1)) -> Piece:
    begin = (place // 2 * unit, AFTER if place % 2 else BEFORE)
    end = ((place + 1) // 2 * unit, BEFORE if place % 2 else AFTER)
    return Piece((begin, end), letter, letter)


def behaviour(word: TimedWord, unit: Fraction = Fraction(1)) -> Behaviour:
    size = len(word.letters)
    pieces = [piece(place, letter, unit) for place, letter in enumerate(word.letters)]
    return behaviour_of(pieces, (size - word.round) // 2 * unit, size // 2 * unit)


def drawn(random: Random) -> tuple[TimedWord, Formula]:
    return random_word(random, NAMES), parse_timed_formula(random_timed(random, random.randint(1, 6), NAMES))


@settings(max_examples=150, deadline=None)
@given(chance)
def test_what_the_definition_says_is_what_is_judged(random: Random) -> None:
    word, formula = drawn(random)
    assert satisfied(behaviour(word), formula) is holds(word, formula)


@settings(max_examples=100, deadline=None)
@given(chance)
def test_what_counts_for_a_time_only_is_nowhere_else_by_the_clock(random: Random) -> None:
    word, formula = drawn(random)
    windows = {name: random_window(random) for name in NAMES}
    expected = holds(counted(word, windows), formula)
    clocked = counting(formula, windows)
    assert satisfied(behaviour(word), clocked) is expected
    assert satisfied(behaviour(word), positive(clocked)) is expected
    assert not expected or satisfied(behaviour(word), untimed(clocked)) is True


@settings(max_examples=50, deadline=None)
@given(chance)
def test_a_formula_without_inner_negations_means_the_same(random: Random) -> None:
    word, formula = drawn(random)
    assert satisfied(behaviour(word), positive(formula)) is holds(word, formula)


@settings(max_examples=50, deadline=None)
@given(chance)
def test_what_is_said_without_seconds_follows(random: Random) -> None:
    word, formula = drawn(random)
    weaker = untimed(formula)
    assert not weaker.timed
    assert not holds(word, formula) or satisfied(behaviour(word), weaker) is True


@settings(max_examples=50, deadline=None)
@given(chance)
def test_where_a_letter_is_not_known_all_that_it_may_be_is_meant(random: Random) -> None:
    word, formula = drawn(random)
    hidden = {place for place in range(len(word.letters)) if random.random() < 0.3}
    pieces = [piece(place, letter) for place, letter in enumerate(word.letters) if place not in hidden]
    size = len(word.letters)
    verdict = satisfied(behaviour_of(pieces, Fraction(size - word.round, 2), Fraction(size, 2)), formula)
    letters = [frozenset[str](), frozenset({"a"}), frozenset({"b"}), frozenset(NAMES)]
    for _ in range(4):
        other = TimedWord(
            tuple(random.choice(letters) if i in hidden else letter for i, letter in enumerate(word.letters)),
            word.round,
        )
        assert verdict is None or holds(other, formula) is verdict


@settings(max_examples=50, deadline=None)
@given(chance)
def test_without_bounds_and_next_time_is_read_as_the_word_of_its_letters(random: Random) -> None:
    formula = random_formula(random, 5, NAMES)
    if "X" in str(formula):
        return
    letters = [frozenset(name for name in NAMES if random.random() < 0.5) for _ in range(random.randint(1, 6))]
    loop = random.randrange(len(letters))
    pieces = [Piece(from_to(Fraction(i), Fraction(i + 1)), letter, letter) for i, letter in enumerate(letters)]
    word = LassoWord(tuple(letters[:loop]), tuple(letters[loop:]))
    judged = satisfied(behaviour_of(pieces, Fraction(loop), Fraction(len(letters))), formula)
    assert judged is satisfies(word, formula)


@settings(max_examples=20, deadline=None)
@given(chance)
def test_fractions_of_seconds_are_exact(random: Random) -> None:
    word = random_word(random, NAMES)
    formula = parse_timed_formula("F[0.125,0.375] a & G[0,0.25] (b -> F[0.5,0.5] a)")
    whole = parse_timed_formula("F[1,3] a & G[0,2] (b -> F[4,4] a)")
    assert satisfied(behaviour(word, Fraction(1, 8)), formula) is holds(word, whole)


@pytest.mark.parametrize(
    ("text", "verdict"),
    [
        ("F[0,10] a", True),  # a holds at 10 itself
        ("F[0,9.999] a", False),
        ("G[0,9] !a", True),
        ("G[0,10] !a", False),
        ("F[20,30] a", False),  # and no more at 20
        ("F[19.999,20] a", True),
        ("!a U[10,10] a", True),
        ("!a U[0,9.9] a", False),
        ("F[12,20] G[0,8] a", False),  # at 20 itself a is over
        ("F[12,20] G[0,7.999] a", True),
        ("G (a -> F[0,10] !a)", True),
        ("G (a -> F[0,9] !a)", False),
        ("a W[0,5] b", False),
        ("!a W[0,5] b", True),
        ("b M[0,5] !a", False),
        ("b R[0,5] !a", True),
        ("F[0,1000000] b", False),
    ],
)
def test_ties_are_decided_as_the_definition_says(text: str, verdict: bool) -> None:  # noqa: FBT001 - what is expected
    a, none = frozenset({"a"}), frozenset[str]()
    pieces = [
        Piece(from_to(Fraction(0), Fraction(10)), none, none),
        Piece(from_to(Fraction(10), Fraction(20)), a, a),
        Piece(from_to(Fraction(20), Fraction(21)), none, none),
    ]
    assert satisfied(staying(pieces), parse_timed_formula(text)) is verdict


def test_a_bound_that_is_many_rounds_of_a_lap_is_cheap() -> None:
    a, none = frozenset({"a"}), frozenset[str]()
    lap = [Piece(from_to(Fraction(0), Fraction(2)), a, a), Piece(from_to(Fraction(2), Fraction(3)), none, none)]
    judged = behaviour_of(lap, Fraction(0), Fraction(3))
    assert satisfied(judged, parse_timed_formula("G F[999999,1000000] a")) is True
    assert satisfied(judged, parse_timed_formula("F[1000000,1000000] a")) is True  # 1 s into a lap
    assert satisfied(judged, parse_timed_formula("F[999998,999998] a")) is False  # 2 s


def test_verdicts_of_a_public_monitor() -> None:
    """R2U2 4.1.0 on the example of its command line (docs.rs/r2u2_cli): F[1,2] (a && b) over MLTL.

    Its verdicts are 0 F, 1 and 2 T, 3 F, 4 F, 5 and 6 T. With a letter for each second, whole bounds and no until, both
    logics agree at whole seconds.
    """
    rows = ["", "a", "b", "ab", "", "a", "b", "ab"]
    verdicts = [False, True, True, False, False, True, True]
    for begin, verdict in enumerate(verdicts):
        pieces = [
            Piece(from_to(Fraction(i), Fraction(i + 1)), frozenset(row), frozenset(row))
            for i, row in enumerate(rows[begin:])
        ]
        assert satisfied(staying(pieces), parse_timed_formula("F[1,2] (a & b)")) is verdict


def test_next_has_no_meaning_in_time() -> None:
    with pytest.raises(ValueError, match="X counts"):
        satisfied(behaviour(TimedWord((frozenset(), frozenset()), 2)), parse_timed_formula("X a"))
