"""Whether a behaviour satisfies a formula with bounds in seconds: metric temporal logic over dense time, exactly.

Of each subformula, from the leaves up, the set of times is reckoned at which it holds: a union of intervals, in one
pass over those of its operands. All operators look ahead, so what holds in the part that repeats does so in each round,
and a set is known from one round.

    t |= a U[p,q] b    some t' in [t + p, t + q] has t' |= b, and u |= a at all u with t <= u < t'
    F[p,q] a = true U[p,q] a          G[p,q] a = ! F[p,q] ! a
    a R[p,q] b = ! (! a U[p,q] ! b)   a W[p,q] b = a U[p,q] b | G[0,q] a   a M[p,q] b = a R[p,q] b & F[0,q] a

    a[p,q]: the proposition a holds at t, and p <= t <= q

Without bounds they are those of LTL, for which time has no end. Where a behaviour is known in part only, each set is
enclosed by two: when the subformula must hold, and when it may.

Source: Koymans, "Specifying real-time properties with metric temporal logic" (1990); of the way of reckoning: Maler and
Nickovic, "Monitoring temporal properties of continuous signals" (2004).
"""

from collections.abc import Callable, Sequence
from math import lcm
from typing import Final

from mission.logic.formula.operators import BOUNDABLE, Operator
from mission.logic.formula.syntax import LONGEST_S, Bounds, Formula, postorder
from mission.logic.timed.behaviour import Behaviour, Known
from mission.logic.timed.time_sets import (
    AFTER,
    BEFORE,
    NEVER,
    Span,
    TimeSet,
    complement,
    contains,
    in_whole,
    intersection,
    joined,
    moved,
    union,
    whole,
)

_START: Final = 0
_Window = tuple[int, int]


def satisfied(behaviour: Behaviour, formula: Formula) -> bool | None:
    """Whether a behaviour satisfies a formula at its beginning; None where what is known of it does not tell.

    None may also stand where every behaviour that is possible has the same verdict for reasons that lie in several
    subformulas at once, such as ``a | !a``; where all is known there is a verdict.

    Raises:
        ValueError: The formula has an ``X``.
    """
    nodes = postorder(formula)
    # What counts by the clock is the same in no two rounds, until it counts no more, or for ever.
    clocked = (node.bounds or () for node in nodes if node.operator is Operator.PROPOSITION)
    behaviour = behaviour.once_until(max((time for times in clocked for time in times if time < LONGEST_S), default=-1))
    unit = _common_unit(behaviour, nodes)
    line = _Line(behaviour, unit)
    found: dict[Formula, Known] = {}
    for node in nodes:
        if node.operator is Operator.PROPOSITION:
            found[node] = Known(*(line.counting(in_whole(each, unit), node.bounds) for each in behaviour.of(node.name)))
            continue
        operands = [found[operand] for operand in node.operands]
        must, may = [each.must for each in operands], [each.may for each in operands]
        if must == may:
            sure = line.holds(node, must, must)
            found[node] = Known(sure, sure)
        else:
            found[node] = Known(line.holds(node, must, may), line.holds(node, may, must))
    if contains(found[formula].must, _START):
        return True
    return None if contains(found[formula].may, _START) else False


def _common_unit(behaviour: Behaviour, nodes: Sequence[Formula]) -> int:
    """A part of a second of which all times are multiples: whole numbers are as exact as fractions, and quicker."""
    sets = [behaviour.untold, *(each for known in behaviour.known.values() for each in known)]
    cuts = (cut[0] for times in sets for span in times for cut in span)
    bounds = (bound for node in nodes for bound in node.bounds or ())
    return lcm(*{time.denominator for time in (*cuts, *bounds, behaviour.loop_s, behaviour.end_s)})


