"""Where regions that move are at a time, as they are drawn."""

import math
from typing import Final

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from mission.geometry.arrays import FloatArray
from mission.geometry.simplices import Partition
from mission.plan import FlightPlan
from mission.report.reading import Record
from mission.spec.motion import Motion
from mission.spec.moving import displacement_m, shape_then

_MOST_INSTANTS: Final = 200


def partition_at(plan: FlightPlan, time_s: float) -> Partition:
    """The triangles at a time on the clock of the trajectory."""
    return plan.partition if plan.moving is None else plan.moving.at(time_s)


def drifting(plan: FlightPlan) -> dict[str, tuple[float, float]]:
    """The regions of which something moves, by their names, and from when to when."""
    if plan.moving is None:
        return {}
    moves = np.asarray(plan.moving.moves[plan.partition.triangles].any(axis=1))
    spans = {region.name: _span_s(region.motion, plan.moving.last_s) for region in plan.spec.regions}
    return {name: span for name, span in spans.items() if moves[plan.labelling.triangles_of(name)].any()}


def _span_s(motion: Motion | None, last_s: float) -> tuple[float, float]:
    return (0.0, last_s) if motion is None else motion.spans_s


def instants_s(plan: FlightPlan) -> FloatArray:
    """Instants between which all that moves goes straight, at most ``_MOST_INSTANTS``; none where nothing moves."""
    if plan.moving is None:
        return np.empty(0)
    times = plan.moving.times_s
    shown = np.linspace(0, len(times) - 1, min(len(times), _MOST_INSTANTS)).round()
    return np.asarray(times[np.unique(shown.astype(np.int64))])


def shape_at(plan: FlightPlan, name: str, shape: BaseGeometry, time_s: float) -> BaseGeometry:
    """A shape that is drawn of a region, at a time: it goes along as a whole, or is what its triangles are then."""
    if plan.moving is None or name not in drifting(plan):
        return shape
    return shape_then(shape, _motion(plan, name), plan.moving, plan.labelling.triangles_of(name), time_s)


def in_order_at(plan: FlightPlan, name: str, shape: BaseGeometry, time_s: float) -> BaseGeometry:
    """The same with its corners in the same order at all times: in triangles, where it does not move as a whole."""
    if _motion(plan, name) is not None:
        return shape_at(plan, name, shape, time_s)
    corners = partition_at(plan, time_s).corners_m[plan.labelling.triangles_of(name)]
    return shapely.multipolygons(shapely.polygons(corners))


def begun(record: Record) -> float:
    """When the clock of a flight's trajectory began, by which regions move; infinite where it never did."""
    return next((visit.t_s for visit in record.visits if math.isfinite(visit.t_s)), math.inf)


def clock_s(record: Record, t_s: FloatArray) -> FloatArray:
    """Times (N,) of the vehicle on the clock of the trajectory; 0 before it began."""
    return np.nan_to_num(np.maximum(0.0, t_s - begun(record)), neginf=0.0)


def distances_at(
    plan: FlightPlan, name: str, shape: BaseGeometry, clocks_s: FloatArray, points_m: FloatArray
) -> FloatArray:
    """How far places (N, 2) are from a region, each at its time on the clock (N,); NaN for a place that is not known.

    Args:
        plan: The plan.
        name: The region's.
        shape: The region as it is drawn, where it begins.
        clocks_s: The times.
        points_m: The places.
    """
    if name not in drifting(plan):
        return np.asarray(shapely.distance(shapely.points(points_m), shape))
    motion = _motion(plan, name)
    if motion is not None:
        return np.asarray(shapely.distance(shapely.points(points_m - displacement_m(motion, clocks_s)), shape))
    shapes = [shape_at(plan, name, shape, time_s) for time_s in clocks_s.tolist()]
    return np.asarray(shapely.distance(shapely.points(points_m), np.array(shapes, dtype=np.object_)))


def nearest(
    plan: FlightPlan, name: str, shape: BaseGeometry, clocks_s: FloatArray, points_m: FloatArray
) -> tuple[FloatArray, float]:
    """Where a line through places was nearest to a region that moves, and how near: arguments as of ``distances_at``.

    Of one that moves as a whole it is straight between places as seen from the region; of another one the places count.

    Returns:
        The two ends of the shortest line, shape (2, 2), and its length.
    """
    motion = _motion(plan, name)
    if motion is None or len(points_m) == 1:
        k = int(np.argmin(distances_at(plan, name, shape, clocks_s, points_m)))
        there = shape_at(plan, name, shape, float(clocks_s[k]))
        ends = shapely.get_coordinates(shapely.shortest_line(shapely.Point(points_m[k]), there))
        return ends, float(np.hypot(*(ends[1] - ends[0])))
    seen = points_m - displacement_m(motion, clocks_s)
    line = shapely.LineString(seen)
    ends = shapely.get_coordinates(shapely.shortest_line(line, shape))
    along = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(seen, axis=0).T))))
    time_s = np.interp(shapely.line_locate_point(line, shapely.Point(ends[0])), along, clocks_s)
    return ends + displacement_m(motion, np.array([time_s])), float(np.hypot(*(ends[1] - ends[0])))


def _motion(plan: FlightPlan, name: str) -> Motion | None:
    return next(region.motion for region in plan.spec.regions if region.name == name)
