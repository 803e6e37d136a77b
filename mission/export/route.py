"""The path of a plan as straight legs between waypoints, for autopilots that fly such missions by themselves."""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.geometry.straightening import straightened
from mission.plan.flight_plan import FlightPlan
from mission.plan.slow_parts import slow_parts
from mission.spec.model import Point
from mission.steering.grid import Slow
from mission.steering.joined import Curve

LEAST_TOLERANCE_M = 0.01
"""Autopilots keep places to 1e-7 degrees, a centimetre."""

_USUAL_TOLERANCE_M = 0.2
_SHARE_OF_TUBE = 0.5
_SHARE_OF_SAMPLING = 1.0 / 16.0
_FEWEST_CELLS = 64


@dataclass(frozen=True)
class Waypoint:
    """A place to fly to on a straight line, and what happens there.

    Attributes:
        place_m: ENU in the domain.
        hold_s: How long to stand still.
        trigger_m: The distance between images from there on, 0 for no more; None where nothing is changed.
        speed_m_s: How fast it may be flown to at most, where a region on the way there asks for less than elsewhere.
    """

    place_m: Point
    hold_s: float = 0.0
    trigger_m: float | None = None
    speed_m_s: float = math.inf


@dataclass(frozen=True)
class Route:
    """Straight legs from the start of a flight to its end.

    Attributes:
        parts: What is flown from rest to rest, as in the plan's trajectory: the first part begins at the start, each
            other one where the one before it ends.
        lap: Which part is flown several times; None where none is.
        laps: How often; None until somebody says that it is enough.
        deviation_m: Proved bound of the distance between somebody on the route and somebody on the smooth path, both
            going on in their own time and neither ever back.
    """

    parts: tuple[tuple[Waypoint, ...], ...]
    lap: int | None
    laps: int | None
    deviation_m: float

    @property
    def once(self) -> tuple[Waypoint, ...]:
        """All waypoints in order, the lap flown once."""
        return (*self.parts[0][:1], *(waypoint for part in self.parts for waypoint in part[1:]))


def usual_tolerance(plan: FlightPlan) -> float:
    """A tolerance that leaves at least half of the proved tube to the vehicle, where it has one."""
    tube_m = plan.certificate.tube_m
    if tube_m == 0.0:
        return _USUAL_TOLERANCE_M
    return max(LEAST_TOLERANCE_M, min(_USUAL_TOLERANCE_M, _SHARE_OF_TUBE * tube_m))


def route_of(plan: FlightPlan, tolerance_m: float) -> Route:
    """The smooth path of a plan as straight legs, its stops among the waypoints.

    Args:
        plan: The plan.
        tolerance_m: How far the legs may be from the smooth path, ``LEAST_TOLERANCE_M`` or more.
    """
    parts, deviation_m, slow = [], 0.0, _slow(plan)
    for number, curve in enumerate(plan.curve.legs):
        part, apart_m = _part(curve, _events(plan, number, slow), tolerance_m)
        parts.append(part)
        deviation_m = max(deviation_m, apart_m)
    trajectory = plan.trajectory
    return Route(tuple(parts), trajectory.lap, trajectory.laps, deviation_m)


@dataclass(frozen=True)
class _Events:
    """What happens on a leg of the curve, by its own parameter: seconds to stand still, distances between images.

    ``slow`` are the parts of it with a largest speed.
    """

    holds_s: dict[float, float]
    triggers_m: dict[float, float]
    slow: tuple[Slow, ...]

    @property
    def places_s(self) -> list[float]:
        """Where something happens."""
        return [*self.holds_s, *self.triggers_m, *(end for part in self.slow for end in (part.begin_s, part.end_s))]


