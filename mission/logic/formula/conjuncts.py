"""A formula as a conjunction: the parts that a word satisfies each of exactly where it satisfies the whole."""

from collections.abc import Callable
from functools import partial
from typing import Final

from mission.logic.formula.operators import Operator
from mission.logic.formula.syntax import (
    TRUE,
    Formula,
    always,
    eventually,
    following,
    implication,
    negation,
    release,
    until,
    weak_until,
)

_Frame = Callable[[Formula], Formula]

_AGAIN: Final[dict[tuple[Operator, bool], _Frame]] = {
    (Operator.ALWAYS, True): always,
    (Operator.EVENTUALLY, False): always,
    (Operator.NEXT, True): following,
    (Operator.NEXT, False): following,
}
"""The operators of one operand that distribute over its conjuncts, with whether they are asserted or denied."""

_LEFT: Final[dict[Operator, Callable[[Formula, Formula], Formula]]] = {
    Operator.UNTIL: until,
    Operator.WEAK_UNTIL: weak_until,
}
"""Those of two that distribute over the conjuncts of the left one."""

_RIGHT: Final[dict[Operator, Callable[[Formula, Formula], Formula]]] = {
    Operator.IMPLIES: implication,
    Operator.RELEASE: release,
}
"""Those that distribute over the conjuncts of the right one."""


def conjuncts(formula: Formula) -> tuple[Formula, ...]:
    """The conjuncts of a formula, each once, in the order of writing; a formula that is no conjunction is its own."""
    operands = formula.operands if formula.operator is Operator.AND else (formula,)
    return tuple(dict.fromkeys(operand for operand in operands if operand is not TRUE))


def separated(formula: Formula) -> tuple[Formula, ...]:
    """Small formulas whose conjunction is equivalent to ``formula``, each once; none where it is ``true``.

    Conjunctions are also found under the operators that distribute over them, such as ``G``, and as denied
    disjunctions.
    """
    found: dict[Formula, None] = {}
    pending: list[tuple[Formula, bool, tuple[_Frame, ...]]] = [(formula, True, ())]
    while pending:
        node, asserted, frames = pending.pop()
        inner = _inner(node, asserted)
        if inner is None:
            part = node if asserted else negation(node)
            for frame in reversed(frames):
                part = frame(part)
            found[part] = None
        else:
            pending += [(operand, sign, (*frames, *more)) for operand, sign, more in reversed(inner)]
    return tuple(part for part in found if part is not TRUE)


def _inner(  # noqa: PLR0911 - one return for each rule
    node: Formula,
    asserted: bool,  # noqa: FBT001 - a polarity
) -> list[tuple[Formula, bool, tuple[_Frame, ...]]] | None:
    """What a formula, or its negation, is the conjunction of: operands, asserted or denied, and what stands around."""
    operator, operands = node.operator, node.operands
    if operator is Operator.NOT:
        return [(operands[0], not asserted, ())]
    if operator is (Operator.AND if asserted else Operator.OR):
        return [(operand, asserted, ()) for operand in operands]
    if operator is Operator.IMPLIES and not asserted:
        return [(operands[0], True, ()), (operands[1], False, ())]
    if (operator, asserted) in _AGAIN:
        return [(operands[0], asserted, (_AGAIN[operator, asserted],))]
    if asserted and operator is Operator.EVENTUALLY and operands[0].operator is Operator.ALWAYS:
        return [(operands[0].operands[0], True, (eventually, always))]
    if asserted and operator in _LEFT:
        return [(operands[0], True, (lambda part: _LEFT[operator](part, operands[1]),))]
    if asserted and operator in _RIGHT:
        return [(operands[1], True, (partial(_RIGHT[operator], operands[0]),))]
    return None
