"""Bounds in seconds, as they are written and read."""

import pickle
from fractions import Fraction
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.errors import FormulaSyntaxError
from mission.logic.formula.operators import Operator
from mission.logic.formula.parser import parse_formula, parse_timed_formula
from mission.logic.formula.syntax import Formula, always, eventually, proposition, until
from tests.support.timed_words import random_timed

A, B = proposition("a"), proposition("b")


def seconds(least: str, most: str) -> tuple[Fraction, Fraction]:
    return Fraction(least), Fraction(most)


@pytest.mark.parametrize(
    ("text", "formula"),
    [
        ("F[0,120] a", eventually(A, seconds("0", "120"))),
        ("F [ 0 , 120 ] a", eventually(A, seconds("0", "120"))),
        ("G[0.5,60.25] !a", always(parse_formula("!a"), seconds("0.5", "60.25"))),
        ("a U[1,90] b", until(A, B, seconds("1", "90"))),
        ("GF[0,3] a", always(eventually(A, seconds("0", "3")))),
        ("[][0,2] a", always(A, seconds("0", "2"))),
        (r"\Diamond[0,1] a", eventually(A, seconds("0", "1"))),
        ("a until[0,3] b", until(A, B, seconds("0", "3"))),
        ("F[0,0] G[1,1000000] a", eventually(always(A, seconds("1", "1000000")), seconds("0", "0"))),
    ],
)
def test_bounds_follow_their_operator(text: str, formula: Formula) -> None:
    assert parse_timed_formula(text) is formula
    assert parse_timed_formula(str(formula)) is formula


@given(st.randoms(use_true_random=False))
def test_what_is_written_is_read_as_the_same(random: Random) -> None:
    formula = parse_timed_formula(random_timed(random, 5, ("a", "b")))
    assert parse_timed_formula(str(formula)) is formula
    assert pickle.loads(pickle.dumps(formula)) is formula  # noqa: S301 - its own


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("F[3,1] a", r"\[3,1\] end before they begin \(column 2\)"),
        ("F[-1,2] a", r"begin in the past \(column 2\)"),
        ("F[0,inf] a", r"\[0,inf\] are no bounds"),
        ("F[0,nan] a", r"\[0,nan\] are no bounds"),
        ("F[1e3,1e4] a", "are no bounds"),
        ("F[5] a", "are no bounds"),
        ("F[0,1000001] a", "longer than 1000000 s"),
        ("F[0,0.0000000001] a", "are no bounds"),
        ("X[0,1] a", r"follows no operator that has bounds \(column 2\)"),
        ("a [0,1] b", "follows no operator that has bounds"),
        ("F[0,1][0,2] a", r"follows no operator that has bounds \(column 7\)"),
        ("![0,1] a", "follows no operator that has bounds"),
        ("F[0,1", r"the character '\[' has no meaning"),
        ("G (a -> F[0,1] X b)", r"X counts triangles and bounds count seconds.*\(column 10\)"),
    ],
)
def test_what_are_no_bounds_is_said(text: str, message: str) -> None:
    with pytest.raises(FormulaSyntaxError, match=message):
        parse_timed_formula(text)


def test_next_may_stand_in_a_conjunct_of_its_own() -> None:
    assert parse_timed_formula("F[0,1] a & X b").timed


def test_where_time_has_no_meaning_bounds_have_none() -> None:
    with pytest.raises(FormulaSyntaxError, match=r"seconds have no meaning here \(column 8\)"):
        parse_formula("F b & F[0,1] a")


def test_a_node_with_bounds_is_another_node() -> None:
    assert eventually(A) is not eventually(A, seconds("0", "1"))
    assert not eventually(A, seconds("0", "1")).eventuality
    assert not always(A, seconds("0", "1")).universality
    assert always(eventually(A, seconds("0", "1"))).timed


@pytest.mark.parametrize(
    ("operator", "bounds"),
    [
        (Operator.NEXT, seconds("0", "1")),
        (Operator.NOT, seconds("0", "1")),
        (Operator.EVENTUALLY, seconds("2", "1")),
        (Operator.EVENTUALLY, seconds("-1", "1")),
        (Operator.EVENTUALLY, (Fraction(0), Fraction(1, 3))),
    ],
)
def test_no_node_has_bounds_that_are_none(operator: Operator, bounds: tuple[Fraction, Fraction]) -> None:
    with pytest.raises(ValueError, match="bounds"):
        Formula(operator, (A,), "", bounds)
