"""Conjunctions taken apart: the parts together mean what the whole does, and are as small as they can be told to be."""

from random import Random

import pytest

from mission.logic.formula.conjuncts import conjuncts, separated
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.word import satisfies
from tests.support.formulas import random_formula, random_word


def test_conjuncts_are_listed_once_and_true_is_none() -> None:
    assert [str(c) for c in conjuncts(parse_formula("F a & (G b & F a) & true"))] == ["F a", "G b"]
    assert conjuncts(parse_formula("F a | G b")) == (parse_formula("F a | G b"),)


@pytest.mark.parametrize(
    ("formula", "parts"),
    [
        ("F a & (G b & F a) & true", ["F a", "G b"]),
        ("F a | G b", ["F a | G b"]),
        ("G (a & X (b & c))", ["G a", "G X b", "G X c"]),
        ("!(F a | F (b | c))", ["G !a", "G !b", "G !c"]),
        ("!(a -> F b)", ["a", "G !b"]),
        ("G (a -> F b & F c)", ["G (a -> F b)", "G (a -> F c)"]),
        ("F G (a & b)", ["F G a", "F G b"]),
        ("G F (a & b)", ["G F (a & b)"]),
        ("(a & b) U c & c R (a & b) & (a & b) W c", ["a U c", "b U c", "c R a", "c R b", "a W c", "b W c"]),
        ("a U (b & c)", ["a U (b & c)"]),
        ("true", []),
    ],
)
def test_conjunctions_are_found_wherever_operators_distribute_over_them(formula: str, parts: list[str]) -> None:
    assert [str(part) for part in separated(parse_formula(formula))] == parts


@pytest.mark.parametrize("seed", range(4))
def test_a_word_satisfies_a_formula_exactly_where_it_satisfies_its_parts(seed: int) -> None:
    random, names = Random(seed), ("a", "b", "c")  # noqa: S311 - no secrets here
    divided = 0
    for _ in range(150):
        formula = random_formula(random, random.randint(1, 9), names)
        parts = separated(formula)
        divided += len(parts) > 1
        for _ in range(10):
            word = random_word(random, names)
            assert satisfies(word, formula) is all(satisfies(word, part) for part in parts), str(formula)
    assert divided > 20
