"""What clearances close: a mission that has no plan because of them, and the largest with which it would have one.

All clearances are taken back together, in the same proportion, until there is a run. What it passes that is closed with
a little more lies between two outlines, or is the rest of a region; the keys that set the clearances there are the ones
to change. Where the others still close another place without these, that one is sought next. Beside outlines the tube
of the proof needs room as well: it is asked for like a clearance of everything, as much as it takes beside slanting
ones. Where it closes the mission by itself, it is what is taken back.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Final

import numpy as np
import shapely

from mission.decimals import decimal, measure
from mission.errors import AutomatonSizeError, NoPlanError, SearchSizeError, SpecError
from mission.geometry.location import OUTSIDE, Locator
from mission.geometry.regions import Labelling
from mission.geometry.shapes import Area
from mission.geometry.simplices import Partition
from mission.logic.formula.operators import Operator
from mission.logic.formula.syntax import postorder
from mission.plan.best_runs import objective_of
from mission.plan.diagnosis import Cause
from mission.planning.product import Product
from mission.planning.recurrence import has_runs
from mission.planning.search import search
from mission.planning.transition_system import TransitionSystem
from mission.spec.areas import Ground, boundary_ground, region_ground
from mission.spec.clearances import BOUNDARY_CLEARANCE, clearances, key_of, largest_m, with_clearances, with_room
from mission.spec.domain import build_domain, joined_m, restricted_triangles
from mission.spec.finding import Path, dotted
from mission.spec.model import BoundaryDomain, MissionSpec, Point, Refinement
from mission.spec.outlines import place
from mission.spec.specification import deterministic_of, formula_of, of_mission

_BESIDE_M: Final = 0.1
"""Clearances that end this near to a place that a centimetre more closes are what closes it."""
_ROOM: Final[Path] = ("flight", "tube")
"""Stands among the clearances for what the tube needs beside all outlines."""
_COARSE: Final = Refinement(smallest_angle_deg=1.0, largest_m=np.inf)

Values = dict[Path, float]


def closed_by_clearances(error: NoPlanError, spec: MissionSpec, start_m: Point) -> NoPlanError:
    """Say which clearances leave a mission without a plan, beside the tube where there is one, or that the tube does.

    Args:
        error: What was said of the mission as it is: it has no run, or none that is proved.
        spec: The mission.
        start_m: Where its flight begins.

    Returns:
        ``error`` itself where there is none without clearances and tube either, or it has one with them, or the
        question is too large.
    """
    try:
        text = _told(spec, start_m)
    except (AutomatonSizeError, SearchSizeError):
        return error
    if not text:
        return error
    if error.regions and not error.cause:  # what cannot be covered says how
        text = f"{error}\n{text}"
    return NoPlanError(
        text, cause=Cause.CLEARANCE, conjuncts=error.conjuncts, restricted=error.restricted, regions=error.regions
    )


def _told(spec: MissionSpec, start_m: Point) -> str:
    """What closes a mission; empty where nothing that is known of here does."""
    given, room_m = clearances(spec), math.sqrt(2.0) * spec.flight.tube_m
    none, tube = dict.fromkeys(given, 0.0), {_ROOM: room_m} if room_m else {}
    question = _Question(spec, start_m)
    if question.has_run(given | tube):
        return ""
    if given and question.has_run(none | tube):
        return question.said(given, tube)
    if tube and question.has_run(given):
        return question.said(tube, given)
    if given and question.has_run(none):
        return question.said(given, {})
    return ""


@dataclass(frozen=True)
class _Narrow:
    """A place that clearances close: the keys that set them, and what is closed, in words."""

    keys: tuple[Path, ...]
    text: str


class _Question:
    """A mission, asked with other clearances."""

    def __init__(self, spec: MissionSpec, start_m: Point) -> None:
        self.spec, self.start_m = spec, start_m
        formula = formula_of(spec)
        self._counts = spec.automaton is not None or any(node.operator is Operator.NEXT for node in postorder(formula))
        self._known: dict[tuple[tuple[Path, float], ...], bool] = {}

    def has_run(self, values: Values) -> bool:
        """Whether it has a run with other clearances."""
        asked = tuple(sorted(values.items()))
        if asked not in self._known:
            found = self.map_of(values)
            self._known[asked] = found is not None and has_runs(found.product)
        return self._known[asked]

    def map_of(self, values: Values) -> "_Map | None":
        """The map with other clearances, and room; None where the flight cannot even begin."""
        spec = with_room(with_clearances(self.spec, values), values.get(_ROOM, 0.0))
        if not self._counts and isinstance(spec.domain, BoundaryDomain):
            # Which way is open does not depend on how thin triangles are.
            spec = replace(spec, domain=replace(spec.domain, refinement=_COARSE))
        try:
            partition, labelling = build_domain(spec)
        except SpecError:
            return None
        restricted = restricted_triangles(spec, labelling)
        locator = Locator(partition)
        start = int(locator.triangle_at(np.array([self.start_m]))[0])
        if start == OUTSIDE or restricted[locator.triangles_touching(self.start_m)].any():
            return None
        soft = [number for number, task in enumerate(spec.tasks) if task.weight is not None]
        required = of_mission(spec, labelling.letters, soft)
        automaton = deterministic_of(required.formula, required.given, labelling.letters)
        system = TransitionSystem.from_partition(partition, labelling, restricted)
        return _Map(spec, self.start_m, partition, labelling, Product(system, automaton, start, spec.semantics))

    def narrows(self, given: Values, others: Values) -> list[_Narrow]:
        """The places that must be opened beside some others, each by keys that no earlier one has."""
        found: list[_Narrow] = []
        while True:
            opened = others | dict.fromkeys((key for narrow in found for key in narrow.keys), 0.0)
            rest = {key: value for key, value in given.items() if key not in opened}
            if not rest or (found and self.has_run(opened)):
                return found
            share = self._largest_share(opened, rest)
            # A centimetre more closes it.
            closed = self.map_of(opened | _scaled(rest, share + 0.01 / max(rest.values())))
            passed = self.map_of(opened | _scaled(rest, share))
            if passed is None or closed is None:
                return found
            narrow = _narrow(passed, closed, rest)
            if narrow is None:
                return found
            found.append(narrow)

    def said(self, given: Values, others: Values) -> str:
        """What is closed, how wide it is, and which clearances, or which tube, open it; empty where that is not found.

        Args:
            given: The clearances that may be taken back, or the room for the tube.
            others: What stays as it is.
        """
        narrows = self.narrows(given, others)
        opened = others | dict.fromkeys((key for narrow in narrows for key in narrow.keys), 0.0)
        lines = []
        for narrow in narrows:
            own = {key: given[key] for key in narrow.keys}
            most = _scaled(own, self._largest_share(opened, own))
            if _ROOM in own:
                asked = " beside the clearances" * bool(others)
                fits = f"{decimal(math.floor(100.0 * most[_ROOM] / math.sqrt(2.0)) / 100.0)} m"
                lines.append(f"{narrow.text}; a tube of {fits} per axis surely has room there{asked}")
                continue
            written = " and ".join(f"{dotted(key)}: {decimal(value)}" for key, value in most.items())
            instead = " and ".join(decimal(value) for value in own.values())
            open_to = "it is open to the tube" if _ROOM in others else "it is open"
            lines.append(f"{narrow.text}; with {written} at most, instead of {instead}, {open_to}")
        if not lines:
            return ""
        tube_m, room = self.spec.flight.tube_m, measure(math.sqrt(2.0) * self.spec.flight.tube_m)
        if _ROOM in given:
            head = f"there is a plan without a tube, but not with this one of {measure(tube_m)} m per axis"
            lines.append(f"it takes up to {room} m on each side of the path: see `flight.tube`")
        else:
            beside = " beside the tube" * (_ROOM in others)
            head = f"there is a plan without clearances, but not with these{beside}"
            if _ROOM in others:
                lines.append(f"the tube of the proof takes up to {room} m on each side of the path")
            elif tube_m:
                lines.append(f"the tube of the proof needs up to {room} m more on each side of the path")
        return "\n".join((f"{head}:", *(f"    {line}" for line in lines)))

    def _largest_share(self, opened: Values, values: Values) -> float:
        """How much of some clearances, beside others that are open, leaves a run."""
        widest = max(values.values())
        most = largest_m(lambda m: self.has_run(opened | _scaled(values, m / widest)), widest)
        return 0.0 if most is None else most / widest


@dataclass(frozen=True, eq=False)
class _Map:
    """A mission on its map with some clearances."""

    spec: MissionSpec
    start_m: Point
    partition: Partition
    labelling: Labelling
    product: Product

    @cached_property
    def grounds(self) -> dict[str, Ground]:
        """The areas of all regions."""
        grounds = {region.name: region_ground(region, self.spec.domain) for region in self.spec.regions}
        return {name: ground for name, ground in grounds.items() if ground is not None}

    @cached_property
    def keys(self) -> dict[str, Path]:
        """The key of each clearance, by the region's name; that of the boundary by no name."""
        return {"": BOUNDARY_CLEARANCE} | {region.name: key_of(region) for region in self.spec.regions}

    @cached_property
    def forbidden(self) -> dict[str, tuple[Area, Area]]:
        """What is kept out of, as it is drawn and with its clearance; what lies beyond the boundary by no name."""
        names = [region.name for region in self.spec.regions if region.forbidden]
        found = {name: (self.grounds[name].drawn, self.grounds[name].kept) for name in names if name in self.grounds}
        if isinstance(self.spec.domain, BoundaryDomain):
            fence = boundary_ground(self.spec.domain)
            around = shapely.box(*fence.drawn.buffer(1.0 + fence.clearance_m).bounds)
            found[""] = (shapely.difference(around, fence.drawn), shapely.difference(around, fence.kept))
        return found

    @property
    def labels(self) -> frozenset[str]:
        """The regions of which something may be entered."""
        restricted = {region.name for region in self.spec.regions if region.forbidden}
        return frozenset(name for letter in self.labelling.letters if not restricted & letter for name in letter)

    @cached_property
    def states(self) -> tuple[int, ...]:
        """The triangles of a best run."""
        return search(self.product, objective_of(self.spec))[0].states

    @property
    def line(self) -> shapely.LineString:
        """From the start over the middles of the edges that a best run crosses, into its last triangle."""
        mesh, states = self.partition, self.states
        common = [np.intersect1d(mesh.triangles[a], mesh.triangles[b]) for a, b in pairwise(states)]
        middles = [mesh.vertices_m[ends].mean(axis=0) for ends in common]
        return shapely.LineString([self.start_m, *middles, mesh.incentres_m[states[-1]]])


