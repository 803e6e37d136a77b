"""Formulas made simpler before they are translated: negation normal form and rewriting.

The rules are those of Etessami and Holzmann, "Optimizing Büchi automata" (2000), of Somenzi and Bloem, "Efficient Büchi
automata from LTL formulae" (2000), and of Babiak et al., "LTL to Büchi automata translation: fast and more
deterministic" (2012). *Eventualities* and *universalities* are defined with the
nodes of formulas.
"""

from collections.abc import Callable
from typing import Final

from mission.logic.formula.implication import Implications
from mission.logic.formula.operators import CONSTANTS, DUAL, Operator
from mission.logic.formula.syntax import (
    FALSE,
    TRUE,
    Formula,
    always,
    conjunction,
    disjunction,
    eventually,
    following,
    negation,
    postorder,
    release,
    strong_release,
    until,
    weak_until,
)

_UNARY: Final = {Operator.AND: Operator.ALWAYS, Operator.OR: Operator.EVENTUALLY}


class Rewriter:
    """Rewrites formulas, and remembers what it found out about them."""

    def __init__(self) -> None:
        self.implies = Implications().implies
        self._negated: dict[Formula, Formula] = {}
        self._builders: dict[Operator, Callable[[Formula, Formula], Formula]] = {
            Operator.UNTIL: self.until,
            Operator.RELEASE: self.release,
            Operator.WEAK_UNTIL: self.weak_until,
            Operator.STRONG_RELEASE: self.strong_release,
        }

    def simplified(self, formula: Formula) -> Formula:
        """An equivalent formula in negation normal form, without ``->`` and ``<->``, and often shorter."""
        return self._normal(formula, positive=True)

    def negated(self, formula: Formula) -> Formula:
        """The negation of a formula that is in negation normal form, in the same form."""
        if formula not in self._negated:
            negative = self._normal(formula, positive=False)
            self._negated[formula] = negative
            self._negated.setdefault(negative, formula)
        return self._negated[formula]

    def _normal(self, formula: Formula, *, positive: bool) -> Formula:
        done: dict[tuple[Formula, bool], Formula] = {}
        pending = [(formula, positive, False)]
        while pending:
            node, sign, expanded = pending.pop()
            if (node, sign) in done:
                continue
            needs = _needed(node, sign)
            if not expanded:
                pending.append((node, sign, True))
                pending.extend((operand, wanted, False) for operand, wanted in needs)
                continue
            done[node, sign] = self._built(node, sign, [done[need] for need in needs])
        return done[formula, positive]

    def _built(self, node: Formula, sign: bool, parts: list[Formula]) -> Formula:  # noqa: FBT001 - a polarity
        operator = node.operator
        match operator:
            case Operator.PROPOSITION:
                return node if sign else negation(node)
            case Operator.NOT:
                return parts[0]
            case Operator.IMPLIES:
                return self.disjunction(parts) if sign else self.conjunction(parts)
            case Operator.IFF:
                # The parts are: the left operand positive and negative, the right one positive and negative.
                left, not_left, right, not_right = parts
                if not sign:
                    right, not_right = not_right, right
                return self.disjunction([self.conjunction([left, right]), self.conjunction([not_left, not_right])])
        return self.build(operator if sign else DUAL[operator], parts)

    def build(self, operator: Operator, parts: list[Formula]) -> Formula:  # noqa: PLR0911 - one return for each rule
        """``operator`` on operands that are simplified already."""
        match operator:
            case Operator.TRUE:
                return TRUE
            case Operator.FALSE:
                return FALSE
            case Operator.AND:
                return self.conjunction(parts)
            case Operator.OR:
                return self.disjunction(parts)
            case Operator.NEXT:
                return self.following(parts[0])
            case Operator.EVENTUALLY:
                return self.eventually(parts[0])
            case Operator.ALWAYS:
                return self.always(parts[0])
        return self._builders[operator](parts[0], parts[1])

    def following(self, operand: Formula) -> Formula:
        """``X operand``."""
        if operand.operator in CONSTANTS or is_suspendable(operand):
            return operand
        return following(operand)

    def eventually(self, operand: Formula) -> Formula:  # noqa: PLR0911 - one return for each rule
        """``F operand``."""
        match operand.operator:
            case Operator.NEXT:
                return self.following(self.eventually(operand.operands[0]))
            case Operator.UNTIL:
                return self.eventually(operand.operands[1])
            case Operator.STRONG_RELEASE:
                return self.eventually(self.conjunction(list(operand.operands)))
            case Operator.WEAK_UNTIL:
                left, right = operand.operands
                return self.disjunction([self.eventually(self.always(left)), self.eventually(right)])
            case Operator.AND:
                stays, rest = _parted(operand.operands, is_suspendable)
                if stays:
                    return self.conjunction([*stays, self.eventually(self.conjunction(rest))])
            case Operator.OR:
                # F (a | b & F a) is F a: whatever comes by a part comes by the others too.
                needed = self._needed_for(operand.operands)
                if len(needed) < len(operand.operands):
                    return self.eventually(self.disjunction(needed))
        if operand.operator in CONSTANTS or operand.eventuality:
            return operand
        return eventually(operand)

    def _needed_for(self, parts: tuple[Formula, ...]) -> list[Formula]:
        """Of the parts of a disjunction those of which none makes one of the others come."""
        kept = list(parts)
        for part in parts:
            others = [other for other in kept if other is not part]
            if any(self.implies(part, eventually(other)) for other in others):
                kept = others
        return kept

    def always(self, operand: Formula) -> Formula:  # noqa: PLR0911 - one return for each rule
        """``G operand``."""
        match operand.operator:
            case Operator.NEXT:
                return self.following(self.always(operand.operands[0]))
            case Operator.RELEASE:
                return self.always(operand.operands[1])
            case Operator.WEAK_UNTIL:
                return self.always(self.disjunction(list(operand.operands)))
            case Operator.STRONG_RELEASE:
                left, right = operand.operands
                return self.conjunction([self.always(self.eventually(left)), self.always(right)])
            case Operator.OR:
                stays, rest = _parted(operand.operands, is_suspendable)
                if stays:
                    return self.disjunction([*stays, self.always(self.disjunction(rest))])
        if operand.operator in CONSTANTS or operand.universality:
            return operand
        return always(operand)

    def until(self, left: Formula, right: Formula) -> Formula:  # noqa: PLR0911 - one return for each rule
        """``left U right``."""
        if right.operator in CONSTANTS or right.eventuality or self.implies(left, right):
            return right
        if self.implies(self.negated(left), right):
            return self.eventually(right)
        if right.operator is Operator.UNTIL and self.implies(left, right.operands[0]):
            return right
        if right.operator is Operator.WEAK_UNTIL and self.implies(left, right.operands[0]):
            return right
        if left.operator is Operator.NEXT and right.operator is Operator.NEXT:
            return self.following(self.until(left.operands[0], right.operands[0]))
        if left.operator in (Operator.UNTIL, Operator.WEAK_UNTIL) and left.operands[1] is right:
            return self.until(left.operands[0], right)
        if left.operator is Operator.OR:
            kept = [part for part in left.operands if not self.implies(part, right)]
            if len(kept) < len(left.operands):
                return self.until(self.disjunction(kept), right)
        return until(left, right)

    def release(self, left: Formula, right: Formula) -> Formula:  # noqa: PLR0911 - one return for each rule
        """``left R right``."""
        if right.operator in CONSTANTS or right.universality or self.implies(right, left):
            return right
        if self.implies(right, self.negated(left)):
            return self.always(right)
        if right.operator in (Operator.RELEASE, Operator.STRONG_RELEASE) and self.implies(right.operands[0], left):
            return right
        if left.operator is Operator.NEXT and right.operator is Operator.NEXT:
            return self.following(self.release(left.operands[0], right.operands[0]))
        if left.operator in (Operator.RELEASE, Operator.STRONG_RELEASE) and left.operands[1] is right:
            return self.release(left.operands[0], right)
        if left.operator is Operator.AND:
            kept = [part for part in left.operands if not self.implies(right, part)]
            if len(kept) < len(left.operands):
                return self.release(self.conjunction(kept), right)
        if right.operator is Operator.OR and left in right.operands:
            return self.weak_until(self.disjunction([part for part in right.operands if part is not left]), left)
        return release(left, right)

    def weak_until(self, left: Formula, right: Formula) -> Formula:  # noqa: PLR0911 - one return for each rule
        """``left W right``."""
        if left is TRUE or right is TRUE or self.implies(self.negated(left), right):
            return TRUE
        if self.implies(left, right):
            return right
        if right is FALSE:
            return self.always(left)
        if right.eventuality:
            return self.disjunction([self.always(left), right])
        if right.operator is Operator.WEAK_UNTIL and self.implies(left, right.operands[0]):
            return right
        if left.operator is Operator.NEXT and right.operator is Operator.NEXT:
            return self.following(self.weak_until(left.operands[0], right.operands[0]))
        if left.operator is Operator.WEAK_UNTIL and left.operands[1] is right:
            return self.weak_until(left.operands[0], right)
        if left.operator is Operator.OR:
            kept = [part for part in left.operands if not self.implies(part, right)]
            if len(kept) < len(left.operands):
                return self.weak_until(self.disjunction(kept), right)
        return weak_until(left, right)

    def strong_release(self, left: Formula, right: Formula) -> Formula:  # noqa: PLR0911 - one return for each rule
        """``left M right``."""
        if left is FALSE or right is FALSE or self.implies(right, self.negated(left)):
            return FALSE
        if self.implies(right, left):
            return right
        if right is TRUE:
            return self.eventually(left)
        if right.universality:
            return self.conjunction([self.eventually(left), right])
        if right.operator is Operator.STRONG_RELEASE and self.implies(right.operands[0], left):
            return right
        if left.operator is Operator.NEXT and right.operator is Operator.NEXT:
            return self.following(self.strong_release(left.operands[0], right.operands[0]))
        if left.operator is Operator.STRONG_RELEASE and left.operands[1] is right:
            return self.strong_release(left.operands[0], right)
        if left.operator is Operator.AND:
            kept = [part for part in left.operands if not self.implies(right, part)]
            if len(kept) < len(left.operands):
                return self.strong_release(self.conjunction(kept), right)
        return strong_release(left, right)

    def conjunction(self, parts: list[Formula]) -> Formula:
        """The conjunction of ``parts``."""
        return self._joined(Operator.AND, parts)

    def disjunction(self, parts: list[Formula]) -> Formula:
        """The disjunction of ``parts``."""
        return self._joined(Operator.OR, parts)

    def _joined(self, operator: Operator, parts: list[Formula]) -> Formula:
        conjoin = operator is Operator.AND
        neutral, absorbing = (TRUE, FALSE) if conjoin else (FALSE, TRUE)
        flat: dict[Formula, None] = {}
        for part in parts:
            flat.update(dict.fromkeys(part.operands if part.operator is operator else (part,)))
        flat.pop(neutral, None)
        if absorbing in flat:
            return absorbing
        merged = self._merged(operator, list(flat))
        if not conjoin:
            merged = self._awaited(merged)
        kept: list[Formula] = []
        for index, part in enumerate(merged):
            others = kept + merged[index + 1 :]
            if any(self._implies_in(operator, other, part) for other in others):
                continue
            kept.append(part)
        for index, part in enumerate(kept):
            opposite = self.negated(part)
            if any(self._implies_in(operator, other, opposite) for other in kept[index + 1 :]):
                return absorbing
        return conjunction(*kept) if conjoin else disjunction(*kept)

    def _implies_in(self, operator: Operator, left: Formula, right: Formula) -> bool:
        return self.implies(left, right) if operator is Operator.AND else self.implies(right, left)

    def _merged(self, operator: Operator, parts: list[Formula]) -> list[Formula]:
        """Join parts whose operators distribute over ``operator``: ``G a & G b`` is ``G (a & b)``."""
        groups: dict[tuple[Operator, Formula | None], list[Formula]] = {}
        for part in parts:
            groups.setdefault(_merge_key(operator, part), []).append(part)
        if all(len(group) == 1 or key[0] is Operator.TRUE for key, group in groups.items()):
            return parts
        result: list[Formula] = []
        for (kind, _), group in groups.items():
            if kind is Operator.TRUE or len(group) == 1:
                result.extend(group)
                continue
            joined = self._merge(operator, kind, group)
            result.extend(joined.operands if joined.operator is operator else (joined,))
        return list(dict.fromkeys(result))

    def _awaited(self, parts: list[Formula]) -> list[Formula]:
        """``F a | G F b`` as ``F (a | G F b)``: one thing to wait for, after which one of the parts is chosen."""
        lasting, rest = _parted(tuple(parts), lambda part: is_suspendable(part) and part.operator is Operator.ALWAYS)
        awaited = next((part for part in rest if part.operator is Operator.EVENTUALLY), None)
        if not lasting or awaited is None:
            return parts
        joined = self.eventually(self.disjunction([*awaited.operands, *lasting]))
        return [joined if part is awaited else part for part in rest]

    def _merge(self, operator: Operator, kind: Operator, group: list[Formula]) -> Formula:
        if kind is DUAL[_UNARY[operator]]:
            # F G a & F G b is F G (a & b), and G F a | G F b is G F (a | b).
            inner = self._joined(operator, [part.operands[0].operands[0] for part in group])
            return self.build(kind, [self.build(_UNARY[operator], [inner])])
        if len(group[0].operands) == 1:
            return self.build(kind, [self._joined(operator, [part.operands[0] for part in group])])
        kept = _shared_operand(operator, group[0].operator)
        other = self._joined(operator, [part.operands[1 - kept] for part in group])
        shared = group[0].operands[kept]
        return self.build(kind, [shared, other] if kept == 0 else [other, shared])


