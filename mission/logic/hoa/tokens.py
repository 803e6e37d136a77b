"""The tokens of the Hanoi Omega-Automata format, versions 1 and 1.1, with their places."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from mission.errors import Fault, SpecError

MAX_LENGTH: Final = 4_000_000
"""Characters that a file may have."""

_TOKEN: Final = re.compile(
    r"(?P<space>[ \t\r\n]+)|(?P<comment>/\*)|(?P<mark>--(?:BODY|END|ABORT)--)|(?P<header>[A-Za-z_][A-Za-z0-9_.-]*:)|"
    r"(?P<identifier>[A-Za-z_][A-Za-z0-9_.-]*)|(?P<alias>@[A-Za-z0-9_.-]+)|(?P<integer>0(?![0-9])|[1-9][0-9]*)|"
    r'(?P<string>"(?:\\.|[^\\"])*")|(?P<symbol>[\[\]{}()&|!])',
    re.DOTALL,
)
_BYTE_ORDER_MARK: Final = "\ufeff"
_COMMENT_PART: Final = re.compile(r"/\*|\*/")
_MAX_DIGITS: Final = 9


@dataclass(frozen=True)
class Token:
    """A token; ``kind`` is one of mark, header, identifier, alias, integer, string, symbol and end.

    ``text`` is without the quotes and escapes of a string and without the colon of a header.
    """

    kind: str
    text: str
    line: int
    column: int

    @property
    def shown(self) -> str:
        """The token as an error message names it."""
        return "the end of the file" if self.kind == "end" else repr(self.text)


def refusal(message: str, token: Token, hint: str = "") -> SpecError:
    """The error of a file that cannot be read from ``token`` on."""
    return SpecError((Fault(token.line, token.column, "automaton", message, hint),))


def tokens(text: str) -> Iterator[Token]:
    """Every token of a file, and one of kind ``end`` that never stops coming.

    Raises:
        SpecError: A character belongs to no token, a comment is not closed, or the file is too long or aborted.
    """
    start = int(text.startswith(_BYTE_ORDER_MARK))
    line, line_start, position = 1, start, start
    if len(text) > MAX_LENGTH:
        raise refusal(f"the automaton has more than {MAX_LENGTH} characters", Token("end", "", 1, 1))
    while position < len(text):
        place = (line, position - line_start + 1)
        match = _TOKEN.match(text, position)
        if match is None:
            raise refusal(f"{text[position]!r} has no meaning here", Token("symbol", text[position], *place))
        kind = match.lastgroup or ""
        end = match.end()
        if kind == "comment":
            end = _comment_end(text, position, Token("comment", "/*", *place))
        elif match.group() == "--ABORT--":
            raise refusal("the automaton was aborted by the tool that wrote it", Token(kind, match.group(), *place))
        elif kind != "space":
            yield _token(kind, match.group(), *place)
        newlines = text.count("\n", position, end)
        if newlines:
            line, line_start = line + newlines, text.rindex("\n", position, end) + 1
        position = end
    while True:
        yield Token("end", "", line, position - line_start + 1)


def _token(kind: str, text: str, line: int, column: int) -> Token:
    if kind == "string":
        text = re.sub(r"\\(.)", r"\1", text[1:-1], flags=re.DOTALL)
    elif kind == "header":
        text = text[:-1]
    elif kind == "integer" and len(text) > _MAX_DIGITS:
        raise refusal("this number is too large", Token(kind, text, line, column))
    return Token(kind, text, line, column)


def _comment_end(text: str, start: int, token: Token) -> int:
    depth = 0
    for part in _COMMENT_PART.finditer(text, start):
        depth += 1 if part.group() == "/*" else -1
        if depth == 0:
            return part.end()
    raise refusal("this comment is never closed", token, "add */")
