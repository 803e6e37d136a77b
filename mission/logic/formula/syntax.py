"""Formulas of linear temporal logic, as immutable values.

Nodes are hash-consed: building the same formula twice gives the same object, so that equality is identity and a formula
is a directed acyclic graph that shares its common parts. Nothing here recurses, so depth is bounded by memory alone.
"""

import re
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from typing import Final, Self, final
from weakref import WeakValueDictionary

from mission.logic.formula.operators import BOUNDABLE, CHAINS, CONSTANTS, RESERVED, STRENGTH, UNARY, Operator

_PLAIN_NAME: Final = re.compile(r"[A-Za-z_][A-Za-z0-9_.]*")
_ANY_NAME: Final = re.compile(r'[^"\\\x00-\x1f\x7f]{1,200}')
_SPLIT_NAME: Final = re.compile(r"[FGX]+(?:[A-Za-z][0-9]*)?")

LONGEST_S: Final = 1_000_000
"""No bound is longer, s; a proposition that counts up to this time does so for ever."""

Bounds = tuple[Fraction, Fraction]
"""The shortest and the longest time to what an operator speaks of, both included, s; of a proposition, when it
counts."""

_ATOM_STRENGTH: Final = 7

_SMALLEST_S: Final = Fraction(1, 10**9)

_Key = tuple[Operator, "tuple[Formula, ...]", str, Bounds | None]
_NODES: WeakValueDictionary[_Key, "Formula"] = WeakValueDictionary()


@final
class Formula:
    """A node of a formula; the same arguments always give the same object.

    Attributes:
        operator: What the node is.
        operands: Its operands in the order of writing; two or more for conjunctions and disjunctions.
        name: The proposition's name; empty for every other operator.
        bounds: Of a temporal operator that speaks of time, between how many seconds from now. Of a proposition that is
            false at all other times, from when to when, by the clock that is 0 where all begins. None of all others.
        timed: Whether it or one of its operands has bounds: it is no formula of LTL, and no automaton is made of it.
        depth: Number of nodes on the longest way down to a leaf, itself included.
        eventuality: Whether the syntax shows that it holds already if it holds at some later position (``F a``).
        universality: Whether the syntax shows that it stays true once it is (``G a``).

    Raises:
        ValueError: The operands do not fit the operator, the name is none that can be written, or the bounds are none.
    """

    __slots__ = (
        *("__weakref__", "bounds", "depth", "eventuality", "name", "operands", "operator", "timed", "universality"),
    )

    operator: Operator
    operands: "tuple[Formula, ...]"
    name: str
    bounds: Bounds | None
    timed: bool
    depth: int
    eventuality: bool
    universality: bool

    def __new__(
        cls, operator: Operator, operands: "tuple[Formula, ...]" = (), name: str = "", bounds: Bounds | None = None
    ) -> Self:
        """Find the node of these arguments, or make it."""
        key = (operator, operands, name, bounds)
        known = _NODES.get(key)
        if known is not None:
            return known
        _check(operator, operands, name)
        _check_bounds(operator, bounds)
        node = super().__new__(cls)
        object.__setattr__(node, "operator", operator)
        object.__setattr__(node, "operands", operands)
        object.__setattr__(node, "name", name)
        object.__setattr__(node, "bounds", bounds)
        object.__setattr__(node, "timed", bounds is not None or any(operand.timed for operand in operands))
        object.__setattr__(node, "depth", 1 + max((operand.depth for operand in operands), default=0))
        object.__setattr__(node, "eventuality", bounds is None and _is_eventuality(operator, operands))
        object.__setattr__(node, "universality", bounds is None and _is_universality(operator, operands))
        return _NODES.setdefault(key, node)

    def __setattr__(self, attribute: str, value: object) -> None:
        raise AttributeError(f"a formula is immutable: {attribute} cannot be set")

    def __delattr__(self, attribute: str) -> None:
        raise AttributeError(f"a formula is immutable: {attribute} cannot be deleted")

    def __copy__(self) -> Self:
        return self

    def __deepcopy__(self, memo: object) -> Self:
        return self

    def __reduce__(self) -> tuple[type["Formula"], _Key]:
        return Formula, (self.operator, self.operands, self.name, self.bounds)

    def __str__(self) -> str:
        return _written(self)

    def __repr__(self) -> str:
        return f"Formula({_written(self)!r})"


