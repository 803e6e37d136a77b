"""Automata of the words that violate a formula."""

from typing import Final

from mission.errors import AutomatonSizeError
from mission.logic.automata.automaton import BuchiAutomaton
from mission.logic.automata.combination import union
from mission.logic.automata.translate import translate
from mission.logic.formula.conjuncts import separated
from mission.logic.formula.syntax import TRUE, Formula, negation

_LONGEST: Final = 120  # characters of a formula in a message


def refutation(formula: Formula) -> BuchiAutomaton:
    """A Büchi automaton of the words that do not satisfy ``formula``.

    All words satisfy a conjunction exactly where all satisfy each of its conjuncts. So it is made of the automata of
    the negations of these, side by side: their sizes add up, where those of a product would multiply.

    Raises:
        AutomatonSizeError: A conjunct, or the automaton of its negation, is too large to be built.
    """
    return union(*map(_outside, separated(formula) or (TRUE,)))


def _outside(part: Formula) -> BuchiAutomaton:
    try:
        return translate(negation(part))
    except AutomatonSizeError as error:
        text = str(part)
        name = text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."
        raise AutomatonSizeError(
            f"a proof needs an automaton of the words that violate `{name}`, and {error}; write it as a conjunction of "
            "smaller formulas, each of which is proved by itself"
        ) from error
