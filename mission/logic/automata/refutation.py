"""Automata of the words that violate a formula."""

from mission.logic.automata.automaton import BuchiAutomaton
from mission.logic.automata.combination import union
from mission.logic.automata.translate import translate
from mission.logic.formula.conjuncts import separated
from mission.logic.formula.syntax import TRUE, Formula, negation


def refutation(formula: Formula) -> BuchiAutomaton:
    """A Büchi automaton of the words that do not satisfy ``formula``.

    All words satisfy a conjunction exactly where all satisfy each of its conjuncts. So it is made of the automata of
    the negations of these, side by side: their sizes add up, where those of a product would multiply.

    Raises:
        AutomatonSizeError: A conjunct, or the automaton of its negation, is too large to be built.
    """
    return union(*(translate(negation(part)) for part in separated(formula) or (TRUE,)))
