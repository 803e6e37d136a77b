"""The text form of formulas, read.

Binding, from the loosest to the tightest, as in Spot: ``->`` and ``<->`` (to the right), ``|``, ``xor``, ``&``, the
binary ``U R W M`` (to the right), the prefix operators ``! X F G``. Other spellings of the same operators are read too
(``spellings``: signs, words, LaTeX), ``V`` as ``R``, and ``1`` and ``0`` as the constants. Where formulas may speak of
time, ``F G U R W M`` carry bounds in seconds: ``F[0,120] a``, ``a U[0,90] b``.

A word is as long as it can be, and is read by the first of these rules that fits:

1. It stands in double quotes, or where an operand is expected and among the ``propositions`` that the caller knows: a
   proposition.
2. It is a word of English that names an operator or a constant, in capitals or not (``not``, ``until``, ``always``), or
   stands where an operator must follow an operand: ``U``, ``R``, ``W``, ``M`` or ``V``. Where an operand is expected
   these letters are propositions like any other (``F R`` speaks of a region R, ``R R R`` of it twice).
3. It is made of the letters F, G and X alone: so many prefix operators (``GF a``).
4. Some letters F, G, X in front of a known proposition: prefix operators and the longest such proposition.
5. The same in front of one letter and its digits (``Fp0``, ``XFp1``, ``GFa``, ``FS1``): prefix operators too.
6. Else it is a proposition as it stands (``Field``, ``Gate``, ``F1``).
"""

import re
from dataclasses import dataclass
from fractions import Fraction
from typing import Final

from mission.errors import FormulaSyntaxError
from mission.logic.formula.conjuncts import conjuncts
from mission.logic.formula.operators import BOUNDABLE, CHAINS, STRENGTH, UNARY, XOR_STRENGTH, Operator
from mission.logic.formula.spellings import (
    COMMANDS,
    INFIX_LETTERS,
    KNOWN_OPERATORS,
    MISTAKEN,
    PREFIX_LETTERS,
    SIGNS,
    SPACES,
    WORDS,
    Meaning,
    Sign,
    folded,
    named,
)
from mission.logic.formula.syntax import (
    FALSE,
    LONGEST_S,
    TRUE,
    Bounds,
    Formula,
    conjunction,
    disjunction,
    equivalence,
    negation,
    postorder,
    proposition,
)

MAX_LENGTH: Final = 65_536
"""Characters that a formula may have."""

MAX_DEPTH: Final = 400
"""How deep operators may be nested; as many parentheses again may stand around them."""

_WORD: Final = "[A-Za-z_][A-Za-z0-9_.]*"
_STYLES: Final = r"\\(?:math(?:cal|bf|rm|sf|it|tt|bb|frak|scr|ord|bin|rel|op)|text(?:bf|rm|sf|it|tt)?|operatorname)"
_TOKEN: Final = re.compile(
    rf"(?P<space>[ \t\r\n\ufe0e\ufe0f]+|\\[ ,;:]|\\(?:{'|'.join(SPACES)})(?![A-Za-z]))|(?P<word>{_WORD})|"
    rf'(?P<number>[0-9][A-Za-z0-9_.]*)|"(?P<quoted>[^"\r\n]*)"|\[(?P<bounds>[^\[\]\r\n]+)\]|'
    rf"{_STYLES} *(?:\{{ *(?P<styled>{_WORD}) *\}}|(?<![A-Za-z])(?P<letter>[A-Za-z]))|\\(?P<command>[A-Za-z]+)|"
    rf"(?P<sign>{'|'.join(map(re.escape, sorted(SIGNS, key=len, reverse=True)))})"
)
_BOUNDS: Final = re.compile(r" *([+-]?)([0-9]{1,9}(?:\.[0-9]{1,9})?) *, *([+-]?)([0-9]{1,9}(?:\.[0-9]{1,9})?) *")
_BOUNDS_HINT: Final = f"two numbers of seconds from 0 to {LONGEST_S}, the smaller first: F[0,120] a"
_SHORT_OPERAND: Final = re.compile(r"([FGX]+)([A-Za-z][0-9]*)")
_BINARY_STRENGTH: Final[dict[Meaning, int]] = {
    Sign.XOR: XOR_STRENGTH,
    **{operator: strength for operator, strength in STRENGTH.items() if operator not in UNARY},
}
_EXPECTED_OPERAND: Final = "a proposition, true, false, ! F G X or ( is expected here"
_EXPECTED_OPERATOR: Final = "an operator such as & | -> U or the end is expected here"


@dataclass
class _Pending:
    """An operator or an open parenthesis that still waits for operands.

    ``strength`` is 0 for a parenthesis, which nothing outbids; ``spelling`` is what the text says.
    """

    meaning: Meaning
    strength: int
    spelling: str
    column: int
    arity: int
    bounds: Bounds | None = None


