"""The shortest way that satisfies a mission, and the run of T along it.

Runs over triangles say little of lengths: the ways between the middles of triangles are longer than need be, on one
run more than on another, and on another mesh otherwise. So the search goes over crossing points of a mesh that is made
for it, from the outlines of what the regions part alone (``mission.planning.crossings``); the run of T is what that way
goes through. On the way there is room for the tube wherever the map has room for it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import shapely

from mission.errors import NoPlanError, SearchSizeError
from mission.geometry.arrays import BoolArray, FloatArray
from mission.geometry.simplices import Partition
from mission.logic.automata.conjunction import Conjunction
from mission.logic.automata.safety import Safety
from mission.plan.best_runs import BestRuns, OneRun, best_accepted, objective_of
from mission.plan.costs import UNIT, passage_lengths
from mission.plan.crossing_maps import CrossingMaps
from mission.plan.homeward import way_in
from mission.plan.way import Way
from mission.planning.crossings import Crossings
from mission.planning.product import Product
from mission.planning.run import Run
from mission.planning.traced import Tracer, stretches
from mission.planning.transition_system import TransitionSystem
from mission.spec.model import Cost, MissionSpec, Semantics
from mission.spec.specification import Specification, deterministic_of


@dataclass(frozen=True, eq=False)
class RunSearch:
    """Searches the best runs of one mission, by whatever cost.

    Attributes:
        system: T, with weights.
        maps: Crossing points on the map.
        closing: Whether a loop must lead the automaton back to where it was, so that all rounds are alike.
    """

    system: TransitionSystem
    maps: CrossingMaps
    closing: bool = False

    def best(
        self, specification: Specification, closed: Sequence[int] = (), unfit: frozenset[int] = frozenset()
    ) -> BestRuns:
        """The best runs that keep out of some triangles: all with the fewest transitions, or one on a shortest way.

        Runs are searched in T where triangles are given to keep out of, for with these a run along a way was not
        proved; and where no way is found, or the specification does not accept what its run reads: it counts triangles,
        perhaps.

        Args:
            specification: What the flight must satisfy.
            closed: Triangles to keep out of.
            unfit: Letters, of whose triangles all are kept out of.

        Raises:
            NoPlanError: If there is no run.
            AutomatonSizeError: If a part of the specification, or all together, asks for too many states.
            SearchSizeError: If triangles times states are too many.
        """
        automaton = deterministic_of(specification.formula, specification.given, self.system.letters)
        in_plane = self._spec.search.cost is not Cost.TRANSITIONS and not closed
        found = self._on_a_way(automaton, unfit) if in_plane else None
        closed = [*closed, *self.of_letters(unfit)]
        return found or self._searched(self.system.without(closed), automaton, self.maps.triangle)

    def of_letters(self, letters: frozenset[int]) -> list[int]:
        """The triangles of some letters, ascending."""
        found: list[int] = np.flatnonzero(np.isin(self.system.letter_of, list(letters))).tolist()
        return found

    def homeward(self, laps: BestRuns, onward: Safety, goal: BoolArray, *, lap_triangle: int) -> Run | None:
        """The best run from where laps end into one of some triangles (M,), to stay there.

        Args:
            laps: What was searched for them.
            onward: What must not be read on the way.
            goal: The triangles.
            lap_triangle: The triangle in which the laps end.

        Returns:
            None where there is none.
        """
        if laps.way is not None:
            end, maps = laps.way.prefix_m[-1], self.maps.each(laps.product.automaton)
            ways = (self._homeward_on(ground, end, onward, lap_triangle, goal) for ground in maps)
            run = next((one for one in ways if one is not None), None)
            if run is not None:
                return run
        return way_in(self.system, onward, lap_triangle, goal)

    def _on_a_way(self, automaton: Conjunction, unfit: frozenset[int]) -> BestRuns | None:
        for ground in self.maps.each(automaton, unfit):
            try:
                found = self._searched(ground.system, automaton, ground.start)
            except (NoPlanError, SearchSizeError):
                continue
            run = self._traced(ground, found.runs[0], self.maps.triangle)
            if run is not None and self._accepts(automaton, run):
                counted = TransitionSystem(self.system.successors, self.system.letter_of, self.system.letters)
                product = Product(counted, found.product.automaton, self.maps.triangle, self._spec.semantics)
                one = OneRun(run, found.runs.cost)
                return BestRuns(product, one, found.exact, *self._way(ground, found.runs[0]))
        return None

    def _homeward_on(
        self, ground: Crossings, end_m: FloatArray, onward: Safety, lap_triangle: int, goal: BoolArray
    ) -> Run | None:
        letter = self.system.letter_of[lap_triangle]
        here = (ground.points_m == end_m).all(axis=1) & (ground.system.letter_of == letter)
        if not here.any():
            return None
        # A state is in the goal where it touches a triangle of it that is of its letter.
        states, triangles = self.maps.locator.tree.query(
            shapely.points(ground.points_m), predicate="dwithin", distance=self.maps.near_m
        )
        inside = np.zeros(ground.system.size, dtype=np.bool_)
        inside[states[goal[triangles] & (self.system.letter_of[triangles] == ground.system.letter_of[states])]] = True
        found = way_in(ground.system, onward, int(np.argmax(here)), inside)
        return None if found is None else self._traced(ground, found, lap_triangle, goal)

    def _searched(self, system: TransitionSystem, automaton: Conjunction, start: int) -> BestRuns:
        objective = objective_of(self._spec)
        return best_accepted(system, automaton, start, self._spec.semantics, objective, closing=self.closing)

    @property
    def _spec(self) -> MissionSpec:
        return self.maps.spec

    @property
    def _partition(self) -> Partition:
        return self.maps.locator.partition

    @cached_property
    def _tracer(self) -> Tracer:
        return Tracer(
            self._partition,
            self.maps.locator.tree,
            self.system.letter_of,
            ~self.maps.restricted,
            passage_lengths(self._partition),
            self.maps.near_m,
        )

    def _traced(self, ground: Crossings, run: Run, first: int, ends: BoolArray | None = None) -> Run | None:
        """The run of T along a run over crossing points, from a triangle on; None where there is none.

        Where the flight stays, it may be asked in which of some triangles.
        """
        head = self._chain(ground, [*run.prefix, run.suffix[0]], first, ends)
        if head is None:
            return None
        loop: tuple[int, ...] | None = (head[-1],)
        if len(run.suffix) > 1:
            around = np.arange(self._partition.size) == head[-1]
            loop = self._chain(ground, [*run.suffix, run.suffix[0]], head[-1], around)
            loop = loop and (loop[:-1] or loop)
        if loop is None:
            return None
        every = (*head[:-1], *loop, head[-1])
        controls = [self._control(here, there) for here, there in pairwise(every)]
        return Run(head[:-1], loop, tuple(controls))

    def _chain(
        self, ground: Crossings, states: list[int], first: int, ends: BoolArray | None
    ) -> tuple[int, ...] | None:
        way = stretches(ground.system.letter_of[states], ground.points_m[states])
        return self._tracer.chain(way, first, ends)

    def _control(self, here: int, there: int) -> int:
        return 0 if here == there else 1 + self._partition.neighbours[here].tolist().index(there)

    def _accepts(self, automaton: Conjunction, run: Run) -> bool:
        prefix, loop = ([int(self.system.letter_of[t]) for t in part] for part in (run.prefix, run.suffix))
        if self._spec.semantics is Semantics.PAPER:
            # The start's label is not read; where the loop begins there, it is read at the end of each round.
            prefix, loop = (prefix[1:], loop) if prefix else ([], [*loop[1:], loop[0]])
        return automaton.whole.accepts(prefix, loop)

    def _way(self, ground: Crossings, run: Run) -> tuple[Way, tuple[float, float]]:
        """The way that a run over crossing points is, and what its prefix and its loop cost."""
        unit = UNIT[self._spec.search.cost][1]
        weights = ground.system.weights[list(run.states), list(run.controls)] * unit
        head = len(run.prefix)
        before = ground.points_m[[*run.prefix, run.suffix[0]]]
        around = ground.points_m[[*run.suffix, *run.suffix[: len(run.suffix) > 1]]]
        return Way(_distinct(before), _distinct(around)), (float(weights[:head].sum()), float(weights[head:].sum()))


def _distinct(points: FloatArray) -> FloatArray:
    """Points without those that are where the one before is."""
    distinct: FloatArray = points[np.append(True, (np.diff(points, axis=0) != 0.0).any(axis=1))]
    return distinct
