"""Whether part of a mission can be met at all: whether it has a run, and what that is to cover can be covered."""

from dataclasses import dataclass

from mission.errors import NoPlanError
from mission.logic.formula.syntax import Formula
from mission.plan.proved_path import PathPlanner
from mission.plan.shortest_way import RunSearch
from mission.planning.product import Product
from mission.planning.recurrence import has_runs
from mission.planning.refusal import refusal
from mission.spec.specification import Specification, deterministic_of


@dataclass(frozen=True, eq=False)
class Feasibility:
    """Asks for formulas of one mission.

    Attributes:
        search: Finds its runs.
        planner: Plans its paths.
    """

    search: RunSearch
    planner: PathPlanner

    def refusal(self, tried: Formula) -> NoPlanError | None:
        """Why a formula, with the automaton that the mission names, cannot be met; None where it can.

        A run that covers regions is met only if lanes lead through these while nothing of the formula is violated. That
        is asked of a best run: of others, lanes begin elsewhere in the same region.
        """
        search, maps, letters = self.search, self.search.maps, self.search.system.letters
        spec = maps.spec
        automaton = deterministic_of(tried, spec.automaton, letters)
        product = Product(search.system, automaton, maps.triangle, spec.semantics)
        if not has_runs(product):
            return NoPlanError(refusal(product))
        if not any(region.cover for region in spec.regions):
            return None
        best = search.best(Specification(tried, spec.automaton, letters))
        try:
            self.planner.path(best.runs[0], best.product.automaton.whole, maps.start_m)
        except NoPlanError as error:
            return error
        return None
