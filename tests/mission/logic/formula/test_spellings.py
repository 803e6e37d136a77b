"""Each spelling of each operator is read as it, and a region of the same name is that region."""

import pytest

from mission.errors import FormulaSyntaxError
from mission.logic.formula.operators import CONSTANTS, RESERVED, UNARY
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.spellings import COMMANDS, SIGNS, WORDS, Meaning, Sign
from mission.logic.formula.syntax import always, eventually, negation, proposition

SPELLED = [
    *SIGNS.items(),
    *WORDS.items(),
    *((word.upper(), meaning) for word, meaning in WORDS.items()),
    *((word.capitalize(), meaning) for word, meaning in WORDS.items()),
    *((f"\\{command}", meaning) for command, meaning in COMMANDS.items()),
]


def written(spelling: str, meaning: Meaning) -> str:
    """A formula in which nothing but this spelling is unusual."""
    if meaning in CONSTANTS:
        return f"a & {spelling}"
    if meaning in UNARY:
        return f"a & {spelling} b"
    if meaning is Sign.OPEN:
        return f"{spelling} a & b)"
    if meaning is Sign.CLOSE:
        return f"(a & b {spelling}"
    return f"a {spelling} b"


@pytest.mark.parametrize(("spelling", "meaning"), SPELLED)
def test_each_spelling(spelling: str, meaning: Meaning) -> None:
    assert parse_formula(written(spelling, meaning)) is parse_formula(written(meaning.value, meaning))


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("always !k", "G !k"),
        ("eventually a", "F a"),
        ("a and not b", "a & !b"),
        ("not a or next b until c", "!a | (X b) U c"),
        ("always (a implies eventually b)", "G (a -> F b)"),
        (r"\Box \neg k", "G !k"),
        (r"\Box\neg k \land \Diamond(a \lor b)", "G !k & F (a | b)"),
        (r"a \mathcal{U} b", "a U b"),
        (r"\mathbf{GF} a \rightarrow \mathsf F\, \text{home}", "G F a -> F home"),
        (r"\left( a \quad\mathcal{ R }\; b \right)", "a R b"),
        ("⊤ U a", "true U a"),
        ("⊥ ∨ ◻️ a", "false | G a"),
        ("a ⇒ b ⇔ c", "a -> (b <-> c)"),
        ("∼a ⋀ ◯ b", "!a & X b"),
        ("◊ a", "F a"),
        ("𝐆 (a 𝒰 b)", "G (a U b)"),
        ("（a ＆ ！b）｜ K₁", "(a & !b) | K1"),
        ("F\u00a0a\u2009&\u3000b", "F a & b"),
        ("a --> b", "a -> b"),
        ("a <--> b", "a <-> b"),
    ],
)
def test_whole_formulas(text: str, plain: str) -> None:
    assert parse_formula(text) is parse_formula(plain)


def test_a_region_of_the_name_comes_first_where_an_operand_stands() -> None:
    known = frozenset({"next", "not", "and", "always", "true"})
    assert parse_formula("F next & !not", known) is parse_formula('F "next" & !"not"')
    assert parse_formula("and and not", known) is parse_formula('"and" & "not"')
    assert parse_formula("always U true", known) is parse_formula('"always" U "true"')
    assert parse_formula("F next", frozenset({"next"})) is eventually(proposition("next"))
    with pytest.raises(FormulaSyntaxError, match="no operator stands between an operand and k"):
        parse_formula("always not k", frozenset({"not"}))


def test_names_in_quotes_are_taken_as_they_stand() -> None:
    assert parse_formula('F "K₁"') is eventually(proposition("K₁"))
    assert parse_formula('always not "always"') is always(negation(proposition("always")))


def test_the_words_are_those_that_are_written_in_quotes() -> None:
    assert set(WORDS) == RESERVED
    assert str(proposition("Next")) == '"Next"'
