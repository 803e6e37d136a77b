"""Where the nose looks at each time of a flight: a function of the trajectory and of what the mission says of it."""

from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import atan2
from typing import NamedTuple

import numpy as np

from mission.geometry.regions import Labelling, union_of
from mission.geometry.simplices import Partition
from mission.plan.covering import CoveredVisit
from mission.plan.flight_plan import FlightPlan
from mission.plan.turning import NEAR_M, TURN_RAD_S, headings_of, lead_s, looked_along
from mission.spec.heading import Heading, Look
from mission.spec.model import MissionSpec, Point
from mission.steering.trajectory import Trajectory

MOVING_M_S = 0.01
"""Whoever is slower stands still."""


class Stretch(NamedTuple):
    """A lane along which the nose looks: times on the trajectory, of laps in the first, and the heading from north."""

    begin_s: float
    end_s: float
    heading_rad: float


class Turned(NamedTuple):
    """A heading, clockwise from north, and how fast it changes."""

    heading_rad: float
    rate_rad_s: float


@dataclass(frozen=True)
class Nose:
    """What the nose of a vehicle is turned to, and how fast it may be.

    Attributes:
        heading: What the mission says; None where it says nothing.
        rate_rad_s: The largest yaw rate.
        toward_m: Where it looks, if that is one place.
        stretches: The lanes along which it looks, in order; what the mission says holds elsewhere.
        rests_s: Begin and end of each time, of laps in the first, in which the vehicle stands still, in order.
    """

    heading: Heading | None = None
    rate_rad_s: float = TURN_RAD_S
    toward_m: Point | None = None
    stretches: tuple[Stretch, ...] = ()
    rests_s: tuple[tuple[float, float], ...] = ()

    @cached_property
    def _ends_s(self) -> tuple[list[float], list[float]]:
        return [each.end_s for each in self.stretches], [end for _, end in self.rests_s]

    def at(
        self, once_s: float, position_m: Point, velocity_m_s: Point, acceleration_m_s2: Point = (0.0, 0.0)
    ) -> Turned | None:
        """Where the nose looks at a time of the trajectory, of laps in the first; None where it stays as it is.

        Position, velocity and acceleration are those at this time, east and north.
        """
        following = bisect_right(self._ends_s[0], once_s)
        if following < len(self.stretches):
            lane = self.stretches[following]
            if once_s >= lane.begin_s - lead_s(self.rate_rad_s):
                return Turned(lane.heading_rad, 0.0)
        if self.heading is not None and self.heading.look is Look.FIXED:
            return Turned(self.heading.fixed_rad, 0.0)
        if self.toward_m is not None:
            away = self.toward_m[0] - position_m[0], self.toward_m[1] - position_m[1]
            return _turned(away, (-velocity_m_s[0], -velocity_m_s[1]), NEAR_M)
        return _turned(velocity_m_s, acceleration_m_s2, MOVING_M_S)

    def rest_left_s(self, once_s: float) -> float | None:
        """How long the vehicle stands still from a time on, if it turns meanwhile to where it sets out; else None."""
        if self.heading is None or self.heading.look not in {Look.AHEAD, Look.LANES}:
            return None
        following = bisect_right(self._ends_s[1], once_s)
        if following == len(self.rests_s) or once_s < self.rests_s[following][0]:
            return 0.0
        return self.rests_s[following][1] - once_s


def _turned(vector: Point, change: Point, least: float) -> Turned | None:
    """The heading of a vector, and its rate; None where it is hardly any."""
    (x, y), (u, v) = vector, change
    square = x * x + y * y
    return Turned(atan2(x, y), (y * u - x * v) / square) if square > least * least else None


def looked_toward(spec: MissionSpec, partition: Partition, labelling: Labelling) -> Point | None:
    """The centre of the region that the nose looks toward, if it does, ENU in the domain."""
    heading = spec.flight.heading
    if heading is None or heading.look is not Look.TOWARD:
        return None
    inside = np.zeros(partition.size, dtype=np.bool_)
    inside[labelling.triangles_of(heading.region)] = True
    centre = union_of(partition, inside).centroid
    return float(centre.x), float(centre.y)


def nose_of(plan: FlightPlan) -> Nose:
    """Where the nose of a planned flight looks."""
    spec = plan.spec
    stretches = [
        Stretch(each.begin_s, each.end_s, each.heading_rad) for each in plan.photographs if each.heading_rad is not None
    ]
    if spec.flight.heading is not None and spec.flight.heading.look is Look.LANES:
        stretches = [lane for visit in looked_along(spec, plan.covers) for lane in _lanes(plan.trajectory, visit)]
    return Nose(
        heading=spec.flight.heading,
        rate_rad_s=spec.limits.yaw_rate_rad_s,
        toward_m=looked_toward(spec, plan.partition, plan.labelling),
        stretches=tuple(stretches),
        rests_s=tuple(_rests(plan.trajectory)),
    )


def _lanes(trajectory: Trajectory, visit: CoveredVisit) -> Iterator[Stretch]:
    begins = trajectory.time_at(visit.imaged_s[:, 0], leaving=True).tolist()
    ends = trajectory.time_at(visit.imaged_s[:, 1]).tolist()
    for begin, end, heading in zip(begins, ends, headings_of(visit.lanes_m).tolist(), strict=True):
        if begin < end:
            yield Stretch(begin, end, heading)


def _rests(trajectory: Trajectory) -> Iterator[tuple[float, float]]:
    """When the vehicle stands still for a while, each leg being flown once."""
    begun_s = 0.0
    for leg in trajectory.legs:
        times, still = leg.law.knots_t_s, leg.law.rates == 0.0
        for k in np.flatnonzero(still[1:] & still[:-1] & (np.diff(leg.law.knots_s) == 0.0)).tolist():
            yield begun_s + float(times[k]), begun_s + float(times[k + 1])
        begun_s += leg.duration_s