def parse_formula(text: str, propositions: frozenset[str] | None = None) -> Formula:
    """Read a formula.

    Args:
        text: The formula in the common LTL syntax.
        propositions: The names that are known to be propositions, such as the regions of a mission. They come before
            every other reading of a word; names outside this set are not refused here.

    Raises:
        FormulaSyntaxError: The text is no formula, is longer than ``MAX_LENGTH`` or nested deeper than ``MAX_DEPTH``,
            or has bounds in seconds.
    """
    formula, column = _parsed(text, propositions)
    if formula.timed:
        hint = "take the bounds away; `mission plan` reads them in the formula of a mission"
        raise FormulaSyntaxError("seconds have no meaning here", text=text, column=column, hint=hint)
    return formula


def parse_timed_formula(text: str, propositions: frozenset[str] | None = None) -> Formula:
    """The same of a formula that may have bounds in seconds.

    Raises:
        FormulaSyntaxError: As there, or a conjunct has bounds and ``X``, which counts triangles and not seconds, too.
    """
    formula, column = _parsed(text, propositions)
    for part in conjuncts(formula):
        if part.timed and any(node.operator is Operator.NEXT for node in postorder(part)):
            hint = "say it without X, or in a conjunct of its own"
            message = "X counts triangles and bounds count seconds: they do not stand in one conjunct"
            raise FormulaSyntaxError(message, text=text, column=column, hint=hint)
    return formula


def _parsed(text: str, propositions: frozenset[str] | None) -> tuple[Formula, int]:
    """A formula, and the column of its last bounds; 0 without any."""
    if len(text) > MAX_LENGTH:
        raise FormulaSyntaxError(
            f"the formula has {len(text)} characters, more than {MAX_LENGTH}", text=text[:80], column=MAX_LENGTH + 1
        )
    parser = _Parser(text, propositions or frozenset())
    return parser.parse(), parser.bounds_column


