"""Mission files, read strictly: every fault of a file is reported, all at once, each with its line and path.

The way of a file: bytes -> text -> tree with positions (``yaml_tree``) -> plain data -> against the schema
(``structure``) -> shapes that files draw written out (``drawn_files``) -> degrees as metres (``geography``) -> its
meaning, where the structure is sound (``check``), and that of the automaton that it may name (``named_automaton``)
-> frozen values (``values``).
"""

from dataclasses import replace
from pathlib import Path
from typing import Any

from mission.errors import Fault, SpecError
from mission.spec.check import meaning_findings
from mission.spec.drawn_files import with_drawn_shapes
from mission.spec.finding import Finding, is_clean, shortened
from mission.spec.geography import in_degrees, in_metres, origin_of, told_in_degrees
from mission.spec.model import MissionSpec, NamedAutomaton
from mission.spec.named_automaton import AUTOMATON, named_automaton
from mission.spec.named_files import Reader, UnreadableError, nothing_beside
from mission.spec.placing import placed
from mission.spec.structure import MOST_ERRORS, plain_data, structure_findings
from mission.spec.values import mission_of
from mission.spec.window_check import of_automaton
from mission.spec.written_automaton import BY_HAND, written_automaton
from mission.spec.yaml_tree import MAX_BYTES, read_tree

MAX_AUTOMATON_BYTES = 1 << 20
"""The size of an automaton's file."""

MOST_FAULTS = 100
"""As many faults are listed; the rest is counted."""


def load_mission(path: str | Path) -> MissionSpec:
    """Read a mission file, and the automaton beside it if it names one.

    Raises:
        SpecError: If the file cannot be read, or with every fault that it has.
    """
    source = str(path)
    try:
        content = _content(Path(path))
    except UnreadableError as error:
        raise SpecError((Fault(0, 0, "", error.message, error.hint),), source) from None
    return parse_mission(content, source, beside(Path(path)))


def beside(path: Path) -> Reader:
    """Reads the files that a mission file names, relative to it."""
    return lambda name: _content(path.parent / name)


def parse_mission(content: bytes, source: str = "", read: Reader = nothing_beside) -> MissionSpec:
    """Read the content of a mission file.

    Args:
        content: The bytes of the file.
        source: Where they come from, for messages and for the name of a mission that gives itself none.
        read: Gives the content of a file that the mission names; without it, there is none.

    Raises:
        SpecError: With every fault of the content, sorted by line, the first ``MOST_FAULTS`` of them.
    """
    try:
        text = _decoded(content)
        tree, faults = read_tree(text)
    except SpecError as error:
        raise SpecError(error.faults, source) from None
    data, findings = plain_data(tree)
    findings.extend(structure_findings(data, tree))
    if isinstance(data, dict):
        data, found = with_drawn_shapes(data, read)
        findings.extend(found)
    origin = None
    if in_degrees(data):
        data, found = in_metres(data)
        findings.extend(found)
        origin = None if found else origin_of(data)
    automaton = None
    if len(findings) < MOST_ERRORS:
        meant = meaning_findings(data, findings)
        if origin is not None:
            # The file has its points in degrees, and so has whoever reads what is wrong with it.
            meant = [replace(each, message=told_in_degrees(each.message, origin)) for each in meant]
        automaton, unsound = _automaton(data, findings, read)
        findings += [
            *meant,
            *unsound,
            *of_automaton(automaton, data.get("regions") if isinstance(data, dict) else None),
        ]
    faults.extend(placed(finding, tree, text) for finding in findings)
    if faults:
        raise SpecError(_bounded(sorted(set(faults))), source)
    return mission_of(data, Path(source).stem.encode("utf-8", "replace").decode() or "mission", automaton)


def _automaton(data: Any, structural: list[Finding], read: Reader) -> tuple[NamedAutomaton | None, list[Finding]]:  # noqa: ANN401 - any JSON value
    """The automaton that the mission names, if it does, and what is wrong with it."""
    if not is_clean(AUTOMATON, structural) or "automaton" not in data.get("mission", {}):
        return None, []
    file, regions = data["mission"]["automaton"], data.get("regions")
    names = frozenset(regions) if isinstance(regions, dict) else None
    if isinstance(file, dict):
        text, findings = written_automaton(file, names)
        return (None, findings) if findings else named_automaton(BY_HAND, text.encode(), names)
    try:
        content = read(file)
    except UnreadableError as error:
        hint = "name a file in the Hanoi Omega-Automata format, by its path relative to the mission file"
        return None, [Finding(AUTOMATON, f"{shortened(file)}: {error.message}", hint)]
    if len(content) > MAX_AUTOMATON_BYTES:
        message = f"{shortened(file)}: the file is larger than {MAX_AUTOMATON_BYTES} bytes"
        return None, [Finding(AUTOMATON, message, "an automaton of this size cannot be planned with")]
    return named_automaton(file, content, names)


def _content(path: Path) -> bytes:
    """The bytes of a file, one more than ``MAX_BYTES`` at most."""
    try:
        with path.open("rb") as file:
            return file.read(MAX_BYTES + 1)
    except FileNotFoundError:
        raise UnreadableError("there is no such file", "check the path") from None
    except IsADirectoryError:
        raise UnreadableError("this is a directory", "name a mission file in it") from None
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise UnreadableError(f"the file cannot be read: {reason}", "check the path and its permissions") from None


def _decoded(content: bytes) -> str:
    if len(content) > MAX_BYTES:
        message = f"the file is larger than {MAX_BYTES} bytes"
        raise SpecError((Fault(0, 0, "", message, "a mission of this size needs fewer nodes"),))
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = content[: error.start]
        line = before.count(b"\n") + 1
        column = len(before.rpartition(b"\n")[2].decode("utf-8", "replace")) + 1
        message = f"the byte 0x{content[error.start]:02x} is not UTF-8"
        raise SpecError((Fault(line, column, "", message, "save the file with the encoding UTF-8"),)) from None


def _bounded(faults: list[Fault]) -> tuple[Fault, ...]:
    if len(faults) <= MOST_FAULTS:
        return tuple(faults)
    message = f"the file has {len(faults)} faults; the first {MOST_FAULTS} are listed"
    return (Fault(0, 0, "", message, "correct these, then check again"), *faults[:MOST_FAULTS])