def _check(operator: Operator, operands: tuple[Formula, ...], name: str) -> None:
    count = len(operands)
    if operator is Operator.PROPOSITION:
        fits = count == 0
        if not _ANY_NAME.fullmatch(name):
            raise ValueError(f"{name!r} cannot be the name of a proposition")
    elif name:
        raise ValueError("only a proposition has a name")
    elif operator in CONSTANTS:
        fits = count == 0
    elif operator in UNARY:
        fits = count == 1
    elif operator in CHAINS:
        fits = count >= 2 and all(operand.operator is not operator for operand in operands)  # noqa: PLR2004 - a pair
    else:
        fits = count == 2  # noqa: PLR2004 - a pair
    if not fits:
        raise ValueError(f"{count} operands do not fit the operator {operator.value}")


def _check_bounds(operator: Operator, bounds: Bounds | None) -> None:
    if bounds is None:
        return
    if operator not in BOUNDABLE and operator is not Operator.PROPOSITION:
        raise ValueError(f"the operator {operator.value} has no bounds in seconds")
    if not 0 <= bounds[0] <= bounds[1] <= LONGEST_S:
        raise ValueError(f"bounds are two times from 0 to {LONGEST_S} s, in ascending order")
    if any((bound / _SMALLEST_S).denominator != 1 for bound in bounds):
        raise ValueError("bounds have nine decimals at most")


def _is_eventuality(  # noqa: PLR0911 - one return for each rule
    operator: Operator, operands: tuple[Formula, ...]
) -> bool:
    if operator is Operator.PROPOSITION:
        return False
    if operator is Operator.NOT:
        return operands[0].universality
    if operator is Operator.IMPLIES:
        return operands[0].universality and operands[1].eventuality
    if operator is Operator.IFF:
        return all(operand.eventuality and operand.universality for operand in operands)
    if operator is Operator.EVENTUALLY:
        return True
    if operator is Operator.UNTIL:
        return operands[1].eventuality
    return all(operand.eventuality for operand in operands)


def _is_universality(  # noqa: PLR0911 - one return for each rule
    operator: Operator, operands: tuple[Formula, ...]
) -> bool:
    if operator is Operator.PROPOSITION:
        return False
    if operator is Operator.NOT:
        return operands[0].eventuality
    if operator is Operator.IMPLIES:
        return operands[0].eventuality and operands[1].universality
    if operator is Operator.IFF:
        return all(operand.eventuality and operand.universality for operand in operands)
    if operator is Operator.ALWAYS:
        return True
    if operator is Operator.RELEASE:
        return operands[1].universality
    return all(operand.universality for operand in operands)


TRUE: Final = Formula(Operator.TRUE)
FALSE: Final = Formula(Operator.FALSE)


def proposition(name: str, window: Bounds | None = None) -> Formula:
    """The proposition ``name``: any characters but quotes, backslashes and control characters, 200 at most.

    Args:
        name: The name.
        window: When it counts, by the clock that is 0 where all begins; at any time where there is none.
    """
    return Formula(Operator.PROPOSITION, (), name, window)


def negation(operand: Formula) -> Formula:
    """``!operand``."""
    return Formula(Operator.NOT, (operand,))


def _chain(operator: Operator, operands: tuple[Formula, ...], neutral: Formula) -> Formula:
    flat: list[Formula] = []
    for operand in operands:
        flat.extend(operand.operands if operand.operator is operator else (operand,))
    if not flat:
        return neutral
    return flat[0] if len(flat) == 1 else Formula(operator, tuple(flat))


def conjunction(*operands: Formula) -> Formula:
    """All of ``operands``, in this order; nested conjunctions are flattened, and none at all is ``true``."""
    return _chain(Operator.AND, operands, TRUE)


def disjunction(*operands: Formula) -> Formula:
    """Any of ``operands``, in this order; nested disjunctions are flattened, and none at all is ``false``."""
    return _chain(Operator.OR, operands, FALSE)


def implication(premise: Formula, conclusion: Formula) -> Formula:
    """``premise -> conclusion``."""
    return Formula(Operator.IMPLIES, (premise, conclusion))


def equivalence(left: Formula, right: Formula) -> Formula:
    """``left <-> right``."""
    return Formula(Operator.IFF, (left, right))


def following(operand: Formula) -> Formula:
    """``X operand``: at the next position."""
    return Formula(Operator.NEXT, (operand,))


def eventually(operand: Formula, bounds: Bounds | None = None) -> Formula:
    """``F operand``: now or later, within the bounds where there are some."""
    return Formula(Operator.EVENTUALLY, (operand,), "", bounds)


