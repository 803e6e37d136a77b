"""The rest of a flight: planned from where the vehicle is, with what of its mission is left to be done.

The rest is a mission of its own: the one that was planned, its specification progressed by the word that was spelled
(``mission.logic.formula.progression``), the laps that are left, and the present place as its start. So everything that
takes missions and plans takes the rest's. The label of the present place was read when it was entered; the rest reads
it once more, which what is left does not tell apart, or leaves its first letter out where it counts letters. What was
entered, and not yet covered or stood in as its region asks, is due beside what is left.
"""

from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import chain, count
from typing import Final

import numpy as np
import shapely

from mission.errors import Fault, NoPlanError, NoRollingStartError, SpecError
from mission.geometry.location import OUTSIDE
from mission.logic.automata.automaton import GeneralisedBuchi
from mission.logic.automata.rabin import DEAD, everything
from mission.logic.automata.remainder import delayed, remainder
from mission.logic.automata.safety import safety_of
from mission.logic.formula.progression import counts_letters, left_of
from mission.logic.formula.rewriting import simplified
from mission.logic.formula.syntax import (
    FALSE,
    TRUE,
    Formula,
    always,
    conjunction,
    disjunction,
    eventually,
    following,
    proposition,
)
from mission.logic.formula.word import Letter
from mission.logic.hoa.text import to_hoa
from mission.plan.beginning import Beginning
from mission.plan.begun import LanesLeft, StayLeft, lanes_left, stays_left
from mission.plan.flight_plan import FlightPlan
from mission.plan.lap_under_way import come, done_first, visits_due
from mission.plan.stages import planned
from mission.spec.domain import build_domain, restricted_triangles
from mission.spec.finding import listed
from mission.spec.model import (
    UNTIL_STOPPED,
    MissionSpec,
    NamedAutomaton,
    NodesDomain,
    Point,
    PointShape,
    PolygonShape,
    Region,
    RegionKind,
    Semantics,
    Start,
)
from mission.spec.specification import deterministic_of, generalised_of, of_mission, timed_of

_RETURN: Final = "return.hoa"
_START: Final = "start"
_ROOM: Final = 3.0  # tubes
_ROUNDING: Final = 1e-6
_LEAST_ROOM_M: Final = 0.5
_CLOCK: Final = "the mission has bounds in seconds from the beginning of its trajectory: its rest is not planned anew"
_MOVES: Final = "regions of the mission move by the clock of its trajectory: nothing is planned anew while it is flown"
_LOST: Final = "what was flown so far violates the mission: nothing that is flown from here satisfies it"


@dataclass(frozen=True)
class Rest:
    """What of a flight is behind it, and where the vehicle is.

    Attributes:
        word: The letters that the flight has spelled so far, as ``Monitor.word`` gives them.
        place_m: Where the new plan begins, ENU in the domain.
        velocity_m_s: With which it begins.
        acceleration_m_s2: Likewise; both zero where it begins at rest.
        flown_s: All of the old trajectory before this time was flown as it was planned, laps unfolded; None where
            nothing of it was.
        laps: How many of the old plan's laps are over; -1 on the way to them, where that completes one before.
        due: The labels that the lap under way has not met; None where none is under way.
    """

    word: tuple[Letter, ...]
    place_m: Point
    velocity_m_s: Point = (0.0, 0.0)
    acceleration_m_s2: Point = (0.0, 0.0)
    flown_s: float | None = None
    laps: int = 0
    due: tuple[Letter, ...] | None = None

    @property
    def begins(self) -> Beginning:
        """How the new plan begins."""
        return Beginning(self.place_m, self.velocity_m_s, self.acceleration_m_s2)


