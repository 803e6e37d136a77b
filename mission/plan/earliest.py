"""Lower bounds of the time of every flight: from place to place in straight lines, from rest, at its full speed.

What no flight can keep is so refused before one is planned, and no order of visits is tried in which something is late
in any case. A flight begins at rest, gains speed no faster than the limits admit, and stands still where it enters a
region to loiter in. What is due counts where the whole tube is inside.

From one area to another, d apart, that takes at least d / v in motion with the speed v; from rest with the acceleration
a it is d / v + v / (2 a), or sqrt(2 d / a) where v is not reached.
"""

import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import Final

import shapely

from mission.geometry.regions import union_of
from mission.geometry.shapes import Area, narrowed, polygonal
from mission.logic.formula.conjuncts import conjuncts
from mission.logic.formula.operators import Operator
from mission.logic.formula.syntax import LONGEST_S, Formula, always, implication
from mission.plan.crossing_maps import CrossingMaps
from mission.plan.time_bounds import FOLLOWED_S
from mission.spec.air_time import air_s, longest_text
from mission.spec.model import CORRIDOR
from mission.spec.specification import Specification
from mission.steering.timing import level_acceleration

_MOST_VISITS: Final = 6
"""Of more, those that are due first are looked at: what bounds them bounds all."""

Before = frozenset[tuple[str, str]]
"""Pairs of regions, the second of which is not met before the first."""

_Place = tuple[str, bool]
"""A region, and whether the whole tube is to be inside."""


@dataclass(frozen=True)
class Hopeless:
    """What no flight can keep.

    Attributes:
        asked: It, as it is written: one bound, or several that cannot be kept together.
        text: The same with by how much it fails at least, in words.
    """

    asked: tuple[str, ...]
    text: str


