"""What a YAML file is made of, each part with its place: lines and columns count from 1."""

import re
from bisect import bisect_right
from dataclasses import dataclass, field
from functools import cached_property
from typing import Final

NUMBER: Final = r"-?+(?:0|[1-9][0-9]{0,15}+)(?:\.[0-9]{1,20}+)?+(?:[eE][-+]?+[0-9]{1,2}+)?+"
"""Numbers that YAML, JSON and a mission file read alike."""

_ROW: Final = re.compile(rf"\[\s*({NUMBER})\s*,\s*({NUMBER})")


@dataclass(frozen=True, eq=False, slots=True)
class Scalar:
    """A value that is neither list nor mapping; ``plain`` if it stands without quotes."""

    line: int
    column: int
    text: str
    style: str

    @property
    def plain(self) -> bool:
        """Whether it stands without quotes."""
        return self.style == ""


@dataclass(eq=False, slots=True)
class Sequence:
    """A list."""

    line: int
    column: int
    items: "list[Node]" = field(default_factory=list)


@dataclass(frozen=True, eq=False)
class Table:
    """A list of pairs of numbers, as long maps have: its values at once, its nodes where somebody asks for them.

    Attributes:
        line: Where it begins.
        column: The same.
        first: Line and column of ``text``, which begins later in a list that is written with dashes.
        text: The source, from the first bracket to the last.
        rows: Its values.
    """

    line: int
    column: int
    first: tuple[int, int]
    text: str
    rows: list[list[float]]

    @cached_property
    def items(self) -> "list[Node]":
        """The rows as nodes with their places."""
        begins = [0, *(found.end() for found in re.finditer("\n", self.text))]

        def place(at: int) -> tuple[int, int]:
            row = bisect_right(begins, at) - 1
            return self.first[0] + row, at - begins[row] + (1 if row else self.first[1])

        return [
            Sequence(*place(row.start()), [Scalar(*place(row.start(i)), row[i], "") for i in (1, 2)])
            for row in _ROW.finditer(self.text)
        ]


@dataclass(eq=False, slots=True)
class Mapping:
    """A mapping; of a key that is repeated, the first value counts."""

    line: int
    column: int
    keys: dict[str, Scalar] = field(default_factory=dict)
    values: "dict[str, Node]" = field(default_factory=dict)


Node = Scalar | Sequence | Table | Mapping
