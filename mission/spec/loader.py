"""Mission files, read strictly: every fault of a file is reported, all at once, each with its line and path.

The way of a file: bytes -> text -> tree with positions (``yaml_tree``) -> plain data -> against the schema
(``structure``) -> its meaning, where the structure is sound (``check``) -> frozen values (``values``).
"""

from pathlib import Path

from mission.errors import Fault, SpecError
from mission.spec.check import meaning_findings
from mission.spec.model import MissionSpec
from mission.spec.placing import placed
from mission.spec.structure import MOST_ERRORS, plain_data, structure_findings
from mission.spec.values import mission_of
from mission.spec.yaml_tree import MAX_BYTES, read_tree

MOST_FAULTS = 100
"""As many faults are listed; the rest is counted."""


def load_mission(path: str | Path) -> MissionSpec:
    """Read a mission file.

    Raises:
        SpecError: If the file cannot be read, or with every fault that it has.
    """
    source = str(path)
    try:
        with Path(path).open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except FileNotFoundError:
        fault = Fault(0, 0, "", "there is no such file", "check the path")
    except IsADirectoryError:
        fault = Fault(0, 0, "", "this is a directory", "name a mission file in it")
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        fault = Fault(0, 0, "", f"the file cannot be read: {reason}", "check the path and its permissions")
    else:
        return parse_mission(content, source)
    raise SpecError((fault,), source)


def parse_mission(content: bytes, source: str = "") -> MissionSpec:
    """Read the content of a mission file.

    Args:
        content: The bytes of the file.
        source: Where they come from, for messages and for the name of a mission that gives itself none.

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
    if len(findings) < MOST_ERRORS:
        findings.extend(meaning_findings(data, findings))
    faults.extend(placed(finding, tree, text) for finding in findings)
    if faults:
        raise SpecError(_bounded(sorted(set(faults))), source)
    return mission_of(data, Path(source).stem.encode("utf-8", "replace").decode() or "mission")


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
