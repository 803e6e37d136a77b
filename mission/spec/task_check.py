"""What may be wrong with tasks that fit the schema."""

from collections.abc import Iterator, Mapping
from typing import Any, Final

from mission.spec.finding import Finding, Path, rather, shortened
from mission.spec.task import BOUND_KEYS, BY, EVERY, UNBOUND_MODES, WITHIN, TaskKind, TaskMode
from mission.spec.task_schema import MOST_SOFT_TASKS

_INSTEAD: Final = {
    TaskKind.SEQUENCED_VISIT: "write `ordered_visit`, which is done with the first visit of its last region, or a "
    "formula with bounds from each visit to the next, such as F[0,60] (S1 & F[0,60] S2)"
}
"""What to write for a bound of a task that has none; when a sequence is done no formula over times to come tells."""

_ENTERED: Final = frozenset({"until", "then", "in"})


def task_findings(number: int, task: dict[str, Any], kinds: Mapping[str, str]) -> list[Finding]:
    """Faults of one task.

    Args:
        number: Its place in the list, from 0.
        task: Its data, which fits the schema.
        kinds: The kind of each region, by name.
    """
    findings = []
    named = list(_named(task, ("tasks", number)))
    for path, name, entered in named:
        if name not in kinds:
            hint = rather(name, sorted(kinds), "regions")
            findings.append(Finding(path, f"the task speaks of `{shortened(name)}`, which is no region", hint))
        elif entered and kinds[name] == "restricted":
            message = f"the task asks to enter `{name}`, which is restricted and so never entered"
            findings.append(Finding(path, message, "name another region, or make it one to survey"))
    kind = next(kind for kind in TaskKind if kind in task)
    findings += _bound_findings(number, task, kind)
    if isinstance(task[kind], dict) and len(named) > 1 and named[0][1] == named[1][1]:
        message = f"the task relates `{shortened(named[0][1])}` to itself"
        findings.append(Finding(named[1][0], message, "name two different regions"))
    return findings


def _bound_findings(number: int, task: dict[str, Any], kind: TaskKind) -> list[Finding]:
    """A bound in seconds that the kind of task has not."""
    value, allowed = task[kind], BOUND_KEYS.get(kind, "")
    if kind is TaskKind.AVOID and not (isinstance(value, dict) and "until" in value):
        allowed = ""
    if kind is TaskKind.REACT and (kind, TaskMode(value.get("how", "delayed"))) in UNBOUND_MODES:
        allowed = ""
    instead = _INSTEAD.get(kind, "take it away, or say it by a formula with bounds, such as F[0,120] S1")
    hint = f"write `{allowed}`" if allowed else instead
    return [
        Finding(("tasks", number, key), f"a task of this form, `{kind}`, has no `{key}`", hint)
        for key in (BY, WITHIN, EVERY)
        if key in task and key != allowed
    ]


def weight_findings(tasks: list[Any]) -> list[Finding]:
    """Whether more tasks are soft than can be weighed against each other."""
    soft = [i for i, task in enumerate(tasks) if isinstance(task, dict) and "weight" in task]
    if len(soft) <= MOST_SOFT_TASKS:
        return []
    message = f"{len(soft)} tasks carry a weight, more than {MOST_SOFT_TASKS}"
    hint = "take the weight off those that must be met, or join tasks that are met or dropped together"
    return [Finding(("tasks", soft[MOST_SOFT_TASKS], "weight"), message, hint)]


def _named(task: dict[str, Any], at: Path) -> Iterator[tuple[Path, str, bool]]:
    """The regions that a task names, each with its path and with whether the task asks to enter it."""
    for key, value in task.items():
        path = (*at, key)
        if isinstance(value, str):
            yield path, value, key != "avoid"
        elif isinstance(value, list):
            yield from (((*path, i), name, key != "avoid") for i, name in enumerate(value))
        elif isinstance(value, dict):
            counted = "at_least" in value or "exactly" in value
            for name, what in value.items():
                if isinstance(what, str) and name != "how":
                    # A reaction is asked for only when its stimulus comes, but one that cannot come is a slip.
                    yield (*path, name), what, name in _ENTERED or counted
