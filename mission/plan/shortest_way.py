"""The shortest way that satisfies a mission, and the run of T along it.

Runs over triangles say little of lengths: the ways between the middles of triangles are longer than need be, on one
run more than on another, and on another mesh otherwise. So the search goes over crossing points of a mesh that is made
for it, from the outlines of what the regions part alone (``mission.planning.crossings``); the run of T is what that way
goes through. On the way there is room for the tube wherever the map has room for it.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Final

import numpy as np
import shapely

from mission.errors import GeometryError, NoPlanError, SearchSizeError
from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.geometry.location import Locator
from mission.geometry.outline_mesh import JOINED, ClassedMesh, Outlines
from mission.geometry.regions import Labelling, union_of
from mission.geometry.simplices import Partition
from mission.geometry.triangulation import selected
from mission.logic.automata.conjunction import Conjunction
from mission.plan.best_runs import BestRuns, OneRun, best_runs, objective_of
from mission.plan.costs import UNIT, passage_lengths
from mission.plan.specification import Specification, deterministic_of
from mission.plan.way import Way
from mission.planning.crossings import Crossings, Spacing, crossings
from mission.planning.product import Product
from mission.planning.run import Run
from mission.planning.traced import Tracer, stretches
from mission.planning.transition_system import TransitionSystem
from mission.spec.model import Cost, MissionSpec, Point, Semantics

_LARGEST: Final = 0.1  # of the extent: the longest edge of the mesh
_SPACINGS: Final = ((0.015, 1, 5), (0.02, 1, 3), (0.03, 1, 2), (0.03, 1, 1), (0.03, 0, 1))
"""Distances of crossing points, of the extent, and how many there are on an edge: the finer, the better."""
_MOST_WAYS: Final = 4_000_000
"""Ways times states of the automaton, and sets of what recurs, that a search may take; the finest that do are used."""


@dataclass(frozen=True, eq=False)
class RunSearch:
    """Searches the best runs of one mission, by whatever cost.

    Attributes:
        spec: The mission.
        system: T, with weights.
        partition: Its triangles.
        labelling: Their labels.
        restricted: Shape (M,), triangles that must not be entered.
        locator: Finds triangles.
        start_m: Where the flight begins.
        triangle: The triangle there.
    """

    spec: MissionSpec
    system: TransitionSystem
    partition: Partition
    labelling: Labelling
    restricted: BoolArray
    locator: Locator
    start_m: Point
    triangle: int

    def best(self, specification: Specification, closed: Sequence[int] = ()) -> BestRuns:
        """The best runs that keep out of some triangles: all with the fewest transitions, or one on a shortest way.

        Where no way is found, or the specification does not accept what its run reads (it counts triangles, perhaps),
        runs are searched in T.

        Args:
            specification: What the flight must satisfy.
            closed: Triangles to keep out of.

        Raises:
            NoPlanError: If there is no run.
            AutomatonSizeError: As in ``best_runs``.
            SearchSizeError: Likewise.
        """
        found = None if self.spec.search.cost is Cost.TRANSITIONS else self._on_a_way(specification, closed)
        return found or self._searched(self.system.without(closed), specification, self.triangle)

    def _on_a_way(self, specification: Specification, closed: Sequence[int]) -> BestRuns | None:
        automaton = deterministic_of(specification.formula, specification.given, self.labelling.letters)
        for ground in self._grounds(_copies(automaton)):
            within = ground.without(self._inside(closed)) if closed else ground
            try:
                found = self._searched(within.system, specification, within.start)
            except (NoPlanError, SearchSizeError):
                continue
            run = self._traced(within, found.runs[0])
            if run is not None and self._accepts(automaton, run):
                counted = TransitionSystem(self.system.successors, self.system.letter_of, self.system.letters)
                product = Product(counted, found.product.automaton, self.triangle, self.spec.semantics)
                one = OneRun(run, found.runs.cost)
                return BestRuns(product, one, found.exact, self._way(within, found.runs[0]))
        return None

    def _searched(self, system: TransitionSystem, specification: Specification, start: int) -> BestRuns:
        return best_runs(system, specification, start, self.spec.semantics, objective_of(self.spec))

    def _grounds(self, copies: int) -> Iterator[Crossings]:
        """Crossing points: with room for the tube, without, and on the mission's own mesh.

        Args:
            copies: How many times as large as their ways a search is.
        """
        for kind in range(3):
            if kind not in self._known:
                self._known[kind] = self._ground(kind, copies)
            ground = self._known[kind]
            if ground is not None:
                yield ground

    @cached_property
    def _known(self) -> dict[int, Crossings | None]:
        return {}

    def _ground(self, kind: int, copies: int) -> Crossings | None:
        tube_m = self.spec.flight.tube_m
        if kind == 0 and tube_m == 0.0:
            return None
        try:
            mesh = self._own_mesh() if kind == 2 else self._outlines.mesh(tube_m * (kind == 0), largest_share=_LARGEST)  # noqa: PLR2004
        except GeometryError:
            return None
        touching = Locator(mesh.partition).triangles_touching(self.start_m)
        beginnings = touching[mesh.class_of[touching] == self.labelling.letter_of[self.triangle]]
        if not len(beginnings):
            return None
        return crossings(
            mesh.partition,
            mesh.class_of,
            self.labelling.letters,
            beginnings=beginnings,
            start_m=self.start_m,
            spacing=self._spacing(mesh.partition, copies),
            unit_m=self._unit_m,
            tolls=self._tolls,
        )

    def _spacing(self, mesh: Partition, copies: int) -> Spacing:
        finer = (Spacing(share * self.partition.extent_m, *counts) for share, *counts in _SPACINGS[:-1])
        share, *counts = _SPACINGS[-1]
        coarsest = Spacing(share * self.partition.extent_m, *counts)
        return next((spacing for spacing in finer if spacing.ways(mesh) * copies <= _MOST_WAYS), coarsest)

    @cached_property
    def _outlines(self) -> Outlines:
        return Outlines.of(self.locator, self.labelling.letter_of, self.restricted)

    def _own_mesh(self) -> ClassedMesh:
        keep = ~self.restricted
        partition = self.partition
        open_mesh = selected(partition.vertices_m, partition.triangles, partition.neighbours, keep)
        return ClassedMesh(open_mesh, self.labelling.letter_of[keep])

    @property
    def _unit_m(self) -> float:
        """The length that weighs 1."""
        unit = UNIT[self.spec.search.cost][1]
        return unit * self.spec.flight.speed_m_s if self.spec.search.cost is Cost.TIME else unit

    @cached_property
    def _tolls(self) -> IntArray:
        """What it costs to come from one letter to another, shape (letters, letters): stops, where time counts."""
        letters = self.labelling.letters
        tolls = np.ones((len(letters), len(letters)))
        if self.spec.search.cost is Cost.TIME:
            halt_s = self.spec.flight.speed_m_s / self.spec.limits.acceleration_m_s2
            for region in self.spec.regions:
                inside = np.array([region.name in letter for letter in letters])
                if region.loiter_s > 0.0:
                    tolls += (~inside[:, None] & inside) * (region.loiter_s + halt_s) / UNIT[Cost.TIME][1]
        return np.rint(tolls).astype(np.int64)

    def _inside(self, triangles: Sequence[int]) -> shapely.Geometry:
        """What is well inside some triangles."""
        area = union_of(self.partition, np.array(triangles, dtype=np.int64))
        return shapely.buffer(area, -JOINED * self.partition.extent_m)

    @cached_property
    def _tracer(self) -> Tracer:
        return Tracer(
            self.partition,
            self.locator.tree,
            self.labelling.letter_of,
            ~self.restricted,
            passage_lengths(self.partition),
            JOINED * self.partition.extent_m,
        )

    def _traced(self, ground: Crossings, run: Run) -> Run | None:
        """The run of T along a run over crossing points; None where there is none."""
        before, around = [*run.prefix, run.suffix[0]], [*run.suffix, run.suffix[0]]
        head = self._chain(ground, before, self.triangle)
        if head is None:
            return None
        if len(run.suffix) == 1:
            loop: tuple[int, ...] | None = (head[-1],)
        else:
            loop = self._chain(ground, around, head[-1], head[-1])
            loop = loop and (loop[:-1] or loop)
        if loop is None:
            return None
        every = (*head[:-1], *loop, head[-1])
        controls = [self._control(here, there) for here, there in pairwise(every)]
        return Run(head[:-1], loop, tuple(controls))

    def _chain(
        self, ground: Crossings, states: list[int], first: int, last: int | None = None
    ) -> tuple[int, ...] | None:
        way = stretches(ground.system.letter_of[states], ground.points_m[states])
        return self._tracer.chain(way, first, last)

    def _control(self, here: int, there: int) -> int:
        return 0 if here == there else 1 + self.partition.neighbours[here].tolist().index(there)

    def _accepts(self, automaton: Conjunction, run: Run) -> bool:
        prefix, loop = ([int(self.labelling.letter_of[t]) for t in part] for part in (run.prefix, run.suffix))
        if self.spec.semantics is Semantics.PAPER:
            # The start's label is not read; where the loop begins there, it is read at the end of each round.
            prefix, loop = (prefix[1:], loop) if prefix else ([], [*loop[1:], loop[0]])
        return automaton.whole.accepts(prefix, loop)

    def _way(self, ground: Crossings, run: Run) -> Way:
        unit = UNIT[self.spec.search.cost][1]
        weights = ground.system.weights[list(run.states), list(run.controls)] * unit
        head = len(run.prefix)
        before = ground.points_m[[*run.prefix, run.suffix[0]]]
        around = ground.points_m[[*run.suffix, *run.suffix[: len(run.suffix) > 1]]]
        return Way(_distinct(before), _distinct(around), (float(weights[:head].sum()), float(weights[head:].sum())))


def _copies(automaton: Conjunction) -> int:
    """How many times as large as its map a search is: in tours, what was met counts (``mission.planning.tours``)."""
    met = max((inf.bit_count() for _, inf in automaton.whole.pairs), default=0)
    return automaton.size << met if met > 1 else automaton.size


def _distinct(points: FloatArray) -> FloatArray:
    """Points without those that are where the one before is."""
    distinct: FloatArray = points[np.append(True, (np.diff(points, axis=0) != 0.0).any(axis=1))]
    return distinct
