"""Refutations, conjunct by conjunct, against the definition of LTL and against the negation of the whole."""

from random import Random

import pytest

from mission.errors import AutomatonSizeError
from mission.logic.automata.refutation import refutation
from mission.logic.automata.translate import translate
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.syntax import conjunction, negation
from mission.logic.formula.word import satisfies
from tests.support.formulas import random_formula, random_word


@pytest.mark.parametrize("seed", range(3))
def test_a_refutation_accepts_what_violates_one_conjunct_or_another(seed: int) -> None:
    random, names = Random(seed), ("a", "b", "c")  # noqa: S311 - no secrets here
    for _ in range(12):
        formula = conjunction(*(random_formula(random, random.randint(1, 4), names) for _ in range(3)))
        outside, whole = refutation(formula), translate(negation(formula))
        for _ in range(15):
            word = random_word(random, names)
            assert outside.accepts(word) is whole.accepts(word) is not satisfies(word, formula), str(formula)


@pytest.mark.parametrize(("formula", "accepts"), [("true", False), ("false", True), ("true & F true", False)])
def test_constants_are_refuted_always_or_never(formula: str, accepts: bool) -> None:  # noqa: FBT001 - a table's column
    assert refutation(parse_formula(formula)).accepts(random_word(Random(0), ("a",))) is accepts  # noqa: S311


def test_the_sizes_of_conjuncts_add_up() -> None:
    """The negation of the whole would have an automaton of 2 to the power of 20 states on the way."""
    reactions = " & ".join(f"G (b{i} -> F c{i})" for i in range(12))
    patrol = " & ".join(f"G F a{i}" for i in range(8))
    assert refutation(parse_formula(f"{reactions} & {patrol}")).size == 2 * 20


def test_a_refusal_names_the_conjunct_and_what_to_write_instead() -> None:
    with pytest.raises(AutomatonSizeError, match=r"violate `X X X .*\.\.\.`, and .*nested deeper.*smaller formulas"):
        refutation(parse_formula("F a & G F b & " + "X " * 300 + "c"))
