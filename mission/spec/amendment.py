"""Changes of a mission in words: a region more or less, another formula, other laps. Each gives another whole mission.

=============================  ========================================================================================
line                           what it does
=============================  ========================================================================================
``restrict NAME SHAPE``        adds a restricted region; SHAPE is a list of corners, or a mapping as in a mission file
``drop NAME``                  takes a region away
``formula FORMULA``            asks for this from now on, instead of formula, tasks and automaton
``laps N``                     how often the loop is flown in all, or ``until_stopped``
=============================  ========================================================================================
"""

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, Final

from mission.errors import Fault, SpecError
from mission.spec.document import document_of
from mission.spec.loader import parse_mission
from mission.spec.model import UNTIL_STOPPED, MissionSpec, Point
from mission.spec.scalars import Oddity
from mission.spec.structure import plain_data
from mission.spec.yaml_tree import read_tree

MOST_LINES: Final = 100
MOST_CHARACTERS: Final = 100_000
_MOST_DIGITS: Final = 20
_HINT: Final = "write `restrict NAME [[x, y], ...]`, `drop NAME`, `formula FORMULA` or `laps N`"

_Document = dict[str, Any]


def amended(spec: MissionSpec, lines: Sequence[str], place_m: Point) -> MissionSpec:
    """A mission with changes, one a line, that is begun where the vehicle is.

    Raises:
        SpecError: A line is none of these, or the mission would have faults.
    """
    text = "" if spec.automaton is None else spec.automaton.text
    return parse_mission(amended_text(spec, lines, place_m), read=lambda _: text.encode())


def amended_text(spec: MissionSpec, lines: Sequence[str], place_m: Point) -> bytes:
    """The same as a file, which may have faults.

    Raises:
        SpecError: A line is no change.
    """
    if len(lines) > MOST_LINES or sum(map(len, lines)) > MOST_CHARACTERS:
        raise SpecError((Fault(0, 0, "", f"these are more than {MOST_LINES} lines, or too long ones"),))
    document = document_of(spec)
    document["start"]["position_m"] = list(place_m)
    for number, line in enumerate(lines, 1):
        word, _, rest = line.strip().partition(" ")
        change = _CHANGES.get(word)
        if change is None:
            raise _fault(number, f"`{word}` is no change of a mission")
        change(document, rest.strip(), number)
    return json.dumps(document).encode()


def asking_for(spec: MissionSpec, other: MissionSpec) -> MissionSpec:
    """A mission that asks for what another one asks for, formula, tasks and automaton."""
    return replace(spec, formula=other.formula, tasks=other.tasks, automaton=other.automaton, semantics=other.semantics)


def asks_the_same(one: MissionSpec, other: MissionSpec) -> bool:
    """Whether two missions have the same formula, tasks and automaton."""
    return (one.formula, one.tasks, one.automaton) == (other.formula, other.tasks, other.automaton)


def _restrict(document: _Document, rest: str, line: int) -> None:
    name, drawn = _named(rest)
    if name in document["regions"]:
        raise _fault(line, f"there is a region `{name}` already", "take another name, or drop that first")
    shape = _shape(drawn, line) if drawn.strip() else None
    if not isinstance(shape, list | dict):
        raise _fault(line, "a region has a name and a shape")
    drawn_as = {"polygon": shape} if isinstance(shape, list) else shape
    document["regions"][name] = {**drawn_as, "kind": "restricted"}


def _shape(drawn: str, line: int) -> Any:  # noqa: ANN401 - any JSON value
    """A shape as plain data, read as strictly as a mission file, and as bounded."""

    def refused(oddity: Oddity) -> None:
        raise _fault(line, f"in a shape there is {oddity.found}", oddity.hint)

    data, _ = plain_data(read_tree(drawn)[0])
    return json.loads(json.dumps(data, default=refused))


def _named(rest: str) -> tuple[str, str]:
    """A name, in double quotes where there are spaces in it, and what comes after it."""
    name, _, after = rest[1:].partition('"') if rest.startswith('"') else rest.partition(" ")
    return name, after


def _drop(document: _Document, rest: str, line: int) -> None:
    name, after = _named(rest)
    if after.strip():
        raise _fault(line, f"after the region there is `{after.strip()}`", "put a name with spaces in double quotes")
    if document["regions"].pop(name, None) is None:
        raise _fault(line, f"there is no region `{name}`", f"there are {', '.join(document['regions'])}")


def _ask(document: _Document, formula: str, line: int) -> None:
    if not formula:
        raise _fault(line, "there is no formula")
    document["mission"]["formula"] = formula
    document["mission"].pop("automaton", None)
    document.pop("tasks", None)


def _count(document: _Document, laps: str, line: int) -> None:
    if laps != UNTIL_STOPPED and not (laps.isdecimal() and len(laps) <= _MOST_DIGITS):
        raise _fault(line, f"`{laps[:_MOST_DIGITS]}` is no number of laps", f"write a whole number, or {UNTIL_STOPPED}")
    document["mission"]["laps"] = laps if laps == UNTIL_STOPPED else int(laps)


_CHANGES: Final[dict[str, Callable[[_Document, str, int], None]]] = {
    "restrict": _restrict,
    "drop": _drop,
    "formula": _ask,
    "laps": _count,
}


def _fault(line: int, message: str, hint: str = _HINT) -> SpecError:
    return SpecError((Fault(line, 1, "", message, hint),))
