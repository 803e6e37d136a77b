"""Plans in time: of the ways that do what a mission asks for, one that keeps its bounds in seconds.

The best run is tried first. Where it is late somewhere, runs are tried that visit in the order of what is due; where it
is early, it waits where it begins, or before it comes into a region of which the bounds speak. What it must not meet
while that is there is passed when it is gone, or a way leads round it, whichever is over sooner. Each is as fast as the
limits admit, and each is proved before it counts.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import chain, combinations, pairwise, product
from typing import Final, Protocol, TypeVar

from mission.errors import LateError, NoPlanError, NoRollingStartError
from mission.logic.formula.conjuncts import conjuncts
from mission.logic.formula.operators import Operator
from mission.logic.formula.syntax import LONGEST_S, Formula, negation, proposition, propositions, until
from mission.plan.air_time import AirTime
from mission.plan.best_runs import BestRuns
from mission.plan.earliest import Earliest, is_place, spans_of
from mission.plan.steered import Steered, Steering
from mission.plan.tasks import DroppedTask, Numbers
from mission.plan.time_bounds import FOLLOWED_S, TimeBound, behaviour_flown, bounds_of, met_at_rest
from mission.plan.windows import around, asking_also, best_of, shunned, waits_s
from mission.spec.model import FIELD, MissionSpec
from mission.spec.tasks import task_text
from mission.steering.trajectory import Trajectory

Bound = TimeBound | AirTime

_MOST_WAITS: Final = 6
_MOST_PLACES: Final = 6
_MOST_CHOICES: Final = 24  # sets of tasks to leave out that are tried, in the order of their weight


class Waiting(Protocol):
    """A trajectory that stands still at a place of its curve, for so many seconds."""

    def __call__(self, *, wait: tuple[float, float]) -> Trajectory:
        """Make it."""
        ...


@dataclass(frozen=True)
class Law:
    """How a path is flown.

    Attributes:
        fastest: As fast as the limits admit.
        later: After a wait; None where it begins in motion.
    """

    fastest: Trajectory
    later: Waiting | None


@dataclass(frozen=True)
class _Timed:
    """A path as it is flown, what becomes of all bounds, and whether it waits for that."""

    flown: Steered
    trajectory: Trajectory
    bounds: list[Bound]
    waits: bool


def in_time(steering: Steering, flown_of: Callable[[Steering], tuple[Steered, Law]]) -> tuple[Steered, Trajectory]:
    """A path, and how it is flown so that all that is asked for in seconds is kept.

    Args:
        steering: What the best runs are steered from.
        flown_of: Steers one of them.

    Raises:
        LateError: None that was tried keeps the bounds.
        NoPlanError: There is no plan.
    """
    asked, flight = steering.specification.timed, steering.planner.spec.flight
    if not asked and flight.longest_s is None:
        flown, law = flown_of(steering)
        return flown, law.fastest
    if flight.guidance == FIELD or flight.replan:
        key = "guidance: field" if flight.guidance == FIELD else "replan: true"
        message = f"bounds in seconds are kept by the time law of one trajectory, and a flight with `{key}` leaves it"
        raise NoPlanError(message, conjuncts=tuple(map(str, asked)))
    earliest = Earliest(steering.search.maps)
    if hopeless := earliest.hopeless(steering.specification):
        raise LateError(
            "\n  ".join(("no flight keeps its bounds in seconds:", *(each.text for each in hopeless))),
            conjuncts=tuple(chain.from_iterable(each.asked for each in hopeless)),
        )
    nearest: list[Bound] = []
    soonest: _Timed | None = None
    for tried, goes_round in _ways(steering, earliest):
        if soonest is not None and not (soonest.waits and goes_round):
            break
        found = _timed(tried, flown_of, needed=tried is steering)
        if found is None:
            continue
        if _are_kept(found.bounds):
            soonest = min(soonest or found, found, key=lambda each: each.trajectory.duration_s)
        elif not nearest or _short_s(found.bounds) < _short_s(nearest):
            nearest = found.bounds
    if soonest is not None:
        return soonest.flown, soonest.trajectory
    late = [bound for bound in nearest if not bound.kept]
    texts = (f"{each.text}{_no_sooner(each, earliest)}" for each in late)
    raise LateError(
        "\n  ".join(("no plan is found that keeps its bounds in seconds; the nearest:", *texts)),
        conjuncts=tuple(str(bound.formula) for bound in late),
    )


def _no_sooner(bound: Bound, earliest: Earliest) -> str:
    """What is known of when something that is late may be there at all."""
    if isinstance(bound, AirTime) or not bound.is_deadline or math.isinf(bound.short_s):
        return ""
    return f", and no flight is there before {earliest.soonest_s(bound.formula):.2f} s"


def _timed(steering: Steering, flown_of: Callable[[Steering], tuple[Steered, Law]], *, needed: bool) -> _Timed | None:
    """A path in its time; None where there is none. One that is ``needed`` says why."""
    try:
        flown, law = flown_of(steering)
    except NoRollingStartError:
        raise
    except NoPlanError:
        if needed:
            raise
        return None
    trajectory, bounds = _in_its_time(steering, flown, law)
    if law.later is not None and not _are_kept(bounds):
        trajectory, bounds = _when_all_is_gone(steering, flown, law.later, trajectory, bounds)
    return _Timed(flown, trajectory, bounds, waits=trajectory is not law.fastest)


Found = TypeVar("Found")


def given_up_in_time(
    spec: MissionSpec, dropped: tuple[DroppedTask, ...], planned: Callable[[Numbers], Found]
) -> tuple[tuple[DroppedTask, ...], Found]:
    """What is planned with the soft tasks of least weight left out for which there is no time.

    Args:
        spec: The mission.
        dropped: What is left out anyhow.
        planned: Plans without some tasks.

    Returns:
        What is left out, in the order of the file, and what was planned.

    Raises:
        LateError: No plan keeps the bounds that must be kept, or of the first choices none.
        NoPlanError: As ``planned`` raises it.
    """
    gone = frozenset(task.number for task in dropped)
    try:
        return dropped, planned(gone)
    except LateError as error:
        late = error
    soft = {
        number: Fraction(task.weight)
        for number, task in enumerate(spec.tasks)
        if task.weight is not None and number not in gone
    }
    choices = sorted(
        (chosen for size in range(1, len(soft) + 1) for chosen in combinations(sorted(soft), size)),
        key=lambda chosen: (sum(soft[number] for number in chosen), len(chosen), sorted(-number for number in chosen)),
    )
    for chosen in choices[:_MOST_CHOICES]:
        try:
            found = planned(gone | frozenset(chosen))
        except LateError:
            continue
        reason = "; ".join(line.strip() for line in str(late).splitlines()[1:])
        more = (DroppedTask(n, task_text(spec.tasks[n]), float(soft[n]), f"there is no time: {reason}") for n in chosen)
        return tuple(sorted((*dropped, *more), key=lambda task: task.number)), found
    raise late


def _in_its_time(steering: Steering, flown: Steered, law: Law) -> tuple[Trajectory, list[Bound]]:
    """A path as it is flown after the shortest wait with which all bounds are kept; at once where none will do."""
    at_once, later = _bounds(steering, flown, law.fastest), law.later
    if later is None or _are_kept(at_once):
        return law.fastest, at_once

    def begun_after(wait_s: float) -> list[Bound]:
        return _bounds(steering, flown, law.fastest, wait_s)

    def waited_at(place_s: float, wait_s: float) -> list[Bound]:
        return _bounds(steering, flown, later(wait=(place_s, wait_s)))

    first = begun_after(_enough_s(at_once))
    if any(after.margin_s <= before.margin_s for before, after in zip(at_once, first, strict=True) if not before.kept):
        return law.fastest, at_once  # what is late is later after any wait
    waits: list[tuple[float, Callable[[float], list[Bound]]]] = [(0.0, begun_after)]
    waits += [(place_s, partial(waited_at, place_s)) for place_s in _places(steering, flown)]
    for place_s, after in waits:
        wait_s = _shortest_wait(after, at_once)
        if wait_s is not None:
            trajectory = later(wait=(place_s, wait_s))
            return trajectory, _bounds(steering, flown, trajectory)
    return law.fastest, at_once


def _shortest_wait(after: Callable[[float], list[Bound]], at_once: list[Bound]) -> float | None:
    """The shortest wait after which all bounds are kept; None where none is found, for something else is late then."""
    wait_s, bounds = 0.0, at_once
    for _ in range(_MOST_WAITS):
        short_s = _short_s(bounds)
        wait_s += _enough_s(bounds)
        bounds = after(wait_s)
        if _are_kept(bounds):
            return wait_s
        if _short_s(bounds) >= short_s:
            return None
    return None


def _enough_s(bounds: list[Bound]) -> float:
    """By how much all of them would have to be kept better, in whole milliseconds."""
    return math.ceil(min(_short_s(bounds), LONGEST_S) * 1000.0) / 1000.0


def _short_s(bounds: list[Bound]) -> float:
    return max(bound.short_s for bound in bounds)


def _are_kept(bounds: list[Bound]) -> bool:
    return all(bound.kept for bound in bounds)


def _when_all_is_gone(
    steering: Steering, flown: Steered, later: Waiting, at_once: Trajectory, bounds: list[Bound]
) -> tuple[Trajectory, list[Bound]]:
    """A path as it is flown when a region is gone that it must not meet before; as it was where no wait will do."""
    asked, of = steering.specification.timed, steering.planner
    at_rest = met_at_rest(at_once, flown.certificate, steering.search.maps.locator)
    met = behaviour_flown(at_once, flown.certificate, at_rest, of.labelling)
    waits = [math.ceil((wait_s + Fraction(FOLLOWED_S)) * 1000 + 1) / 1000.0 for wait_s in waits_s(asked, met)]
    if not waits:
        return at_once, bounds
    after = _bounds(steering, flown, at_once, waits[0])
    others = [(now, then) for now, then in zip(bounds, after, strict=True) if not _is_shunning(now)]
    if any(then.margin_s < now.margin_s for now, then in others if not now.kept):
        return at_once, bounds  # what is late is later after any wait
    for place_s, wait_s in product((0.0, *_places(steering, flown)), waits):
        trajectory = later(wait=(place_s, wait_s))
        found = _bounds(steering, flown, trajectory)
        if _are_kept(found):
            return trajectory, found
    return at_once, bounds


def _is_shunning(bound: Bound) -> bool:
    return isinstance(bound, TimeBound) and bool(shunned([bound.formula]))


def _places(steering: Steering, flown: Steered) -> list[float]:
    """Where to wait on the way: before it may come into a region of which the bounds speak."""
    names = frozenset[str]().union(*map(propositions, steering.specification.timed))
    labelling, certificate = steering.planner.labelling, flown.certificate
    met = [names & frozenset[str]().union(*map(labelling.label, possible)) for possible in certificate.possible]
    middles = 0.5 * (certificate.knots_s[:-1] + certificate.knots_s[1:])
    before = [k for k, (here, ahead) in enumerate(pairwise(met)) if ahead - here]
    return [float(middles[k]) for k in before[:_MOST_PLACES]]


def _bounds(steering: Steering, flown: Steered, trajectory: Trajectory, later_s: float = 0.0) -> list[Bound]:
    """What becomes of all that is asked for in seconds, where all of a trajectory is flown so much later."""
    asked, locator = steering.specification.timed, steering.search.maps.locator
    met = met_at_rest(trajectory, flown.certificate, locator)
    in_place = bounds_of(asked, trajectory, flown.certificate, met, steering.planner.labelling, later_s=later_s)
    aloft = AirTime.of(steering.planner.spec.flight, later_s + trajectory.duration_s)
    return [*in_place, *([] if aloft is None else [aloft])]


def _ways(steering: Steering, earliest: Earliest) -> Iterator[tuple[Steering, bool]]:
    """Ways, each with whether it goes round what is there for a time.

    The best run, those that go round, and then those of either kind that visit what is due first before what is due
    later, or at any time, and what comes last at the end. Orders in which something is late in any case are left out,
    and those of which the run is one before.
    """
    yield steering, False
    rounds = list(around(steering))
    yield from ((each, True) for each in rounds)
    seen = {_states_of(each.found) for each in (steering, *rounds)}
    for base in (steering, *rounds[:1]) if steering.free else ():
        for order in dict.fromkeys(_orders(base)):
            urgent = asking_also(base.specification, order)
            ordered = best_of(base, urgent) if earliest.admits(urgent) else None
            if ordered is not None and _states_of(ordered.found) not in seen:
                seen.add(_states_of(ordered.found))
                yield ordered, False


def _states_of(found: BestRuns) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """What tells one of the best runs from others."""
    first = found.runs[0]
    return first.prefix, first.suffix


def _orders(steering: Steering) -> Iterator[tuple[Formula, ...]]:
    """What is to come before what: by deadlines, and by when they are there; then each thing that is due before all."""
    asked, labelling = steering.specification, steering.planner.labelling
    begun = labelling.label(steering.search.maps.triangle)
    spans = {proposition(name): span for name, span in spans_of(asked.timed).items()}
    visited = [node.operands[0] for node in conjuncts(asked.formula) if _is_visit(node)]
    places = [place for place in dict.fromkeys((*spans, *visited)) if place.name not in begun]
    for times in zip(*(spans.get(place, (0.0, math.inf)) for place in places), strict=True):
        when = dict(zip(places, times, strict=True))
        sooner = [(a, b) for a in places for b in places if when[a] < when[b]]
        if sooner:
            yield tuple(until(negation(b), a) for a, b in sooner)
    for first in (place for place in places if place in spans):
        if len(places) > 1:
            yield tuple(until(negation(other), first) for other in places if other is not first)


def _is_visit(formula: Formula) -> bool:
    return formula.operator is Operator.EVENTUALLY and is_place(formula.operands[0])
