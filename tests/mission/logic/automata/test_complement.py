"""Complements against membership, decided straight from the definition of generalised Büchi acceptance."""

from random import Random

import pytest
from hypothesis import given, reject
from hypothesis import strategies as st

from mission.errors import AutomatonSizeError
from mission.logic.automata import complement as module
from mission.logic.automata.automaton import GeneralisedBuchi
from mission.logic.automata.complement import complement
from mission.logic.automata.conversion import with_marked_transitions
from mission.logic.automata.translate import translate, translate_generalised
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.syntax import negation
from mission.logic.formula.word import LassoWord, satisfies
from mission.logic.hoa.text import parse_generalised
from tests.support.automata import LETTERS, NAMES, accepts, random_automaton, random_lasso
from tests.support.drawn_cases import tried
from tests.support.formulas import random_formula


def complements(random: Random, automaton: GeneralisedBuchi, letters: int, words: int) -> None:
    other = complement(automaton, LETTERS[:letters])
    for _ in range(words):
        word = random_lasso(random, letters)
        assert accepts(automaton, word) is not other.accepts(word), f"{automaton} on {word}"


@given(
    seed=st.integers(0, 2**32),
    size=st.integers(1, 4),
    sets=st.integers(0, 2),
    degree=st.sampled_from([0.8, 1.2, 1.6, 2.2]),
    letters=st.integers(1, 4),
)
@tried(100)
def test_each_word_is_accepted_by_the_one_or_the_other(
    seed: int, size: int, sets: int, degree: float, letters: int
) -> None:
    random = Random(seed)  # noqa: S311 - no secrets here
    try:
        complements(random, random_automaton(random, size, sets, degree, letters), letters, 12)
    except AutomatonSizeError:
        reject()


@pytest.mark.long
@pytest.mark.parametrize("seed", range(6))
def test_each_word_is_accepted_by_the_one_or_the_other_at_length(seed: int) -> None:
    random = Random(seed)  # noqa: S311 - no secrets here
    refused = 0
    for _ in range(150):
        letters = random.randint(1, 4)
        automaton = random_automaton(random, random.randint(1, 5), random.randrange(3), 1.6, letters)
        try:
            complements(random, automaton, letters, 40)
        except AutomatonSizeError:
            refused += 1
    assert refused <= 3


@pytest.mark.parametrize("seed", range(2))
def test_the_complement_of_a_formula_is_its_negation(seed: int) -> None:
    random = Random(seed)  # noqa: S311 - no secrets here
    for _ in range(25):
        formula = random_formula(random, random.randrange(8), NAMES)
        other = complement(translate_generalised(formula), LETTERS)
        for _ in range(20):
            word = random_lasso(random, 4)
            assert other.accepts(word) is not satisfies(word, formula), f"{formula} on {word}"


@pytest.mark.parametrize("text", ["G F a & G F b", "F a", "G (a -> F b)", "F G a", "F G a | G F b", "a U b"])
def test_the_complement_of_the_complement_is_the_language(text: str) -> None:
    random, formula = Random(1), parse_formula(text)  # noqa: S311 - no secrets here
    once = complement(translate_generalised(formula), LETTERS)
    twice = complement(with_marked_transitions(once), LETTERS)
    for _ in range(60):
        word = random_lasso(random, 4)
        assert twice.accepts(word) is satisfies(word, formula), f"{text} on {word}"


@pytest.mark.parametrize("text", ["F (a & F b)", "G !a", "a U b", "G F a", "F a & G !b"])
def test_of_a_simple_automaton_it_is_as_small_as_that_of_the_negated_formula(text: str) -> None:
    formula = parse_formula(text)
    other = complement(translate_generalised(formula), LETTERS)
    assert other.size <= translate(negation(formula)).size, text


def test_only_the_letters_that_occur_matter() -> None:
    # Nondeterministic in general, deterministic where a and b never hold together.
    text = (
        'HOA: v1 Start: 0 AP: 2 "a" "b" Acceptance: 1 Inf(0) --BODY-- State: 0 [0] 0 [1] 1 State: 1 {0} [1] 1 --END--'
    )
    automaton = parse_generalised(text)
    other = complement(automaton, (frozenset({"a", "elsewhere"}), frozenset({"b"}), frozenset({"b", "there"})))
    a, b = frozenset("a"), frozenset("b")
    assert not other.accepts(LassoWord((a,), (b,)))
    assert other.accepts(LassoWord((a, b), (a,)))
    assert other.accepts(LassoWord((), (a,)))
    assert other.propositions == NAMES
    assert other.deterministic or other.size <= 4


def test_nothing_and_everything() -> None:
    nothing = GeneralisedBuchi(NAMES, 1, (0,), 1, ())
    everything = complement(nothing, LETTERS)
    again = complement(translate_generalised(parse_formula("true")), LETTERS)
    for word in (LassoWord((), (letter,)) for letter in LETTERS):
        assert everything.accepts(word)
        assert not again.accepts(word)
    assert again.edges == ()


def test_a_complement_beyond_the_bound_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MAX_STATES", 20)
    random = Random(5)  # noqa: S311 - no secrets here
    with pytest.raises(AutomatonSizeError, match=r"more than 20 states.* smaller automaton, or a deterministic one"):
        complement(random_automaton(random, 6, 2, 2.2, 4), LETTERS)
