"""Whether a flight may begin where a mission says: inside the domain, and in nothing that is kept clear."""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely

from mission.decimals import decimal, measure
from mission.geometry.arrays import BoolArray
from mission.geometry.location import Locator
from mission.geometry.shapes import Area, grown, shrunk
from mission.geometry.simplices import ROUNDING, Partition
from mission.spec.areas import Ground
from mission.spec.clearances import BOUNDARY_CLEARANCE, key_of, largest_m
from mission.spec.finding import Finding, Path, dotted, listed
from mission.spec.model import Point, Region
from mission.spec.outlines import Outlines, extent_of, place
from mission.spec.tube import disturbed_m

_SURELY: Final = 0.98
"""Of the tube: a smoothed path may begin a little beside the start."""


@dataclass(frozen=True)
class Tube:
    """What the proof of a flight adds on each side of its path, on each axis.

    Attributes:
        disturbance_m_s2: Bound w of the acceleration that tracking does not know of.
        time_constant_s: tau of the tracking law.
        others_m: What comes from other causes.
    """

    disturbance_m_s2: float
    time_constant_s: float
    others_m: float = 0.0

    @property
    def width_m(self) -> float:
        """Half of its width."""
        return disturbed_m(self.disturbance_m_s2, self.time_constant_s) + self.others_m


NO_TUBE: Final = Tube(0.0, 1.0)


def start_findings(
    start_m: Point, locator: Locator, restricted: dict[Region, BoolArray], outlines: Outlines, tube: Tube = NO_TUBE
) -> list[Finding]:
    """What is wrong with a start that is not in free space, or not far enough inside it for a proof.

    Args:
        start_m: Where the flight begins.
        locator: The mesh.
        restricted: The triangles of each restricted region, shape (M,).
        outlines: What was drawn.
        tube: What the proof adds to the path.
    """
    path = ("start", "position_m")
    touching = locator.triangles_touching(start_m)
    if not len(touching):
        fence = outlines.fence
        if fence and fence.clearance_m and shapely.intersects(fence.drawn, shapely.Point(start_m)):
            return [_start_too_near(start_m, "the boundary", fence, BOUNDARY_CLEARANCE, tube)]
        return [Finding(path, f"the start {place(start_m)} lies outside the domain", reach(locator.partition))]
    within = [region for region, mask in restricted.items() if mask[touching].any()]
    grounds = {region: outlines.grounds.get(region.name) for region in within}
    near = [
        _start_too_near(start_m, region.name, ground, key_of(region), tube)
        for region, ground in grounds.items()
        if ground and ground.clearance_m and not shapely.intersects(ground.drawn, shapely.Point(start_m))
    ]
    if near:
        return near
    if not within:
        return _in_the_tube(start_m, locator.partition, restricted, outlines, tube)
    how = "in" if len(touching) == 1 else "in or on the edge of"
    message = f"the start {place(start_m)} lies {how} the restricted region {listed(region.name for region in within)}"
    return [Finding(path, message, "move it out of every restricted region")]


def _start_too_near(start_m: Point, name: str, ground: Ground, key: Path, tube: Tube) -> Finding:
    """Of a start that only a clearance forbids."""
    start = shapely.Point(start_m)
    outside = not shapely.intersects(ground.drawn, start)
    least_m = ROUNDING * extent_of(ground.drawn)

    around = _square(start_m, _SURELY * tube.width_m)

    def free(clearance_m: float) -> bool:
        area = (grown if outside else shrunk)(ground.drawn, clearance_m)
        if tube.width_m > 0.0:
            return not shapely.intersects(area, around) if outside else bool(shapely.contains(area, around))
        return bool(shapely.dwithin(area, start, least_m)) != outside

    most = largest_m(free, ground.clearance_m)
    apart, kept_m = measure(shapely.distance(ground.drawn.boundary, start)), decimal(ground.clearance_m)
    message = f"the start {place(start_m)} is {apart} m from {name}, within its clearance of {kept_m} m"
    instead = f", or write at most {decimal(most)} for {dotted(key)}" if most is not None else ""
    return Finding(("start", "position_m"), message, f"move it away{instead}")


def _in_the_tube(
    start_m: Point, partition: Partition, restricted: dict[Region, BoolArray], outlines: Outlines, tube: Tube
) -> list[Finding]:
    """Of a free start round which the tube meets what is restricted, or leaves the domain: there is no proof then."""
    if tube.width_m == 0.0:
        return []
    fence = outlines.fence
    outer = fence.kept if fence else shapely.convex_hull(shapely.multipoints(partition.vertices_m))
    beyond = shapely.difference(shapely.box(*outer.buffer(2.0 * tube.width_m).bounds), outer)
    kept: list[tuple[str, Area, Ground | None, Path]] = [("the boundary", beyond, fence, BOUNDARY_CLEARANCE)]
    for region, mask in restricted.items():
        triangles = shapely.multipolygons(shapely.polygons(partition.corners_m[mask]))
        kept.append((region.name, triangles, outlines.grounds.get(region.name), key_of(region)))
    return [
        _start_too_near_for_proof(start_m, name, area, (ground, key), tube)
        for name, area, ground, key in kept
        if shapely.intersects(area, _square(start_m, _SURELY * tube.width_m))
    ]


def _start_too_near_for_proof(
    start_m: Point, name: str, area: Area, cleared: tuple[Ground | None, Path], tube: Tube
) -> Finding:
    ground, key = cleared
    apart = measure(float(shapely.distance(area, shapely.Point(start_m))))
    of_clearance = f" with its clearance of {decimal(ground.clearance_m)} m" if ground and ground.clearance_m else ""
    message = (
        f"the start {place(start_m)} is {apart} m from {name}{of_clearance}, within the tube of the proof, "
        f"{decimal(tube.width_m)} m each way"
    )
    narrow_m = largest_m(lambda m: not shapely.intersects(area, _square(start_m, m)), tube.width_m) or 0.0
    disturbance = math.floor(100.0 * (narrow_m - tube.others_m) / tube.time_constant_s**2 + ROUNDING) / 100.0
    ways = ["move it away"]
    if ground and ground.clearance_m:
        drawn, around = ground.drawn, _square(start_m, tube.width_m)
        outside = name != "the boundary"

        def free(clearance_m: float) -> bool:
            if outside:
                return not shapely.intersects(grown(drawn, clearance_m), around)
            return bool(shapely.contains(shrunk(drawn, clearance_m), around))

        most = largest_m(free, ground.clearance_m)
        ways += [f"write at most {decimal(most)} for {dotted(key)}"] if most is not None else []
    ways += [f"write at most {decimal(disturbance)} for flight.disturbance_m_s2"] if disturbance >= 0.0 else []
    if tube.others_m > 0.0:
        ways.append(f"write less for the causes in flight.tube, for {decimal(narrow_m)} m in all")
    return Finding(("start", "position_m"), message, ", or ".join(ways))


def _square(middle_m: Point, half_m: float) -> shapely.Polygon:
    east, north = middle_m
    return shapely.box(east - half_m, north - half_m, east + half_m, north + half_m)


def reach(partition: Partition) -> str:
    """How far the domain reaches, in words."""
    left, low, right, high = map(decimal, np.concatenate((partition.vertices_m.min(0), partition.vertices_m.max(0))))
    return f"the domain reaches from {left} to {right} m east and from {low} to {high} m north"