class Earliest:
    """Lower bounds of the times of one mission's flights.

    Args:
        maps: Where it is flown, and from where.
    """

    def __init__(self, maps: CrossingMaps) -> None:
        self._maps, spec = maps, maps.spec
        limits = spec.limits
        # A curve in a corridor is never faster than what is asked for. Where fields steer for want of one, their waves
        # may be, for a moment; such a flight is held to the same.
        self._speed_m_s = min(limits.speed_m_s, spec.flight.speed_m_s if spec.smoothing == CORRIDOR else math.inf)
        self._acceleration_m_s2 = level_acceleration(limits.acceleration_m_s2, limits.tilt_rad)
        self._loiters_s = {region.name: region.loiter_s for region in spec.regions}
        self._areas: dict[tuple[str, bool], Area] = {}
        self._start = shapely.Point(maps.start_m)

    def hopeless(self, specification: Specification) -> list[Hopeless]:
        """What of a specification, and of the time from arming to landing, no flight can keep."""
        found = [*self._late(specification), *self._apart(specification), *self._too_long(specification)]
        return found or list(self._together(specification))

    def soonest_s(self, formula: Formula) -> float:
        """When what is due by a formula with bounds may be there at the earliest, by this formula alone."""
        return max((self._arrival_s(place, frozenset()) for place in due_of([formula])), default=0.0)

    def admits(self, specification: Specification) -> bool:
        """Whether, for all that is known, all that is due may be in time in some order that a specification admits."""
        due, before = due_of(specification.timed), before_of(conjuncts(specification.formula))
        return self._least_late_s(due, dict.fromkeys(due, True), before) <= -FOLLOWED_S

    def _late(self, specification: Specification) -> Iterator[Hopeless]:
        """What is due before it can be reached."""
        before = before_of(conjuncts(specification.formula))
        for formula in specification.timed:
            for place, due_s in due_of([formula]).items():
                soonest_s = self._arrival_s(place, before)
                if soonest_s > due_s - FOLLOWED_S:
                    late = f"no flight is there before {soonest_s:.2f} s"
                    yield self._told((str(formula),), soonest_s + FOLLOWED_S - due_s, late)
                    break

    def _together(self, specification: Specification) -> Iterator[Hopeless]:
        """What is due in time each by itself, and not all of it in any order."""
        due = due_of(specification.timed)
        before = before_of(conjuncts(specification.formula))
        late_s = FOLLOWED_S + self._least_late_s(due, dict.fromkeys(due, True), before)
        if 0.0 < late_s < math.inf:
            asked = (str(formula) for formula in specification.timed if due_of([formula]))
            yield self._told(tuple(asked), late_s, "in whatever order something is so late")

    def _apart(self, specification: Specification) -> Iterator[Hopeless]:
        """What is to follow sooner than it can, and what is to come back sooner than it can."""
        met = met_by(specification.formula).union(*map(met_by, specification.timed))
        again = frozenset[str]().union(*map(_met_again, conjuncts(specification.formula)))
        for formula in specification.timed:
            asked = _reaction_of(formula)
            if asked is not None and asked.when in met:
                takes_s = self._way_s((asked.when, False), (asked.then, True))
                apart = f"from {asked.when} to {asked.then} it is {takes_s:.2f} s"
            elif (asked := _return_of(formula)) is not None and asked.when in again:
                ways = {
                    other: self._way_s((asked.when, True), (other, False), stays=False)
                    + self._way_s((other, False), (asked.when, True))
                    for other in sorted(again)
                }
                farthest = max(ways, key=ways.__getitem__)
                takes_s = ways[farthest]
                apart = f"from {asked.when} to {farthest} and back it is {takes_s:.2f} s"
            else:
                continue
            if takes_s > asked.within_s - FOLLOWED_S:
                yield self._told((str(formula),), takes_s + FOLLOWED_S - asked.within_s, apart)

    def _too_long(self, specification: Specification) -> Iterator[Hopeless]:
        """The time from arming to landing, where the shortest tour of all that is to be met takes longer."""
        flight = self._maps.spec.flight
        if flight.longest_s is None:
            return
        last = sorted(frozenset[str]().union(*map(_stayed_in, conjuncts(specification.formula))))[:1]
        met = sorted(met_by(specification.formula) - {*last}, key=lambda name: -self._arrival_s(name, frozenset()))
        tour = [*met[: _MOST_VISITS - 1], *last]
        before = frozenset((name, end) for end in last for name in tour if name != end)
        takes_s = air_s(
            flight.altitude_m, self._least_late_s(dict.fromkeys(tour, 0.0), dict.fromkeys(tour, False), before)
        )
        if takes_s > flight.longest_s:
            words = f"from arming to landing are {takes_s:.1f} s"
            yield self._told((longest_text(flight.longest_s),), takes_s - flight.longest_s, words)

    def _told(self, asked: tuple[str, ...], short_s: float, why: str) -> Hopeless:
        speed = f"even in straight lines at {self._speed_m_s:.3g} m/s"
        return Hopeless(asked, f"{' & '.join(asked)} fails by at least {short_s:.2f} s: {why}, {speed}")

    def _arrival_s(self, place: str, before: Before) -> float:
        """When a region is reached at the earliest, after all that is met before it."""
        names, grown = {place}, True
        while grown:
            more = {a for a, b in before if b in names} - names
            names, grown = names | more, bool(more)
        due = {name: 0.0 if name == place else math.inf for name in names}
        return self._least_late_s(due, {name: name == place for name in due}, before)

    def _least_late_s(self, due: Mapping[str, float], sure: Mapping[str, bool], before: Before) -> float:
        """By how much something is late at least, in the best of all orders; infinite where there is no order.

        Args:
            due: The regions that are met, and when each is due.
            sure: Whether the whole tube is to be inside.
            before: What comes before what.
        """
        names = frozenset(sorted(due, key=lambda name: (due[name], name))[:_MOST_VISITS])
        best_s = math.inf
        pending: list[tuple[str, float, float, frozenset[str]]] = [("", 0.0, -math.inf, names)]
        while pending:
            last, time_s, late_s, left = pending.pop()
            if late_s >= best_s:
                continue
            if not left:
                best_s = late_s
            for name in sorted(left):
                if not any(after == name and first in left for first, after in before):
                    at_s = time_s + self._way_s((last, sure.get(last, False)), (name, sure[name]))
                    pending.append((name, at_s, max(late_s, at_s - due[name]), left - {name}))
        return best_s

    def _way_s(self, here: _Place, there: _Place, *, stays: bool = True) -> float:
        """The least time from a region, or the start where it has no name, to another, a stay included."""
        metres = float(shapely.distance(self._area(*here), self._area(*there)))
        stay_s = self._stay_s(here[0], self._area(*there)) if here[0] and stays else 0.0
        speed, acceleration = self._speed_m_s, self._acceleration_m_s2
        if here[0] and stay_s == 0.0:
            return metres / speed
        slow = metres < speed**2 / (2.0 * acceleration)
        return stay_s + (
            math.sqrt(2.0 * metres / acceleration) if slow else metres / speed + speed / (2.0 * acceleration)
        )

    def _stay_s(self, name: str, onward: Area) -> float:
        """How long a flight stays in a region for certain before it is in an area.

        Who begins in a region does not enter it; and where the area is near, the tube may be in it before.
        """
        area, corner_m = self._area(name, sure=False), math.sqrt(2.0) * self._maps.spec.flight.tube_m
        near = min(float(shapely.distance(area, self._start)), float(shapely.distance(area, onward))) <= corner_m
        return 0.0 if near else self._loiters_s.get(name, 0.0)

    def _area(self, name: str, sure: bool) -> Area:  # noqa: FBT001 - which of both it is
        """Where the middle of the tube is in a region, all of the tube if ``sure``; the start where it has no name."""
        if not name:
            return self._start
        if (name, sure) not in self._areas:
            maps = self._maps
            whole = polygonal(union_of(maps.locator.partition, maps.labelling.triangles_of(name)))
            inner = narrowed(whole, maps.spec.flight.tube_m) if sure else whole
            # Where the tube has no room, nothing is said here.
            self._areas[name, sure] = whole if inner.is_empty else inner
        return self._areas[name, sure]


