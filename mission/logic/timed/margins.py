"""How near a verdict was: by how many seconds bounds are kept or missed, and when that was settled."""

import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Final

from mission.logic.formula.operators import Operator
from mission.logic.formula.syntax import LONGEST_S, Formula, negation, postorder, proposition, propositions, rebuilt
from mission.logic.timed.behaviour import Behaviour, Piece, so_far, staying
from mission.logic.timed.judge import satisfied
from mission.logic.timed.rewriting import positive, tightened
from mission.logic.timed.time_sets import AFTER, BEFORE, Time

STEP_S: Final = Fraction(1, 1000)
"""Margins and times of verdicts are whole multiples of this."""


def margin_s(behaviour: Behaviour, formula: Formula) -> float:
    """By how much each bound of a formula could be tightened at once so that a behaviour still surely satisfies it, s.

    Below 0 where it does not, or not surely: so much wider the bounds would have to be. Infinite where no change of
    bounds makes a difference. Rounded down to ``STEP_S``.
    """
    normal = positive(formula)
    farthest = math.ceil((2 * behaviour.end_s + _longest_s(formula)) / STEP_S) + 1

    def fails(steps: int) -> bool:
        return satisfied(behaviour, tightened(normal, steps * STEP_S)) is not True

    least, most = (0, farthest) if not fails(0) else (-farthest, 0)
    if fails(least):
        return -math.inf
    if most and not fails(most):
        return math.inf
    return float((_first(fails, least, most) - 1) * STEP_S)


def settled_s(pieces: Sequence[Piece], formula: Formula, *, from_s: Time = 0) -> float | None:
    """When it was certain what becomes of a formula in a behaviour that stays as its last piece is, s.

    None where that is never certain, as what counts may still come.

    Args:
        pieces: What is passed, ascending; the last piece lasts for ever.
        formula: The formula.
        from_s: Nothing before this is looked for.
    """
    verdict = satisfied(staying(pieces), formula)
    last_s = pieces[-1].span[0][0] + _longest_s(formula) + 1
    first, last = math.floor(from_s / STEP_S), math.ceil(max(last_s, from_s) / STEP_S)

    def decided(steps: int) -> bool:
        return satisfied(so_far(pieces, steps * STEP_S), formula) is verdict

    if verdict is None or not decided(last):
        return None
    return float(_first(decided, first - 1, last) * STEP_S)


def unbroken(pieces: Sequence[Piece], formula: Formula, now_s: Time) -> bool | None:
    """Whether nothing up to a time breaks a formula, as if all that follows were as it should be; None if untold.

    So a flight of laps is judged, of which no time is the last.

    Args:
        pieces: What is passed, ascending.
        formula: The formula.
        now_s: What comes after this counts as whatever the formula asks for.
    """
    names = propositions(formula)

    def named(node: Formula, operands: tuple[Formula, ...]) -> Formula:
        if node.operator is Operator.NOT:
            return negation(proposition(_denied(node.operands[0].name), node.operands[0].bounds))
        return node if not operands else Formula(node.operator, operands, "", node.bounds)

    end = now_s, AFTER
    known = [
        Piece(
            (piece.span[0], min(piece.span[1], end)),
            piece.must | {_denied(name) for name in names & piece.must},
            piece.may | {_denied(name) for name in names & piece.may},
        )
        for piece in pieces
        if piece.span[0] < end
    ]
    last = Piece((end, (now_s + 1, BEFORE)), names, names)
    return satisfied(staying([*known, last]), rebuilt(positive(formula), named))


def _denied(name: str) -> str:
    """The proposition that stands for another where that is denied."""
    return f"! {name}"


def _first(true: Callable[[int], bool], least: int, most: int) -> int:
    """The first number above ``least`` of which something is true that stays true; it is of ``most``."""
    while most - least > 1:
        middle = (least + most) // 2
        least, most = (least, middle) if true(middle) else (middle, most)
    return most


def _longest_s(formula: Formula) -> Fraction:
    """No bounded operator of a formula looks farther ahead, with all that is inside of it, and nothing ends later."""
    longest: dict[Formula, Fraction] = {}
    for node in postorder(formula):
        inside = max((longest[operand] for operand in node.operands), default=Fraction(0))
        ends = [time for time in node.bounds or () if node.operands or time < LONGEST_S]
        longest[node] = inside + max(ends, default=0)
    return longest[formula]
