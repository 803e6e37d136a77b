"""What a mission file means, checked section by section wherever its structure is sound."""

import re
from collections.abc import Iterable
from typing import Any

from mission.errors import FormulaSyntaxError
from mission.logic.formula.parser import parse_timed_formula
from mission.logic.formula.syntax import propositions, written_name
from mission.spec.domain import examine_domain
from mission.spec.finding import Finding, Path, is_clean, listed, rather, shortened
from mission.spec.model import FIELD, TRAJECTORY, Point, Region, RegionKind
from mission.spec.motion_check import motion_findings
from mission.spec.schema import DOMAIN_KEYS, OPERATOR_NAMES, SHAPE_KEYS, default_of
from mission.spec.start_check import NO_TUBE, Tube
from mission.spec.task_check import task_findings, weight_findings
from mission.spec.tube import margins_of
from mission.spec.values import domain_of, point_of, region_of
from mission.spec.window_check import window_findings

_FORMULA: Path = ("mission", "formula")
_TOWARD: Path = ("flight", "heading", "toward")
_START: Path = ("start", "position_m")


def meaning_findings(data: Any, structural: list[Finding]) -> list[Finding]:  # noqa: ANN401 - any JSON value
    """Faults of formula, geometry and start; parts that have structural findings already are left out.

    Args:
        data: The file's data.
        structural: What was found against the schema.
    """
    findings = []
    regions = data.get("regions") if isinstance(data, dict) else None
    if is_clean(_FORMULA, structural) and "formula" in data.get("mission", {}):
        names = frozenset(regions) if isinstance(regions, dict) else None
        findings.extend(_formula_findings(data["mission"]["formula"], names))
    if is_clean(("tasks",), [f for f in structural if len(f.path) <= 1]) and "tasks" in data:
        findings.extend(weight_findings(data["tasks"]))
        kinds = {name: str(_kind(value)) for name, value in regions.items()} if isinstance(regions, dict) else None
        for i, task in enumerate(data["tasks"] if kinds else ()):
            if is_clean(("tasks", i), structural):
                findings.extend(task_findings(i, task, kinds or {}))
    findings.extend(_cover_findings(regions))
    findings.extend(window_findings(data, structural))
    moved = list(motion_findings(data, structural))
    findings.extend(moved)
    structural = [*structural, *moved]
    if is_clean(("flight", "guidance"), structural):
        findings.extend(_guidance_findings(data.get("flight", {}), regions))
    if isinstance(regions, dict) and is_clean(_TOWARD[:2], structural):
        findings.extend(_toward_findings(data.get("flight", {}).get("heading"), regions))
    if all(is_clean(("domain", key), structural) for key in DOMAIN_KEYS):
        known = _known_regions(data.get("regions"), structural)
        start_m: Point | None = point_of(data["start"]["position_m"]) if is_clean(_START, structural) else None
        findings.extend(examine_domain(domain_of(data["domain"]), known, start_m, _tube_of(data, structural))[2])
    return findings


def _tube_of(data: Any, structural: list[Finding]) -> Tube:  # noqa: ANN401 - any JSON value
    """The tube that the flight asks for; none where that is not sound."""
    flight, keys = data.get("flight", {}), ("disturbance_m_s2", "time_constant_s")
    if not all(is_clean(("flight", key), structural) for key in (*keys, "tube")):
        return NO_TUBE
    others_m = margins_of(flight).sum_m
    disturbance_m_s2, time_constant_s = (float(flight.get(key, default_of("flight", key))) for key in keys)
    return Tube(disturbance_m_s2, time_constant_s, others_m)


def _kind(region: Any) -> Any:  # noqa: ANN401 - any JSON value
    return region.get("kind") if isinstance(region, dict) else None


def _cover_findings(regions: Any) -> list[Finding]:  # noqa: ANN401 - any JSON value
    """Regions that are to be covered and are not there to be surveyed."""
    hint = "make it `kind: survey`, or take `cover` away"
    return [
        Finding(("regions", name, "cover"), f"a region of kind {_kind(value)} is not covered", hint, at_key=True)
        for name, value in (regions.items() if isinstance(regions, dict) else ())
        if isinstance(value, dict) and "cover" in value and _kind(value) in set(RegionKind) - {RegionKind.SURVEY}
    ]


