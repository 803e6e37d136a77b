"""The best runs of a mission: its specification searched with its costs."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

from mission.errors import SearchSizeError
from mission.logic.automata.conjunction import Conjunction
from mission.plan.way import Way
from mission.planning.objective import Objective
from mission.planning.product import Product
from mission.planning.run import Run
from mission.planning.search import search
from mission.planning.transition_system import TransitionSystem
from mission.spec.model import MissionSpec, Semantics
from mission.spec.specification import Specification, deterministic_of


class Runs(Protocol):
    """Some runs, numbered from 0; ``ShortestRuns`` are all of the least cost."""

    @property
    def count(self) -> int:
        """How many there are."""

    @property
    def cost(self) -> int:
        """The weighed cost of each of them."""

    def __getitem__(self, index: int) -> Run:
        """The run of a number; IndexError beyond the last."""

    def __iter__(self) -> Iterator[Run]:
        """One after the other."""


@dataclass(frozen=True)
class OneRun:
    """The one run that is a shortest way's."""

    run: Run
    cost: int
    count: int = 1

    def __getitem__(self, index: int) -> Run:
        """The run, whose number is 0."""
        return (self.run,)[index]

    def __iter__(self) -> Iterator[Run]:
        """It alone."""
        yield self.run


@dataclass(frozen=True, eq=False)
class BestRuns:
    """What the search found.

    Attributes:
        product: The product of T and the specification.
        runs: The best runs.
        exact: Whether there are no better ones in any order of the tasks that recur. Where these are too many for an
            exact search, the runs are the best among those that meet them in one fixed order.
        way: The shortest way in the plane along which the one run goes; None where runs were searched in T.
        way_costs: What its prefix and one round of its loop cost, in the unit of the mission's costs.
    """

    product: Product
    runs: Runs
    exact: bool
    way: Way | None = None
    way_costs: tuple[float, float] | None = None


def objective_of(spec: MissionSpec) -> Objective:
    """How a mission weighs prefix and suffix."""
    return Objective(spec.search.prefix_weight, spec.search.suffix_weight)


def best_runs(
    system: TransitionSystem, specification: Specification, start: int, semantics: Semantics, objective: Objective
) -> BestRuns:
    """Search the product of a transition system with a specification.

    Raises:
        NoPlanError: As in ``best_accepted``.
        AutomatonSizeError: If a part of the specification, or all together, asks for too many states.
        SearchSizeError: As in ``best_accepted``.
    """
    automaton = deterministic_of(specification.formula, specification.given, system.letters)
    return best_accepted(system, automaton, start, semantics, objective)


def best_accepted(
    system: TransitionSystem,
    automaton: Conjunction,
    start: int,
    semantics: Semantics,
    objective: Objective,
    *,
    closing: bool = False,
) -> BestRuns:
    """The same with an automaton over the letters of the system; ``closing`` is that of ``search``.

    Tasks that recur are met in whatever order is best.

    Raises:
        NoPlanError: If there is no run.
        SearchSizeError: If states of the system times those of the automaton are too many.
    """
    product = Product(system, automaton, start, semantics)
    try:
        return BestRuns(product, search(product, objective, closing=closing), exact=True)
    except SearchSizeError:
        product = Product(system, automaton.in_turn(), start, semantics)
        return BestRuns(product, search(product, objective, closing=True), exact=False)
