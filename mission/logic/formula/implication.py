"""Implications between formulas that their syntax shows.

The rules are those of Somenzi and Bloem, "Efficient Büchi automata from LTL formulae" (2000), with the operators ``W``
and ``M`` beside ``U`` and ``R``.
"""

from typing import Final

from mission.logic.formula.operators import Operator
from mission.logic.formula.syntax import FALSE, TRUE, Formula, always, eventually

_BUDGET: Final = 200_000
_MAX_DEPTH: Final = 100  # of both formulas together; a few calls a level are far below the depth of Python's stack


class Implications:
    """Finds implications between formulas in negation normal form, and remembers them."""

    def __init__(self) -> None:
        self._implied: dict[tuple[Formula, Formula], bool] = {}
        self._budget = _BUDGET

    def implies(self, left: Formula, right: Formula) -> bool:
        """Whether the syntax shows that ``left`` implies ``right``; both in negation normal form."""
        if left is right or left is FALSE or right is TRUE:
            return True
        if left is TRUE or right is FALSE:
            return False
        key = (left, right)
        known = self._implied.get(key)
        if known is None:
            if self._budget <= 0 or left.depth + right.depth > _MAX_DEPTH:
                return False
            self._budget -= 1
            known = self._implied[key] = self._shows(left, right)
        return known

    def _shows(self, left: Formula, right: Formula) -> bool:
        if left.operator is Operator.OR:
            return all(self.implies(part, right) for part in left.operands)
        if right.operator is Operator.AND:
            return all(self.implies(left, part) for part in right.operands)
        if left.operator is Operator.AND and any(self.implies(part, right) for part in left.operands):
            return True
        if right.operator is Operator.OR and any(self.implies(left, part) for part in right.operands):
            return True
        return self._shows_now(left, right) or self._shows_always(left, right)

    def _shows_now(self, left: Formula, right: Formula) -> bool:  # noqa: C901 - one case for each operator
        """By what ``left`` says of this position, or by what suffices for ``right`` at this position."""
        now: tuple[Formula, ...] = ()
        match left.operator:
            case Operator.ALWAYS:
                now = left.operands
            case Operator.RELEASE:
                now = left.operands[1:]
            case Operator.STRONG_RELEASE:
                now = (*left.operands[1:], eventually(left.operands[0]))
            case Operator.UNTIL:
                now = (eventually(left.operands[1]),)
        if any(self.implies(part, right) for part in now):
            return True
        suffices: tuple[Formula, ...] = ()
        match right.operator:
            case Operator.EVENTUALLY:
                suffices = right.operands
            case Operator.UNTIL:
                suffices = right.operands[1:]
            case Operator.WEAK_UNTIL:
                suffices = (*right.operands[1:], always(right.operands[0]))
            case Operator.RELEASE:
                suffices = (always(right.operands[1]),)
        if any(self.implies(left, part) for part in suffices):
            return True
        if right.operator in (Operator.RELEASE, Operator.STRONG_RELEASE):
            return all(self.implies(left, part) for part in right.operands)
        if left.operator in (Operator.UNTIL, Operator.WEAK_UNTIL):
            return all(self.implies(part, right) for part in left.operands)
        return False

    def _shows_always(self, left: Formula, right: Formula) -> bool:
        """By comparing operators of the same kind operand by operand."""
        pair = (left.operator, right.operator)
        if pair == (Operator.NEXT, Operator.NEXT):
            return self.implies(left.operands[0], right.operands[0])
        if pair[1] is Operator.ALWAYS and left.universality:
            return self.implies(left, right.operands[0])
        if pair[0] is Operator.EVENTUALLY and right.eventuality:
            return self.implies(left.operands[0], right)
        if pair in _WEAKER:
            return all(map(self.implies, left.operands, right.operands))
        return False


_WEAKER: Final = frozenset(
    {
        (Operator.UNTIL, Operator.UNTIL),
        (Operator.UNTIL, Operator.WEAK_UNTIL),
        (Operator.WEAK_UNTIL, Operator.WEAK_UNTIL),
        (Operator.STRONG_RELEASE, Operator.STRONG_RELEASE),
        (Operator.STRONG_RELEASE, Operator.RELEASE),
        (Operator.RELEASE, Operator.RELEASE),
    }
)
