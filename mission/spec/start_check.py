"""Whether a flight may begin where a mission says: inside the domain, and in nothing that is kept clear."""

import numpy as np
import shapely

from mission.decimals import decimal, measure
from mission.geometry.arrays import BoolArray
from mission.geometry.location import Locator
from mission.geometry.shapes import grown, shrunk
from mission.geometry.simplices import ROUNDING, Partition
from mission.spec.areas import Ground
from mission.spec.clearances import BOUNDARY_CLEARANCE, key_of, largest_m
from mission.spec.finding import Finding, Path, dotted, listed
from mission.spec.model import Point, Region
from mission.spec.outlines import Outlines, extent_of, place


def start_findings(
    start_m: Point, locator: Locator, restricted: dict[Region, BoolArray], outlines: Outlines
) -> list[Finding]:
    """What is wrong with a start that is not in free space.

    Args:
        start_m: Where the flight begins.
        locator: The mesh.
        restricted: The triangles of each restricted region, shape (M,).
        outlines: What was drawn.
    """
    path = ("start", "position_m")
    touching = locator.triangles_touching(start_m)
    if not len(touching):
        fence = outlines.fence
        if fence and fence.clearance_m and shapely.intersects(fence.drawn, shapely.Point(start_m)):
            return [_start_too_near(start_m, "the boundary", fence, BOUNDARY_CLEARANCE)]
        return [Finding(path, f"the start {place(start_m)} lies outside the domain", reach(locator.partition))]
    within = [region for region, mask in restricted.items() if mask[touching].any()]
    grounds = {region: outlines.grounds.get(region.name) for region in within}
    near = [
        _start_too_near(start_m, region.name, ground, key_of(region))
        for region, ground in grounds.items()
        if ground and ground.clearance_m and not shapely.intersects(ground.drawn, shapely.Point(start_m))
    ]
    if near or not within:
        return near
    how = "in" if len(touching) == 1 else "in or on the edge of"
    message = f"the start {place(start_m)} lies {how} the restricted region {listed(region.name for region in within)}"
    return [Finding(path, message, "move it out of every restricted region")]


def _start_too_near(start_m: Point, name: str, ground: Ground, key: Path) -> Finding:
    """Of a start that only a clearance forbids."""
    start = shapely.Point(start_m)
    outside = not shapely.intersects(ground.drawn, start)
    least_m = ROUNDING * extent_of(ground.drawn)

    def free(clearance_m: float) -> bool:
        near = shapely.dwithin((grown if outside else shrunk)(ground.drawn, clearance_m), start, least_m)
        return bool(near) != outside

    most = largest_m(free, ground.clearance_m)
    apart, kept_m = measure(shapely.distance(ground.drawn.boundary, start)), decimal(ground.clearance_m)
    message = f"the start {place(start_m)} is {apart} m from {name}, within its clearance of {kept_m} m"
    instead = f", or write at most {decimal(most)} for {dotted(key)}" if most is not None else ""
    return Finding(("start", "position_m"), message, f"move it away{instead}")


def reach(partition: Partition) -> str:
    """How far the domain reaches, in words."""
    left, low, right, high = map(decimal, np.concatenate((partition.vertices_m.min(0), partition.vertices_m.max(0))))
    return f"the domain reaches from {left} to {right} east and from {low} to {high} north"
