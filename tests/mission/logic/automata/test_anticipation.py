from random import Random

import pytest

from mission.logic.automata.equivalence import Language, telling_word
from mission.logic.automata.translate import translate, translate_generalised
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.word import satisfies
from tests.support.formulas import random_formula, random_word


@pytest.mark.parametrize(
    ("text", "generalised", "states"),
    [
        ("G F a -> G F b", 2, 3),
        ("(G F a & G F c) -> G F b", 3, 4),
        ("G F a <-> G F b", 2, 4),
        ("(G F a & G F b) -> (G F c & G F d)", 3, 5),
        ("F G (a U b) | G F c", 2, 4),
        ("F (a & X b) | G F c", 3, 4),
    ],
)
def test_what_waits_for_a_guess_waits_for_what_is_recurrent_as_well(text: str, generalised: int, states: int) -> None:
    """No state is needed for the recurrent part alone: the one that waits bears its marks, and has a copy that accepts.

    `G F a <-> G F b` has two sets, of a and of b, and so three copies of the one that waits.
    """
    formula = parse_formula(text)
    assert translate_generalised(formula).size <= generalised
    automaton = translate(formula)
    assert automaton.size <= states
    random = Random(4)  # noqa: S311 - no secrets here
    for _ in range(60):
        word = random_word(random, automaton.propositions)
        assert automaton.accepts(word) is satisfies(word, formula), f"{formula} on {word}"


@pytest.mark.parametrize("shell", ["G F a | F ({})", "G F (a & X b) | (c U ({}))", "X (G F a | ({})) & F b"])
def test_nothing_more_is_accepted_than_before(shell: str) -> None:
    random = Random(shell)  # noqa: S311 - no secrets here
    for _ in range(10):
        formula = parse_formula(shell.format(random_formula(random, random.randrange(1, 7), ("a", "b", "c"))))
        automaton = translate_generalised(formula)
        assert telling_word(Language.of_automaton(automaton), Language.of_formula(formula)) is None
        found = translate(formula)
        for _ in range(20):
            word = random_word(random, ("a", "b", "c"))
            assert found.accepts(word) is satisfies(word, formula), f"{formula} on {word}"
