"""What is left of a formula once a beginning of a word has been read.

Of a letter a and a formula f, what is left, f/a, is satisfied by exactly the words v of which a.v satisfies f. Source:
Bacchus and Kabanza, "Planning for temporally extended goals" (1998), Sec. 4, whose rules are the expansion laws of LTL
without their ``X``; they are applied to negation normal form, so that what is left is in that form again.
"""

from collections.abc import Iterable
from functools import reduce
from itertools import groupby
from typing import Final

from mission.errors import AutomatonSizeError
from mission.logic.formula.operators import Operator
from mission.logic.formula.rewriting import Rewriter
from mission.logic.formula.syntax import FALSE, TRUE, Formula, postorder, propositions
from mission.logic.formula.word import Letter

MOST_NODES: Final = 2_000
"""Distinct nodes that what is left of a formula may have."""


def left_of(formula: Formula, word: Iterable[Letter]) -> Formula:
    """What the rest of a word must satisfy, so that all of it satisfies a formula.

    Args:
        formula: Of the whole word.
        word: How it begins.

    Returns:
        An equivalent of what is left, in negation normal form; ``false`` shows that nothing goes on from there well,
        but not everything that cannot be satisfied is rewritten to it.

    Raises:
        AutomatonSizeError: What is left has more than ``MOST_NODES`` nodes.
    """
    return reduce(_Progression().after, _told_apart(formula, word), formula)


def counts_letters(formula: Formula) -> bool:
    """Whether a formula may tell how often a letter is repeated, by its syntax: whether it has ``X``."""
    return any(node.operator is Operator.NEXT for node in postorder(formula))


def _told_apart(formula: Formula, word: Iterable[Letter]) -> Iterable[Letter]:
    """The letters as far as the formula tells them apart, each once where repeats do not matter."""
    names = propositions(formula)
    letters = (letter & names for letter in word)
    return letters if counts_letters(formula) else (letter for letter, _ in groupby(letters))


class _Progression:
    """Progresses formulas letter by letter, and remembers the steps: words of laps take the same ones over and over."""

    def __init__(self) -> None:
        self._rewriter = Rewriter()
        self._normal: dict[Formula, Formula] = {}
        self._steps: dict[tuple[Formula, Letter], Formula] = {}

    def after(self, formula: Formula, letter: Letter) -> Formula:
        key = (formula, letter)
        if key not in self._steps:
            left = self._simple(self._step(self._simple(formula), letter))
            if len(postorder(left)) > MOST_NODES:
                raise AutomatonSizeError(f"what is left of the formula has more than {MOST_NODES} parts")
            self._steps[key] = left
        return self._steps[key]

    def _simple(self, formula: Formula) -> Formula:
        if formula not in self._normal:
            simple = self._rewriter.simplified(formula)
            self._normal[formula] = self._normal[simple] = simple
        return self._normal[formula]

    def _step(self, formula: Formula, letter: Letter) -> Formula:
        left: dict[Formula, Formula] = {}
        for node in postorder(formula):
            left[node] = self._left(node, [left[operand] for operand in node.operands], letter)
        return left[formula]

    def _left(  # noqa: PLR0911 - one return for each rule
        self, node: Formula, parts: list[Formula], letter: Letter
    ) -> Formula:
        """What is left of a node, given what is left of its operands."""
        both, either = self._rewriter.conjunction, self._rewriter.disjunction
        match node.operator:
            case Operator.PROPOSITION:
                return TRUE if node.name in letter else FALSE
            case Operator.NOT:  # of a proposition
                return FALSE if parts[0] is TRUE else TRUE
            case Operator.NEXT:
                return node.operands[0]
            case Operator.EVENTUALLY:
                return either([parts[0], node])
            case Operator.ALWAYS:
                return both([parts[0], node])
            case Operator.UNTIL | Operator.WEAK_UNTIL:
                return either([parts[1], both([parts[0], node])])
            case Operator.RELEASE | Operator.STRONG_RELEASE:
                return both([parts[1], either([parts[0], node])])
        return self._rewriter.build(node.operator, parts)  # true, false, & and |
