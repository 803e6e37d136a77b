"""From formulas to small Büchi automata."""

from mission.logic.automaton import BuchiAutomaton
from mission.logic.degeneralisation import degeneralised
from mission.logic.diagrams import Diagrams
from mission.logic.formula import Formula, proposition_order
from mission.logic.progression import Progression
from mission.logic.rewriting import simplified
from mission.logic.structure import pruned, state_based
from mission.logic.tableau import Tableau
from mission.logic.weak import is_obligation, weak_structure


def translate(formula: Formula) -> BuchiAutomaton:
    """A Büchi automaton that accepts exactly the words that satisfy ``formula``."""
    short = simplified(formula)
    names = proposition_order(formula)
    diagrams = Diagrams()
    if is_obligation(short):
        progression = Progression(diagrams, names)
        return state_based(pruned(weak_structure(progression, diagrams, names, short, 100_000)))
    structure = pruned(Tableau(diagrams, names).structure(short, 100_000))
    return state_based(pruned(degeneralised(structure, tuple(range(structure.sets)))))
