"""YAML as a tree of positions, read from the parser's events: no objects are constructed, everything is bounded.

The tree is built without recursion, and every bound is checked while it grows, so neither deep nesting nor aliases of
aliases can exhaust memory or stack.
"""

import re
from dataclasses import dataclass, field
from typing import Any, Final, NoReturn

import yaml

from mission.errors import Fault, SpecError
from mission.spec.finding import Path, dotted

MAX_BYTES: Final = 1_048_576
MAX_DEPTH: Final = 20
MAX_NODES: Final = 250_000
"""Bounds of a mission file: its size, how deep lists and mappings nest, and how many values it has, each alias counted
as what it stands for."""

LINE_BREAK: Final = re.compile("\r\n|[\n\r\x85\u2028\u2029]")
_UNPRINTABLE: Final = re.compile("[^\t\n\r -~\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_UNPRINTABLE_IN_TEXT: Final = re.compile("[^\t\n -~\xa0-\u2027\u202a-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
# The C parser is some fifteen times faster, but words its errors differently: Python's own has the last word.
_FAST_LOADER: Final[Any] = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


@dataclass(frozen=True, eq=False)
class Scalar:
    """A value that is neither list nor mapping; ``plain`` if it stands without quotes. Positions count from 1."""

    line: int
    column: int
    text: str
    style: str

    @property
    def plain(self) -> bool:
        """Whether it stands without quotes."""
        return self.style == ""


@dataclass(eq=False)
class Sequence:
    """A list."""

    line: int
    column: int
    items: "list[Node]" = field(default_factory=list)


@dataclass(eq=False)
class Mapping:
    """A mapping; of a key that is repeated, the first value counts."""

    line: int
    column: int
    keys: dict[str, Scalar] = field(default_factory=dict)
    values: "dict[str, Node]" = field(default_factory=dict)


Node = Scalar | Sequence | Mapping


@dataclass
class _Open:
    """A list or mapping that is being read; ``key`` is the key that waits for its value."""

    node: Sequence | Mapping
    path: Path
    anchor: str | None
    size_before: int
    height: int = 1
    key: Scalar | None = None


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
        _stop(len(before), len(before[-1]) + 1, f"the character {character} is not allowed in YAML", "take it away")
    try:
        return _Builder().build(text, _FAST_LOADER)
    except yaml.YAMLError:
        pass
    try:
        return _Builder().build(text, yaml.SafeLoader)
    except yaml.MarkedYAMLError as error:
        message, hint, at_begin = _worded(error)
        mark = error.context_mark if at_begin else error.problem_mark
        line, column = (mark.line + 1, mark.column + 1) if mark else (0, 0)
        if error.problem_mark and "quoted scalar" not in str(error.context):
            _refuse_reserved_sign(text, error.problem_mark.line + 1, error.problem_mark.column + 1)
        _stop(line, column, message, hint)
    except (yaml.YAMLError, ValueError, OverflowError) as error:
        # The pure Python scanner lets ValueError through for numbers in directives and escapes out of range.
        _stop(0, 0, f"this is not YAML: {error}", "check escapes in double quotes and lines that begin with %")


def _stop(line: int, column: int, message: str, hint: str, path: str = "") -> NoReturn:
    raise SpecError((Fault(line, column, path, message, hint),)) from None


TEXT_KEYS: Final = ("formula", "automaton", "name", "description")
"""Keys whose value is a text."""

_BEGINS_WITH_SIGN: Final = re.compile(
    rf"""(?P<flow>.*[{{,])?[ ]*["']?(?P<key>{"|".join(TEXT_KEYS)})["']?[ ]*:[ ]+(?P<sign>[]\[{{}}!&*%@`|>,?"'-])"""
)


def _refuse_reserved_sign(text: str, line: int, column: int) -> None:
    """Say so where YAML stops in a text, or at it, because of the sign that it begins with."""
    lines = LINE_BREAK.split(text)
    found = _BEGINS_WITH_SIGN.match(lines[line - 1][:column]) if line <= len(lines) else None
    # After a text in quotes, in braces, a comma is what is most likely missing.
    if found and not (found["flow"] and found["sign"] in _QUOTES):
        _stop_at_sign(line, found.end(), found["key"], found["sign"])


def _stop_at_sign(line: int, column: int, key: str, sign: str, path: str = "") -> NoReturn:
    message = f"the text of `{key}` begins with `{sign}`, which YAML keeps for itself"
    block = f"write it as a block: {key}: |, and below it, indented, the text"
    hint = block if sign in _QUOTES else f"put it in single quotes, {key}: '{sign}...', or {block}"
    _stop(line, column, message, hint, path)


_QUOTES: Final = ("'", '"')
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
    ("expected <block end>", "the indentation fits nothing above it", "indent all keys of a mapping alike", False),
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


def _worded(error: yaml.MarkedYAMLError) -> tuple[str, str, bool]:
    """Message, hint and whether to point at the begin, for what the YAML parser says."""
    problem = error.problem or str(error)
    said = f"{error.context or ''} {problem}"
    for part, message, hint, at_begin in _WORDINGS:
        if part in said:
            return message, hint, at_begin and error.context_mark is not None
    return f"YAML syntax: {problem}", "put text with special characters in quotes, and see the lines above, too", False


class _Builder:
    def __init__(self) -> None:
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
                    _stop(line, column, "a second document begins here", "a mission file has one; take the `---` away")
            elif isinstance(event, yaml.AliasEvent):
                self._alias(str(event.anchor), line, column)
            elif isinstance(event, yaml.ScalarEvent):
                self._scalar(event, line, column)
            elif isinstance(event, yaml.SequenceStartEvent | yaml.MappingStartEvent):
                self._open(event, line, column)
            elif isinstance(event, yaml.SequenceEndEvent | yaml.MappingEndEvent):
                self._close()
        if self._root is None:
            _stop(0, 0, "the file is empty", "a mission file has at least domain, regions, mission and start")
        return self._root, self._faults

    def _scalar(self, event: yaml.ScalarEvent, line: int, column: int) -> None:
        self._refuse_sign(event, line, column)
        self._refuse_tag(event.tag, line, column)
        style = "" if event.implicit[0] else str(event.style or "")
        found = _UNPRINTABLE_IN_TEXT.search(event.value)
        if found:
            message = f"the text has the character U+{ord(found.group()):04X}, which cannot be shown"
            _stop(line, column, message, "take it away", dotted(self._path_of_next()))
        node = Scalar(line, column, event.value, style)
        self._grow(1, line, column)
        if event.anchor:
            self._anchors[event.anchor] = _Anchored(node, 1, 0)
        self._add(node, 0)

    def _open(self, event: yaml.SequenceStartEvent | yaml.MappingStartEvent, line: int, column: int) -> None:
        self._refuse_tag(event.tag, line, column)
        self._refuse_as_key(line, column)
        if len(self._stack) >= MAX_DEPTH:
            _stop(
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
        if done.anchor:
            self._anchors[done.anchor] = _Anchored(done.node, self._size - done.size_before, done.height)
        self._add(done.node, done.height)

    def _alias(self, name: str, line: int, column: int) -> None:
        known = self._anchors.get(name)
        if known is None:
            self._refuse_sign(None, line, column)
            _stop(line, column, f"the alias *{name} has no anchor &{name} before it", "write the value out")
        if not isinstance(known.node, Scalar):
            self._refuse_as_key(line, column)
        self._grow(known.size, line, column)
        if len(self._stack) + known.height > MAX_DEPTH:
            _stop(
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
            _stop(line, column, f"the file has more than {MAX_NODES} values, aliases counted as what they repeat", hint)

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
            _stop_at_sign(line, column, str(key), sign, dotted(path))

    def _refuse_tag(self, tag: str | None, line: int, column: int) -> None:
        if tag is not None:
            where = dotted(self._path_of_next())
            shown = tag.replace("tag:yaml.org,2002:", "!!")[:80]
            _stop(line, column, f"the tag `{shown}` is not allowed", "write the value without a tag", where)

    def _refuse_as_key(self, line: int, column: int) -> None:
        parent = self._stack[-1] if self._stack else None
        if parent and isinstance(parent.node, Mapping) and parent.key is None:
            where = dotted(parent.path)
            _stop(line, column, "a list or mapping stands where a key must", "write `key: value`", where)
