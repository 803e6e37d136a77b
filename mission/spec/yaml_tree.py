"""YAML as a tree of positions, read from the parser's events: no objects are constructed, everything is bounded.

The tree is built without recursion, and every bound is checked while it grows, so neither deep nesting nor aliases of
aliases can exhaust memory or stack.
"""

import re
from collections.abc import Mapping as MappingOf
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, Final

import yaml

from mission.errors import Fault, SpecError
from mission.spec.finding import Path, dotted
from mission.spec.nodes import Mapping, Node, Scalar, Sequence, Table
from mission.spec.tables import MARK, TableError, TakenOut, without_tables
from mission.spec.yaml_errors import LINE_BREAK, TEXT_KEYS, refuse_reserved_sign, stop, stop_at_sign, worded

MAX_BYTES: Final = 1 << 24
MAX_DEPTH: Final = 20
MAX_NODES: Final = 500_000
"""Bounds of a mission file: its size, how deep lists and mappings nest, and how many values it has, each alias counted
as what it stands for. The largest maps, of 100,000 nodes, have 300,000 values in some 5 MB; as many values that are no
tables take 100 MB of memory."""

MAX_BYTES_FOR_PYTHON: Final = 1 << 17
"""In texts longer than this, an error is told in the words of the C parser: Python's takes a second for 50 kB."""

