"""A mission that moves, as one that stands still: what to keep out of, and where to go, for the time of a flight.

It serves to find a path, no more: whether that does what is asked is proved on the map that moves.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np
import shapely

from mission.errors import NoPlanError
from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.geometry.moving import MovingPartition, hulls_of
from mission.geometry.refinement import SMALLEST_ANGLE_DEG
from mission.geometry.regions import Labelling, union_of
from mission.logic.formula.conjuncts import conjuncts
from mission.logic.formula.operators import Operator
from mission.logic.formula.parser import parse_timed_formula
from mission.logic.formula.syntax import FALSE, Formula, conjunction, postorder, propositions, rebuilt
from mission.logic.timed.rewriting import positive, untimed
from mission.spec.model import (
    BoundaryDomain,
    MissionSpec,
    NodesDomain,
    PolygonShape,
    PolygonsShape,
    Refinement,
    Region,
)
from mission.spec.specification import Specification

Span = tuple[float, float]
"""From when to when, s."""

_INSTANTS: Final = 24
"""Of a time for which a region must stay where one goes, as many are looked at."""
_INSIDE: Final = 1e-3
"""Of its size, by how much less of a region is taken."""


@dataclass(frozen=True)
class Guess:
    """When each region that moves is taken to be where.

    Attributes:
        closed: Those to keep out of: wherever they are in one of some times.
        met: Those to go to: where they are all of a time.
    """

    closed: Mapping[str, tuple[Span, ...]]
    met: Mapping[str, Span]


class MovingMap:
    """The map of a mission that moves.

    Args:
        spec: The mission.
        moving: Its triangles.
        labelling: Their labels.
    """

    def __init__(self, spec: MissionSpec, moving: MovingPartition, labelling: Labelling) -> None:
        self.spec, self.moving, self.labelling = spec, moving, labelling
        moves = moving.moves[moving.fixed.triangles]
        self.drifting = tuple(region for region in spec.regions if moves[labelling.triangles_of(region.name)].any())

    def triangles_of(self, name: str) -> BoolArray:
        """The triangles of a region, shape (M,)."""
        inside = np.zeros(self.moving.fixed.size, dtype=np.bool_)
        inside[self.labelling.triangles_of(name)] = True
        return inside

    def swept(self, name: str, span_s: Span) -> shapely.Geometry:
        """All places where a region is at some time between two."""
        triangles = self.labelling.triangles_of(name)
        corners = [self._corners_at(time_s, triangles) for time_s in self._instants(*span_s)]
        both = [np.concatenate(pair, axis=1) for pair in pairwise((*corners, corners[-1]))]
        return shapely.union_all(hulls_of(np.concatenate(both)))

    def kept(self, name: str, span_s: Span) -> shapely.Geometry:
        """The places that are in a region all of the time between two, and a little less."""
        triangles, (begin_s, end_s) = self.labelling.triangles_of(name), span_s
        end_s = min(end_s, max(begin_s, self.moving.last_s))
        times = np.union1d(self._instants(begin_s, end_s), np.linspace(begin_s, end_s, _INSTANTS))
        areas = [shapely.union_all(shapely.polygons(self._corners_at(time_s, triangles))) for time_s in times]
        size_m = float(np.sqrt(areas[0].area))
        return shapely.buffer(shapely.intersection_all(areas), -_INSIDE * size_m, join_style="mitre")

    def still(self, guess: Guess) -> MissionSpec:
        """The mission with its regions where they are guessed, and without seconds for what moves: a guess has none.

        Raises:
            NoPlanError: A region moves on so fast that there is no place to wait for it in.
        """
        spec, gone = self.spec, frozenset(self._gone(guess))
        domain, regions = spec.domain, tuple(each for each in self._regions(guess) if each.name not in gone)
        moving = frozenset(region.name for region in self.drifting)
        formula = ""
        if spec.formula:
            parsed = parse_timed_formula(spec.formula, frozenset(region.name for region in spec.regions))
            parts = (untimed(part) if moving & propositions(part) else part for part in conjuncts(parsed))
            formula = str(rebuilt(conjunction(*parts), lambda node, of: _without(node, of, gone)))
        tasks = tuple(replace(task, bound_s=None) if moving.intersection(task.regions) else task for task in spec.tasks)
        if isinstance(domain, NodesDomain):
            (ring,) = _parts(union_of(self.moving.fixed, np.ones(self.moving.fixed.size, dtype=np.bool_)))
            domain = BoundaryDomain(ring, Refinement(SMALLEST_ANGLE_DEG, np.inf))
        return replace(spec, domain=domain, regions=regions, formula=formula, tasks=tasks)

    def _gone(self, guess: Guess) -> Iterator[str]:
        """Those that are nowhere in the way: what is said of them is not true."""
        for region in self.drifting:
            if not guess.closed.get(region.name) and region.name not in guess.met:
                yield region.name

    def _regions(self, guess: Guess) -> Iterator[Region]:
        drifting = frozenset(region.name for region in self.drifting)
        for region in self.spec.regions:
            if region.name in guess.met:
                area = self.kept(region.name, guess.met[region.name])
                if area.is_empty:
                    begin_s, end_s = guess.met[region.name]
                    raise NoPlanError(
                        f"{region.name} moves on so fast that no place is in it from {begin_s:.1f} to {end_s:.1f} s"
                    )
                yield _drawn(region, area)
            elif guess.closed.get(region.name):
                yield _drawn(region, shapely.union_all([self.swept(region.name, s) for s in guess.closed[region.name]]))
            elif region.name not in drifting and isinstance(self.spec.domain, NodesDomain):
                yield _drawn(region, union_of(self.moving.fixed, self.triangles_of(region.name)))
            else:
                yield replace(region, motion=None)

    def _instants(self, begin_s: float, end_s: float) -> FloatArray:
        inner = self.moving.times_s[(self.moving.times_s > begin_s) & (self.moving.times_s < end_s)]
        return np.concatenate(([begin_s], inner, [min(end_s, max(begin_s, self.moving.last_s))]))

    def _corners_at(self, time_s: float, triangles: IntArray) -> FloatArray:
        return self.moving.vertices_at(time_s)[self.moving.fixed.triangles[triangles]]


def asserted(specification: Specification) -> frozenset[str]:
    """The propositions that are to be true at some time, or may make something so, in a specification."""
    found = set[str]()
    for formula in (specification.formula, *specification.timed):
        root = positive(formula)
        for above in (Formula(Operator.NEXT, (root,)), *postorder(root)):
            if above.operator is not Operator.NOT:
                found |= {node.name for node in above.operands if node.operator is Operator.PROPOSITION}
    return frozenset(found)


def _without(node: Formula, operands: tuple[Formula, ...], gone: frozenset[str]) -> Formula:
    if node.operator is Operator.PROPOSITION:
        return FALSE if node.name in gone else node
    return Formula(node.operator, operands, "", node.bounds) if operands else node


def _drawn(region: Region, area: shapely.Geometry) -> Region:
    """A region that stands where an area is."""
    return replace(region, shape=PolygonsShape(tuple(_parts(area))), clearance_m=0.0, motion=None)


def _parts(area: shapely.Geometry) -> Iterator[PolygonShape]:
    for part in shapely.get_parts(area):
        rings = (tuple((float(x), float(y)) for x, y in ring.coords[:-1]) for ring in (part.exterior, *part.interiors))
        corners, *holes = rings
        yield PolygonShape(corners, tuple(holes))
