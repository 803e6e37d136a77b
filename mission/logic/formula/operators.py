"""The operators of formulas: how they are written, what each takes, and how tightly it binds.

Source of the operators: Pnueli, "The temporal logic of programs" (1977); ``W`` (weak until) and ``M`` (strong release)
as in Manna and Pnueli, "The Temporal Logic of Reactive and Concurrent Systems" (1992).
"""

from enum import StrEnum
from typing import Final

RESERVED: Final = frozenset(
    {
        *("true", "false", "not", "next", "always", "globally", "eventually", "finally"),
        *("and", "or", "xor", "implies", "iff", "until", "release", "releases"),
    }
)
"""Words that are a proposition in double quotes only, in capitals or not: they spell an operator or a constant."""


class Operator(StrEnum):
    """What a node is; the value is how it is written."""

    TRUE = "true"
    FALSE = "false"
    PROPOSITION = "proposition"
    NOT = "!"
    AND = "&"
    OR = "|"
    IMPLIES = "->"
    IFF = "<->"
    NEXT = "X"
    EVENTUALLY = "F"
    ALWAYS = "G"
    UNTIL = "U"
    RELEASE = "R"
    WEAK_UNTIL = "W"
    STRONG_RELEASE = "M"


CONSTANTS: Final = frozenset({Operator.TRUE, Operator.FALSE})
UNARY: Final = frozenset({Operator.NOT, Operator.NEXT, Operator.EVENTUALLY, Operator.ALWAYS})
CHAINS: Final = frozenset({Operator.AND, Operator.OR})
TEMPORAL: Final = frozenset(
    {
        Operator.NEXT,
        Operator.EVENTUALLY,
        Operator.ALWAYS,
        Operator.UNTIL,
        Operator.RELEASE,
        Operator.WEAK_UNTIL,
        Operator.STRONG_RELEASE,
    }
)

DUAL: Final = {
    Operator.TRUE: Operator.FALSE,
    Operator.FALSE: Operator.TRUE,
    Operator.AND: Operator.OR,
    Operator.OR: Operator.AND,
    Operator.NEXT: Operator.NEXT,
    Operator.EVENTUALLY: Operator.ALWAYS,
    Operator.ALWAYS: Operator.EVENTUALLY,
    Operator.UNTIL: Operator.RELEASE,
    Operator.RELEASE: Operator.UNTIL,
    Operator.WEAK_UNTIL: Operator.STRONG_RELEASE,
    Operator.STRONG_RELEASE: Operator.WEAK_UNTIL,
}
"""What an operator becomes where its operands and itself are denied."""

BOUNDABLE: Final = TEMPORAL - {Operator.NEXT}
"""Operators that may carry bounds in seconds: ``F[0,120] a``."""

# How tightly an operator binds; the same number on both sides of one that associates to the right. The order is the
# one of Spot's grammar, in which exclusive or, that no node stands for, comes between `|` and `&`.
XOR_STRENGTH: Final = 3
STRENGTH: Final = {
    Operator.IMPLIES: 1,
    Operator.IFF: 1,
    Operator.OR: 2,
    Operator.AND: 4,
    Operator.UNTIL: 5,
    Operator.RELEASE: 5,
    Operator.WEAK_UNTIL: 5,
    Operator.STRONG_RELEASE: 5,
    Operator.NOT: 6,
    Operator.NEXT: 6,
    Operator.EVENTUALLY: 6,
    Operator.ALWAYS: 6,
}
