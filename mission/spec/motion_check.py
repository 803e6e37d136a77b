"""What may be wrong with regions and nodes that move, before the mesh is looked at."""

from collections.abc import Iterator
from contextlib import suppress
from typing import Any, Final

from mission.errors import FormulaSyntaxError
from mission.logic.formula.operators import Operator
from mission.logic.formula.parser import parse_timed_formula
from mission.logic.formula.syntax import postorder
from mission.spec.finding import Finding, Path, is_clean, shortened
from mission.spec.model import FIELD
from mission.spec.motion import motion_fault

_FORMULA: Final[Path] = ("mission", "formula")
_STANDS_STILL: Final = {
    "active_s": "is there for a time only, and moves",
    "cover": "is covered lane by lane, and moves",
    "speed_m_s": "has a speed of its own, and moves",
    "at": "is the triangle at a point, and moves",
}
"""Keys of a region that do not go with ``motion``, and what it would be."""


def motion_findings(data: Any, structural: list[Finding]) -> Iterator[Finding]:  # noqa: ANN401 - any JSON value
    """Faults of motions that fit the schema.

    Args:
        data: The file's data.
        structural: What was found against the schema.
    """
    if not isinstance(data, dict):
        return
    moved = list(_motions(data, structural))
    for path, motion in moved:
        fault = motion_fault(motion)
        if fault is not None:
            yield Finding(path, *fault)
    for (section, name, *_), _ in moved:
        for key, what in _STANDS_STILL.items() if section == "regions" else ():
            if key in data["regions"][name]:
                hint = f"take `motion` away, or `{key}`" if key != "at" else "draw it, or name its nodes"
                yield Finding((section, name, key), f"`{shortened(str(name))}` {what}", hint, at_key=True)
    if moved and is_clean(("mission",), structural):
        yield from _of_what_is_asked(data.get("mission", {}), data.get("regions"))
    if moved:
        yield from _of_what_is_planned_in_flight(data)


def _motions(data: dict[str, Any], structural: list[Finding]) -> Iterator[tuple[Path, dict[str, Any]]]:
    """The motions whose keys fit, each with its path."""
    regions, domain = data.get("regions"), data.get("domain")
    of_regions = regions.items() if isinstance(regions, dict) else ()
    found: list[tuple[Path, Any]] = [
        (("regions", name, "motion"), value["motion"])
        for name, value in of_regions
        if isinstance(value, dict) and "motion" in value
    ]
    of_nodes = domain.get("motions") if isinstance(domain, dict) else None
    if isinstance(of_nodes, list):
        found += [(("domain", "motions", i), motion) for i, motion in enumerate(of_nodes)]
    yield from ((path, motion) for path, motion in found if is_clean(path, structural))


def _of_what_is_asked(mission: Any, regions: Any) -> Iterator[Finding]:  # noqa: ANN401 - any JSON value
    """What counts triangles, where these move."""
    if "automaton" in mission:
        message = "an automaton reads triangles one by one, and here some move"
        yield Finding(("mission", "automaton"), message, "use a formula or tasks, or take `motion` away")
    with suppress(FormulaSyntaxError):  # which is a finding of the formula's own
        names = frozenset(regions) if isinstance(regions, dict) else frozenset[str]()
        parsed = parse_timed_formula(mission.get("formula", "true"), names)
        if any(node.operator is Operator.NEXT for node in postorder(parsed)):
            message = "X counts triangles, and here some move"
            yield Finding(_FORMULA, message, "say it without X, or take `motion` away")


def _of_what_is_planned_in_flight(data: dict[str, Any]) -> Iterator[Finding]:
    """What asks for plans while the mission is flown."""
    flight, hint = data.get("flight"), "take `{}` away, or `motion`"
    if isinstance(flight, dict) and flight.get("guidance") == FIELD:
        return  # nothing ever is
    if isinstance(flight, dict) and flight.get("replan"):
        message = "nothing is planned anew in flight where something moves"
        yield Finding(("flight", "replan"), message, hint.format("replan"))
    if "battery" in data:
        message = "a return in time is planned in flight, and nothing is planned anew where something moves"
        yield Finding(("battery",), message, hint.format("battery"), at_key=True)
