"""Reading a vehicle's parameters by name, several at a time: https://mavlink.io/en/services/parameter.html.

A vehicle answers PARAM_REQUEST_READ with PARAM_VALUE, and says nothing of a name that it does not have; so each name is
asked for again, a few times, and what has not come then is not known. Versions of one autopilot call the same thing by
other names: as soon as one of them has come, the others are let go of.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mission.link.values import ParameterValue

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

_AT_ONCE: Final = 8
_PACE_S: Final = 0.1
"""So many names are asked for in so short a time, and no more: ArduPilot keeps twenty requests and drops the rest."""

_AGAIN_S: Final = 0.7
_ATTEMPTS: Final = 6


@dataclass
class _Wanted:
    """One parameter under all its names; times of the clock here."""

    names: tuple[str, ...]
    attempts: int = 0
    asked_s: float = -float("inf")


class ParameterReading:
    """What was asked for and what has come; times are of the clock here.

    Attributes:
        wanted: What to ask for, by the name of the autopilot: each parameter under all names that it may have.
        values: What has come, as it was sent, by name.
    """

    def __init__(self) -> None:
        """Want nothing yet."""
        self.wanted: Mapping[str, Iterable[tuple[str, ...]]] = {}
        self.values: dict[str, ParameterValue] = {}
        self._wanted: list[_Wanted] = []
        self._paced_s = -float("inf")

    def begin(self, autopilot: str) -> None:
        """Ask for what is wanted of this autopilot."""
        self._wanted = [_Wanted(names) for names in self.wanted.get(autopilot, ())]

    def take(self, body: ParameterValue) -> None:
        """Take note of a value, whoever asked for it."""
        self.values[body.name] = body
        self._wanted = [wanted for wanted in self._wanted if body.name not in wanted.names]

    def due(self, now_s: float) -> list[str]:
        """The names to ask for now."""
        if not self._wanted or now_s - self._paced_s < _PACE_S:
            return []
        self._wanted = [w for w in self._wanted if w.attempts < _ATTEMPTS or now_s - w.asked_s < _AGAIN_S]
        due: list[str] = []
        for wanted in self._wanted:
            if len(due) >= _AT_ONCE:
                break
            if wanted.attempts < _ATTEMPTS and now_s - wanted.asked_s >= _AGAIN_S:
                wanted.attempts, wanted.asked_s, self._paced_s = wanted.attempts + 1, now_s, now_s
                due += wanted.names
        return due

    @property
    def complete(self) -> bool:
        """Whether all has come, or will not."""
        return not self._wanted