def always(operand: Formula, bounds: Bounds | None = None) -> Formula:
    """``G operand``: now and ever after, or all the time between the bounds."""
    return Formula(Operator.ALWAYS, (operand,), "", bounds)


def until(left: Formula, right: Formula, bounds: Bounds | None = None) -> Formula:
    """``left U right``: ``right`` comes, between the bounds if need be, and ``left`` holds until just before."""
    return Formula(Operator.UNTIL, (left, right), "", bounds)


def release(left: Formula, right: Formula) -> Formula:
    """``left R right``: ``right`` holds up to and including the first ``left``, or for ever."""
    return Formula(Operator.RELEASE, (left, right))


def weak_until(left: Formula, right: Formula) -> Formula:
    """``left W right``: as ``U``, or ``left`` holds for ever."""
    return Formula(Operator.WEAK_UNTIL, (left, right))


def strong_release(left: Formula, right: Formula) -> Formula:
    """``left M right``: as ``R``, and ``left`` does come."""
    return Formula(Operator.STRONG_RELEASE, (left, right))


def postorder(formula: Formula) -> tuple[Formula, ...]:
    """Every distinct node of ``formula``, operands before what is built from them, left before right."""
    order: dict[Formula, None] = {}
    pending: list[tuple[Formula, bool]] = [(formula, False)]
    while pending:
        node, expanded = pending.pop()
        if node in order:
            continue
        if expanded:
            order[node] = None
            continue
        pending.append((node, True))
        pending.extend((operand, False) for operand in reversed(node.operands) if operand not in order)
    return tuple(order)


def propositions(formula: Formula) -> frozenset[str]:
    """The names of the propositions that occur in ``formula``."""
    return frozenset(proposition_order(formula))


def proposition_order(formula: Formula) -> tuple[str, ...]:
    """The names of the propositions in ``formula``, each once, in the order of their first occurrence."""
    return tuple(node.name for node in postorder(formula) if node.operator is Operator.PROPOSITION)


def rebuilt(formula: Formula, build: Callable[[Formula, tuple[Formula, ...]], Formula]) -> Formula:
    """Replace each node, from the leaves up, by ``build(node, operands already replaced)``."""
    done: dict[Formula, Formula] = {}
    for node in postorder(formula):
        done[node] = build(node, tuple(done[operand] for operand in node.operands))
    return done[formula]


def written_name(name: str) -> str:
    """How a proposition is written: bare where that is read back as itself, in double quotes otherwise."""
    bare = _PLAIN_NAME.fullmatch(name) and name.lower() not in RESERVED and not _SPLIT_NAME.fullmatch(name)
    return name if bare else f'"{name}"'


def _written(formula: Formula) -> str:
    """The text of a formula, with no more parentheses than the syntax or a reader needs."""
    texts: dict[Formula, str] = {}
    for node in postorder(formula):
        operator = node.operator
        if operator is Operator.PROPOSITION:
            texts[node] = written_name(node.name) + _window_text(node.bounds)
        elif operator in CONSTANTS:
            texts[node] = operator.value
        elif operator in UNARY:
            (operand,) = node.operands
            inner = _enclosed(texts[operand], _strength(operand) < STRENGTH[operator])
            sign = operator.value + _bounds_text(node.bounds)
            texts[node] = sign + inner if operator is Operator.NOT else f"{sign} {inner}"
        else:
            # One level of operators without parentheses reads badly beyond `&` inside `|` inside `->`.
            strength = STRENGTH[operator]
            parts = (_enclosed(texts[operand], _strength(operand) <= strength) for operand in node.operands)
            texts[node] = f" {operator.value}{_bounds_text(node.bounds)} ".join(parts)
    return texts[formula]


def _window_text(window: Bounds | None) -> str:
    if window is None or window[1] < LONGEST_S:
        return _bounds_text(window)
    return f"[{seconds_text(window[0])},inf]"


def _bounds_text(bounds: Bounds | None) -> str:
    return "" if bounds is None else f"[{','.join(map(seconds_text, bounds))}]"


def seconds_text(seconds: Fraction) -> str:
    """A number of seconds, or of any decimal fraction of them, as it is written in bounds."""
    text = format(Decimal(seconds.numerator) / Decimal(seconds.denominator), "f")
    return text.rstrip("0").rstrip(".") if "." in text else text


def _strength(formula: Formula) -> int:
    return STRENGTH.get(formula.operator, _ATOM_STRENGTH)


def _enclosed(text: str, enclose: bool) -> str:  # noqa: FBT001 - whether, not which
    return f"({text})" if enclose else text
