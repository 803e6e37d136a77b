from random import Random

import pytest

from mission.errors import AutomatonSizeError
from mission.logic.automata import stutter
from mission.logic.automata.complement import complement
from mission.logic.automata.conversion import with_accepting_states
from mission.logic.automata.stutter import tells_repeats_apart
from mission.logic.automata.translate import translate
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.syntax import negation
from mission.logic.formula.word import LassoWord, Letter
from tests.support.automata import LETTERS, random_automaton


@pytest.mark.parametrize("text", ["F (a & F b)", "G F a & G F b", "F G a | a U b", "X true", "G (a -> F !a)", "false"])
def test_without_next_a_formula_tells_no_repeats_apart(text: str) -> None:
    formula = parse_formula(text)
    assert not tells_repeats_apart(translate(formula), translate(negation(formula)), LETTERS)


@pytest.mark.parametrize("text", ["X a", "F (a & X a)", "a & X !a", "G (a -> X b)", "G F (a & X a & X X !a)"])
def test_with_next_it_does_where_it_cannot_be_said_otherwise(text: str) -> None:
    formula = parse_formula(text)
    assert tells_repeats_apart(translate(formula), translate(negation(formula)), LETTERS)


def test_next_makes_no_difference_where_it_only_waits_for_a_change() -> None:
    formula = parse_formula("F (a & X (a U !a))")  # "after some a there is a time without": F (a & F !a)
    assert not tells_repeats_apart(translate(formula), translate(negation(formula)), LETTERS)


def test_it_depends_on_the_letters_that_there_are() -> None:
    formula = parse_formula("G (a -> X b)")
    pair = translate(formula), translate(negation(formula))
    assert tells_repeats_apart(*pair, (frozenset("a"), frozenset("b")))
    assert not tells_repeats_apart(*pair, (frozenset("ab"), frozenset("b")))


def lassos(letters: tuple[Letter, ...]) -> list[LassoWord]:
    """Lasso words in which equal letters do not follow each other."""
    parts = [(), *((x,) for x in letters), *((x, y) for x in letters for y in letters if x != y)]
    words = [LassoWord(head, loop) for head in parts for loop in parts if loop]
    return [word for word in words if word.prefix[-1:] != word.suffix[:1]]


def stretched(random: Random, word: LassoWord) -> LassoWord:
    def repeated(part: tuple[Letter, ...]) -> tuple[Letter, ...]:
        return tuple(letter for letter in part for _ in range(random.randint(1, 3)))

    return LassoWord(repeated(word.prefix), repeated(word.suffix) + repeated(word.suffix))


@pytest.mark.parametrize("seed", range(3))
def test_automata_that_tell_none_apart_judge_stretched_words_alike(seed: int) -> None:
    random = Random(seed)  # noqa: S311 - no secrets here
    letters = LETTERS[:2]
    told = equal = shown = 0
    for _ in range(60):
        given = random_automaton(random, random.randint(1, 3), 1, 1.0, 2)
        machine = with_accepting_states(given)
        differ = any(
            machine.accepts(word) is not machine.accepts(stretched(random, word)) for word in lassos(letters) * 3
        )
        if tells_repeats_apart(machine, complement(given, letters), letters):
            told += 1
            shown += differ
        else:
            equal += 1
            assert not differ, given
    assert min(told, equal) > 5
    assert shown > told / 2


def test_a_question_that_is_too_large_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stutter, "MAX_STATES", 3)
    formula = parse_formula("F (a & F b)")
    with pytest.raises(AutomatonSizeError, match="more than 3 states"):
        tells_repeats_apart(translate(formula), translate(negation(formula)), LETTERS)