def _narrow(passed: _Map, closed: _Map, rest: Values) -> _Narrow | None:
    """What a little more closes of what a run passes; None where that is no place: the start is in a region no more.

    Args:
        passed: The map with the run.
        closed: The map without.
        rest: The clearances that were taken back.
    """
    visited = {name for state in passed.states for name in passed.labelling.label(state)}
    lost = [name for name in passed.grounds if name in visited - closed.labels]
    return _swallowed(passed, lost[0], rest) if lost else _between(passed, closed, rest)


def _swallowed(passed: _Map, name: str, rest: Values) -> _Narrow:
    """Of a region that was visited, and of which a little more leaves nothing."""
    kept = passed.grounds[name].kept
    left = shapely.difference(kept, shapely.union_all([area for _, area in passed.forbidden.values()]))
    beside = [each for each, (_, area) in passed.forbidden.items() if shapely.dwithin(area, left, _BESIDE_M)]
    blamed = [each for each in beside if passed.keys[each] in rest] or [name]
    said = " and ".join("its own" if each == name else _of(each) for each in blamed)
    text = f"nothing is left of {name} outside of {said} clearance"
    if _ROOM in rest:
        return _Narrow((_ROOM,), f"the tube does not fit into {name}")
    return _Narrow(tuple(dict.fromkeys(passed.keys[each] for each in blamed)), text)