def _guidance_findings(flight: Any, regions: Any) -> list[Finding]:  # noqa: ANN401 - any JSON value
    """Regions that are to be covered by a flight that keeps to no lanes."""
    if not isinstance(flight, dict) or flight.get("guidance") != FIELD or not isinstance(regions, dict):
        return []
    if flight.get("replan"):
        hint = "leave it out: by the field, a flight that was pushed away goes on from there in any case"
        return [Finding(("flight", "replan"), "this flight follows no trajectory whose tube it could leave", hint)]
    covered = [name for name, value in regions.items() if isinstance(value, dict) and "cover" in value]
    hint = f"take `cover` away from {listed(covered)}, or write `guidance: {TRAJECTORY}`"
    message = "lanes are flown along a trajectory, not by the field"
    return [Finding(("flight", "guidance"), message, hint)] if covered else []


def _toward_findings(heading: Any, regions: Any) -> list[Finding]:  # noqa: ANN401 - any JSON value
    """A region that the nose is to look toward, and that there is not."""
    name = heading.get("toward") if isinstance(heading, dict) else None
    if name is None or name in regions:
        return []
    hint = rather(name, sorted(regions), "regions")
    return [Finding(_TOWARD, f"the nose is to look toward `{shortened(name)}`, which is no region", hint)]


def _known_regions(regions: Any, structural: list[Finding]) -> list[Region]:  # noqa: ANN401 - any JSON value
    """The regions whose shape is sound; one of unknown kind or loiter counts as a plain region to survey."""
    known = []
    for name, value in regions.items() if isinstance(regions, dict) else ():
        path: Path = ("regions", name)
        if all(is_clean((*path, key), structural) for key in SHAPE_KEYS):
            kind = value["kind"] if is_clean((*path, "kind"), structural) else RegionKind.SURVEY
            shape = {key: part for key, part in value.items() if key not in ("loiter_s", "speed_m_s", "cover")}
            for key in ("active_s", "motion"):
                if not is_clean((*path, key), structural):
                    shape.pop(key, None)
            known.append(region_of(name, {**shape, "kind": kind}))
    return known


def _unquoted(formula: str, names: Iterable[str]) -> str:
    """What to do about a name of a region that a formula can say in quotes alone, and says without; empty elsewhere."""
    for name in sorted(names, key=len, reverse=True):
        quoted = written_name(name)
        if not (name.isascii() and name.isidentifier()) and name in formula.replace(quoted, ""):
            return f"put the name in double quotes: {quoted}"
    return ""


def _formula_findings(formula: str, names: frozenset[str] | None) -> list[Finding]:
    """Faults of the formula; ``names`` are the regions, None where they are not known."""
    try:
        # A region of a name like G is a fault of its own and must not change how the formula is read.
        known = frozenset(name for name in names or () if not re.search(OPERATOR_NAMES, name))
        parsed = parse_timed_formula(formula, known)
    except FormulaSyntaxError as error:
        # The end of the text has no character of its own; the last one stands for it.
        character = max(0, min(error.column, len(formula)) - 1)
        hint = _unquoted(formula, names or ()) or error.hint
        return [Finding(_FORMULA, f"{error.message} (column {error.column})", hint, character=character)]
    if names is None:
        return []
    findings = []
    for name in sorted(propositions(parsed) - names):
        hint = rather(name, sorted(names), "regions")
        hint = _unquoted(formula, names) or hint
        place = re.search(rf"(?<![A-Za-z0-9_.]){re.escape(name)}(?![A-Za-z0-9_.])", formula)
        at = place.start() if place else None
        column = f" (column {at + 1})" if at is not None else ""
        message = f"the formula speaks of `{shortened(name)}`, which is no region{column}"
        findings.append(Finding(_FORMULA, message, hint, character=at))
    return findings
