"""Changes of a mission that another process hands in while it is flown, through files in the flight's folder.

A request is a file, an answer is one beside it; both are written whole, so that neither side ever reads a part of one,
and either may die at any time. Requests are answered in the order of their names; one that is not answered any more, as
the flight is over, is withdrawn by whoever looked for the answer too long, and told so.
"""

import json
import os
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from secrets import token_hex
from time import time_ns
from typing import Any, Final

import yaml

from mission.spec.document import document_of
from mission.spec.model import MissionSpec
from mission.whole_file import write_whole

GO_ON: Final = "go on"
"""The line that lets a vehicle that holds fly the old plan on."""

_REQUEST: Final = ".amendment.json"
_ANSWER: Final = ".answer.json"
_MOST_BYTES: Final = 1 << 24
_MOST_WAITING: Final = 8
"""Each takes a plan, one after the other: of more that come at once those that came last are refused."""


@dataclass(frozen=True)
class Amendment:
    """What is to be changed.

    Attributes:
        name: Tells it from others.
        lines: Changes, one a line; empty where there is a mission.
        mission: A whole mission file; empty where there are lines.
    """

    name: str
    lines: tuple[str, ...] = ()
    mission: str = ""


@dataclass(frozen=True)
class AmendmentAnswer:
    """What came of one.

    Attributes:
        accepted: Whether the flight goes on by it.
        words: What is to be said of it.
    """

    accepted: bool
    words: str


class AmendmentFolder:
    """The side of the flight."""

    def __init__(self, folder: Path) -> None:
        """Look for requests in a folder; those that were answered are not taken again by a flight that is taken up."""
        self._folder = folder
        answers = folder.glob("*" + _ANSWER)
        self._seen = {file.name.removesuffix(_ANSWER) + _REQUEST for file in answers}

    def take(self) -> Amendment | None:
        """The next request, if there is one that can be read."""
        try:
            with os.scandir(self._folder) as entries:
                names = sorted(entry.name for entry in entries if entry.name.endswith(_REQUEST))
        except OSError:
            return None
        waiting = [name for name in names if name not in self._seen]
        for name in waiting[_MOST_WAITING:]:
            self._seen.add(name)
            words = f"{_MOST_WAITING} changes wait already; hand it in again once they are answered"
            self.answer(Amendment(name.removesuffix(_REQUEST)), AmendmentAnswer(accepted=False, words=words))
        if not waiting:
            return None
        self._seen.add(waiting[0])
        return self._read(waiting[0])

    def answer(self, amendment: Amendment, answer: AmendmentAnswer) -> None:
        """Answer a request; an answer that cannot be written is missed by nobody in flight."""
        text = json.dumps({"accepted": answer.accepted, "words": answer.words})
        try:
            write_whole(self._folder / (amendment.name + _ANSWER), text, durable=False)
        except OSError:
            return

    def keep(self, number: int, mission: MissionSpec) -> None:
        """Keep a mission that was amended, with the number of its plan, which holds it in any case."""
        text = yaml.safe_dump(document_of(mission), sort_keys=False, allow_unicode=True)
        try:
            write_whole(self._folder / amended_file(number), text, durable=False)
        except OSError:
            return

    def _read(self, name: str) -> Amendment | None:
        found = Amendment(name.removesuffix(_REQUEST))
        try:
            data = _json(self._folder / name)
            lines = tuple(str(line) for line in data.get("lines", ()))
            return Amendment(found.name, lines, str(data.get("mission", "")))
        except (OSError, ValueError, AttributeError, TypeError, RecursionError):
            self.answer(found, AmendmentAnswer(accepted=False, words="the request cannot be read"))
            return None


def amended_file(number: int) -> str:
    """The name of a mission that was amended in flight, by the number of its plan."""
    return f"mission-{number}.yaml"


def hand_in(folder: Path, *, lines: Sequence[str] = (), mission: str = "") -> str:
    """Hand in a request; returns its name, by which the answer is found.

    Raises:
        OSError: The folder cannot be written to.
    """
    name = f"{time_ns():020d}-{token_hex(4)}"
    text = json.dumps({"lines": list(lines), "mission": mission})
    write_whole(folder / (name + _REQUEST), text, durable=False)
    return name


def withdraw(folder: Path, name: str) -> None:
    """Take a request back that nobody waits for any more, so that no later flight in the folder takes it."""
    with suppress(OSError):
        (folder / (name + _REQUEST)).unlink(missing_ok=True)


def answer_to(folder: Path, name: str) -> AmendmentAnswer | None:
    """The answer to a request, once there is one.

    Raises:
        OSError: It cannot be read.
    """
    file = folder / (name + _ANSWER)
    if not file.is_file():
        return None
    data = _json(file)
    return AmendmentAnswer(bool(data["accepted"]), str(data["words"]))


def _json(file: Path) -> Any:  # noqa: ANN401 - whatever JSON holds
    with file.open("rb") as stream:
        content = stream.read(_MOST_BYTES + 1)
    if len(content) > _MOST_BYTES:
        raise ValueError(f"{file.name} is too large")
    return json.loads(content)
