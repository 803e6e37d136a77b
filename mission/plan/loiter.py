"""Where along the smoothed path the vehicle stands still inside the regions that ask for it."""

import math
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from mission.geometry.regions import Labelling, union_of
from mission.geometry.simplices import Partition
from mission.plan.visits import visits
from mission.spec.model import Region
from mission.steering.joined import Curve, JoinedCurve
from mission.steering.path import SteeringPath

_SAMPLES_A_VISIT = 129
_DEEP_ENOUGH = 0.5


@dataclass(frozen=True)
class Stop:
    """Where the vehicle loiters.

    Attributes:
        region: Name of the region.
        s: Curve parameter.
        seconds: How long it stands still.
        depth_m: Distance from the outline of the region, negative outside.
        planned_depth_m: The same where the planned path is deepest.
    """

    region: str
    s: float
    seconds: float
    depth_m: float
    planned_depth_m: float


def loiter_stops(
    path: SteeringPath, curve: JoinedCurve, partition: Partition, labelling: Labelling, regions: tuple[Region, ...]
) -> tuple[Stop, ...]:
    """Find one stop for each time that the planned path enters a region with a loiter time.

    A region in which a leg begins is not entered by that: of a flight, the vehicle was put there, and of a later leg,
    the one before it has entered. The stop is the point of the smoothed curve that lies
    deepest inside the region during the visit, so that the vehicle stands well clear of the region's edges.

    Returns:
        The stops in the order in which they are reached.
    """
    stops: list[Stop] = []
    loitering = [region for region in regions if region.loiter_s > 0.0]
    for region in loitering:
        members = set(labelling.triangles_of(region.name).tolist())
        outline = union_of(partition, labelling.triangles_of(region.name))
        for leg, smoothed, begins_s in zip(path.legs, curve.legs, curve.starts_s.tolist(), strict=False):
            for first, last in visits([segment.triangle in members for segment in leg.segments]):
                if first == 0:
                    continue
                start_s, end_s = float(leg.knots_s[first]), float(leg.knots_s[last + 1])
                # Halfway on a way to the roomiest place and back it stands still in any case.
                ends = [(each.start_s, each.lanes) for each in leg.segments[first : last + 1] if each.lanes]
                turns_s = [float(begin_s + corner_s) for begin_s, lanes in ends for corner_s in lanes.corners_s[1:-1]]
                s, depth_m = _deepest(smoothed, outline, start_s, end_s, turns_s)
                _, planned_depth_m = _deepest(leg, outline, start_s, end_s, turns_s)
                stops.append(Stop(region.name, begins_s + s, region.loiter_s, depth_m, planned_depth_m))
    return tuple(sorted(stops, key=lambda stop: stop.s))


def shallow_stop(stops: tuple[Stop, ...], tube_m: float) -> str:
    """Which stop is not well inside its region, in words after "the smoothed path"; empty where none is.

    The whole tube must be inside, and the stop at least half as deep as the planned path goes.
    """
    for stop in stops:
        if stop.depth_m <= max(math.sqrt(2.0) * tube_m, _DEEP_ENOUGH * stop.planned_depth_m):
            return f"comes no deeper than {stop.depth_m:.2f} m into {stop.region}, where it is to loiter"
    return ""


def _deepest(
    curve: Curve | SteeringPath, outline: BaseGeometry, start_s: float, end_s: float, also_s: list[float]
) -> tuple[float, float]:
    s = np.union1d(np.linspace(start_s, end_s, _SAMPLES_A_VISIT), also_s)
    points = shapely.points(curve.position(s))
    depth = np.where(shapely.contains(outline, points), 1.0, -1.0) * shapely.distance(outline.boundary, points)
    best = int(np.argmax(depth))
    return float(s[best]), float(depth[best])
