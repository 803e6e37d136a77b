"""Restricted regions that are there for a time only, on the way of a plan: what a flight that is late would meet."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from mission.logic.formula.operators import Operator
from mission.logic.formula.syntax import Bounds, Formula
from mission.logic.timed.behaviour import Behaviour
from mission.logic.timed.time_sets import NEVER


@dataclass(frozen=True)
class Closing:
    """A region that must not be met while it is there.

    Attributes:
        formula: What asks for that.
        region: Its proposition, as it is written.
        window_s: When it is there.
        spans_s: When a flight within the tube may be in it, by the clock of the trajectory, ascending.
    """

    formula: Formula
    region: Formula
    window_s: Bounds
    spans_s: tuple[tuple[float, float], ...]

    def is_met(self, flown_s: float, late_s: float) -> bool:
        """Whether a flight comes into it while it is there.

        One that is in it already does not: the way out is the best that is left.

        Args:
            flown_s: How much of the trajectory has been flown.
            late_s: How much longer that has taken; the rest is flown so much later.
        """
        begin_s, end_s = self.window_s
        return any(a > flown_s and a + late_s <= end_s and b + late_s >= begin_s for a, b in self.spans_s)


def closings(formulas: Iterable[Formula], flown: Behaviour) -> tuple[Closing, ...]:
    """Those of which formulas say that they must never be met.

    Args:
        formulas: What is asked for in time.
        flown: Every flight within the tube that keeps to the clock of the trajectory.
    """
    return tuple(
        Closing(formula, node, window_s, _spans_s(flown, node.name, window_s[1]))
        for formula, node in ((formula, _never(formula)) for formula in formulas)
        if node is not None and (window_s := node.bounds) is not None
    )


def entered(all_of_them: Sequence[Closing], missed: Iterable[str]) -> str:
    """The first of them that is among formulas that are missed, as it is written; empty where none is."""
    names = frozenset(missed)
    return next((str(each.region) for each in all_of_them if str(each.formula) in names), "")


def ahead(all_of_them: Sequence[Closing], flown_s: float, late_s: float) -> str:
    """The first of them that a flight is going to meet, as it is written; empty where it meets none."""
    return next((str(each.region) for each in all_of_them if each.is_met(flown_s, late_s)), "")


def _never(formula: Formula) -> Formula | None:
    """What a formula says that it is never so; None where it says something else."""
    if formula.operator is not Operator.ALWAYS or formula.bounds is not None:
        return None
    (inside,) = formula.operands
    return inside.operands[0] if inside.operator is Operator.NOT else None


def _spans_s(flown: Behaviour, name: str, until_s: Fraction) -> tuple[tuple[float, float], ...]:
    alone = replace(flown, known={name: flown.of(name)}, untold=NEVER).once_until(until_s)
    return tuple((float(begin[0]), float(end[0])) for begin, end in alone.of(name).may)
