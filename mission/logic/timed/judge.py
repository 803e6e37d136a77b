"""Whether a behaviour satisfies a formula with bounds in seconds: metric temporal logic over dense time, exactly.

Of each subformula, from the leaves up, the set of times is reckoned at which it holds: a union of intervals, in one
pass over those of its operands. All operators look ahead, so what holds in the part that repeats does so in each round,
and a set is known from one round.

    t |= a U[p,q] b    some t' in [t + p, t + q] has t' |= b, and u |= a at all u with t <= u < t'
    F[p,q] a = true U[p,q] a          G[p,q] a = ! F[p,q] ! a
    a R[p,q] b = ! (! a U[p,q] ! b)   a W[p,q] b = a U[p,q] b | G[0,q] a   a M[p,q] b = a R[p,q] b & F[0,q] a

Without bounds they are those of LTL, for which time has no end. Where a behaviour is known in part only, each set is
enclosed by two: when the subformula must hold, and when it may.

Source: Koymans, "Specifying real-time properties with metric temporal logic" (1990); of the way of reckoning: Maler and
Nickovic, "Monitoring temporal properties of continuous signals" (2004).
"""

from collections.abc import Callable
from fractions import Fraction
from typing import Final

from mission.logic.formula.syntax import BOUNDABLE, Bounds, Formula, Operator, postorder
from mission.logic.timed.behaviour import Behaviour, Known
from mission.logic.timed.time_sets import (
    AFTER,
    BEFORE,
    NEVER,
    Span,
    TimeSet,
    complement,
    contains,
    intersection,
    joined,
    moved,
    union,
)

_START: Final = Fraction(0)


def satisfied(behaviour: Behaviour, formula: Formula) -> bool | None:
    """Whether a behaviour satisfies a formula at its beginning; None where what is known of it does not tell.

    None may also stand where every behaviour that is possible has the same verdict for reasons that lie in several
    subformulas at once, such as ``a | !a``; where all is known there is a verdict.

    Raises:
        ValueError: The formula has an ``X``.
    """
    known = when(behaviour, formula)
    if contains(known.must, _START):
        return True
    return None if contains(known.may, _START) else False


def when(behaviour: Behaviour, formula: Formula) -> Known:
    """The times, up to the end of the first round, at which a formula must hold, and at which it may."""
    line = _Line(behaviour.loop_s, behaviour.end_s)
    found: dict[Formula, Known] = {}
    for node in postorder(formula):
        if node.operator is Operator.PROPOSITION:
            found[node] = behaviour.of(node.name)
            continue
        operands = [found[operand] for operand in node.operands]
        must, may = [each.must for each in operands], [each.may for each in operands]
        if all(each.must == each.may for each in operands):
            sure = line.holds(node, must, must)
            found[node] = Known(sure, sure)
        else:
            found[node] = Known(line.holds(node, must, may), line.holds(node, may, must))
    return found[formula]


class _Line:
    """Time up to the end of the first round, and what is looked up of times beyond it."""

    def __init__(self, loop_s: Fraction, end_s: Fraction) -> None:
        self._loop_s, self._end_s, self._round_s = loop_s, end_s, end_s - loop_s
        self._whole: Span = (_START, BEFORE), (end_s, BEFORE)

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

    def _not(self, times: TimeSet) -> TimeSet:
        return complement(times, self._whole)

    def _bounds(self, bounds: Bounds | None) -> Bounds:
        """Bounds of the same meaning of which neither is much later than the end of the first round.

        From any time on, what lies farther ahead than one whole way to that end has been met before; and what is later
        than two such ways is a whole number of rounds later than something that is not.
        """
        least, most = bounds or (_START, self._end_s)
        rounds = max(0, (least - self._end_s) // self._round_s)
        least, most = least - rounds * self._round_s, most - rounds * self._round_s
        return least, min(most, least + self._end_s)

    def _ahead(self, times: TimeSet, to_s: Fraction) -> TimeSet:
        """A set beyond the end of the first round, at least up to and including a time."""
        again = intersection(times, (((self._loop_s, BEFORE), self._whole[1]),))
        rounds = max(0, (to_s - self._end_s) // self._round_s + 1)
        shifts = (k * self._round_s for k in range(1, rounds + 1)) if again else ()
        return joined([*times, *((moved(a, by), moved(b, by)) for by in shifts for a, b in again)])

    def _clipped(self, times: TimeSet) -> TimeSet:
        return intersection(times, (self._whole,))

    def eventually(self, times: TimeSet, bounds: Bounds) -> TimeSet:
        least, most = bounds
        ahead = self._ahead(times, self._end_s + most)
        return self._clipped(joined((moved(begin, -most), moved(end, -least)) for begin, end in ahead))

    def always(self, times: TimeSet, bounds: Bounds) -> TimeSet:
        return self._not(self.eventually(self._not(times), bounds))

    def until(self, left: TimeSet, right: TimeSet, bounds: Bounds) -> TimeSet:
        least, most = bounds
        to_s = self._end_s + most
        goals, first = self._ahead(right, to_s), 0
        found: list[Span] = []
        for begin, end in self._ahead(left, to_s):
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

    def release(self, left: TimeSet, right: TimeSet, bounds: Bounds) -> TimeSet:
        return self._not(self.until(self._not(left), self._not(right), bounds))


_OF: Final[dict[Operator, Callable[[_Line, list[TimeSet], Bounds], TimeSet]]] = {
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
