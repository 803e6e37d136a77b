from random import Random

import pytest

from mission.logic.formula.implication import Implications
from mission.logic.formula.operators import Operator
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.rewriting import simplified
from mission.logic.formula.syntax import postorder
from mission.logic.formula.word import satisfies
from tests.support.formulas import random_formula, random_word

NAMES = ("a", "b", "c")


def check_rewriting(seed: int, formulas: int) -> None:
    random = Random(seed)  # noqa: S311 - no secrets here
    for _ in range(formulas):
        formula = random_formula(random, random.randrange(1, 21), NAMES[: random.randrange(1, 4)])
        short = simplified(formula)
        for _ in range(6):
            word = random_word(random, NAMES)
            assert satisfies(word, formula) == satisfies(word, short), f"{formula} became {short}; {word}"


def check_implications(seed: int, pairs: int) -> int:
    """The number of implications that were found, and held."""
    random = Random(seed)  # noqa: S311 - no secrets here
    found = 0
    for _ in range(pairs):
        left = simplified(random_formula(random, random.randrange(6), NAMES[:2]))
        right = simplified(random_formula(random, random.randrange(6), NAMES[:2]))
        if left is not right and Implications().implies(left, right):
            found += 1
            for _ in range(6):
                word = random_word(random, NAMES[:2])
                assert satisfies(word, right) or not satisfies(word, left), f"{left} does not imply {right}; {word}"
    return found


@pytest.mark.parametrize("seed", range(3))
def test_rewriting_keeps_the_meaning(seed: int) -> None:
    check_rewriting(seed, 150)


def test_implications_are_true() -> None:
    assert check_implications(2, 1500) > 100


@pytest.mark.long
@pytest.mark.timeout(1200)
@pytest.mark.parametrize("seed", range(10, 14))
def test_many_rewritings_and_implications(seed: int) -> None:
    check_rewriting(seed, 5_000)
    assert check_implications(seed, 20_000) > 1_000


def test_negation_normal_form() -> None:
    random = Random(1)  # noqa: S311 - no secrets here
    for _ in range(100):
        for node in postorder(simplified(random_formula(random, 12, NAMES))):
            assert node.operator not in (Operator.IMPLIES, Operator.IFF)
            assert node.operator is not Operator.NOT or node.operands[0].operator is Operator.PROPOSITION


@pytest.mark.parametrize(
    ("text", "short"),
    [
        ("!(a U b)", "!a R !b"),
        ("a & !a", "false"),
        ("G a & F !a", "false"),
        ("a | true", "true"),
        ("F F a", "F a"),
        ("X G F a", "G F a"),
        ("F (a & G F b)", "G F b & F a"),
        ("G a & G b", "G (a & b)"),
        ("F a | F b", "F (a | b)"),
        ("F G a & F G b", "F G (a & b)"),
        ("true U a", "F a"),
        ("a U F b", "F b"),
        ("a -> a", "true"),
        ("a <-> a", "true"),
        ("!a U a", "F a"),
        ("(a U b) U b", "a U b"),
        ("G (a W b)", "G (a | b)"),
        ("F (a M b)", "F (a & b)"),
        ("G F b | F a", "F (a | G F b)"),
        ("G F a -> G F b", "F (G !a | G F b)"),
        ("!a W a", "true"),
    ],
)
def test_rules(text: str, short: str) -> None:
    assert simplified(parse_formula(text)) is parse_formula(short)


def test_a_chain_of_equivalences_stays_small() -> None:
    formula = parse_formula(" <-> ".join(f"G F a{index}" for index in range(20)))
    assert len(postorder(simplified(formula))) < 1000