class _Parser:
    """Operator precedence parsing with explicit stacks: no recursion, so no depth of nesting can exhaust Python's."""

    def __init__(self, text: str, propositions: frozenset[str]) -> None:
        self._text = text
        self._known = propositions
        self._values: list[Formula] = []
        self._pending: list[_Pending] = []
        self._wants_operand = True
        self.bounds_column = 0

    def parse(self) -> Formula:
        position = 0
        text = folded(self._text)
        readers = {
            "word": self._word,
            "styled": self._word,
            "letter": self._word,
            "quoted": self._quoted,
            "number": self._number,
            "command": self._command,
            "bounds": self._bounds,
            "sign": self._sign,
        }
        while position < len(text):
            token = _TOKEN.match(text, position)
            if token is None:
                raise self._unreadable(position + 1)
            kind = str(token.lastgroup)
            if kind in readers:
                # A name in quotes is taken as it stands.
                source = self._text if kind == "quoted" else text
                readers[kind](source[slice(*token.span(kind))], position + 1)
            position = token.end()
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
        if self._wants_operand and word in self._known:
            self._operand(proposition(self._checked(word, column)))
            return
        meaning = WORDS.get(word.lower()) or (None if self._wants_operand else INFIX_LETTERS.get(word))
        if meaning is not None:
            self._meant(meaning, word, column)
        elif not self._wants_operand:
            hint = _EXPECTED_OPERATOR
            if word[0] in INFIX_LETTERS:
                hint += f"; for the operator {word[0]} write {word[0]} {word[1:]}"
            raise self._error(f"no operator stands between an operand and {word}", column, hint)
        else:
            prefix, rest = self._split(word)
            for offset, letter in enumerate(prefix):
                self._meant(PREFIX_LETTERS[letter], letter, column + offset)
            if rest:
                self._operand(proposition(self._checked(rest, column + len(prefix))))

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

    def _quoted(self, name: str, column: int) -> None:
        if not self._wants_operand:
            raise self._error(f'no operator stands between an operand and "{name}"', column, _EXPECTED_OPERATOR)
        self._operand(proposition(self._checked(name, column)))

    def _number(self, digits: str, column: int) -> None:
        if digits not in ("0", "1"):
            hint = "0 and 1 are the constants false and true; a name begins with a letter"
            raise self._error(f"{digits} is neither a constant nor a name", column, hint)
        if not self._wants_operand:
            raise self._error(f"no operator stands between an operand and {digits}", column, _EXPECTED_OPERATOR)
        self._operand(TRUE if digits == "1" else FALSE)

    def _bounds(self, inside: str, column: int) -> None:
        """The bounds of the operator that was just read."""
        written, self.bounds_column = f"[{inside}]", column
        top = self._pending[-1] if self._wants_operand and self._pending else None
        if top is None or top.meaning not in BOUNDABLE or top.bounds is not None:
            hint = "bounds follow F, G, U, R, W or M: F[0,120] a; groups are written in parentheses"
            raise self._error(f"{written:.40} follows no operator that has bounds", column, hint)
        read = _BOUNDS.fullmatch(inside)
        if read is None:
            raise self._error(f"{written:.40} are no bounds", column, _BOUNDS_HINT)
        if "-" in read.group(1, 3):
            raise self._error(f"{written:.40} begin in the past", column, _BOUNDS_HINT)
        least, most = Fraction(read.group(2)), Fraction(read.group(4))
        if least > most:
            raise self._error(f"{written:.40} end before they begin", column, _BOUNDS_HINT)
        if most > LONGEST_S:
            raise self._error(f"{written:.40} are longer than {LONGEST_S} s", column, _BOUNDS_HINT)
        top.bounds = least, most

    def _sign(self, sign: str, column: int) -> None:
        self._meant(SIGNS[sign], sign, column)

    def _command(self, command: str, column: int) -> None:
        if command not in COMMANDS:
            hint = f"the operators are {KNOWN_OPERATORS}; a region stands by its name alone"
            raise self._error(f"the command \\{command} has no meaning in a formula", column, hint)
        self._meant(COMMANDS[command], f"\\{command}", column)

    def _meant(self, meaning: Meaning, spelling: str, column: int) -> None:
        """Take what a spelling means in."""
        if meaning is Sign.CLOSE:
            self._close(column)
        elif meaning in _BINARY_STRENGTH:
            self._infix(meaning, spelling, column)
        elif not self._wants_operand:
            raise self._error(f"no operator stands between an operand and {spelling}", column, _EXPECTED_OPERATOR)
        elif meaning is Sign.OPEN:
            self._push(_Pending(meaning, 0, spelling, column, 0))
        elif meaning is Operator.TRUE or meaning is Operator.FALSE:
            self._operand(Formula(meaning))
        else:
            self._push(_Pending(meaning, STRENGTH[Operator(meaning)], spelling, column, 1))

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

    def _operand(self, formula: Formula) -> None:
        self._values.append(formula)
        self._wants_operand = False

    def _infix(self, meaning: Meaning, spelling: str, column: int) -> None:
        if self._wants_operand:
            raise self._error(f"{spelling} has no left operand", column, _EXPECTED_OPERAND + _quoting(spelling))
        strength = _BINARY_STRENGTH[meaning]
        while self._pending and self._pending[-1].strength > strength:
            self._reduce()
        self._wants_operand = True
        top = self._pending[-1] if self._pending else None
        if top is not None and meaning in CHAINS and top.meaning is meaning:
            top.arity += 1
            return
        if top is not None and meaning is Sign.XOR and top.strength == strength:
            self._reduce()
        self._push(_Pending(meaning, strength, spelling, column, 2))

    def _push(self, pending: _Pending) -> None:
        self._pending.append(pending)
        if len(self._pending) > 2 * MAX_DEPTH:
            raise self._too_deep(pending.column)

    def _reduce(self) -> None:
        pending = self._pending.pop()
        operands = tuple(self._values[-pending.arity :])
        del self._values[-pending.arity :]
        formula = _built(pending.meaning, operands, pending.bounds)
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
        expected = _EXPECTED_OPERAND if self._wants_operand else _EXPECTED_OPERATOR
        hint = MISTAKEN.get(folded(character), expected)
        return self._error(f"the character {named(character)} has no meaning in a formula", column, hint)

    def _too_deep(self, column: int) -> FormulaSyntaxError:
        hint = "use fewer parentheses and operators inside each other"
        return self._error(f"the formula is nested deeper than {MAX_DEPTH}", column, hint)

    def _lacking(self, pending: _Pending, column: int) -> FormulaSyntaxError:
        if pending.strength == 0:
            return self._error("the parenthesis is empty", column, _EXPECTED_OPERAND)
        hint = _EXPECTED_OPERAND + _quoting(pending.spelling)
        return self._error(f"{pending.spelling} lacks its operand", column, hint)

    def _error(self, message: str, column: int, hint: str) -> FormulaSyntaxError:
        return FormulaSyntaxError(message, text=self._text, column=column, hint=hint)


def _quoting(spelling: str) -> str:
    """How a proposition is written that is called like an operator; empty for a spelling that can be no name."""
    is_name = spelling in PREFIX_LETTERS or spelling.lower() in WORDS
    return f'; a proposition of the name {spelling} is written "{spelling}"' if is_name else ""


def _built(meaning: Meaning, operands: tuple[Formula, ...], bounds: Bounds | None) -> Formula:
    if meaning is Sign.XOR:
        return negation(equivalence(*operands))
    if meaning is Operator.AND:
        return conjunction(*operands)
    if meaning is Operator.OR:
        return disjunction(*operands)
    return Formula(Operator(meaning), operands, "", bounds)