def plan_rest(plan: FlightPlan, rest: Rest, amended: MissionSpec | None = None) -> FlightPlan:
    """Plan what is left of a flight; after the last of its laps, that is the return.

    A lap that is under way is completed on the way to the laps that are left, or to the return where it is the last.

    Args:
        plan: What was flown so far, or some of it.
        rest: How far.
        amended: The mission as it is from now on, in the same frame; the plan's own by default. If it asks for the same
            (formula, tasks and automaton), what is left of that is planned. Anything else holds from now on.

    Raises:
        SpecError: The present place, or what was amended, cannot be used.
        NoRollingStartError: There is no plan with the present motion; at rest there may be one.
        NoPlanError: Nothing that is flown from here satisfies the mission, or there is no proof.
        AutomatonSizeError: What is left asks for too large an automaton.
    """
    spec = plan.spec if amended is None else amended
    if plan.required.timed or timed_of(spec):
        raise NoPlanError(_CLOCK)
    if plan.spec.moves or spec.moves:
        raise NoPlanError(_MOVES)
    if spec.origin != plan.spec.origin:
        raise SpecError((Fault(0, 0, "domain.origin", "what is amended has another origin than what is flown"),))
    if not _asks_the_same(spec, plan.spec):
        return _with_room(_begun_at(replace(spec, semantics=Semantics.STANDARD), rest), rest.begins, plan)
    lanes, stays = _under_way(plan, spec, rest)
    under_way = [*(left.region for left in lanes), *(left.region for left in stays)]
    begins = replace(rest.begins, lanes=lanes, stays=stays)
    if not plan.run.recurrent or (rest.due is None and _laps_left(spec, rest)):
        return _with_room(_begun_at(_left(plan, spec, rest, under_way), rest), begins, plan)
    visits = () if rest.due is None else visits_due(plan, rest.due, under_way)
    if not _laps_left(spec, rest):
        return _returning(plan, spec, rest, begins if visits else rest.begins, visits)
    begins = replace(begins, completes=bool(visits))
    try:
        return _with_room(_begun_at(_left(plan, spec, rest, (), done_first(plan, visits)), rest), begins, plan)
    except NoRollingStartError:
        raise
    except NoPlanError:
        if not visits:
            raise
        # What the lap had already cannot be kept out of.
        return _with_room(_begun_at(_left(plan, spec, rest, (), come(visits)), rest), begins, plan)


def plan_return(plan: FlightPlan, rest: Rest) -> FlightPlan:
    """Plan a return in time: to where the flight may end, on a way on which nothing is violated that was not before.

    Whatever else is left of the mission is left undone.

    Raises:
        SpecError: The present place cannot be used.
        NoRollingStartError: As in ``plan_rest``.
        NoPlanError: No way back violates nothing, or there is no proof.
        AutomatonSizeError: What must not be done asks for too large an automaton.
    """
    if plan.spec.moves:
        raise NoPlanError(_MOVES)
    return _returning(plan, plan.spec, rest, rest.begins, ())


def _returning(
    plan: FlightPlan, spec: MissionSpec, rest: Rest, begins: Beginning, visits: Sequence[frozenset[str]]
) -> FlightPlan:
    """Plan a return, and some visits before it; the errors are those of ``plan_return``."""
    letters = plan.labelling.letters
    left, safety = spec, safety_of(everything(len(letters)))
    with suppress(NoPlanError):
        left = _left(plan, spec, rest, ())
        required = of_mission(left, letters)
        whole = deterministic_of(required.formula, required.given, letters).whole
        if whole.initial != DEAD:
            safety = safety_of(whole)
    due = frozenset().union(*visits)
    regions = [each if each.name in due else replace(each, loiter_s=0.0, cover=None) for each in spec.regions]
    homes = [region.name for region in regions if region.kind is RegionKind.HOME]
    if not homes:
        regions.append(_start_region(spec, plan.start_m))
        homes = [regions[-1].name]
    goal = conjunction(eventually(always(disjunction(*map(proposition, homes)))), *come(visits))
    asked = generalised_of(goal, _named(_RETURN, safety.unviolated(letters)))
    back = replace(
        left,
        regions=tuple(regions),
        formula="",
        tasks=(),
        automaton=_named(_RETURN, asked),
    )
    return _with_room(_begun_at(back, rest), begins, plan)


def _with_room(spec: MissionSpec, begins: Beginning, known: FlightPlan) -> FlightPlan:
    """Plan a mission from a place; where there is no plan as the tube has no room there, say that.

    Raises:
        MissionError: As in ``planned``.
    """
    try:
        return planned(spec, begins, known=known)
    except NoRollingStartError:
        raise
    except NoPlanError as error:
        near = _crowding(spec, begins.place_m)
        if not near:
            raise
        x, y = begins.place_m
        raise NoPlanError(
            f"no plan begins at ({x:.2f}, {y:.2f}): the tube of {spec.flight.tube_m:.3g} m on each side has no room "
            f"there beside {listed(near)}; bring the vehicle away from there first",
            regions=error.regions,
        ) from error


