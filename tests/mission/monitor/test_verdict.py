"""Three-valued verdicts against the definition of LTL on all short continuations, and progress one can follow."""

from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.logic.automata.automaton import compile_to_alphabet
from mission.logic.automata.refutation import refutation
from mission.logic.formula.conjuncts import separated
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.syntax import TRUE
from mission.logic.formula.word import LassoWord, satisfies
from mission.monitor.verdict import FormulaWatch, Progress, Verdict
from mission.spec.specification import deterministic_of
from tests.support.curves import compiled
from tests.support.drawn_cases import tried

LETTERS = (frozenset[str](), frozenset({"a"}), frozenset({"b"}))
FORMULAS = (
    "F a",
    "G !a",
    "F (a & F b)",
    "!b U a",
    "G F a",
    "F G a",
    "G (a -> F b)",
    "X a",
    "F a & G !b",
    "a W b",
    "true",
    "false",
    "F (a & b)",
    "F a & G !a",
    "F a & G (a -> X b) & G !b",
    "F a & F b & G (a -> X G !b)",
    "G F a & F G !b & (b W a)",
)


def watching(text: str) -> FormulaWatch:
    parts = [compiled(str(part), LETTERS) for part in separated(parse_formula(text)) or (TRUE,)]
    whole = deterministic_of(parse_formula(text), None, LETTERS).whole
    return FormulaWatch(parts, whole, compile_to_alphabet(refutation(parse_formula(text)), LETTERS), LETTERS)


@given(st.sampled_from(FORMULAS), st.lists(st.integers(0, 2), max_size=6))
@tried(160)
def test_the_verdict_is_that_of_all_continuations(text: str, word: list[int]) -> None:
    watch, formula = watching(text), parse_formula(text)
    for letter in word:
        watch.read(letter)
    spelled = tuple(LETTERS[i] for i in word)
    outcomes = {
        satisfies(
            LassoWord((*spelled, *(LETTERS[i] for i in more[:-2])), tuple(LETTERS[i] for i in more[-2:])), formula
        )
        for more in product(range(3), repeat=5)
    }
    decided = Verdict.TRUE if outcomes == {True} else Verdict.FALSE
    assert watch.verdict is (decided if len(outcomes) == 1 else Verdict.OPEN)


@pytest.mark.parametrize(
    ("text", "word", "progress"),
    [
        ("F a", "", Progress(0, 1, ("a",))),
        ("F a", "-", Progress(0, 1, ("a",))),
        ("F a", "a", Progress(1, 1, ())),
        ("F (a & F b)", "-", Progress(0, 2, ("a",))),
        ("F (a & F b)", "ba-", Progress(1, 2, ("b",))),
        ("F (a & F b)", "ab", Progress(2, 2, ())),
        ("F a & F b", "", Progress(0, 2, ("a", "b"))),
        ("F a & F b", "b", Progress(1, 2, ("a",))),
        ("G !a", "b", Progress(0, 0, ())),
        ("G !a", "a", Progress(0, 0, ())),
    ],
)
def test_progress_one_can_follow(text: str, word: str, progress: Progress) -> None:
    watch = watching(text)
    for letter in word:
        watch.read("-ab".index(letter))
    assert watch.progress == progress


@pytest.mark.parametrize(("word", "awaited"), [("a", ("b",)), ("b", ("a",)), ("ab", ("a",)), ("ba-", ("b",))])
def test_recurrent_missions_await_the_next_region(word: str, awaited: tuple[str, ...]) -> None:
    watch = watching("G F a & G F b")
    for letter in word:
        watch.read("-ab".index(letter))
    assert watch.verdict is Verdict.OPEN
    assert watch.progress.awaited in (awaited, ("a", "b"))


def test_a_prefix_may_be_bad_for_a_conjunction_and_for_none_of_its_parts() -> None:
    """Twelve reactions, whose automaton would have thousands of states, and a reaction that is forbidden."""
    letters = (frozenset[str](), *(frozenset({f"{name}{i}"}) for i in range(12) for name in "bc"))
    reactions = [f"G (b{i} -> F c{i})" for i in range(12)]
    parts = [compiled(text, letters) for text in (*reactions, "G !c3")]
    formula = parse_formula(" & ".join((*reactions, "G !c3")))
    outside = compile_to_alphabet(refutation(formula), letters)
    watch = FormulaWatch(parts, deterministic_of(formula, None, letters).whole, outside, letters)
    for names, verdict in (
        (("b0", "c0", "b7", "b5"), Verdict.OPEN),
        (("b3",), Verdict.FALSE),
        (("c7",), Verdict.FALSE),
    ):
        for name in names:
            watch.read(letters.index(frozenset({name})))
        assert watch.verdict is verdict
    assert watch.progress.done == 0
