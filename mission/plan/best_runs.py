"""The best runs of a mission: its specification searched with its costs."""

from dataclasses import dataclass

from mission.errors import SearchSizeError
from mission.logic.automata.automaton import compile_generalised, compile_to_alphabet
from mission.plan.specification import Specification
from mission.planning.objective import Objective
from mission.planning.product import Product
from mission.planning.search import ShortestRuns, search
from mission.planning.tours import MOST_SETS
from mission.planning.transition_system import TransitionSystem
from mission.spec.model import MissionSpec, Semantics


@dataclass(frozen=True, eq=False)
class BestRuns:
    """What the search found.

    Attributes:
        product: The product that was searched.
        runs: The best runs.
        exact: Whether there are no better ones in any order of the tasks that recur. Where these are too many for an
            exact search, the runs are the best among those that meet them in the one order that the automaton fixes.
    """

    product: Product
    runs: ShortestRuns
    exact: bool


def objective_of(spec: MissionSpec) -> Objective:
    """How a mission weighs prefix and suffix."""
    return Objective(spec.search.prefix_weight, spec.search.suffix_weight)


def best_runs(
    system: TransitionSystem, specification: Specification, start: int, semantics: Semantics, objective: Objective
) -> BestRuns:
    """Search the product of a transition system with a specification.

    Tasks that recur are met in whatever order is best, which an automaton with several acceptance sets leaves open.
    Where all of them are one set, the smaller automaton with accepting states serves.

    Raises:
        NoPlanError: If there is no run.
        AutomatonSizeError: If the generalised automaton is too large to be built.
    """
    automaton = specification.generalised
    if 1 < automaton.sets <= MOST_SETS:
        try:
            product = Product(system, compile_generalised(automaton, system.letters), start, semantics)
            return BestRuns(product, search(product, objective), exact=True)
        except SearchSizeError:
            pass
    in_turn = compile_to_alphabet(specification.automaton, system.letters)
    product = Product(system, in_turn, start, semantics)
    return BestRuns(product, search(product, objective), exact=automaton.sets <= 1)
