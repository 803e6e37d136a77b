"""Equivalence of formulas and automata: a word that tells two apart does, and none is missed."""

from random import Random

import pytest

from mission.errors import AutomatonSizeError
from mission.logic.automata import equivalence
from mission.logic.automata.equivalence import Language, telling_word, told_apart
from mission.logic.automata.translate import translate_generalised
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.syntax import conjunction, disjunction, negation
from mission.logic.formula.word import satisfies
from tests.support.automata import accepts, random_automaton, random_lasso
from tests.support.formulas import random_formula, random_word


@pytest.mark.parametrize("seed", range(3))
def test_formulas_are_told_apart_by_a_word_of_one_of_them(seed: int) -> None:
    random, names, different = Random(seed), ("a", "b"), 0  # noqa: S311 - no secrets here
    for _ in range(40):
        one, other = (random_formula(random, random.randint(1, 4), names) for _ in range(2))
        word = telling_word(Language.of_formula(one), Language.of_formula(other))
        if word is None:
            words = (random_word(random, names) for _ in range(30))
            assert all(satisfies(word, one) is satisfies(word, other) for word in words), f"{one} and {other}"
        else:
            different += 1
            assert satisfies(word, one) is not satisfies(word, other)
    assert 0 < different < 40


@pytest.mark.parametrize("seed", range(3))
def test_automata_are_told_apart_by_a_word_of_one_of_them(seed: int) -> None:
    random = Random(seed)  # noqa: S311 - no secrets here
    for _ in range(12):
        one, other = (random_automaton(random, random.randint(1, 3), random.randrange(3), 1.6, 4) for _ in range(2))
        word = telling_word(Language.of_automaton(one), Language.of_automaton(other))
        if word is None:
            words = (random_lasso(random, 4) for _ in range(30))
            assert all(accepts(one, word) is accepts(other, word) for word in words)
        else:
            assert accepts(one, word) is not accepts(other, word)
        assert telling_word(Language.of_automaton(one), Language.of_automaton(one)) is None


@pytest.mark.parametrize("seed", range(2))
def test_a_formula_is_equivalent_to_its_automaton_and_to_no_weaker_one(seed: int) -> None:
    random, names = Random(seed), ("a", "b", "c")  # noqa: S311 - no secrets here
    for _ in range(12):
        formula = random_formula(random, random.randint(1, 5), names)
        given = Language.of_automaton(translate_generalised(formula))
        assert telling_word(Language.of_formula(formula), given) is None
        other = random_formula(random, 3, names)
        both, rest = conjunction(formula, other), conjunction(formula, negation(other))
        assert telling_word(Language.of_formula(disjunction(both, rest)), given) is None
        word = telling_word(given, Language.of_formula(both))
        assert word is None or (satisfies(word, formula) and not satisfies(word, other))


def test_the_letters_are_those_that_the_labels_tell_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    machine = translate_generalised(parse_formula("G (a & b & c)"))
    assert set(told_apart([machine])) == {frozenset("abc"), frozenset()}
    monkeypatch.setattr(equivalence, "MAX_LETTERS", 3)
    with pytest.raises(AutomatonSizeError, match="more than 3 letters apart"):
        telling_word(Language.of_automaton(machine), Language.of_formula(parse_formula("F a & F b & F d")))
