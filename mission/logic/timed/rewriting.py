"""Formulas with bounds, rewritten: without negations inside, without seconds, and with all bounds changed."""

from fractions import Fraction
from typing import Final

from mission.logic.formula.operators import CHAINS, DUAL, Operator
from mission.logic.formula.syntax import (
    FALSE,
    LONGEST_S,
    TRUE,
    Bounds,
    Formula,
    always,
    conjunction,
    disjunction,
    eventually,
    negation,
    postorder,
    proposition,
    rebuilt,
)

_EXISTENTIAL: Final = frozenset({Operator.EVENTUALLY, Operator.UNTIL})


def positive(formula: Formula) -> Formula:
    """An equivalent formula with negations in front of propositions alone, and bounds on ``F``, ``G``, ``U``, ``R``."""
    found: dict[Formula, tuple[Formula, Formula]] = {}
    for node in postorder(formula):
        sides = [found[operand] for operand in node.operands]
        asserted, denied = tuple(side[0] for side in sides), tuple(side[1] for side in sides)
        match node.operator:
            case Operator.TRUE | Operator.FALSE:
                found[node] = (node, Formula(DUAL[node.operator]))
            case Operator.PROPOSITION:
                found[node] = (node, negation(node))
            case Operator.NOT:
                found[node] = (denied[0], asserted[0])
            case Operator.IMPLIES:
                found[node] = (disjunction(denied[0], asserted[1]), conjunction(asserted[0], denied[1]))
            case Operator.IFF:
                found[node] = (
                    disjunction(conjunction(*asserted), conjunction(*denied)),
                    disjunction(conjunction(asserted[0], denied[1]), conjunction(denied[0], asserted[1])),
                )
            case _:
                found[node] = (
                    _made(node.operator, asserted, node.bounds),
                    _made(DUAL[node.operator], denied, node.bounds),
                )
    return found[formula][0]


def _made(operator: Operator, operands: tuple[Formula, ...], bounds: Bounds | None) -> Formula:
    """An operator over operands; the weak until and the strong release with bounds by what they stand for."""
    if operator is Operator.AND:
        return conjunction(*operands)
    if operator is Operator.OR:
        return disjunction(*operands)
    if bounds is not None and operator in (Operator.WEAK_UNTIL, Operator.STRONG_RELEASE):
        until_then = Fraction(0), bounds[1]
        if operator is Operator.WEAK_UNTIL:
            return disjunction(Formula(Operator.UNTIL, operands, "", bounds), always(operands[0], until_then))
        return conjunction(Formula(Operator.RELEASE, operands, "", bounds), eventually(operands[0], until_then))
    return Formula(operator, operands, "", bounds)


def untimed(formula: Formula) -> Formula:
    """What of a formula can be said without seconds: a formula of LTL that holds wherever it does.

    What begins at once and lasts for a while says nothing of the word; nor does that something is not there by the
    clock, for it may be passed at another time.
    """
    return rebuilt(rebuilt(positive(formula), _weaker), _simpler)


def _weaker(node: Formula, operands: tuple[Formula, ...]) -> Formula:
    """A node without its bounds."""
    if node.operator is Operator.PROPOSITION:
        return proposition(node.name)
    if node.operator is Operator.NOT and node.operands[0].bounds is not None:
        return TRUE
    if not node.operands:
        return node
    if node.bounds is None or node.operator is Operator.UNTIL:
        return _made(node.operator, operands, None)
    if node.operator is Operator.EVENTUALLY:
        return eventually(operands[0])
    return eventually(disjunction(*operands)) if node.bounds[0] > 0 else TRUE


def _simpler(node: Formula, operands: tuple[Formula, ...]) -> Formula:
    """A node without the constants among its operands, as far as it has another meaning for them."""
    if not node.operands:
        return node
    operator, last = node.operator, operands[-1]
    if operator in CHAINS:
        neutral, other = (TRUE, FALSE) if operator is Operator.AND else (FALSE, TRUE)
        return other if other in operands else _made(operator, tuple(x for x in operands if x is not neutral), None)
    if operator in (Operator.NOT, Operator.NEXT) or last not in (TRUE, FALSE):
        return _made(operator, operands, None)
    if operator is Operator.STRONG_RELEASE and last is TRUE:
        return eventually(operands[0])
    if operator is Operator.WEAK_UNTIL and last is FALSE:
        return always(operands[0])
    return last  # `F true`, `a U true`, `a R true` and the like


def tightened(formula: Formula, by_s: Fraction) -> Formula:
    """A formula of ``positive`` with each bound harder to keep by so many seconds, or easier where they are below 0.

    What must come within bounds has that much less time, at both of their ends; what must last has to last that much
    longer. A bound of 0 at the beginning is none, and stays. Of a proposition that counts for a time only, that time is
    shorter where the proposition is to hold, and longer where it is not to.
    """

    def build(node: Formula, operands: tuple[Formula, ...]) -> Formula:
        if node.operator is Operator.NOT and node.operands[0].bounds is not None:
            window = _counting(node.operands[0].bounds, -by_s)
            return TRUE if window is None else negation(proposition(node.operands[0].name, window))
        if node.bounds is None:
            return _made(node.operator, operands, None) if node.operands else node
        if node.operator is Operator.PROPOSITION:
            window = _counting(node.bounds, by_s)
            return FALSE if window is None else proposition(node.name, window)
        comes = node.operator in _EXISTENTIAL
        bounds = _narrowed(node.bounds, by_s if comes else -by_s)
        if bounds is None:
            return FALSE if comes else TRUE
        return _made(node.operator, operands, bounds)

    return rebuilt(formula, build)


def _counting(window: Bounds, by_s: Fraction) -> Bounds | None:
    """When a proposition counts, for a shorter time; one without an end has none then either."""
    bounds = _narrowed(window, by_s)
    return (bounds[0], window[1]) if bounds and window[1] == LONGEST_S else bounds


def _narrowed(bounds: Bounds, by_s: Fraction) -> Bounds | None:
    """Bounds with less between them, where they do not begin at once; None where nothing is left."""
    least, most = bounds
    least = max(Fraction(0), least + by_s if least else least)
    most = min(Fraction(LONGEST_S), most - by_s)
    return None if least > most else (least, most)
