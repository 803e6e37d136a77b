"""The formula that a mission is planned by: its own, its tasks, and what becomes of tasks that may be dropped.

Which tasks to drop is found exactly, as a hitting set: a conflict is a least set of soft tasks that cannot all be met,
so of each conflict one task must go, and the cheapest set that hits every conflict known so far is tried next. Where
the tasks that it leaves can be met, nothing cheaper can do; otherwise they contain a further conflict.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import combinations

from mission.errors import NoPlanError
from mission.logic.formula.syntax import Formula
from mission.spec.model import MissionSpec
from mission.spec.specification import formula_of
from mission.spec.tasks import task_text

Refusal = NoPlanError | None
"""Why a formula has no run; None where it has one."""

Numbers = frozenset[int]
"""Tasks by their places in the file, from 0."""


@dataclass(frozen=True)
class DroppedTask:
    """A soft task that is not met.

    Attributes:
        number: Its place in the file's list, from 0.
        task: As it is written there.
        weight: What is lost with it.
        reason: Why it cannot be met.
    """

    number: int
    task: str
    weight: float
    reason: str


def dropped_tasks(
    spec: MissionSpec,
    refusal: Callable[[Formula], Refusal],
    explained: Callable[[NoPlanError, MissionSpec], NoPlanError] = lambda error, _: error,
) -> tuple[DroppedTask, ...]:
    """Find the soft tasks to drop: of the least total weight; then as few as possible; then the last in the file.

    Args:
        spec: The mission.
        refusal: Why there is no run of a formula, or None where there is one.
        explained: The same in better words, of a mission that has no run.

    Returns:
        What was dropped, in the order of the file; every soft task where not even the others can be met.
    """
    soft = {i: Fraction(task.weight) for i, task in enumerate(spec.tasks) if task.weight is not None}
    known: dict[Numbers, Refusal] = {}

    def refused(kept: Numbers) -> Refusal:
        if kept not in known:
            known[kept] = refusal(formula_of(spec, soft.keys() - kept))
        return known[kept]

    def said(conflict: Numbers) -> str:
        error = refused(conflict)
        if error is None:
            return ""
        # In the conflict alone, all its tasks must be met.
        tasks = (task for i, task in enumerate(spec.tasks) if i in conflict or i not in soft)
        must = replace(spec, tasks=tuple(replace(task, weight=None) for task in tasks))
        return str(explained(error, must)).splitlines()[0].rstrip(":")

    everything = frozenset(soft)
    if not soft or not refused(everything):
        return ()
    if refused(frozenset()):
        return tuple(_reported(spec, i, everything, [everything], said) for i in sorted(everything))
    candidates = sorted(
        (frozenset(chosen) for size in range(len(soft) + 1) for chosen in combinations(sorted(soft), size)),
        key=lambda chosen: (sum(soft[i] for i in chosen), len(chosen), sorted(-i for i in chosen)),
    )
    conflicts: list[Numbers] = []
    dropped: Numbers = frozenset()
    while refused(everything - dropped):
        conflicts.append(_least(everything - dropped, refused))
        dropped = next(chosen for chosen in candidates if all(chosen & conflict for conflict in conflicts))
    return tuple(_reported(spec, i, dropped, conflicts, said) for i in sorted(dropped))


def _least(conflict: Numbers, refused: Callable[[Numbers], Refusal]) -> Numbers:
    """A part of a conflict that is one, too, and no longer when any task is taken out."""
    for i in sorted(conflict, reverse=True):
        if refused(conflict - {i}):
            conflict -= {i}
    return conflict


def _reported(
    spec: MissionSpec,
    number: int,
    dropped: Numbers,
    conflicts: list[Numbers],
    said: Callable[[Numbers], str],
) -> DroppedTask:
    """Why one task was dropped: the conflict that no other dropped task hits, or else the smallest that it is in."""
    own = [conflict for conflict in conflicts if number in conflict]
    conflict = min(own, key=lambda conflict: (len(conflict & dropped), len(conflict), sorted(conflict)))
    others = [task_text(spec.tasks[i]) for i in sorted(conflict - {number})]
    beside = f"together with {' and '.join(others)}, " if others else ""
    task = spec.tasks[number]
    return DroppedTask(number, task_text(task), task.weight or 0.0, f"{beside}{said(conflict)}")