def _needed(node: Formula, sign: bool) -> list[tuple[Formula, bool]]:  # noqa: FBT001 - a polarity
    """The operands of a node with the polarities in which they are needed."""
    match node.operator:
        case Operator.NOT:
            return [(node.operands[0], not sign)]
        case Operator.IFF:
            return [(operand, wanted) for operand in node.operands for wanted in (True, False)]
        case Operator.IMPLIES:
            premise, conclusion = node.operands
            return [(premise, not sign), (conclusion, sign)]
    return [(operand, sign) for operand in node.operands]


def _parted(parts: tuple[Formula, ...], condition: Callable[[Formula], bool]) -> tuple[list[Formula], list[Formula]]:
    return [part for part in parts if condition(part)], [part for part in parts if not condition(part)]


def _shared_operand(operator: Operator, kind: Operator) -> int:
    """Which operand two formulas must share to be joined by ``operator``; the other operands are joined."""
    first = kind in (Operator.RELEASE, Operator.STRONG_RELEASE)
    return 0 if first is (operator is Operator.AND) else 1


def _merge_key(operator: Operator, part: Formula) -> tuple[Operator, Formula | None]:
    """Formulas of the same key can be joined; ``TRUE`` stands for those that cannot."""
    unary = _UNARY[operator]
    if part.operator in (unary, Operator.NEXT):
        return part.operator, None
    if part.operator is DUAL[unary] and part.operands[0].operator is unary:
        return part.operator, TRUE
    joins = {
        # a U c & b U c is (a & b) U c, and c U a | c U b is c U (a | b); R, M and W likewise.
        Operator.AND: (Operator.UNTIL, Operator.WEAK_UNTIL, Operator.RELEASE, Operator.STRONG_RELEASE),
        Operator.OR: (Operator.UNTIL, Operator.WEAK_UNTIL, Operator.RELEASE, Operator.STRONG_RELEASE),
    }
    if part.operator in joins[operator]:
        return part.operator, part.operands[_shared_operand(operator, part.operator)]
    return Operator.TRUE, None


def is_suspendable(formula: Formula) -> bool:
    """Whether the syntax shows that the formula holds at one position exactly if at all: ``G F a``, ``F G a``."""
    return formula.eventuality and formula.universality


def simplified(formula: Formula) -> Formula:
    """An equivalent formula in negation normal form, without ``->`` and ``<->``, and often shorter."""
    rewriter = Rewriter()
    result = rewriter.simplified(formula)
    for _ in range(3):
        again = rewriter.simplified(result)
        if again is result or len(postorder(again)) > len(postorder(result)):
            break
        result = again
    return result