_UNPRINTABLE: Final = re.compile("[^\t\n\r -~\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_UNPRINTABLE_IN_TEXT: Final = re.compile("[^\t\n -~\xa0-\u2027\u202a-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
# The C parser is some fifteen times faster, but says less of errors: of short texts, Python's own has the last word.
_FAST_LOADER: Final[Any] = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


@dataclass
class _Open:
    """A list or mapping that is being read; ``key`` is the key that waits for its value."""

    node: Sequence | Mapping
    path: Path
    anchor: str | None
    size_before: int
    height: int = 1
    key: Scalar | None = None
    table: Table | None = None


@dataclass(frozen=True)
class _Anchored:
    node: Node
    size: int
    height: int


def read_tree(text: str) -> tuple[Node, list[Fault]]:
    """The tree of a YAML text, and the faults that do not hinder reading on (repeated keys).

    Raises:
        SpecError: With the one fault where the text stops being readable.
    """
    found = _UNPRINTABLE.search(text)
    if found:
        before = LINE_BREAK.split(text[: found.start()])
        character = f"U+{ord(found.group()):04X}"
        stop(len(before), len(before[-1]) + 1, f"the character {character} is not allowed in YAML", "take it away")
    short, tables = without_tables(text)
    if tables:
        # Whatever is wrong is told of the text as it stands.
        with suppress(yaml.YAMLError, TableError, SpecError):
            return _Builder(tables).build(short, _FAST_LOADER)
    try:
        try:
            return _Builder({}).build(text, _FAST_LOADER)
        except yaml.YAMLError:
            if len(text) > MAX_BYTES_FOR_PYTHON:
                raise
            return _Builder({}).build(text, yaml.SafeLoader)
    except yaml.MarkedYAMLError as error:
        message, hint, at_begin = worded(error, text)
        mark = error.context_mark if at_begin else error.problem_mark
        line, column = (mark.line + 1, mark.column + 1) if mark else (0, 0)
        if error.problem_mark and "quoted scalar" not in str(error.context):
            refuse_reserved_sign(text, error.problem_mark.line + 1, error.problem_mark.column + 1)
        stop(line, column, message, hint)
    except (yaml.YAMLError, ValueError, OverflowError) as error:
        # The pure Python scanner lets ValueError through for numbers in directives and escapes out of range.
        stop(0, 0, f"this is not YAML: {error}", "check escapes in double quotes and lines that begin with %")


_TABLE_HEIGHT: Final = 2


class _Builder:
    """Builds the tree; ``tables`` are those that were taken out of the text, by what stands for them."""

    def __init__(self, tables: MappingOf[str, TakenOut]) -> None:
        self._tables = dict(tables)
        self._root: Node | None = None
        self._stack: list[_Open] = []
        self._anchors: dict[str, _Anchored] = {}
        self._faults: list[Fault] = []
        self._size = 0

    def build(self, text: str, loader: Any) -> tuple[Node, list[Fault]]:  # noqa: ANN401 - PyYAML's C loader has no type
        documents = 0
        for event in yaml.parse(text, Loader=loader):
            mark = event.start_mark
            line, column = (mark.line + 1, mark.column + 1) if mark else (0, 0)
            if isinstance(event, yaml.DocumentStartEvent):
                documents += 1
                if documents > 1:
                    stop(line, column, "a second document begins here", "a mission file has one; take the `---` away")
            elif isinstance(event, yaml.AliasEvent):
                self._alias(str(event.anchor), line, column)
            elif isinstance(event, yaml.ScalarEvent):
                self._scalar(event, line, column)
            elif isinstance(event, yaml.SequenceStartEvent | yaml.MappingStartEvent):
                self._open(event, line, column)
            elif isinstance(event, yaml.SequenceEndEvent | yaml.MappingEndEvent):
                self._close()
        if self._tables:
            raise TableError  # one of them stands where no value does
        if self._root is None:
            stop(0, 0, "the file is empty", "a mission file has at least domain, regions, mission and start")
        return self._root, self._faults

    def _scalar(self, event: yaml.ScalarEvent, line: int, column: int) -> None:
        self._refuse_sign(event, line, column)
        self._refuse_tag(event.tag, line, column)
        if self._tables and MARK in event.value:
            self._table(event, line, column)
            return
        style = "" if event.implicit[0] else str(event.style or "")
        found = _UNPRINTABLE_IN_TEXT.search(event.value)
        if found:
            message = f"the text has the character U+{ord(found.group()):04X}, which cannot be shown"
            stop(line, column, message, "take it away", dotted(self._path_of_next()))
        node = Scalar(line, column, event.value, style)
        self._grow(1, line, column)
        if event.anchor:
            self._anchors[event.anchor] = _Anchored(node, 1, 0)
        self._add(node, 0)

    def _table(self, event: yaml.ScalarEvent, line: int, column: int) -> None:
        """Take a table in, in the place of the text that stands for it: as a list, or as all that a list holds."""
        taken = self._tables.pop(event.value, None)
        parent = self._stack[-1] if self._stack else None
        as_key = parent is not None and isinstance(parent.node, Mapping) and parent.key is None
        if taken is None or as_key or len(self._stack) + _TABLE_HEIGHT > MAX_DEPTH:
            raise TableError
        rows = taken.rows()
        # Before the text an anchor may stand, with which the value begins.
        end = event.end_mark
        first = (end.line + 1, end.column - len(event.value) - 1) if end else (line, column)
        self._grow(3 * len(rows), line, column)
        if taken.dashes:
            if parent is None or not isinstance(parent.node, Sequence) or parent.node.items:
                raise TableError
            parent.table = Table(parent.node.line, parent.node.column, first, taken.text, rows)
            parent.height = _TABLE_HEIGHT
            return
        self._grow(1, line, column)
        node = Table(line, column, first, taken.text, rows)
        if event.anchor:
            self._anchors[event.anchor] = _Anchored(node, 1 + 3 * len(rows), _TABLE_HEIGHT)
        self._add(node, _TABLE_HEIGHT)

    def _open(self, event: yaml.SequenceStartEvent | yaml.MappingStartEvent, line: int, column: int) -> None:
        self._refuse_tag(event.tag, line, column)
        self._refuse_as_key(line, column)
        if len(self._stack) >= MAX_DEPTH:
            stop(
                line,
                column,
                f"lists and mappings are nested deeper than {MAX_DEPTH}",
                "a mission file needs five levels",
            )
        size = self._size
        self._grow(1, line, column)
        node = Sequence(line, column) if isinstance(event, yaml.SequenceStartEvent) else Mapping(line, column)
        if event.anchor:
            self._anchors.pop(event.anchor, None)
        self._stack.append(_Open(node, self._path_of_next(), event.anchor, size))

    def _close(self) -> None:
        done = self._stack.pop()
        node = done.table or done.node
        if done.anchor:
            self._anchors[done.anchor] = _Anchored(node, self._size - done.size_before, done.height)
        self._add(node, done.height)

    def _alias(self, name: str, line: int, column: int) -> None:
        known = self._anchors.get(name)
        if known is None:
            self._refuse_sign(None, line, column)
            stop(line, column, f"the alias *{name} has no anchor &{name} before it", "write the value out")
        if not isinstance(known.node, Scalar):
            self._refuse_as_key(line, column)
        self._grow(known.size, line, column)
        if len(self._stack) + known.height > MAX_DEPTH:
            stop(
                line,
                column,
                f"lists and mappings are nested deeper than {MAX_DEPTH}",
                "a mission file needs five levels",
            )
        self._add(known.node, known.height)

    def _add(self, node: Node, height: int) -> None:
        if not self._stack:
            self._root = node
            return
        parent = self._stack[-1]
        if parent.table:
            raise TableError  # the list goes on
        parent.height = max(parent.height, height + 1)
        if isinstance(parent.node, Sequence):
            parent.node.items.append(node)
        elif parent.key is not None:
            self._set(parent.node, parent.path, parent.key, node)
            parent.key = None
        elif isinstance(node, Scalar):  # nothing else gets here, see _refuse_as_key
            parent.key = node

    def _set(self, mapping: Mapping, path: Path, key: Scalar, node: Node) -> None:
        name = key.text
        if name in mapping.keys:
            first = mapping.keys[name]
            message = f"the key `{name}` is repeated; it stands on line {first.line} already"
            self._faults.append(Fault(key.line, key.column, dotted((*path, name)), message, "keep one of the two"))
            return
        mapping.keys[name] = key
        mapping.values[name] = node

    def _path_of_next(self) -> Path:
        """Path of the node that is read next."""
        if not self._stack:
            return ()
        parent = self._stack[-1]
        if isinstance(parent.node, Sequence):
            return (*parent.path, len(parent.node.items))
        return (*parent.path, parent.key.text) if parent.key else parent.path

    def _grow(self, count: int, line: int, column: int) -> None:
        self._size += count
        if self._size > MAX_NODES:
            hint = "write values out instead of aliases, or make the mission smaller"
            stop(line, column, f"the file has more than {MAX_NODES} values, aliases counted as what they repeat", hint)

    def _refuse_sign(self, event: yaml.ScalarEvent | None, line: int, column: int) -> None:
        """Refuse a text that YAML does not see whole: a tag, an anchor or an alias (no event) stands where it begins.

        An anchor is refused before a formula alone: other texts are reasonably repeated.
        """
        path = self._path_of_next()
        key = path[-1] if path and self._stack[-1].key else None
        if event is None:
            sign = "*"
        elif event.tag and not event.tag.startswith("tag:yaml.org,2002:"):
            sign = "!"
        else:
            sign = "&" if event.anchor and key == "formula" else ""
        if sign and key in TEXT_KEYS:
            stop_at_sign(line, column, str(key), sign, dotted(path))

    def _refuse_tag(self, tag: str | None, line: int, column: int) -> None:
        if tag is not None:
            where = dotted(self._path_of_next())
            shown = tag.replace("tag:yaml.org,2002:", "!!")[:80]
            stop(line, column, f"the tag `{shown}` is not allowed", "write the value without a tag", where)

    def _refuse_as_key(self, line: int, column: int) -> None:
        parent = self._stack[-1] if self._stack else None
        if parent and isinstance(parent.node, Mapping) and parent.key is None:
            where = dotted(parent.path)
            stop(line, column, "a list or mapping stands where a key must", "write `key: value`", where)
