"""How near a flight came to regions, and how far it was from a planned path."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import shapely

from mission.geometry.arrays import FloatArray
from mission.spec.model import Point
from mission.spec.restricted import ShapeAt
from mission.verify.flown.reach import Reaches


@dataclass(frozen=True)
class Nearness:
    """How near a flight came to a region, as it is drawn.

    Attributes:
        region: Its name.
        least_m: The smallest distance of the straight lines through the reports, but for those across gaps; 0 where
            they meet it. Of a region that moves, that of the reports themselves from where it is then.
        t_s: When that was.
        position_m: Where.
        surely_m: The vehicle was nowhere nearer than this, whatever it did between the reports.
    """

    region: str
    least_m: float
    t_s: float
    position_m: Point
    surely_m: float


@dataclass(frozen=True)
class Deviation:
    """How far a flight was from a planned path, wherever on it.

    Attributes:
        largest_m: The largest distance of a report.
        t_s: When that was.
        rms_m: Root of the mean square.
    """

    largest_m: float
    t_s: float
    rms_m: float


def nearness_of(reaches: Reaches, shapes: Mapping[str, shapely.Geometry], *, whole: bool) -> tuple[Nearness, ...]:
    """How near a flight came to each shape.

    Args:
        reaches: The reports, and how far the vehicle may have been off between them.
        shapes: By the names of their regions.
        whole: Whether the log has the flight from begin to end.
    """
    return tuple(_nearness(reaches, name, shape, whole=whole) for name, shape in shapes.items())


def nearness_of_moving(
    reaches: Reaches, shapes: Mapping[str, ShapeAt], clock_s: FloatArray, fastest_m_s: float, *, whole: bool
) -> tuple[Nearness, ...]:
    """How near a flight came to each shape that moves.

    Args:
        reaches: As in ``nearness_of``.
        shapes: Where they are, by the names of their regions.
        clock_s: The time of each report by which they move, shape (N,).
        fastest_m_s: They move no faster.
        whole: As in ``nearness_of``.
    """
    found = []
    for name, shape_at in shapes.items():
        here = np.array([shape_at(t_s) for t_s in clock_s.tolist()])
        ends: FloatArray = shapely.distance(here, shapely.points(reaches.position_m))
        nearest = int(np.argmin(ends))
        # Between two reports, from the nearer of them in time: half of the way, and of what the region moves.
        between = reaches.reach_m + 0.5 * (reaches.apart_m + fastest_m_s * reaches.gap_s)
        surely_m = float((np.minimum(ends[:-1], ends[1:]) - between).min(initial=ends[nearest]))
        told = float(ends[nearest]), float(reaches.t_s[nearest]), _pair(reaches.position_m[nearest])
        found.append(Nearness(name, *told, max(surely_m, 0.0) if whole else 0.0))
    return tuple(found)


def deviation_of(reaches: Reaches, path_m: FloatArray) -> Deviation:
    """How far the reports are from a path through points, shape (P, 2)."""
    line = shapely.LineString(path_m)
    shapely.prepare(line)
    distance: FloatArray = shapely.distance(line, shapely.points(reaches.position_m))
    worst = int(np.argmax(distance))
    return Deviation(float(distance[worst]), float(reaches.t_s[worst]), float(np.sqrt(np.mean(distance**2))))


def _nearness(reaches: Reaches, name: str, shape: shapely.Geometry, *, whole: bool) -> Nearness:
    shapely.prepare(shape)
    ends: FloatArray = shapely.distance(shape, shapely.points(reaches.position_m))
    nearest = int(np.argmin(ends))
    least_m, time_s, place = float(ends[nearest]), float(reaches.t_s[nearest]), reaches.position_m[nearest]
    if len(ends) == 1:
        return Nearness(name, least_m, time_s, _pair(place), least_m if whole else 0.0)
    # Where the vehicle stood still, older versions of GEOS divide 0 by 0 in passing.
    with np.errstate(invalid="ignore"):
        distances: FloatArray = shapely.distance(shape, reaches.lines)
    flown = np.where(reaches.is_gap, np.inf, distances)
    on_line = int(np.argmin(flown))
    if flown[on_line] <= least_m:
        line, least_m = reaches.lines[on_line], float(flown[on_line])
        place = shapely.get_coordinates(shapely.shortest_line(line, shape))[0]
        moved_m = shapely.length(line)
        share = shapely.line_locate_point(line, shapely.Point(place)) / moved_m if moved_m else 0.0
        time_s = float(reaches.t_s[on_line] + share * reaches.gap_s[on_line])
    surely_m = max(float((distances - reaches.reach_m).min()), 0.0) if whole else 0.0
    return Nearness(name, least_m, time_s, _pair(place), surely_m)


def _pair(place_m: FloatArray) -> Point:
    return float(place_m[0]), float(place_m[1])
