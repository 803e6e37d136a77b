"""What boundary and clearances take from a mission: ground that is cut off, or out of reach."""

from typing import Final

import shapely

from mission.decimals import decimal
from mission.spec.areas import Ground, boundary_ground, region_ground
from mission.spec.clearances import BOUNDARY_CLEARANCE
from mission.spec.finding import dotted, listed
from mission.spec.model import BoundaryDomain, MissionSpec, Point, RegionKind
from mission.spec.outlines import BOUNDARY

_WORTH_SAYING: Final = 1e-3  # of a region's area


def cut_off(spec: MissionSpec) -> tuple[str, ...]:
    """Warnings for the regions of which something lies outside a boundary that cuts them off, or no part is left."""
    if not isinstance(spec.domain, BoundaryDomain):
        return ()
    fence, forbidden = boundary_ground(spec.domain), _forbidden(spec)
    lost = {name: _lost(ground, fence, wanted=name not in forbidden) for name, ground in _grounds(spec).items()}
    return tuple(f"regions.{name}: {loss}" for name, loss in lost.items() if loss)


def out_of_reach(spec: MissionSpec, start_m: Point) -> tuple[str, ...]:
    """A warning where the boundary is in parts, between which no way leads: what lies in others than the start."""
    if not isinstance(spec.domain, BoundaryDomain):
        return ()
    fence = boundary_ground(spec.domain)
    parts = shapely.get_parts(fence.kept)
    if len(parts) == 1:
        return ()
    own = parts[int(shapely.distance(parts, shapely.Point(start_m)).argmin())]
    forbidden = _forbidden(spec)
    elsewhere = [
        name
        for name, ground in _grounds(spec).items()
        if name not in forbidden and shapely.intersection(ground.kept, own).area == 0.0
    ]
    of_clearance = len(shapely.get_parts(fence.drawn)) < len(parts)
    whose = (
        f"{dotted(BOUNDARY_CLEARANCE)}: {decimal(fence.clearance_m)} leaves"
        if of_clearance
        else f"{dotted(BOUNDARY)} has"
    )
    there = f"; {listed(elsewhere)} cannot be reached from the start" if elsewhere else ""
    return (f"{whose} {len(parts)} parts, and no way leads from one to another{there}",)


def _grounds(spec: MissionSpec) -> dict[str, Ground]:
    grounds = {region.name: region_ground(region, spec.domain) for region in spec.regions}
    return {name: ground for name, ground in grounds.items() if ground is not None}


def _forbidden(spec: MissionSpec) -> frozenset[str]:
    return frozenset(region.name for region in spec.regions if region.kind is RegionKind.RESTRICTED)


def _lost(ground: Ground, fence: Ground, *, wanted: bool) -> str:
    """What of an area is lost, in words; empty where that is not worth saying."""
    if wanted and shapely.intersection(ground.kept, fence.kept).area == 0.0:
        return "clearances leave nothing of it"
    share = 1.0 - shapely.intersection(ground.drawn, fence.drawn).area / ground.drawn.area
    return f"{share:.1%} of it lies outside the boundary and is cut off" if share > _WORTH_SAYING else ""
