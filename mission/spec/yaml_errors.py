"""What a YAML parser finds wrong, in words for the writer of a mission file."""

import re
from typing import Final, NoReturn

import yaml

from mission.errors import Fault, SpecError

LINE_BREAK: Final = re.compile("\r\n|[\n\r\x85\u2028\u2029]")


def stop(line: int, column: int, message: str, hint: str, path: str = "") -> NoReturn:
    """Raise the one fault with which a text stops being readable."""
    raise SpecError((Fault(line, column, path, message, hint),)) from None


TEXT_KEYS: Final = ("formula", "automaton", "name", "description")
"""Keys whose value is a text."""

_BEGINS_WITH_SIGN: Final = re.compile(
    rf"""(?P<flow>.*[{{,])?[ ]*["']?(?P<key>{"|".join(TEXT_KEYS)})["']?[ ]*:[ ]+(?P<sign>[]\[{{}}!&*%@`|>,?"'-])"""
)


def refuse_reserved_sign(text: str, line: int, column: int) -> None:
    """Say so where YAML stops in a text, or at it, because of the sign that it begins with."""
    lines = LINE_BREAK.split(text)
    found = _BEGINS_WITH_SIGN.match(lines[line - 1][:column]) if line <= len(lines) else None
    # After a text in quotes, in braces, a comma is what is most likely missing.
    if found and not (found["flow"] and found["sign"] in _QUOTES):
        stop_at_sign(line, found.end(), found["key"], found["sign"])


def stop_at_sign(line: int, column: int, key: str, sign: str, path: str = "") -> NoReturn:
    """Refuse a text that YAML does not read whole because of the sign that it begins with."""
    message = f"the text of `{key}` begins with `{sign}`, which YAML keeps for itself"
    block = f"write it as a block: {key}: |, and below it, indented, the text"
    hint = block if sign in _QUOTES else f"put it in single quotes, {key}: '{sign}...', or {block}"
    stop(line, column, message, hint, path)


_QUOTES: Final = ("'", '"')
_INDENTATION: Final = ("the indentation fits nothing above it", "indent all keys of a mapping alike", False)
_WORDINGS: Final = (
    ("'\\t'", "a tab stands where YAML wants spaces", "indent with spaces only", False),
    (
        "mapping values are not allowed",
        "a second `:` on one line",
        "put the value in quotes, or the key on its line",
        False,
    ),
    ("could not find expected ':'", "a key without `:`", "write `key: value`", True),
    (
        "expected ',' or",
        "a list or mapping in brackets is not closed",
        "close it with ] or }; commas between items",
        True,
    ),
    ("expected <block end>", *_INDENTATION),
    ("expected key", *_INDENTATION),
    ("expected '-' indicator", *_INDENTATION),
    (
        "unknown escape character",
        "in double quotes a backslash begins an escape",
        "put the text in single quotes, or write it as a block: the key and |, the text on the next line, indented",
        False,
    ),
    ("quoted scalar", "a quote is never closed", "close it with the same quote as it begins", True),
)
"""What the YAML parser says, what that means to the writer of a mission file, what to do, and whether the place to
look at is where the faulty thing begins or where the parser noticed."""


def worded(error: yaml.MarkedYAMLError, text: str) -> tuple[str, str, bool]:
    """Message, hint and whether to point at the begin, for what the YAML parser says."""
    problem = error.problem or str(error)
    said = f"{error.context or ''} {problem}"
    if error.problem_mark and "found character that" in said:  # which one, the C parser leaves out
        said += repr(text[error.problem_mark.index : error.problem_mark.index + 1])
    for part, message, hint, at_begin in _WORDINGS:
        if part in said:
            return message, hint, at_begin and error.context_mark is not None
    return f"YAML syntax: {problem}", "put text with special characters in quotes, and see the lines above, too", False
