"""The best runs of a mission: its specification searched with its costs."""

from dataclasses import dataclass

from mission.errors import SearchSizeError
from mission.plan.specification import Specification, deterministic_of
from mission.planning.objective import Objective
from mission.planning.product import Product
from mission.planning.search import ShortestRuns, search
from mission.planning.transition_system import TransitionSystem
from mission.spec.model import MissionSpec, Semantics


@dataclass(frozen=True, eq=False)
class BestRuns:
    """What the search found.

    Attributes:
        product: The product that was searched.
        runs: The best runs.
        exact: Whether there are no better ones in any order of the tasks that recur. Where these are too many for an
            exact search, the runs are the best among those that meet them in one fixed order.
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

    Tasks that recur are met in whatever order is best.

    Raises:
        NoPlanError: If there is no run.
        AutomatonSizeError: If a part of the specification, or all together, asks for too many states.
        SearchSizeError: If triangles times states are too many.
    """
    automaton = deterministic_of(specification.formula, specification.given, system.letters)
    product = Product(system, automaton, start, semantics)
    try:
        return BestRuns(product, search(product, objective), exact=True)
    except SearchSizeError:
        product = Product(system, automaton.in_turn(), start, semantics)
        return BestRuns(product, search(product, objective, closing=True), exact=False)
