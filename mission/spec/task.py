"""Tasks of a mission, which stand for formulas; their meaning is in ``mission.logic.formula.patterns``."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Final


class TaskKind(StrEnum):
    """What a task asks for, by its key in the file; the meaning of each is in ``mission.logic.formula.patterns``."""

    VISIT = "visit"
    SEQUENCED_VISIT = "sequenced_visit"
    ORDERED_VISIT = "ordered_visit"
    STRICT_ORDERED_VISIT = "strict_ordered_visit"
    FAIR_VISIT = "fair_visit"
    PATROL = "patrol"
    SEQUENCED_PATROL = "sequenced_patrol"
    ORDERED_PATROL = "ordered_patrol"
    STRICT_ORDERED_PATROL = "strict_ordered_patrol"
    FAIR_PATROL = "fair_patrol"
    AVOID = "avoid"
    VISITS = "visits"
    WAIT = "wait"
    REACT = "react"


class TaskMode(StrEnum):
    """Which form of ``avoid`` (until, after), of ``visits`` (the bounds) or of ``react`` (the five reactions)."""

    PLAIN = ""
    UNTIL = "until"
    AFTER = "after"
    AT_MOST = "at_most"
    AT_LEAST = "at_least"
    EXACTLY = "exactly"
    INSTANTANEOUS = "instantaneous"
    DELAYED = "delayed"
    PROMPT = "prompt"
    BOUND = "bound"
    BOUND_DELAY = "bound_delay"


BY: Final = "by_s"
WITHIN: Final = "within_s"
EVERY: Final = "every_s"

BOUND_KEYS: Final[Mapping[TaskKind, str]] = {
    TaskKind.VISIT: BY,
    TaskKind.ORDERED_VISIT: BY,
    TaskKind.STRICT_ORDERED_VISIT: BY,
    TaskKind.FAIR_VISIT: BY,
    TaskKind.WAIT: BY,
    TaskKind.AVOID: BY,
    TaskKind.REACT: WITHIN,
    TaskKind.PATROL: EVERY,
    TaskKind.SEQUENCED_PATROL: EVERY,
    TaskKind.ORDERED_PATROL: EVERY,
    TaskKind.STRICT_ORDERED_PATROL: EVERY,
    TaskKind.FAIR_PATROL: EVERY,
}
"""Kinds of tasks that may carry a bound in seconds, with its key: by when, how long after its trigger, how often."""

UNBOUND_MODES: Final = frozenset(
    {(TaskKind.AVOID, TaskMode.PLAIN), (TaskKind.AVOID, TaskMode.AFTER)}
    | {(TaskKind.REACT, TaskMode.INSTANTANEOUS), (TaskKind.REACT, TaskMode.BOUND)}
)
"""Forms of them that may not: nothing is to come, or it comes at once."""


@dataclass(frozen=True)
class Task:
    """One entry of ``tasks``.

    Attributes:
        kind: What it asks for.
        regions: Names, in the order of the list; of ``avoid`` with until or after, ``wait`` and ``react`` the region
            that is avoided, waited in or reacted to, then the other one.
        mode: Its form, where the kind has several.
        count: The number of visits of ``visits``; 0 otherwise.
        weight: How much is lost where it is dropped, above 0; None where it must be met.
        bound_s: Within how many seconds, by the key that ``BOUND_KEYS`` has of its kind; None where any time will do.
    """

    kind: TaskKind
    regions: tuple[str, ...]
    mode: TaskMode = TaskMode.PLAIN
    count: int = 0
    weight: float | None = None
    bound_s: float | None = None
