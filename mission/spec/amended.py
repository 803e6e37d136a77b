"""A mission's text with other values in it, its comments and its shape kept where that can be."""

import json
import re
from collections.abc import Mapping as Values
from contextlib import suppress
from copy import deepcopy
from typing import Any, Final

import yaml

from mission.errors import SpecError
from mission.spec.nodes import Mapping, Node, Scalar
from mission.spec.structure import plain_data
from mission.spec.yaml_errors import LINE_BREAK
from mission.spec.yaml_tree import read_tree

_SCALAR: Final = re.compile(r""""[^"\n]*"|'[^'\n]*'|[^\s,#}\]]+""")
_LIST: Final = re.compile(r"\[[^\[\]\n]*\]")

Key = tuple[str, ...]
GONE: Final = None
"""In the place of a value: the key is taken away."""


def with_values(text: str, changes: Values[Key, Any]) -> str:
    """The text of a sound mission file with other values.

    Each is written where it stands, or into its section. Where that does not come out as it should (an alias in the
    place of a value, say), the whole mission is written anew, without its comments.

    Args:
        text: The mission file.
        changes: Values by their keys, such as ``("mission", "laps")``, or ``GONE``.
    """
    amended, wanted = text, _data(text)
    for key, value in changes.items():
        _put(wanted, key, value)
        for edited in (_in_place(amended, key, value), f"{amended.rstrip()}\n{_section(key, value)}"):
            with suppress(SpecError):
                if edited is not None and _data(edited) == wanted:
                    amended = edited
                    break
        else:
            amended = yaml.safe_dump(wanted, sort_keys=False, allow_unicode=True)
    return amended


def _put(data: dict[str, Any], key: Key, value: Any) -> None:  # noqa: ANN401 - any JSON value
    """Change a value within; a text in the place of a section gives way to one."""
    *sections, last = key
    for section in sections:
        if not isinstance(data.get(section), dict):
            data[section] = {}
        data = data[section]
    if value is GONE:
        data.pop(last, None)
    else:
        data[last] = deepcopy(value)


def _section(key: Key, value: Any) -> str:  # noqa: ANN401 - any JSON value
    """A section with one value, for the end of a file."""
    indented = [f"{'  ' * depth}{name}:" for depth, name in enumerate(key)]
    return "\n".join(indented) + f" {_written(value)}\n"


def _in_place(text: str, key: Key, value: Any) -> str | None:  # noqa: ANN401 - any JSON value
    """The text with the value where it stands, or first in its section; None where there is no such section."""
    section: Node | None = read_tree(text)[0]
    for name in key[:-1]:
        section = section.values.get(name) if isinstance(section, Mapping) else None
    if not isinstance(section, Mapping) or not section.keys or value is GONE:
        return None
    there = section.values.get(key[-1])
    if there is not None:
        at = _offset(text, there.line, there.column)
        pattern = _SCALAR if isinstance(there, Scalar) else _LIST
        return text[:at] + pattern.sub(lambda _: _written(value), text[at:], count=1)
    first = min(section.keys.values(), key=lambda each: (each.line, each.column))
    at = _offset(text, first.line, first.column)
    if (section.line, section.column) == (first.line, first.column):
        return f"{text[:at]}{key[-1]}: {_written(value)}\n{' ' * (first.column - 1)}{text[at:]}"
    return f'{text[:at]}"{key[-1]}": {_written(value)}, {text[at:]}'


def _written(value: Any) -> str:  # noqa: ANN401 - any JSON value
    return json.dumps(value, ensure_ascii=False)


def _offset(text: str, line: int, column: int) -> int:
    """Where a place is in the text; lines and columns count from 1."""
    begins = [0, *(found.end() for found in LINE_BREAK.finditer(text))]
    return begins[line - 1] + column - 1


def _data(text: str) -> dict[str, Any]:
    data, _ = plain_data(read_tree(text)[0])
    return dict(data)
