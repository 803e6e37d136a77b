from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.errors import FormulaSyntaxError
from mission.logic.formula.parser import MAX_DEPTH, MAX_LENGTH, parse_formula
from mission.logic.formula.syntax import always, conjunction, eventually, negation, proposition, release
from tests.support.drawn_cases import tried
from tests.support.formulas import measured_formulas, random_formula


@pytest.mark.parametrize(
    ("text", "written"),
    [
        ("F (S1 & F R) & G !K1", "F (S1 & F R) & G !K1"),
        ("<>(S1 && <>R) && []~K1", "F (S1 & F R) & G !K1"),
        ("◇(S1 ∧ ◇R) ∧ □¬K1", "F (S1 & F R) & G !K1"),
        ("a -> b <-> c -> d", "a -> (b <-> (c -> d))"),
        ("a => b <=> c", "a -> (b <-> c)"),
        ("a | b & c | d", "a | b & c | d"),
        ("(a | b) & c", "(a | b) & c"),
        ("a \\/ b /\\ c || d", "a | b & c | d"),
        ("a U b U c", "a U (b U c)"),
        ("(a U b) U c", "(a U b) U c"),
        ("a V b", "a R b"),
        ("!a U b", "!a U b"),
        ("!(a U b)", "!(a U b)"),
        ("X F G a M b W c", "X F G a M (b W c)"),
        ("a xor b xor c", "!(!(a <-> b) <-> c)"),
        ("a ^ b | c", "!(a <-> b) | c"),
        ("1 & 0 | true & false", "true & false | true & false"),
        ("a_1.b & _x", "a_1.b & _x"),
        ('F "no fly zone" & "F"', 'F "no fly zone" & "F"'),
    ],
)
def test_the_common_syntax(text: str, written: str) -> None:
    assert str(parse_formula(text)) == written


@pytest.mark.parametrize(
    ("text", "written"),
    [
        # U, R, W, M and V are operators only where one must stand.
        ("F R", "F R"),
        ("a R b", "a R b"),
        ("R R R", "R R R"),
        ("U U W W M", "U U (W W M)"),
        ("G !R & F(W)", "G !R & F W"),
        # F, G and X in front of one letter and its digits.
        ("Fp0", "F p0"),
        ("XFp1 | GFa", "X F p1 | G F a"),
        ("FS1 & G!K1", "F S1 & G !K1"),
        ("GF a", "G F a"),
        ("Go", "G o"),
        # Longer words stand for themselves.
        ("F Farm & G Gate", "F Farm & G Gate"),
        ("Field U Xenon", "Field U Xenon"),
        ("F F1 & G1", "F F1 & G1"),
        ("F FS1a", "F FS1a"),
    ],
)
def test_words_are_read_by_documented_rules(text: str, written: str) -> None:
    assert str(parse_formula(text)) == written


@pytest.mark.parametrize(
    ("text", "known", "written"),
    [
        ("F Fa", {"Fa"}, 'F "Fa"'),
        ("F Fa", {"a"}, "F F a"),
        ("GFarm & FFarm", {"Farm"}, "G Farm & F Farm"),
        ("FGate", {"Gate", "ate"}, "F Gate"),
        ("FGate", {"ate"}, "F G ate"),
        ("G", {"G"}, '"G"'),
        ("F G", {"G"}, 'F "G"'),
        ("true", {"true"}, '"true"'),
        ("FFeild", {"Field"}, "FFeild"),
        ("R R R", {"R"}, "R R R"),
    ],
)
def test_known_propositions_come_first(text: str, known: set[str], written: str) -> None:
    assert str(parse_formula(text, frozenset(known))) == written


def test_the_region_r_and_the_operator_r() -> None:
    assert parse_formula("F R") is eventually(proposition("R"))
    assert parse_formula("R R R") is release(proposition("R"), proposition("R"))


def test_the_formulas_that_automata_are_measured_on_are_read() -> None:
    for group in ("dac", "mission"):
        for measured in measured_formulas(group):
            assert parse_formula(str(measured.formula)) is measured.formula
    assert parse_formula("Fp0") is eventually(proposition("p0"))
    assert parse_formula("G!p0") is always(negation(proposition("p0")))