def _slow(plan: FlightPlan) -> tuple[Slow, ...]:
    """The parts of the curve with a largest speed, each with the way on which to brake ahead of it."""
    parts = slow_parts(plan.proofs, plan.labelling, plan.spec.regions)
    if not parts:
        return ()
    knots, points, _, _ = plan.curve.sampled(_FEWEST_CELLS)
    along_m = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))))
    fastest_m_s = min(plan.spec.flight.speed_m_s, plan.spec.limits.speed_m_s)

    def braked(part: Slow) -> float:
        way_m = max(0.0, fastest_m_s**2 - part.speed_m_s**2) / (2.0 * plan.spec.limits.acceleration_m_s2)
        return float(np.interp(np.interp(part.begin_s, knots, along_m) - way_m, along_m, knots))

    return tuple(part._replace(begin_s=braked(part)) for part in parts)


def _events(plan: FlightPlan, number: int, slow: tuple[Slow, ...]) -> _Events:
    begin_s, end_s = plan.curve.starts_s[number : number + 2].tolist()
    own = (
        part._replace(begin_s=max(part.begin_s - begin_s, 0.0), end_s=min(part.end_s, end_s) - begin_s)
        for part in slow
        if part.begin_s < end_s and part.end_s > begin_s
    )
    events = _Events({}, {}, tuple(own))
    triggers = [
        (s, trigger_m)
        for visit in plan.covers
        if visit.trigger_m is not None
        for lane in visit.lanes_s.tolist()
        for s, trigger_m in zip(lane, (visit.trigger_m, 0.0), strict=True)
    ]
    for kind, told in ((events.holds_s, plan.stops), (events.triggers_m, triggers)):
        for s, value in told:
            # Where two legs meet, it is the earlier one on which things happen, as in the trajectory.
            if begin_s < s <= end_s or (number == 0 and s <= begin_s):
                own_s = min(s - begin_s, plan.curve.legs[number].duration_s)
                kind[own_s] = max(value, kind.get(own_s, 0.0))
    return events


def _part(curve: Curve, events: _Events, tolerance_m: float) -> tuple[tuple[Waypoint, ...], float]:
    """One curve as waypoints, and the bound of their deviation."""
    s, sampling_m = _samples(curve, tolerance_m * _SHARE_OF_SAMPLING)
    eventful = np.clip(events.places_s, 0.0, curve.duration_s)
    s = np.union1d(s, eventful)
    points = curve.position(s)
    fixed = sorted({0, len(s) - 1, *np.searchsorted(s, eventful).tolist()})
    kept, worst_m = [0], 0.0
    for first, last in pairwise(fixed):
        corners, apart_m = straightened(points[first : last + 1], tolerance_m - sampling_m)
        kept += (first + corners[1:]).tolist()
        worst_m = max(worst_m, apart_m)
    legs = np.stack((s[kept[:-1]], s[kept[1:]]), axis=1).tolist()
    speeds = [math.inf] + [
        min((part.speed_m_s for part in events.slow if part.begin_s < end and part.end_s > begin), default=math.inf)
        for begin, end in legs
    ]
    waypoints = (
        Waypoint((float(x), float(y)), events.holds_s.get(where, 0.0), events.triggers_m.get(where), speed)
        for where, (x, y), speed in zip(s[kept].tolist(), points[kept].tolist(), speeds, strict=True)
    )
    return tuple(waypoints), worst_m + sampling_m


def _samples(curve: Curve, tolerance_m: float) -> tuple[FloatArray, float]:
    """Parameters (P,) whose chords stay within a tolerance of the curve, and a proved bound of how far off they are.

    A chord over h of the parameter is nowhere farther than sup |r''| h^2 / 8 from the curve's point at the same h.
    """
    knots, _, _, bends = curve.sampled(_FEWEST_CELLS)
    off_m = curve.norm_bounds(knots, 2, bends) * np.diff(knots) ** 2 / 8.0
    pieces = np.maximum(1, np.ceil(np.sqrt(off_m / tolerance_m))).astype(np.int64)
    cell = np.repeat(np.arange(len(pieces)), pieces)
    place = np.arange(len(cell)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    s = knots[cell] + np.diff(knots)[cell] * place / pieces[cell]
    return np.append(s, curve.duration_s), float((off_m / pieces**2).max(initial=0.0))
