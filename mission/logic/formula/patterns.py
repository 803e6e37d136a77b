"""The catalogue of mission patterns for robots, as formulas over region names.

Source: Menghi, Tsigkanos, Pelliccione, Ghezzi and Berger, "Specification Patterns for Robotic Missions", IEEE
Transactions on Software Engineering 47 (2021). The catalogue reads a word place by place, every place being one of its
locations, and uses ``X`` for "after that". Over a mesh, a region is many triangles, entered and left with several
letters in a row, and between regions lies open space; ``X`` would speak of triangles. So nothing here uses ``X``: what
is counted and ordered are *visits*. A visit begins when a region is entered and ends when the vehicle comes to another
region; one that leaves into open space and comes back is still on the same visit. Each formula therefore holds of a
word if and only if it holds with letters repeated, and a vehicle that sways across the edge of a region cannot break
it. Where the meaning departs from the catalogue's for another reason, the function says so.

``places`` are the regions that end a visit to any other one; those that a pattern orders are always among them.
In the examples, c is one such region. All functions raise ValueError where they are given no region, or a number of
visits below one.
"""

from collections.abc import Sequence
from functools import reduce
from itertools import pairwise, permutations

from mission.logic.formula.syntax import (
    Formula,
    always,
    conjunction,
    disjunction,
    equivalence,
    eventually,
    implication,
    negation,
    proposition,
    until,
    weak_until,
)


def visit(regions: Sequence[str]) -> Formula:
    """Every region is visited, in any order: ``F a & F b``."""
    return conjunction(*(eventually(place) for place in _places(regions)))


def sequenced_visit(regions: Sequence[str]) -> Formula:
    """A visit to each comes after one to the region before it, whatever else is visited: ``F (a & F b)``."""
    return reduce(_before, reversed(_places(regions)[:-1]), eventually(_places(regions)[-1]))


def ordered_visit(regions: Sequence[str]) -> Formula:
    """Sequenced, and no region is visited before the one before it: ``F (a & F b) & (!b U a)``."""
    firsts = (until(negation(b), a) for a, b in pairwise(_places(regions)))
    return conjunction(sequenced_visit(regions), *firsts)


def strict_ordered_visit(regions: Sequence[str], places: Sequence[str] = ()) -> Formula:
    """Ordered, and each is visited only once before the next one is: ``... & (!a U (a & ((a | !c) U (!a U b))))``."""
    once = (
        _then(a, until(_still_at(a, regions, places), until(negation(a), b))) for a, b in pairwise(_places(regions))
    )
    return conjunction(ordered_visit(regions), *once)


def fair_visit(regions: Sequence[str], places: Sequence[str] = ()) -> Formula:
    """Every region is visited, and none again before all the others: ``F a & F b & G (a -> ((a | !c) W (!a W b)))``...

    So at no time do the numbers of visits differ by more than one. The catalogue asks only that the next one in the
    list comes first, which is the same for two regions and lets the numbers of n regions differ by n - 1.
    """
    return conjunction(visit(regions), *_fairness(regions, places))


def patrol(regions: Sequence[str]) -> Formula:
    """Every region is visited again and again: ``G F a & G F b``."""
    return conjunction(*(always(eventually(place)) for place in _places(regions)))


def sequenced_patrol(regions: Sequence[str]) -> Formula:
    """The sequence is flown again and again, whatever else is visited: ``G F (a & F b)``.

    The formula is the catalogue's. It holds of the same words as ``patrol``: what is visited again and again is also
    visited in this sequence again and again.
    """
    return always(sequenced_visit(regions))


def ordered_patrol(regions: Sequence[str], places: Sequence[str] = ()) -> Formula:
    """Patrolled, and no region is visited, at first or again, before the one before it is visited (again).

    ``G F a & G F b & (!b U a) & G (b -> ((b | !c) W (!b W a)))``. The catalogue asks the last of the first region
    after the last one, too; with that, its ordered and its strictly ordered patrols would be the same.
    """
    pairs = list(pairwise(_places(regions)))
    firsts = (until(negation(b), a) for a, b in pairs)
    again = (_not_again_before(b, a, _still_at(b, regions, places)) for a, b in pairs)
    return conjunction(patrol(regions), *firsts, *again)


def strict_ordered_patrol(regions: Sequence[str], places: Sequence[str] = ()) -> Formula:
    """Visits to the regions come in exactly this order, round after round.

    ``((!a & !b) U a) & G (a -> ((a | !c) U ((!a & !b) U b))) & ...``. Regions that overlap count as visited in order
    where the vehicle goes from one straight into the next.
    """
    stops = _places(regions)
    if len(stops) == 1:
        return patrol(regions)
    none = conjunction(*(negation(stop) for stop in stops))
    rounds = (
        always(implication(a, until(_still_at(a, regions, places), until(none, b))))
        for a, b in zip(stops, stops[1:] + stops[:1], strict=True)
    )
    return conjunction(until(none, stops[0]), *rounds)


def fair_patrol(regions: Sequence[str], places: Sequence[str] = ()) -> Formula:
    """Every region is visited again and again, and none again before all the others (see ``fair_visit``)."""
    return conjunction(patrol(regions), *_fairness(regions, places))


def avoid(regions: Sequence[str]) -> Formula:
    """Global avoidance: none is ever entered, ``G !a & G !b``."""
    return conjunction(*(always(negation(place)) for place in _places(regions)))


