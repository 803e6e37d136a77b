"""From formulas to small Büchi automata."""

from mission.logic.automaton import BuchiAutomaton
from mission.logic.degeneralisation import degeneralised
from mission.logic.diagrams import Diagrams
from mission.logic.formula import Formula, proposition_order
from mission.logic.rewriting import Rewriter, simplified
from mission.logic.structure import pruned, state_based
from mission.logic.tableau import Tableau


def translate(formula: Formula) -> BuchiAutomaton:
    """A Büchi automaton that accepts exactly the words that satisfy ``formula``."""
    short = simplified(formula)
    names = proposition_order(formula)
    structure = pruned(Tableau(Diagrams(), names, Rewriter()).structure(short, 100_000))
    return state_based(pruned(degeneralised(structure, tuple(range(structure.sets)))))
