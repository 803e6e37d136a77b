import pytest

from mission.logic.formula.parser import parse_formula
from mission.logic.formula.syntax import following, proposition
from mission.logic.formula.word import LassoWord, satisfies


def word(text: str) -> LassoWord:
    """``ab . c | a`` is the letters {a, b}, {}, {c} and then {a} for ever; a dot is the empty letter."""
    prefix, suffix = (tuple(frozenset(letter.replace(".", "")) for letter in part.split()) for part in text.split("|"))
    return LassoWord(prefix, suffix)


@pytest.mark.parametrize(
    ("text", "formula", "expected"),
    [
        ("| a", "G a", True),
        ("a a . | a", "G a", False),
        ("a a . | a", "F G a", True),
        ("| a .", "G F a & G F !a", True),
        ("| a .", "F G a", False),
        (". | a b", "X a & X X b & X X X a", True),
        ("| a", "X X X a", True),
        ("a a b | .", "a U b", True),
        ("a . b | .", "a U b", False),
        ("| a", "a U b", False),
        ("| a", "a W b", True),
        ("b b ab | .", "a R b", True),
        ("| b", "a R b", True),
        ("| b", "a M b", False),
        ("b b ab | .", "a M b", True),
        ("b b a | .", "a R b", False),
        ("c | . b", "F b -> (c <-> !a)", True),
        ("| .", "true & !false", True),
        ("a | b c", "G (b -> X c) & G (c -> X b)", True),
    ],
)
def test_textbook_examples(text: str, formula: str, expected: bool) -> None:  # noqa: FBT001 - a verdict
    assert satisfies(word(text), parse_formula(formula)) is expected


def test_depth_is_no_matter() -> None:
    formula = proposition("a")
    for _ in range(3000):
        formula = following(formula)
    assert satisfies(word("| a ."), formula)
    assert not satisfies(word("| . a"), formula)


def test_positions_ahead_are_met_once_and_in_order() -> None:
    lasso = word("a b | c d")
    assert lasso.future(0) == (0, 1, 2, 3)
    assert lasso.future(1) == (1, 2, 3)
    assert lasso.future(3) == (3, 2)


def test_the_loop_has_a_letter() -> None:
    with pytest.raises(ValueError, match="at least one letter"):
        LassoWord((frozenset("a"),), ())
