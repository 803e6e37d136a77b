"""Long lists of pairs of numbers, taken out of a YAML text before it is parsed.

Of a map of 100,000 triangles nearly all the text is such a list, and an event for each number costs more than all the
rest. A list in brackets, or of lines with dashes, is replaced by a short text in quotes and by as much space as it
took, so that everything else keeps its place. Where that text does not come back as the one value that it stands for
(a list in a comment or in a text, say), ``TableError`` is raised and the whole is parsed as it stands.
"""

import json
import re
from dataclasses import dataclass
from typing import Final

from mission.spec.nodes import NUMBER

MARK: Final = "\ue000"
"""Begins the text that stands for a table; a private character, that no file with tables taken out has."""

_MARKED: Final = re.compile(rf"{MARK}|\\[uU]0*e000", re.IGNORECASE)
_LEAST_ROWS: Final = 64
_SPACE: Final = r"(?:[ \n]|\r\n)*+"
_PAIR: Final = rf"\[{_SPACE}{NUMBER}{_SPACE},{_SPACE}{NUMBER}{_SPACE}\]"
_LINE: Final = rf"\[ *+{NUMBER} *+, *+{NUMBER} *+\]"
_TABLE: Final = re.compile(
    rf"(?P<brackets>\[{_SPACE}(?:{_PAIR}{_SPACE},{_SPACE}){{{_LEAST_ROWS - 1},}}+{_PAIR}{_SPACE}\])|"
    rf"^(?P<indent> *+)- (?P<dashes>{_LINE}(?: *+\r?\n(?P=indent)- {_LINE}){{{_LEAST_ROWS - 1},}}+)(?= *+\r?$)",
    re.MULTILINE,
)
_DASH: Final = re.compile(r" *\r?\n *- ")


class TableError(Exception):
    """A table that was taken out does not come back as a value."""


@dataclass(frozen=True)
class TakenOut:
    """A table as text: ``dashes`` where it is one of lines that begin with a dash, of which the first remains."""

    text: str
    dashes: bool

    def rows(self) -> list[list[float]]:
        """Its values."""
        flow = f"[{_DASH.sub(',', self.text)}]" if self.dashes else self.text
        rows: list[list[float]] = json.loads(flow)
        return rows


def without_tables(text: str) -> tuple[str, dict[str, TakenOut]]:
    """A text with its tables replaced, and what was replaced, by the text that stands for it."""
    taken: dict[str, TakenOut] = {}
    if _MARKED.search(text):
        return text, taken

    def replaced(found: re.Match[str]) -> str:
        kind = str(found.lastgroup)
        table = found[kind]
        name = f"{MARK}{len(taken)}"
        taken[name] = TakenOut(table, kind == "dashes")
        breaks = table.count("\n")
        last = len(table) - table.rfind("\n") - 1
        short = f'"{name}"' + "\n" * breaks + " " * (last if breaks else last - len(name) - 2)
        return found[0][: found.start(kind) - found.start()] + short

    return _TABLE.sub(replaced, text), taken