def _between(passed: _Map, closed: _Map, rest: Values) -> _Narrow | None:
    """Of a passage that the run takes, and that a little more closes; None where nothing crosses it."""
    shut = shapely.union_all([area for _, area in closed.forbidden.values()])
    shut = shapely.buffer(shut, joined_m(passed.partition.extent_m))
    if not shapely.intersects(passed.line, shut):
        return None
    point = _crossed(passed.line, shut)
    apart = {name: float(shapely.distance(area, point)) for name, (_, area) in passed.forbidden.items()}
    first, *others = sorted(apart, key=apart.__getitem__)
    second = others[0] if others and apart[others[0]] <= _BESIDE_M else first
    (one, _), (other, _) = passed.forbidden[first], passed.forbidden[second]
    foot = shapely.shortest_line(point, one).coords[1]
    across = shapely.shortest_line(point, other).coords[1] if second != first else _opposite(point, foot, one)
    width = measure(float(np.hypot(foot[0] - across[0], foot[1] - across[1])))
    whose = f"{_called(first)} and {_called(second)} are" if first != second else f"two sides of {_called(first)} are"
    keys = tuple(dict.fromkeys(key for each in (first, second) if (key := passed.keys[each]) in rest))
    text = f"{whose} {width} m apart near {place((round(point.x, 1), round(point.y, 1)))}"
    return _Narrow(keys or tuple(rest), text)


def _crossed(line: shapely.LineString, forbidden: Area) -> shapely.Point:
    """The middle of the first part of a line in what is forbidden that leads from one free piece of it to another."""
    free = shapely.get_parts(shapely.difference(shapely.box(*line.buffer(1.0).bounds), forbidden))
    inside = shapely.get_parts(shapely.line_merge(shapely.intersection(line, forbidden)))
    ends = shapely.points([end for part in inside for end in (part.coords[0], part.coords[-1])])
    pieces = shapely.STRtree(free).nearest(ends).reshape(-1, 2)
    leading = np.flatnonzero(pieces[:, 0] != pieces[:, 1])
    part = inside[leading[0]] if len(leading) else max(inside, key=shapely.length)
    return part.interpolate(0.5, normalized=True)


def _opposite(point: shapely.Point, foot: tuple[float, float], area: Area) -> tuple[float, float]:
    """Where an area begins on the other side of a point, seen from its nearest place."""
    x, y = point.x + 2.0 * (point.x - foot[0]), point.y + 2.0 * (point.y - foot[1])
    hit = shapely.intersection(shapely.LineString([(point.x, point.y), (x, y)]), area)
    end = shapely.shortest_line(point, hit if not hit.is_empty else area).coords[1]
    return float(end[0]), float(end[1])


def _called(name: str) -> str:
    return name or "the boundary"


def _of(name: str) -> str:
    return f"{name}'s" if name else "the boundary's"


def _scaled(values: Mapping[Path, float], share: float) -> Values:
    """Clearances in the same proportion, in whole centimetres, rounded down; as they are where the share is 1."""
    if share >= 1.0:
        return dict(values)
    return {key: float(np.floor(100.0 * value * share + 1e-6)) / 100.0 for key, value in values.items()}