def avoid_until(region: str, release: str) -> Formula:
    """Past avoidance: not entered before ``release`` is, which must be: ``!a U b``."""
    return until(negation(proposition(region)), proposition(release))


def avoid_after(region: str, trigger: str) -> Formula:
    """Future avoidance: never inside from the first visit to ``trigger`` on: ``G (b -> G !a)``."""
    return always(implication(proposition(trigger), avoid([region])))


def visits_at_most(region: str, count: int, places: Sequence[str] = ()) -> Formula:
    """Upper restricted avoidance: ``count`` visits or fewer; for one, ``!a W ((a | !c) W G !a)``."""
    _check(count)
    place, still = proposition(region), _still_at(proposition(region), [region], places)
    return reduce(
        lambda rest, _: weak_until(negation(place), weak_until(still, rest)), range(count), always(negation(place))
    )


def visits_at_least(region: str, count: int, places: Sequence[str] = ()) -> Formula:
    """Lower restricted avoidance: ``count`` visits or more; for two, ``F (a & F (!a & c & F a))``."""
    _check(count)
    place, elsewhere = proposition(region), _elsewhere(region, places)
    return reduce(
        lambda rest, _: eventually(conjunction(place, eventually(conjunction(elsewhere, rest)))),
        range(count - 1),
        eventually(place),
    )


def visits_exactly(region: str, count: int, places: Sequence[str] = ()) -> Formula:
    """Exact restricted avoidance: ``count`` visits; for one, ``!a U (a & ((a | !c) W G !a))``.

    The last visit may last for ever: a vehicle that stays where it ends is there. The catalogue's must end.
    """
    _check(count)
    place, still = proposition(region), _still_at(proposition(region), [region], places)
    elsewhere = _elsewhere(region, places)
    return reduce(
        lambda rest, _: _then(place, until(still, conjunction(elsewhere, rest))),
        range(count - 1),
        _then(place, weak_until(still, always(negation(place)))),
    )


def wait(region: str, stimulus: str) -> Formula:
    """Stays in the region from the start until it enters ``stimulus``: ``a U b``."""
    return until(proposition(region), proposition(stimulus))


def instantaneous_reaction(stimulus: str, reaction: str) -> Formula:
    """Whenever in one, in the other at the same time: ``G (a -> b)``."""
    return always(implication(proposition(stimulus), proposition(reaction)))


def delayed_reaction(stimulus: str, reaction: str) -> Formula:
    """Each visit to one is followed by a visit to the other: ``G (a -> F b)``."""
    return always(implication(proposition(stimulus), eventually(proposition(reaction))))


def prompt_reaction(stimulus: str, reaction: str, places: Sequence[str] = ()) -> Formula:
    """From one the vehicle goes to the other before it visits any other of ``places``.

    ``G (a -> (a U (!c U b)))`` for one other region c. The catalogue's "next instant", ``X b``, is the next other
    region here: between regions lies open space.
    """
    a, b = proposition(stimulus), proposition(reaction)
    between = conjunction(*(negation(proposition(name)) for name in places if name not in (stimulus, reaction)))
    return always(implication(a, until(a, until(between, b))))


def bound_reaction(stimulus: str, reaction: str) -> Formula:
    """In one exactly while in the other: ``G (a <-> b)``."""
    return always(equivalence(proposition(stimulus), proposition(reaction)))


def bound_delay(stimulus: str, reaction: str, places: Sequence[str] = ()) -> Formula:
    """A prompt reaction, and the other region is visited in no other way.

    ``prompt_reaction`` and ``(b | (!b W a)) & G (b -> ((b | !c) W (!b W a)))``; starting inside b is no visit.
    """
    a, b = proposition(stimulus), proposition(reaction)
    first = disjunction(b, weak_until(negation(b), a))
    again = _not_again_before(b, a, _still_at(b, [stimulus], places))
    return conjunction(prompt_reaction(stimulus, reaction, places), first, again)


def _places(regions: Sequence[str]) -> list[Formula]:
    if not regions:
        raise ValueError("a task names one region at least")
    return [proposition(name) for name in regions]


def _before(rest: Formula, place: Formula) -> Formula:
    return eventually(conjunction(place, rest))


def _then(place: Formula, rest: Formula) -> Formula:
    """At the first position in a place, ``rest``."""
    return until(negation(place), conjunction(place, rest))


def _still_at(place: Formula, regions: Sequence[str], places: Sequence[str]) -> Formula:
    """While a visit lasts: in the place, or in no other."""
    others = [name for name in dict.fromkeys((*regions, *places)) if name != place.name]
    return disjunction(place, conjunction(*(negation(proposition(name)) for name in others)))


def _elsewhere(region: str, places: Sequence[str]) -> Formula:
    """In another region, so that the visit is over."""
    others = disjunction(*(proposition(name) for name in places if name != region))
    return conjunction(negation(proposition(region)), others)


def _not_again_before(place: Formula, other: Formula, still: Formula) -> Formula:
    """Between two visits to a place there is one to the other."""
    return always(implication(place, weak_until(still, weak_until(negation(place), other))))


def _fairness(regions: Sequence[str], places: Sequence[str]) -> list[Formula]:
    return [_not_again_before(a, b, _still_at(a, regions, places)) for a, b in permutations(_places(regions), 2)]


def _check(count: int) -> None:
    if count < 1:
        raise ValueError("the number of visits is one at least")
