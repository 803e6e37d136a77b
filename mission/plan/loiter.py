"""Where along the smoothed path the vehicle stands still inside the regions that ask for it."""

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from mission.geometry.regions import Labelling
from mission.geometry.simplices import Partition
from mission.plan.visits import visits
from mission.spec.model import Region
from mission.steering.path import SteeringPath
from mission.steering.smoothing import FourierCurve

_SAMPLES_A_VISIT = 129


def loiter_stops(
    path: SteeringPath, curve: FourierCurve, partition: Partition, labelling: Labelling, regions: tuple[Region, ...]
) -> tuple[tuple[float, float], ...]:
    """Find one stop for each time that the planned path enters a region with a loiter time.

    A region in which the path begins is not entered by that. The stop is the point of the smoothed curve that lies
    deepest inside the region during the visit, so that the vehicle stands well clear of the region's edges.

    Returns:
        Pairs (curve parameter, seconds to stand still), ascending.
    """
    triangles = [segment.triangle for segment in path.segments]
    stops: list[tuple[float, float]] = []
    for region in regions:
        if region.loiter_s <= 0.0:
            continue
        members = set(labelling.triangles_of(region.name).tolist())
        outline = shapely.union_all(shapely.polygons(partition.corners_m[sorted(members)]))
        for first, last in visits([triangle in members for triangle in triangles]):
            if first == 0:
                continue
            start_s = path.segments[first].start_s
            end_s = path.segments[last].start_s + path.segments[last].duration_s
            stops.append((_deepest(curve, outline, start_s, end_s), region.loiter_s))
    return tuple(sorted(stops))


def _deepest(curve: FourierCurve, outline: BaseGeometry, start_s: float, end_s: float) -> float:
    s = np.linspace(start_s, end_s, _SAMPLES_A_VISIT)
    points = shapely.points(curve.position(s))
    depth = np.where(shapely.contains(outline, points), 1.0, -1.0) * shapely.distance(outline.boundary, points)
    return float(s[int(np.argmax(depth))])