@pytest.mark.parametrize(
    ("text", "column", "message", "hint"),
    [
        ("", 1, "empty", "F a"),
        ("   ", 1, "empty", "F a"),
        ("a b", 3, "no operator stands between an operand and b", "an operator"),
        ("a & ", 4, "& lacks its operand", "a proposition"),
        ("& a", 1, "& has no left operand", "a proposition"),
        ("a & | b", 5, "| has no left operand", "a proposition"),
        ("F", 2, "F lacks its operand", 'written "F"'),
        ("(a", 1, "never closed", ")"),
        ("a)", 2, "closes nothing", "("),
        (")", 1, "begins with )", ""),
        ("()", 2, "empty", "a proposition"),
        ("a & F)", 6, "F lacks its operand", 'written "F"'),
        ("a (b)", 3, "between an operand and (", "an operator"),
        ("a !b", 3, "between an operand and !", "an operator"),
        ("a Ub", 3, "between an operand and Ub", "U b"),
        ("a 1", 3, "between an operand and 1", "an operator"),
        ('a "b"', 3, "between an operand", "an operator"),
        ("p0 p1", 4, "between an operand and p1", "an operator"),
        ("a # b", 3, "'#' has no meaning", "an operator"),
        ("a * b", 3, "'*' has no meaning", "and is written &"),
        ("F a, b", 4, "',' has no meaning", "and is written &"),
        ("F no-fly", 5, "'-' has no meaning", "a name has letters, digits"),
        ("◆ a", 1, "(U+25C6 BLACK DIAMOND) has no meaning", "past"),
        ("a \u200b", 3, "(U+200B ZERO WIDTH SPACE) has no meaning", "an operator"),
        ("F “a”", 3, "(U+201C LEFT DOUBLE QUOTATION MARK)", 'quotes are written "'),
        ("\\foo a", 1, "\\foo has no meaning", "-> <-> F G X U"),
        ("\\!a", 1, "'\\\\' has no meaning", "a proposition"),
        ("and a", 1, "and has no left operand", 'written "and"'),
        ("a & next", 9, "next lacks its operand", 'written "next"'),
        ("a always b", 3, "no operator stands between an operand and always", "an operator"),
        ("a & 2b", 5, "2b is neither", "letter"),
        ('"a', 1, "never closed", '"'),
        ('""', 1, "cannot be the name", "letters"),
        ("xor a", 1, "no left operand", ""),
        ("a\n& $", 5, "'$' has no meaning", "a proposition"),
    ],
)
def test_faults_have_a_column_and_a_hint(text: str, column: int, message: str, hint: str) -> None:
    with pytest.raises(FormulaSyntaxError) as caught:
        parse_formula(text)
    assert caught.value.column == column
    assert message in caught.value.message
    assert hint in caught.value.hint
    assert caught.value.text == text


@pytest.mark.parametrize(
    "text",
    [
        "(" * 10_000 + "a" + ")" * 10_000,
        "!" * 10_000 + "a",
        "X " * 10_000 + "a",
        "a U " * 10_000 + "a",
        "a->" * 9000 + "a",
    ],
)
def test_nesting_is_bounded(text: str) -> None:
    with pytest.raises(FormulaSyntaxError, match="nested deeper"):
        parse_formula(text)


def test_nesting_up_to_the_bound_is_read_back() -> None:
    formula = parse_formula("(" * MAX_DEPTH + "a" + ")" * MAX_DEPTH)
    assert formula is proposition("a")
    deep = parse_formula("a U (" * (MAX_DEPTH - 1) + "a" + ")" * (MAX_DEPTH - 1))
    assert parse_formula(str(deep)) is deep


def test_length_is_bounded_but_long_chains_are_not_deep() -> None:
    with pytest.raises(FormulaSyntaxError, match="characters"):
        parse_formula("a" * (MAX_LENGTH + 1))
    names = [f"a{index}" for index in range(5000)]
    assert parse_formula(" & ".join(names)) is conjunction(*map(proposition, names))


@given(st.integers(0, 10**9), st.integers(0, 25))
@tried(200)
def test_the_text_of_a_formula_is_read_as_the_same_formula(seed: int, operators: int) -> None:
    names = ("a", "R", "U", "F", "Farm", "Fa", "true", "S1", "two words", "G1", "xor", "V", "Next", "and", "K_1")
    formula = random_formula(Random(seed), operators, names)  # noqa: S311 - no secrets here
    assert parse_formula(str(formula)) is formula


_SPELLINGS = ("xor", "not ", " until ", "\\neg", "\\mathcal{U}", "⊤", "𝒰", "◆")
_PIECES = st.sampled_from([*'aFGXUR()!&|"1-<é\\\0V ', "->", "<->", "<>", "[]", *_SPELLINGS])


@given(st.one_of(st.text(max_size=40), st.lists(_PIECES, max_size=30).map("".join)))
@tried(400)
def test_malformed_text_raises_nothing_else(text: str) -> None:
    fault = None
    try:
        formula = parse_formula(text)
        assert parse_formula(str(formula)) is formula
    except FormulaSyntaxError as error:
        fault = error
    assert fault is None or (fault.message and 1 <= fault.column <= len(text) + 1)