class _Line:
    """Time up to the end of the first round, and what is looked up of times beyond it."""

    def __init__(self, behaviour: Behaviour, unit: int) -> None:
        self._unit, self._loop, self._end = unit, whole(behaviour.loop_s, unit), whole(behaviour.end_s, unit)
        self._round = self._end - self._loop
        self._whole: Span = (_START, BEFORE), (self._end, BEFORE)

    def holds(  # noqa: PLR0911 - one return for each operator
        self, node: Formula, sets: list[TimeSet], others: list[TimeSet]
    ) -> TimeSet:
        """When a node holds, by the sets of its operands; where they are denied, by the ``others``."""
        if node.operator in BOUNDABLE:
            return _OF[node.operator](self, sets, self._bounds(node.bounds))
        match node.operator:
            case Operator.TRUE | Operator.FALSE:
                return (self._whole,) if node.operator is Operator.TRUE else NEVER
            case Operator.NOT:
                return self._not(others[0])
            case Operator.AND:
                return self._not(union(*map(self._not, sets)))
            case Operator.OR:
                return union(*sets)
            case Operator.IMPLIES:
                return union(self._not(others[0]), sets[1])
            case Operator.IFF:
                return union(intersection(*sets), intersection(*map(self._not, others)))
        raise ValueError("X counts the letters of a word, which time has none of")

    def counting(self, times: TimeSet, window: Bounds | None) -> TimeSet:
        """The times of a proposition that lie in its window, by the clock."""
        if window is None:
            return times
        begin, end = (whole(time, self._unit) for time in window)
        last = self._whole[1] if window[1] >= LONGEST_S else (end, AFTER)
        return intersection(times, joined([((begin, BEFORE), last)]))

    def _not(self, times: TimeSet) -> TimeSet:
        return complement(times, self._whole)

    def _bounds(self, bounds: Bounds | None) -> _Window:
        """Bounds of the same meaning of which neither is much later than the end of the first round.

        From any time on, what lies farther ahead than one whole way to that end has been met before; and what is later
        than two such ways is a whole number of rounds later than something that is not.
        """
        least, most = (_START, self._end) if bounds is None else (whole(bound, self._unit) for bound in bounds)
        rounds = max(0, (least - self._end) // self._round)
        least, most = least - rounds * self._round, most - rounds * self._round
        return least, min(most, least + self._end)

    def _ahead(self, times: TimeSet, to: int) -> TimeSet:
        """A set beyond the end of the first round, at least up to and including a time."""
        again = intersection(times, (((self._loop, BEFORE), self._whole[1]),))
        rounds = max(0, (to - self._end) // self._round + 1)
        shifts = (k * self._round for k in range(1, rounds + 1)) if again else ()
        return joined([*times, *((moved(a, by), moved(b, by)) for by in shifts for a, b in again)])

    def _clipped(self, times: TimeSet) -> TimeSet:
        return intersection(times, (self._whole,))

    def eventually(self, times: TimeSet, bounds: _Window) -> TimeSet:
        least, most = bounds
        ahead = self._ahead(times, self._end + most)
        return self._clipped(joined((moved(begin, -most), moved(end, -least)) for begin, end in ahead))

    def always(self, times: TimeSet, bounds: _Window) -> TimeSet:
        return self._not(self.eventually(self._not(times), bounds))

    def until(self, left: TimeSet, right: TimeSet, bounds: _Window) -> TimeSet:
        least, most = bounds
        to = self._end + most
        goals, first = self._ahead(right, to), 0
        found: list[Span] = []
        for begin, end in self._ahead(left, to):
            # While the left holds, and at the moment at which it ceases to, the right may come.
            last = end[0], AFTER
            while first < len(goals) and goals[first][1] <= begin:
                first += 1
            number = first
            while number < len(goals) and goals[number][0] < last:
                came, went = max(goals[number][0], begin), min(goals[number][1], last)
                found.append((max(moved(came, -most), begin), min(moved(went, -least), end)))
                number += 1
        reached = self._clipped(joined(sorted(found)))
        return union(right, reached) if least == 0 else reached

    def release(self, left: TimeSet, right: TimeSet, bounds: _Window) -> TimeSet:
        return self._not(self.until(self._not(left), self._not(right), bounds))


_OF: Final[dict[Operator, Callable[[_Line, list[TimeSet], _Window], TimeSet]]] = {
    Operator.EVENTUALLY: lambda line, sets, bounds: line.eventually(sets[0], bounds),
    Operator.ALWAYS: lambda line, sets, bounds: line.always(sets[0], bounds),
    Operator.UNTIL: lambda line, sets, bounds: line.until(sets[0], sets[1], bounds),
    Operator.RELEASE: lambda line, sets, bounds: line.release(sets[0], sets[1], bounds),
    Operator.WEAK_UNTIL: lambda line, sets, bounds: union(
        line.until(sets[0], sets[1], bounds), line.always(sets[0], (_START, bounds[1]))
    ),
    Operator.STRONG_RELEASE: lambda line, sets, bounds: intersection(
        line.release(sets[0], sets[1], bounds), line.eventually(sets[0], (_START, bounds[1]))
    ),
}
"""The sets of the temporal operators: they are monotone, so that sets that must hold give one that must, too."""
