"""The meaning of formulas on ultimately periodic words, straight from the definition of LTL.

This is what everything else is checked against, so it is kept plain and shares nothing with the translator: one pass
over the subformulas, and for each of them and each position of the word a look at the positions that follow.
"""

from dataclasses import dataclass

from mission.logic.formula.operators import Operator
from mission.logic.formula.syntax import Formula, postorder

Letter = frozenset[str]
"""The propositions that hold at one position; all others do not."""


@dataclass(frozen=True)
class LassoWord:
    """The infinite word ``prefix suffix suffix suffix ...``.

    Attributes:
        prefix: Letters read once; may be empty.
        suffix: Letters read for ever; at least one.

    Raises:
        ValueError: The suffix is empty.
    """

    prefix: tuple[Letter, ...]
    suffix: tuple[Letter, ...]

    def __post_init__(self) -> None:
        if not self.suffix:
            raise ValueError("the part of a lasso word that repeats has at least one letter")

    def future(self, position: int) -> tuple[int, ...]:
        """Every position of ``prefix + suffix`` that is met from ``position`` on, in the order of first meeting."""
        length = len(self.prefix) + len(self.suffix)
        return (*range(position, length), *range(len(self.prefix), position))


def satisfies(word: LassoWord, formula: Formula) -> bool:
    """Whether ``word`` satisfies ``formula`` at its first position."""
    letters = word.prefix + word.suffix
    positions = range(len(letters))
    futures = [word.future(position) for position in positions]
    truth: dict[Formula, list[bool]] = {}
    for node in postorder(formula):
        truth[node] = [_holds(node, letters, futures[position], truth) for position in positions]
    return truth[formula][0]


def _holds(  # noqa: C901, PLR0911 - one case for each line of the definition
    node: Formula, letters: tuple[Letter, ...], future: tuple[int, ...], truth: dict[Formula, list[bool]]
) -> bool:
    """Whether ``node`` holds at the first of the positions ``future``; ``truth`` knows its operands everywhere."""
    here = future[0]
    values = [truth[operand] for operand in node.operands]
    match node.operator:
        case Operator.TRUE | Operator.FALSE:
            return node.operator is Operator.TRUE
        case Operator.PROPOSITION:
            return node.name in letters[here]
        case Operator.NOT:
            return not values[0][here]
        case Operator.AND:
            return all(value[here] for value in values)
        case Operator.OR:
            return any(value[here] for value in values)
        case Operator.IMPLIES:
            return not values[0][here] or values[1][here]
        case Operator.IFF:
            return values[0][here] == values[1][here]
        case Operator.NEXT:
            return values[0][future[1] if len(future) > 1 else here]
        case Operator.EVENTUALLY:
            return any(values[0][later] for later in future)
        case Operator.ALWAYS:
            return all(values[0][later] for later in future)
    return _holds_between(node.operator, values[0], values[1], future)


def _holds_between(operator: Operator, left: list[bool], right: list[bool], future: tuple[int, ...]) -> bool:
    """The binary temporal operators; what has not happened in all of ``future`` never happens."""
    for later in future:
        if operator in (Operator.UNTIL, Operator.WEAK_UNTIL):
            if right[later]:
                return True
            if not left[later]:
                return False
        else:
            if not right[later]:
                return False
            if left[later]:
                return True
    return operator in (Operator.WEAK_UNTIL, Operator.RELEASE)
