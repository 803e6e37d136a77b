"""The text form of formulas, read.

Binding, from the loosest to the tightest, as in Spot: ``->`` and ``<->`` (to the right), ``|``, ``xor``, ``&``, the
binary ``U R W M`` (to the right), the prefix operators ``! X F G``. Other spellings of the same operators are read too
(see ``_SYMBOLS``), ``V`` as ``R``, and ``1`` and ``0`` as the constants.

A word is as long as it can be, and is read by the first of these rules that fits:

1. It stands in double quotes, or among the ``propositions`` that the caller knows: a proposition.
2. It stands where an operator must follow an operand: ``U``, ``R``, ``W``, ``M``, ``V`` or ``xor``. Where an operand is
   expected they are propositions like any other (``F R`` speaks of a region R, ``R R R`` of it twice).
3. It is made of the letters F, G and X alone: so many prefix operators (``GF a``).
4. Some letters F, G, X in front of a known proposition: prefix operators and the longest such proposition.
5. The same in front of one letter and its digits (``Fp0``, ``XFp1``, ``GFa``, ``FS1``): prefix operators too.
6. Else it is a proposition as it stands (``Field``, ``Gate``, ``F1``).
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from mission.errors import FormulaSyntaxError
from mission.logic.formula.syntax import (
    CHAINS,
    FALSE,
    RESERVED,
    STRENGTH,
    TRUE,
    UNARY,
    XOR_STRENGTH,
    Formula,
    Operator,
    conjunction,
    disjunction,
    equivalence,
    negation,
    proposition,
)

MAX_LENGTH: Final = 65_536
"""Characters that a formula may have."""

MAX_DEPTH: Final = 400
"""How deep operators may be nested; as many parentheses again may stand around them."""

_BINARY_WORDS: Final = {
    "U": Operator.UNTIL,
    "R": Operator.RELEASE,
    "V": Operator.RELEASE,
    "W": Operator.WEAK_UNTIL,
    "M": Operator.STRONG_RELEASE,
}
_PREFIX_WORDS: Final = {"F": Operator.EVENTUALLY, "G": Operator.ALWAYS, "X": Operator.NEXT}
_SYMBOLS: Final[dict[str, Operator]] = {
    "!": Operator.NOT,
    "~": Operator.NOT,
    "¬": Operator.NOT,
    "[]": Operator.ALWAYS,
    "□": Operator.ALWAYS,
    "<>": Operator.EVENTUALLY,
    "◇": Operator.EVENTUALLY,
    "○": Operator.NEXT,
    "&": Operator.AND,
    "&&": Operator.AND,
    "/\\": Operator.AND,
    "∧": Operator.AND,
    "|": Operator.OR,
    "||": Operator.OR,
    "\\/": Operator.OR,
    "∨": Operator.OR,
    "->": Operator.IMPLIES,
    "=>": Operator.IMPLIES,
    "→": Operator.IMPLIES,
    "<->": Operator.IFF,
    "<=>": Operator.IFF,
    "↔": Operator.IFF,
}
_TOKEN: Final = re.compile(
    r'(?P<space>[ \t\r\n]+)|(?P<word>[A-Za-z_][A-Za-z0-9_.]*)|(?P<number>[0-9][A-Za-z0-9_.]*)|"(?P<quoted>[^"\r\n]*)"|'
    r"(?P<symbol><->|<=>|->|=>|<>|\[\]|&&|\|\||/\\|\\/|[!~¬□◇○&∧|∨→↔^⊕()])"
)
_SHORT_OPERAND: Final = re.compile(r"([FGX]+)([A-Za-z][0-9]*)")
_EXPECTED_OPERAND: Final = "a proposition, true, false, ! F G X or ( is expected here"
_EXPECTED_OPERATOR: Final = "an operator such as & | -> U or the end is expected here"


@dataclass
class _Pending:
    """An operator or an open parenthesis that still waits for operands.

    ``operator`` is None for a parenthesis and for ``xor``; ``strength`` is 0 for a parenthesis, which nothing outbids.
    """

    operator: Operator | None
    strength: int
    column: int
    arity: int


def parse_formula(text: str, propositions: frozenset[str] | None = None) -> Formula:
    """Read a formula.

    Args:
        text: The formula in the common LTL syntax.
        propositions: The names that are known to be propositions, such as the regions of a mission. They come before
            every other reading of a word; names outside this set are not refused here.

    Raises:
        FormulaSyntaxError: The text is no formula, is longer than ``MAX_LENGTH`` or nested deeper than ``MAX_DEPTH``.
    """
    if len(text) > MAX_LENGTH:
        raise FormulaSyntaxError(
            f"the formula has {len(text)} characters, more than {MAX_LENGTH}", text=text[:80], column=MAX_LENGTH + 1
        )
    return _Parser(text, propositions or frozenset()).parse()


class _Parser:
    """Operator precedence parsing with explicit stacks: no recursion, so no depth of nesting can exhaust Python's."""

    def __init__(self, text: str, propositions: frozenset[str]) -> None:
        self._text = text
        self._known = propositions
        self._values: list[Formula] = []
        self._pending: list[_Pending] = []
        self._wants_operand = True

    def parse(self) -> Formula:
        position = 0
        readers = {"word": self._word, "quoted": self._quoted, "number": self._number, "symbol": self._symbol}
        while position < len(self._text):
            column = position + 1
            token = _TOKEN.match(self._text, position)
            if token is None:
                raise self._unreadable(column)
            position = token.end()
            kind = token.lastgroup
            if kind in readers:
                readers[kind](token.group(kind), column)
        end = len(self._text.rstrip()) + 1
        if self._wants_operand:
            if not self._pending:
                raise self._error("the formula is empty", end, "write a formula such as F a & G !b")
            raise self._lacking(self._pending[-1], end)
        while self._pending:
            if self._pending[-1].strength == 0:
                raise self._error("this parenthesis is never closed", self._pending[-1].column, "add a )")
            self._reduce()
        (formula,) = self._values
        return formula

    def _word(self, word: str, column: int) -> None:
        if not self._wants_operand:
            self._infix_word(word, column)
        elif word in self._known:
            self._operand(proposition(self._checked(word, column)), column)
        elif word in ("true", "false"):
            self._operand(TRUE if word == "true" else FALSE, column)
        elif word == "xor":
            raise self._error("xor has no left operand", column, _EXPECTED_OPERAND)
        else:
            prefix, rest = self._split(word)
            for offset, letter in enumerate(prefix):
                self._prefix(_PREFIX_WORDS[letter], column + offset)
            if rest:
                self._operand(proposition(self._checked(rest, column + len(prefix))), column)

    def _split(self, word: str) -> tuple[str, str]:
        """The prefix operators that a word begins with, and the proposition after them (rules 3 to 6)."""
        letters = len(word) - len(word.lstrip("FGX"))
        if letters == len(word):
            return word, ""
        for cut in range(1, letters + 1):
            if word[cut:] in self._known:
                return word[:cut], word[cut:]
        short = _SHORT_OPERAND.fullmatch(word)
        return (short.group(1), short.group(2)) if short else ("", word)

    def _infix_word(self, word: str, column: int) -> None:
        if word in _BINARY_WORDS:
            operator = _BINARY_WORDS[word]
            self._infix(operator, STRENGTH[operator], column)
        elif word == "xor":
            self._infix(None, XOR_STRENGTH, column)
        elif word[0] in _BINARY_WORDS and len(word) > 1:
            hint = f"{_EXPECTED_OPERATOR}; for the operator {word[0]} write {word[0]} {word[1:]}"
            raise self._error(f"no operator stands between an operand and {word}", column, hint)
        else:
            raise self._error(f"no operator stands between an operand and {word}", column, _EXPECTED_OPERATOR)

    def _quoted(self, name: str, column: int) -> None:
        if not self._wants_operand:
            raise self._error(f'no operator stands between an operand and "{name}"', column, _EXPECTED_OPERATOR)
        self._operand(proposition(self._checked(name, column)), column)

    def _number(self, digits: str, column: int) -> None:
        if digits not in ("0", "1"):
            hint = "0 and 1 are the constants false and true; a name begins with a letter"
            raise self._error(f"{digits} is neither a constant nor a name", column, hint)
        if not self._wants_operand:
            raise self._error(f"no operator stands between an operand and {digits}", column, _EXPECTED_OPERATOR)
        self._operand(TRUE if digits == "1" else FALSE, column)

    def _symbol(self, symbol: str, column: int) -> None:
        if symbol == "(":
            if not self._wants_operand:
                raise self._error("no operator stands between an operand and (", column, _EXPECTED_OPERATOR)
            self._push(_Pending(None, 0, column, 0))
        elif symbol == ")":
            self._close(column)
        elif symbol in ("^", "⊕"):
            self._infix(None, XOR_STRENGTH, column)
        elif _SYMBOLS[symbol] in UNARY:
            if not self._wants_operand:
                raise self._error(f"no operator stands between an operand and {symbol}", column, _EXPECTED_OPERATOR)
            self._prefix(_SYMBOLS[symbol], column)
        else:
            self._infix(_SYMBOLS[symbol], STRENGTH[_SYMBOLS[symbol]], column)

    def _close(self, column: int) -> None:
        if self._wants_operand:
            if not self._pending:
                raise self._error("the formula begins with )", column, _EXPECTED_OPERAND)
            raise self._lacking(self._pending[-1], column)
        while self._pending and self._pending[-1].strength:
            self._reduce()
        if not self._pending:
            raise self._error("this parenthesis closes nothing", column, "take it away, or add a (")
        self._pending.pop()

    def _operand(self, formula: Formula, column: int) -> None:
        if not self._wants_operand:
            raise self._error(f"no operator stands before {formula}", column, _EXPECTED_OPERATOR)
        self._values.append(formula)
        self._wants_operand = False

    def _prefix(self, operator: Operator, column: int) -> None:
        self._push(_Pending(operator, STRENGTH[operator], column, 1))

    def _infix(self, operator: Operator | None, strength: int, column: int) -> None:
        if self._wants_operand:
            name = operator.value if operator else "xor"
            raise self._error(f"{name} has no left operand", column, _EXPECTED_OPERAND)
        while self._pending and self._pending[-1].strength > strength:
            self._reduce()
        self._wants_operand = True
        top = self._pending[-1] if self._pending else None
        if top is not None and operator in CHAINS and top.operator is operator:
            top.arity += 1
            return
        if top is not None and operator is None and top.strength == strength:
            self._reduce()
        self._push(_Pending(operator, strength, column, 2))

    def _push(self, pending: _Pending) -> None:
        self._pending.append(pending)
        if len(self._pending) > 2 * MAX_DEPTH:
            raise self._too_deep(pending.column)

    def _reduce(self) -> None:
        pending = self._pending.pop()
        operands = tuple(self._values[-pending.arity :])
        del self._values[-pending.arity :]
        formula = _builder(pending.operator)(operands)
        if formula.depth > MAX_DEPTH:
            raise self._too_deep(pending.column)
        self._values.append(formula)

    def _checked(self, name: str, column: int) -> str:
        try:
            proposition(name)
        except ValueError as error:
            raise self._error(str(error), column, "use letters, digits, _ and . and 200 characters at most") from error
        return name

    def _unreadable(self, column: int) -> FormulaSyntaxError:
        character = self._text[column - 1]
        if character == '"':
            return self._error("this quote is never closed", column, 'add a "')
        hint = _EXPECTED_OPERAND if self._wants_operand else _EXPECTED_OPERATOR
        return self._error(f"the character {character!r} has no meaning in a formula", column, hint)

    def _too_deep(self, column: int) -> FormulaSyntaxError:
        hint = "use fewer parentheses and operators inside each other"
        return self._error(f"the formula is nested deeper than {MAX_DEPTH}", column, hint)

    def _lacking(self, pending: _Pending, column: int) -> FormulaSyntaxError:
        if pending.strength == 0:
            return self._error("the parenthesis is empty", column, _EXPECTED_OPERAND)
        name = pending.operator.value if pending.operator else "xor"
        hint = _EXPECTED_OPERAND
        if name in RESERVED:
            hint += f'; a proposition of the name {name} is written "{name}"'
        return self._error(f"{name} lacks its operand", column, hint)

    def _error(self, message: str, column: int, hint: str) -> FormulaSyntaxError:
        return FormulaSyntaxError(message, text=self._text, column=column, hint=hint)


def _builder(operator: Operator | None) -> Callable[[tuple[Formula, ...]], Formula]:
    if operator is None:
        return lambda operands: negation(equivalence(*operands))
    if operator is Operator.AND:
        return lambda operands: conjunction(*operands)
    if operator is Operator.OR:
        return lambda operands: disjunction(*operands)
    return lambda operands: Formula(operator, operands)
