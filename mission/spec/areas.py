"""The areas that a mission's shapes stand for, as they are drawn and with their clearance."""

from dataclasses import dataclass

import numpy as np

from mission.geometry.shapes import Area, disc, grown, shrunk, strip, united
from mission.spec.model import (
    AreaShape,
    BoundaryDomain,
    CircleShape,
    NodesDomain,
    PointShape,
    PolygonsShape,
    Region,
    RegionKind,
    StripShape,
    TriangleShape,
)


@dataclass(frozen=True, eq=False)
class Ground:
    """An area of a mission.

    Attributes:
        drawn: As the file has it; where that is round, a polygon around it if the vehicle must keep out, or else in it.
        kept: With its clearance: larger where the vehicle must keep out, or else smaller, and perhaps empty.
        clearance_m: How far the rims of the two are apart.
    """

    drawn: Area
    kept: Area
    clearance_m: float


def boundary_ground(domain: BoundaryDomain) -> Ground:
    """Where the vehicle may fly."""
    drawn = drawn_area(domain.boundary, outside=False)
    return Ground(drawn, shrunk(drawn, domain.clearance_m), domain.clearance_m)


def region_ground(region: Region, domain: NodesDomain | BoundaryDomain) -> Ground | None:
    """The area of a region; None of one that is a triangle of the mesh."""
    return None if isinstance(region.shape, TriangleShape | PointShape) else area_ground(region, region.shape, domain)


def area_ground(region: Region, shape: AreaShape, domain: NodesDomain | BoundaryDomain) -> Ground:
    """The area of a region of such a shape."""
    restricted = region.kind is RegionKind.RESTRICTED
    drawn, clearance_m = drawn_area(shape, outside=restricted), clearance_of(region, domain)
    return Ground(drawn, (grown if restricted else shrunk)(drawn, clearance_m), clearance_m)


def clearance_of(region: Region, domain: NodesDomain | BoundaryDomain) -> float:
    """The clearance of a region: its own, or the domain's for all restricted ones, m."""
    if region.clearance_m is not None:
        return region.clearance_m
    if region.kind is RegionKind.RESTRICTED and isinstance(domain, BoundaryDomain):
        return domain.restricted_clearance_m
    return 0.0


def drawn_area(shape: AreaShape, *, outside: bool) -> Area:
    """A shape as an area; ``outside`` says on which side one that is round may err."""
    if isinstance(shape, CircleShape):
        return disc(np.array(shape.centre_m), shape.radius_m, outside=outside)
    if isinstance(shape, StripShape):
        return strip(np.array(shape.line_m), shape.width_m, outside=outside)
    parts = shape.parts if isinstance(shape, PolygonsShape) else (shape,)
    return united((np.array(part.corners_m), [np.array(hole) for hole in part.holes_m]) for part in parts)
