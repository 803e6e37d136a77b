"""The keys of a mission file that set clearances, and the largest values with which something still holds."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Final

from mission.spec.areas import clearance_of
from mission.spec.finding import Path
from mission.spec.model import BoundaryDomain, MissionSpec, NodesDomain, PointShape, Region, RegionKind, TriangleShape

BOUNDARY_CLEARANCE: Final[Path] = ("domain", "clearance_m")
RESTRICTED_CLEARANCE: Final[Path] = ("domain", "restricted_clearance_m")

_STEPS_A_METRE: Final = 100


def key_of(region: Region) -> Path:
    """The key that sets a region's clearance."""
    if region.clearance_m is None and region.kind is RegionKind.RESTRICTED:
        return RESTRICTED_CLEARANCE
    return ("regions", region.name, "clearance_m")


def clearances(spec: MissionSpec) -> dict[Path, float]:
    """The clearances above 0 of what has an outline, by their keys, in the order of the file."""
    domain = spec.domain
    if isinstance(domain, NodesDomain):
        return {}
    drawn = [region for region in spec.regions if not isinstance(region.shape, TriangleShape | PointShape)]
    values = {BOUNDARY_CLEARANCE: domain.clearance_m}
    values |= {key_of(region): clearance_of(region, domain) for region in drawn}
    return {key: value for key, value in values.items() if value > 0.0}


def clearances_by_name(spec: MissionSpec) -> dict[str, float]:
    """The clearances above 0 of regions with an outline, by their names, and that of ``boundary`` first; metres."""
    given = clearances(spec)
    bounds = {"boundary": given[BOUNDARY_CLEARANCE]} if BOUNDARY_CLEARANCE in given else {}
    return bounds | {region.name: given[key] for region in spec.regions if (key := key_of(region)) in given}


def with_clearances(spec: MissionSpec, values: Mapping[Path, float]) -> MissionSpec:
    """The mission with other values of some of the keys that ``clearances`` gives."""
    if not isinstance(spec.domain, BoundaryDomain):
        return spec
    domain = replace(
        spec.domain,
        clearance_m=values.get(BOUNDARY_CLEARANCE, spec.domain.clearance_m),
        restricted_clearance_m=values.get(RESTRICTED_CLEARANCE, spec.domain.restricted_clearance_m),
    )
    regions = (
        replace(region, clearance_m=values.get(("regions", region.name, "clearance_m"), region.clearance_m))
        for region in spec.regions
    )
    return replace(spec, domain=domain, regions=tuple(regions))


def with_room(spec: MissionSpec, room_m: float) -> MissionSpec:
    """The mission with so much more clearance of all that has an outline."""
    if not isinstance(spec.domain, BoundaryDomain) or room_m == 0.0:
        return spec
    domain = replace(
        spec.domain,
        clearance_m=spec.domain.clearance_m + room_m,
        restricted_clearance_m=spec.domain.restricted_clearance_m + room_m,
    )
    regions = (
        region
        if isinstance(region.shape, TriangleShape | PointShape) or key_of(region) == RESTRICTED_CLEARANCE
        else replace(region, clearance_m=(region.clearance_m or 0.0) + room_m)
        for region in spec.regions
    )
    return replace(spec, domain=domain, regions=tuple(regions))


def largest_m(holds: Callable[[float], bool], below_m: float) -> float | None:
    """The largest whole number of centimetres below a value at which something holds that holds at all smaller ones.

    Returns:
        None where it does not even hold at 0. With one centimetre more it does not hold, or the value is reached.
    """
    holding, failing = -1, -int(-below_m * _STEPS_A_METRE // 1)
    while failing - holding > 1:
        middle = (holding + failing) // 2
        holding, failing = (middle, failing) if holds(middle / _STEPS_A_METRE) else (holding, middle)
    return None if holding < 0 else holding / _STEPS_A_METRE
