"""Tasks between their three forms: the data of a file, frozen values, and formulas."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any, Final

from mission.decimals import decimal
from mission.logic.formula import patterns
from mission.logic.formula.syntax import (
    Formula,
    always,
    conjunction,
    eventually,
    implication,
    negation,
    proposition,
    until,
)
from mission.logic.timed.rewriting import untimed
from mission.spec.model import Region, RegionKind
from mission.spec.task import BOUND_KEYS, EVERY, Task, TaskKind, TaskMode
from mission.spec.windows import as_there

Data = dict[str, Any]

_OF_LIST: Final[Mapping[TaskKind, Callable[[Sequence[str]], Formula]]] = {
    TaskKind.VISIT: patterns.visit,
    TaskKind.SEQUENCED_VISIT: patterns.sequenced_visit,
    TaskKind.ORDERED_VISIT: patterns.ordered_visit,
    TaskKind.PATROL: patterns.patrol,
    TaskKind.SEQUENCED_PATROL: patterns.sequenced_patrol,
    TaskKind.AVOID: patterns.avoid,
}

_OF_VISITS: Final[Mapping[TaskKind, Callable[[Sequence[str], Sequence[str]], Formula]]] = {
    TaskKind.STRICT_ORDERED_VISIT: patterns.strict_ordered_visit,
    TaskKind.FAIR_VISIT: patterns.fair_visit,
    TaskKind.ORDERED_PATROL: patterns.ordered_patrol,
    TaskKind.STRICT_ORDERED_PATROL: patterns.strict_ordered_patrol,
    TaskKind.FAIR_PATROL: patterns.fair_patrol,
}

_OF_COUNT: Final[Mapping[TaskMode, Callable[[str, int, Sequence[str]], Formula]]] = {
    TaskMode.AT_MOST: patterns.visits_at_most,
    TaskMode.AT_LEAST: patterns.visits_at_least,
    TaskMode.EXACTLY: patterns.visits_exactly,
}

_OF_PAIR: Final[Mapping[tuple[TaskKind, TaskMode], Callable[[str, str], Formula]]] = {
    (TaskKind.AVOID, TaskMode.UNTIL): patterns.avoid_until,
    (TaskKind.AVOID, TaskMode.AFTER): patterns.avoid_after,
    (TaskKind.WAIT, TaskMode.PLAIN): patterns.wait,
    (TaskKind.REACT, TaskMode.INSTANTANEOUS): patterns.instantaneous_reaction,
    (TaskKind.REACT, TaskMode.DELAYED): patterns.delayed_reaction,
    (TaskKind.REACT, TaskMode.BOUND): patterns.bound_reaction,
}

_OF_NEXT: Final[Mapping[TaskMode, Callable[[str, str, Sequence[str]], Formula]]] = {
    TaskMode.PROMPT: patterns.prompt_reaction,
    TaskMode.BOUND_DELAY: patterns.bound_delay,
}


def task_formula(task: Task, regions: Sequence[Region]) -> Formula:
    """What a task asks for, as far as that can be said without seconds.

    Args:
        task: The task.
        regions: The mission's; a visit ends where the vehicle comes to another of them (to restricted ones it never
            comes).
    """
    formula = as_there(_whole_formula(task, regions), regions)
    return untimed(formula) if formula.timed else formula


def _whole_formula(task: Task, regions: Sequence[Region]) -> Formula:
    """What a task asks for, wherever regions are there all the time."""
    places = [region.name for region in regions if region.kind is not RegionKind.RESTRICTED]
    if task.kind is TaskKind.VISITS:
        return _OF_COUNT[task.mode](task.regions[0], task.count, places)
    if task.kind in _OF_VISITS:
        return _OF_VISITS[task.kind](task.regions, places)
    if task.mode is TaskMode.PLAIN and task.kind in _OF_LIST:
        return _OF_LIST[task.kind](task.regions)
    first, second = task.regions
    if task.mode in _OF_NEXT:
        return _OF_NEXT[task.mode](first, second, places)
    return _OF_PAIR[task.kind, task.mode](first, second)


def timed_formula(task: Task, regions: Sequence[Region]) -> Formula | None:
    """What a task asks for in time, beside ``task_formula``; None where it has no bound.

    By when: ``F[0,s] a`` of each region, or the ``U`` of the formula with this bound. Within: ``G (a -> F[0,s] b)``.
    Every: ``G (a -> G F[0,s] a)``, from the first visit on. All of it has bounds where it speaks of a region that is
    there for a time only.
    """
    whole = as_there(_whole_formula(task, regions), regions)
    bound = () if task.bound_s is None else (as_there(_bound_formula(task, task.bound_s), regions),)
    parts = (*([whole] if whole.timed else []), *bound)
    return conjunction(*parts) if parts else None


def _bound_formula(task: Task, bound_s: float) -> Formula:
    bounds = Fraction(0), Fraction(decimal(bound_s))
    places = [proposition(name) for name in task.regions]
    if task.kind is TaskKind.WAIT:
        return until(places[0], places[1], bounds)
    if task.kind is TaskKind.AVOID:
        return until(negation(places[0]), places[1], bounds)
    if task.kind is TaskKind.REACT:
        return always(implication(places[0], eventually(places[1], bounds)))
    if BOUND_KEYS[task.kind] == EVERY:
        return conjunction(*(always(implication(place, always(eventually(place, bounds)))) for place in places))
    return conjunction(*(eventually(place, bounds) for place in places))


def task_of(data: Data) -> Task:
    """The task of an entry that fits the schema."""
    kind = TaskKind(next(key for key in data if key in set(TaskKind)))
    weight, bound_s = (data.get(key) for key in ("weight", BOUND_KEYS.get(kind, "")))
    return replace(
        _kind_of(kind, data[kind]),
        weight=None if weight is None else float(weight),
        bound_s=None if bound_s is None else float(bound_s),
    )


def _kind_of(kind: TaskKind, value: Any) -> Task:  # noqa: ANN401 - any of its shapes
    """What is asked for by one key of an entry."""
    if isinstance(value, str):
        return Task(kind, (value,))
    if isinstance(value, list):
        return Task(kind, tuple(value))
    if kind is TaskKind.WAIT:
        return Task(kind, (value["in"], value["until"]))
    if kind is TaskKind.REACT:
        return Task(kind, (value["when"], value["then"]), TaskMode(value.get("how", "delayed")))
    mode = TaskMode(next(key for key in value if key != "region"))
    if kind is TaskKind.VISITS:
        return Task(kind, (value["region"],), mode, int(value[mode]))
    return Task(kind, (value["region"], value[mode]), mode)


def task_data(task: Task) -> Data:
    """The entry of a file that is read as this task."""
    value: Any = list(task.regions)
    if task.kind is TaskKind.VISITS:
        value = {"region": task.regions[0], task.mode.value: task.count}
    elif task.kind is TaskKind.WAIT:
        value = {"in": task.regions[0], "until": task.regions[1]}
    elif task.kind is TaskKind.REACT:
        value = {"when": task.regions[0], "then": task.regions[1], "how": task.mode.value}
    elif task.mode is not TaskMode.PLAIN:
        value = {"region": task.regions[0], task.mode.value: task.regions[1]}
    bound = {} if task.bound_s is None else {BOUND_KEYS[task.kind]: task.bound_s}
    return {task.kind.value: value} | bound | ({} if task.weight is None else {"weight": task.weight})


def task_text(task: Task) -> str:
    """A task as it would be written on one line, without its weight: ``ordered_visit [S1, S2], by_s: 120``."""
    data = task_data(task)
    key, value = task.kind.value, data[task.kind.value]
    bound = "" if task.bound_s is None else f", {BOUND_KEYS[task.kind]}: {decimal(task.bound_s)}"
    if isinstance(value, list):
        return (f"{key} {value[0]}" if len(value) == 1 else f"{key} [{', '.join(value)}]") + bound
    return f"{key} {{{', '.join(f'{name}: {what}' for name, what in value.items())}}}{bound}"
