"""What is left of an automaton accepts exactly the words that complete the beginning."""

from random import Random

from mission.logic.automata.conversion import with_accepting_states
from mission.logic.automata.remainder import delayed, remainder
from mission.logic.automata.translate import translate_generalised
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.word import LassoWord, satisfies
from tests.support.formulas import random_formula, random_letter, random_word

NAMES = ("a", "b")


def test_an_automaton_goes_on_from_the_states_that_a_word_leads_to() -> None:
    random = Random(4)  # noqa: S311 - tests need no secrets
    told = set()
    for _ in range(150):
        formula = random_formula(random, random.randrange(1, 8), NAMES)
        automaton = translate_generalised(formula)
        begin = tuple(random_letter(random, NAMES) for _ in range(random.randrange(4)))
        word = random_word(random, NAMES)
        left = remainder(automaton, begin)
        accepted = left is not None and with_accepting_states(left).accepts(word)
        assert accepted is satisfies(LassoWord(begin + word.prefix, word.suffix), formula), (formula, begin, word)
        told.add(accepted)
        later = LassoWord((random_letter(random, NAMES), *word.prefix), word.suffix)
        assert left is None or with_accepting_states(delayed(left)).accepts(later) is accepted
    assert told == {False, True}


def test_after_a_beginning_that_no_run_reads_nothing_is_left() -> None:
    assert remainder(translate_generalised(parse_formula("G a")), (frozenset("b"),)) is None