def due_of(timed: Collection[Formula]) -> dict[str, float]:
    """The regions that are to be met within bounds of the beginning, or before they are gone, with when that is, s."""
    return {name: due_s for name, (_, due_s) in spans_of(timed).items() if due_s < LONGEST_S}


def spans_of(timed: Collection[Formula]) -> dict[str, tuple[float, float]]:
    """The regions that are to be met within bounds of the beginning, or while they are there: from when to when."""
    found: dict[str, tuple[float, float]] = {}
    for formula in timed:
        if formula.operator in (Operator.EVENTUALLY, Operator.UNTIL):
            for place in filter(is_place, conjuncts(formula.operands[-1])):
                spans = [bounds for bounds in (formula.bounds, place.bounds) if bounds is not None]
                for least, most in spans:
                    before = found.get(place.name, (0.0, math.inf))
                    found[place.name] = max(before[0], float(least)), min(before[1], float(most))
    return found


def before_of(formulas: Collection[Formula]) -> Before:
    """What is not met before what, by formulas such as ``!b U a``."""
    return frozenset(
        (goal.name, denied.operands[0].name)
        for denied, goal in (each.operands for each in formulas if each.operator is Operator.UNTIL)
        if denied.operator is Operator.NOT and is_place(denied.operands[0]) and is_place(goal)
    )


def met_by(formula: Formula) -> frozenset[str]:
    """Regions that are met wherever a formula holds."""
    match formula.operator:
        case Operator.PROPOSITION:
            return frozenset({formula.name})
        case Operator.AND:
            return frozenset[str]().union(*map(met_by, formula.operands))
        case Operator.OR:
            return frozenset.intersection(*map(met_by, formula.operands))
        case Operator.EVENTUALLY | Operator.ALWAYS | Operator.UNTIL | Operator.NEXT:
            return met_by(formula.operands[-1])
    return frozenset()


def _met_again(formula: Formula) -> frozenset[str]:
    """Regions that are met again and again: of ``G F a``."""
    recurs = formula.operator is Operator.ALWAYS and formula.operands[0].operator is Operator.EVENTUALLY
    return met_by(formula) if recurs else frozenset()


def _stayed_in(formula: Formula) -> frozenset[str]:
    """Regions in which a flight stays: of ``F G a``."""
    stays = formula.operator is Operator.EVENTUALLY and formula.operands[0].operator is Operator.ALWAYS
    return met_by(formula) if stays else frozenset()


@dataclass(frozen=True)
class _Reaction:
    when: str
    then: str
    within_s: float


def _reaction_of(formula: Formula) -> _Reaction | None:
    """Of ``G (a -> F[0,s] b)``."""
    implied = _implied(formula)
    if implied is None:
        return None
    when, then = implied
    if not is_place(when) or then.operator is not Operator.EVENTUALLY or then.bounds is None:
        return None
    goal = then.operands[0]
    return _Reaction(when.name, goal.name, float(then.bounds[1])) if is_place(goal) else None


def _return_of(formula: Formula) -> _Reaction | None:
    """Of ``G (a -> G F[0,s] a)``."""
    implied = _implied(formula)
    if implied is None or implied[1].operator is not Operator.ALWAYS or implied[1].bounds is not None:
        return None
    found = _reaction_of(always(implication(implied[0], implied[1].operands[0])))
    return found if found is not None and found.when == found.then else None


def _implied(formula: Formula) -> tuple[Formula, Formula] | None:
    """Both sides of ``G (a -> b)``."""
    if formula.operator is not Operator.ALWAYS or formula.bounds is not None:
        return None
    inner = formula.operands[0]
    return (inner.operands[0], inner.operands[1]) if inner.operator is Operator.IMPLIES else None


def is_place(formula: Formula) -> bool:
    """Whether a formula is that the vehicle is in a region."""
    return formula.operator is Operator.PROPOSITION
