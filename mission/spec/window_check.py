"""What may be wrong with regions that are there for a time only."""

from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import Any, Final

from mission.errors import FormulaSyntaxError
from mission.logic.formula.conjuncts import conjuncts
from mission.logic.formula.operators import Operator
from mission.logic.formula.parser import parse_timed_formula
from mission.logic.formula.syntax import postorder, propositions
from mission.spec.finding import Finding, Path, is_clean, shortened
from mission.spec.model import NamedAutomaton

_FORMULA: Final[Path] = ("mission", "formula")
_AUTOMATON: Final[Path] = ("mission", "automaton")


def window_findings(data: Any, structural: list[Finding]) -> Iterator[Finding]:  # noqa: ANN401 - any JSON value
    """Faults of times that fit the schema.

    Args:
        data: The file's data.
        structural: What was found against the schema.
    """
    regions: Any = data.get("regions") if isinstance(data, dict) else None
    windows = {name: each for name, each in _windows(regions) if is_clean(("regions", name, "active_s"), structural)}
    for name, (begin_s, end_s) in windows.items():
        path = ("regions", name, "active_s")
        if begin_s is None and end_s is None:
            yield Finding(path, f"`{shortened(name)}` would be there all the time", "leave `active_s` out")
        elif begin_s is not None and end_s is not None and begin_s >= end_s:
            yield Finding(path, f"{begin_s} to {end_s} s is no time", "write two numbers of seconds, the smaller first")
        if "cover" in regions[name]:
            hint = "take `active_s` away; what is to be covered by a time is asked for with `by_s`"
            yield Finding(path, f"`{shortened(name)}` is covered lane by lane, whenever that is", hint, at_key=True)
    if windows and is_clean(_FORMULA, structural) and "formula" in data.get("mission", {}):
        yield from _of_formula(data["mission"]["formula"], windows, frozenset(regions))


def of_automaton(given: NamedAutomaton | None, regions: Any) -> Iterator[Finding]:  # noqa: ANN401 - any JSON value
    """Regions that are there for a time only, of which an automaton reads."""
    for name in [] if given is None else sorted(dict(_windows(regions)).keys() & set(given.automaton.propositions)):
        message = f"the automaton speaks of `{shortened(name)}`, which is there for a time only: it reads no clock"
        yield Finding(_AUTOMATON, message, f"take `active_s` away from `{shortened(name)}`, or use a formula or tasks")


def _windows(regions: Any) -> Iterator[tuple[str, Any]]:  # noqa: ANN401 - any JSON value
    for name, value in regions.items() if isinstance(regions, dict) else ():
        if isinstance(value, dict) and "active_s" in value:
            yield name, value["active_s"]


def _of_formula(text: str, windows: Mapping[str, Any], names: frozenset[str]) -> Iterator[Finding]:
    """A conjunct that counts triangles, and speaks of what is there for a time only."""
    with suppress(FormulaSyntaxError):  # which is a finding of the formula's own
        for part in conjuncts(parse_timed_formula(text, names)):
            spoken = sorted(propositions(part) & windows.keys())
            if spoken and any(node.operator is Operator.NEXT for node in postorder(part)):
                message = f"X counts triangles, and `{shortened(spoken[0])}` is there for a time only"
                yield Finding(_FORMULA, message, "say it without X, or take `active_s` away")
