"""A mission's text with another value in it, its comments and its shape kept."""

import json
import re
from contextlib import suppress
from typing import Any, Final

from mission.errors import SpecError
from mission.spec.nodes import Mapping, Node, Scalar
from mission.spec.structure import plain_data
from mission.spec.yaml_errors import LINE_BREAK
from mission.spec.yaml_tree import read_tree

_VALUE: Final = re.compile(r""""[^"\n]*"|'[^'\n]*'|[^\s,#}\]]+""")


def with_laps(text: str, laps: int | str) -> str:
    """The text of a sound mission file, with another number of laps.

    Where no value can be written in its place (it is an alias, say), a comment at the end tells it.
    """
    tree, _ = read_tree(text)
    wanted = _data(tree)
    wanted["mission"] = {**wanted.get("mission", {}), "laps": laps}
    for amended in (_in_section(text, tree, laps), f"{text.rstrip()}\nmission:\n  laps: {laps}\n"):
        with suppress(SpecError):
            if amended is not None and _data(read_tree(amended)[0]) == wanted:
                return amended
    return f"{text.rstrip()}\n# flown with laps: {laps}\n"


def _in_section(text: str, tree: Node, laps: int | str) -> str | None:
    """The text with the laps in its section ``mission``; None where it has none that holds something."""
    section = tree.values.get("mission") if isinstance(tree, Mapping) else None
    if not isinstance(section, Mapping) or not section.keys:
        return None
    there = section.values.get("laps")
    if isinstance(there, Scalar):
        at = _offset(text, there.line, there.column)
        return text[:at] + _VALUE.sub(str(laps), text[at:], count=1)
    key = min(section.keys.values(), key=lambda each: (each.line, each.column))
    at = _offset(text, key.line, key.column)
    if (section.line, section.column) == (key.line, key.column):
        return f"{text[:at]}laps: {laps}\n{' ' * (key.column - 1)}{text[at:]}"
    return f'{text[:at]}"laps": {json.dumps(laps)}, {text[at:]}'


def _offset(text: str, line: int, column: int) -> int:
    """Where a place is in the text; lines and columns count from 1."""
    begins = [0, *(found.end() for found in LINE_BREAK.finditer(text))]
    return begins[line - 1] + column - 1


def _data(tree: Node) -> dict[str, Any]:
    data, _ = plain_data(tree)
    return dict(data)