def _crowding(spec: MissionSpec, place_m: Point) -> list[str]:
    """The restricted regions that the tube about a place touches, or the boundary; none where it has room."""
    partition, labelling = build_domain(spec)
    tube_m = spec.flight.tube_m
    square = shapely.box(*(c - tube_m for c in place_m), *(c + tube_m for c in place_m))
    triangles = shapely.polygons(partition.corners_m)
    met = np.flatnonzero(shapely.intersects(triangles, square))
    shut = met[restricted_triangles(spec, labelling)[met]]
    restricted = {region.name for region in spec.regions if region.forbidden}
    names = sorted(restricted & frozenset().union(*(labelling.label(int(triangle)) for triangle in shut)))
    inside_m2 = float(shapely.area(shapely.intersection(triangles[met], square)).sum())
    return [*names, *(["the boundary"] if inside_m2 < (1.0 - _ROUNDING) * square.area else [])]


def _start_region(spec: MissionSpec, start_m: Point) -> Region:
    """A region about the start, in which the tube has room."""
    names = {region.name for region in spec.regions}
    name = next(name for name in chain((_START,), (f"{_START} {i}" for i in count(2))) if name not in names)
    if isinstance(spec.domain, NodesDomain):
        return Region(name, RegionKind.AREA, PointShape(start_m))
    half_m = max(_LEAST_ROOM_M, _ROOM * spec.flight.tube_m)
    box = shapely.box(*(c - half_m for c in start_m), *(c + half_m for c in start_m))
    corners = tuple((float(x), float(y)) for x, y in shapely.get_coordinates(box)[:-1])
    return Region(name, RegionKind.AREA, PolygonShape(corners))


def _asks_the_same(one: MissionSpec, other: MissionSpec) -> bool:
    return (one.formula, one.tasks, one.automaton) == (other.formula, other.tasks, other.automaton)


def _begun_at(spec: MissionSpec, rest: Rest) -> MissionSpec:
    """A mission that begins where a flight is; how long that may be is watched, and bounds nothing that is left."""
    return replace(spec, run=0, start=Start(rest.place_m), flight=replace(spec.flight, longest_s=None))


def _laps_left(spec: MissionSpec, rest: Rest) -> int:
    """How many laps are left beside the one that is under way; one where nobody has said how many there are."""
    laps = spec.flight.laps
    return 1 if laps == UNTIL_STOPPED else max(0, laps - rest.laps - int(rest.due is not None))


def _left(
    plan: FlightPlan, spec: MissionSpec, rest: Rest, regions: Sequence[str], before: Iterable[Formula] = ()
) -> MissionSpec:
    """The mission that is left, with a visit of some regions, and what comes before its laps."""
    if plan.run.recurrent and spec.flight.laps != UNTIL_STOPPED:
        spec = replace(spec, flight=replace(spec.flight, laps=max(1, _laps_left(spec, rest))))
    if not rest.word:
        return spec
    triangle = int(plan.locator.triangle_at(np.array([rest.place_m]))[0])
    known = triangle != OUTSIDE and plan.labelling.label(triangle) == rest.word[-1]
    formula = left_of(plan.required.formula, rest.word)
    if formula is FALSE:
        raise NoPlanError(_LOST)
    if known and counts_letters(formula):
        formula = following(formula)
    # A visit that is asked for in any case is not asked for twice: it would make the first lap another than the others.
    whole = simplified(conjunction(formula, *map(_visited, dict.fromkeys(regions)))) if regions else formula
    # That one is another than the others is what is asked for: it is not simplified.
    whole = conjunction(whole, *before)
    automaton = None
    if plan.required.given is not None:
        left = remainder(plan.required.given.automaton, rest.word)
        if left is None:
            raise NoPlanError(_LOST)
        automaton = _named(plan.required.given.file, delayed(left) if known else left)
        automaton, whole = _named(automaton.file, generalised_of(whole, automaton)), TRUE
    text = "" if automaton is not None else str(whole)
    return replace(spec, formula=text, tasks=(), automaton=automaton, semantics=Semantics.STANDARD)


def _visited(region: str) -> Formula:
    return eventually(proposition(region))


def _named(file: str, automaton: GeneralisedBuchi) -> NamedAutomaton:
    return NamedAutomaton(file, to_hoa(automaton), automaton)


def _under_way(plan: FlightPlan, spec: MissionSpec, rest: Rest) -> tuple[tuple[LanesLeft, ...], tuple[StayLeft, ...]]:
    """The visits of regions that were entered, and are not yet covered, or stood in, as they ask to be."""
    met: frozenset[str] = frozenset().union(*rest.word)
    flown_s = 0.0 if rest.flown_s is None else plan.trajectory.first_lap_s(rest.flown_s)
    kept = frozenset(region.name for region in spec.regions if region in plan.spec.regions)
    return tuple(lanes_left(plan, flown_s, met & kept)), tuple(stays_left(plan, flown_s, met & kept))
