"""Fault files, read strictly: YAML without tags, anchors or objects; every fault of a file is told, each with its line.

faults:
  - {fault: gps_loss, since: takeoff, at_s: 20, for_s: 8}
  - {fault: gust, at_s: 60, for_s: 4, east_m_s: 9}
"""

from difflib import get_close_matches
from math import inf, isfinite
from typing import Final, NamedTuple

import yaml

from vehicle_sim.errors import ConfigurationError
from vehicle_sim.faults.schedule import KINDS, FaultKind, Schedule, ScheduledFault, Since

MAX_BYTES: Final = 65_536
MAX_FAULTS: Final = 256
MAX_DEPTH: Final = 4
"""Bounds of a file: its size, how many faults it has, how deep it nests."""

LATEST_S: Final = 1e6
_MOST_TOLD: Final = 50
_NEAR: Final = 0.7
_TIMES: Final = ("at_s", "for_s", "ramp_s")


class FileFault(NamedTuple):
    """One thing that is wrong with a fault file: its line from 1, what is wrong, and what to write instead."""

    line: int
    message: str
    hint: str


class FaultFileError(ConfigurationError):
    """A fault file that cannot be used; `faults` are all that is wrong with it."""

    def __init__(self, source: str, faults: tuple[FileFault, ...]) -> None:
        """Tell all of them, in the order of their lines."""
        self.faults = tuple(sorted(faults))
        told = [f"{source}:{fault.line}: {fault.message}; {fault.hint}" for fault in self.faults[:_MOST_TOLD]]
        left = len(self.faults) - len(told)
        super().__init__("\n".join(told + ([f"and {left} more"] if left > 0 else [])))


def read_schedule(content: bytes, source: str = "faults") -> Schedule:
    """Return the schedule that a file holds; `source` is what it is called.

    Raises:
        FaultFileError: With everything that is wrong with the file.
    """
    try:
        root = _tree(content)
    except _Unusable as error:
        raise FaultFileError(source, (error.fault,)) from None
    reader = _Reader()
    faults = reader.faults_of(root)
    if reader.found:
        raise FaultFileError(source, tuple(reader.found))
    return Schedule(tuple(faults))


class _Unusable(Exception):  # noqa: N818 - it never leaves this module
    """Where the file stops being readable."""

    def __init__(self, line: int, message: str, hint: str) -> None:
        self.fault = FileFault(line, message, hint)


def _tree(content: bytes) -> yaml.Node:
    """Return the tree of nodes, of which nothing has been constructed."""
    if len(content) > MAX_BYTES:
        raise _Unusable(1, f"the file is longer than {MAX_BYTES} bytes", "a fault takes one line")
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise _Unusable(line, "the file is not UTF-8", "save it as UTF-8") from None
    try:
        _refuse_what_is_not_plain(text)
        root = yaml.compose(text, Loader=yaml.SafeLoader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        hint = "check brackets, colons and indents"
        raise _Unusable(mark.line + 1 if mark else 1, f"this is not YAML: {error.problem}", hint) from None
    except (yaml.YAMLError, ValueError, OverflowError) as error:
        what = str(error).splitlines()[0]
        raise _Unusable(1, f"this is not YAML: {what}", "check for characters that cannot be printed") from None
    if root is None:
        raise _Unusable(1, "the file is empty", "write `faults:` and a list")
    return root


def _refuse_what_is_not_plain(text: str) -> None:
    """Find tags, anchors and depth among the parser's events, because composing recurses."""
    depth = 0
    for event in yaml.parse(text, Loader=yaml.SafeLoader):
        line = event.start_mark.line + 1 if event.start_mark else 1
        if getattr(event, "anchor", None) is not None:
            raise _Unusable(line, "anchors and aliases are not allowed", "write the value out")
        if getattr(event, "tag", None) is not None:
            raise _Unusable(line, "tags are not allowed", "write the value without it")
        depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
        if depth > MAX_DEPTH:
            raise _Unusable(line, "lists and mappings nest too deep", "write a list of faults, as in the example")


def _listed(names: object) -> str:
    return ", ".join(str(name) for name in names) if isinstance(names, list | tuple) else str(names)


class _Reader:
    """Turns nodes into faults; `found` are the things that are wrong."""

    def __init__(self) -> None:
        self.found: list[FileFault] = []

    def _wrong(self, node: yaml.Node, message: str, hint: str) -> None:
        self.found.append(FileFault(node.start_mark.line + 1, message, hint))

    def faults_of(self, root: yaml.Node) -> list[ScheduledFault]:
        """Read the file as a whole."""
        top = self._mapping(root, "the file", "write `faults:` and a list")
        for name, (key, _value) in top.items():
            if name != "faults":
                self._wrong(key, f"there is no key `{name[:40]}`", "the file has one key, `faults`")
        if "faults" not in top:
            if isinstance(root, yaml.MappingNode):
                self._wrong(root, "`faults` is missing", "write `faults:` and a list")
            return []
        node = top["faults"][1]
        if not isinstance(node, yaml.SequenceNode):
            self._wrong(node, "`faults` is not a list", "begin each fault with `- `")
            return []
        if len(node.value) > MAX_FAULTS:
            self._wrong(node, f"there are more than {MAX_FAULTS} faults", "make the schedule shorter")
            return []
        faults = [self._fault(item) for item in node.value]
        return [fault for fault in faults if fault is not None]

    def _mapping(self, node: yaml.Node, what: str, hint: str) -> dict[str, tuple[yaml.Node, yaml.Node]]:
        if not isinstance(node, yaml.MappingNode):
            self._wrong(node, f"{what} is not a mapping", hint)
            return {}
        pairs: dict[str, tuple[yaml.Node, yaml.Node]] = {}
        for key, value in node.value:
            if not isinstance(key, yaml.ScalarNode):
                self._wrong(key, "a key is not a name", "write `key: value`")
            elif key.value in pairs:
                self._wrong(key, f"the key `{key.value[:40]}` is repeated", "keep one of the two")
            else:
                pairs[key.value] = (key, value)
        return pairs

    def _fault(self, node: yaml.Node) -> ScheduledFault | None:
        pairs = self._mapping(node, "a fault", "write {fault: gps_loss, at_s: 20}")
        if not pairs:
            return None
        before = len(self.found)
        name = self._word(pairs, "fault", tuple(KINDS), node)
        kind = KINDS.get(name)
        if kind is None:
            return None
        self._refuse_unknown(name, kind, pairs)
        since = self._word(pairs, "since", tuple(Since), None) or Since.BOOT
        at_s = self._number(pairs, "at_s", 0.0, LATEST_S, 0.0)
        for_s = self._number(pairs, "for_s", 0.0, LATEST_S, inf) if kind.lasting else inf
        ramp_s = self._number(pairs, "ramp_s", 0.0, LATEST_S, 0.0) if kind.lasting and not kind.swells else 0.0
        values = {
            quantity: self._number(
                pairs, quantity, bounds.least, bounds.most, bounds.default, whole=bounds.whole, at=node
            )
            for quantity, bounds in kind.quantities.items()
        }
        fault = ScheduledFault(kind=name, values=values, since=Since(since), at_s=at_s, for_s=for_s, ramp_s=ramp_s)
        self._weigh(fault, pairs, node)
        return fault if len(self.found) == before else None

    def _refuse_unknown(self, name: str, kind: FaultKind, pairs: dict[str, tuple[yaml.Node, yaml.Node]]) -> None:
        times = _TIMES[: 1 if not kind.lasting else 2 if kind.swells else 3]
        known = ("fault", "since", *times, *kind.quantities)
        for key, (where, _value) in pairs.items():
            if key not in known:
                near = get_close_matches(key, known, n=1, cutoff=_NEAR)
                hint = f"did you mean `{near[0]}`?" if near else f"it has {_listed(known)}"
                self._wrong(where, f"`{name}` has no `{key[:40]}`", hint)

    def _weigh(self, fault: ScheduledFault, pairs: dict[str, tuple[yaml.Node, yaml.Node]], node: yaml.Node) -> None:
        """Find what no single value shows to be wrong."""
        kind = KINDS[fault.kind]
        if fault.for_s == 0.0:
            self._wrong(pairs["for_s"][1], "a fault of no duration does nothing", "write the seconds that it lasts")
        if kind.swells and "for_s" not in pairs:
            hint = "write how long it takes to swell and to fade, in seconds"
            self._wrong(node, f"a `{fault.kind}` needs `for_s`", hint)
        if 2.0 * fault.ramp_s > fault.for_s:
            hint = "`ramp_s` is half of `for_s` at most"
            self._wrong(pairs["ramp_s"][1], "both ramps are longer than the fault", hint)
        optional = [key for key, bounds in kind.quantities.items() if bounds.default == 0.0]
        if optional and not any(key in pairs for key in optional):
            self._wrong(node, f"this `{fault.kind}` does nothing", f"give at least one of {_listed(optional)}")

    def _word(
        self,
        pairs: dict[str, tuple[yaml.Node, yaml.Node]],
        key: str,
        known: tuple[str, ...],
        needed_at: yaml.Node | None,
    ) -> str:
        if key not in pairs:
            if needed_at is not None:
                self._wrong(needed_at, f"`{key}` is missing", f"one of {_listed(known)}")
            return ""
        node = pairs[key][1]
        word = node.value if isinstance(node, yaml.ScalarNode) else ""
        if word in known:
            return str(word)
        near = get_close_matches(str(word), known, n=1, cutoff=_NEAR)
        hint = f"did you mean `{near[0]}`?" if near else f"one of {_listed(known)}"
        self._wrong(node, f"`{str(word)[:40]}` is no value of `{key}`", hint)
        return ""

    def _number(
        self,
        pairs: dict[str, tuple[yaml.Node, yaml.Node]],
        key: str,
        least: float,
        most: float,
        default: float | None,
        *,
        whole: bool = False,
        at: yaml.Node | None = None,
    ) -> float:
        if key not in pairs:
            if default is None and at is not None:
                self._wrong(at, f"`{key}` is missing", f"a number from {least:g} to {most:g}")
            return default or 0.0
        node = pairs[key][1]
        try:
            value = float(node.value) if isinstance(node, yaml.ScalarNode) and node.style is None else inf
        except ValueError:
            value = inf
        kind = "whole number" if whole else "number"
        if not (isfinite(value) and least <= value <= most) or (whole and value != int(value)):
            shown = node.value if isinstance(node, yaml.ScalarNode) else "this"
            self._wrong(node, f"`{key}` cannot be {str(shown)[:40]}", f"write a {kind} from {least:g} to {most:g}")
            return default or 0.0
        return value
