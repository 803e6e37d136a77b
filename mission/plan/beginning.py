"""How a plan begins: at a place, at rest or in motion."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import numpy as np
import shapely

from mission.errors import UnprovedError
from mission.geometry.arrays import FloatArray
from mission.plan.begun import LanesLeft, StayLeft
from mission.spec.model import Point
from mission.steering.bezier import DEGREE, BezierCurve
from mission.steering.motion import Motion, Pace
from mission.steering.stopping import Stopping, stopping

_TINY: Final = 1e-12
_OF_LIMITS: Final = 0.75
"""With which the vehicle brakes, in what it can do."""

_OF_JERK: Final = 0.5
"""What the curve takes of it at first; the rest is left for the law to slow down."""

_THROUGH: Final = (1.5, 1.0, 0.5, 0.25)
"""How far ahead a path goes straight on at first, in ways on which the vehicle comes to rest."""


class Onward(NamedTuple):
    """How a curve r(s) goes on, and the law s = sigma(t) with which it is flown.

    Attributes:
        slope_m_s: Shape (2,), r' where it begins.
        bend_m_s2: Shape (2,), r'' there.
        law: sigma' and sigma'' there.
    """

    slope_m_s: FloatArray
    bend_m_s2: FloatArray
    law: tuple[float, float]

    def motion(self, pace: Pace) -> Motion:
        """What a curve is made for: at first it is flown as fast as it is begun, and as an acceleration fades."""
        rate, growth = self.law
        fastest = rate + 0.5 * max(growth, 0.0) ** 2 * float(np.hypot(*self.slope_m_s)) / pace.jerk_m_s3
        return Motion(self.slope_m_s, self.bend_m_s2, _OF_JERK * pace.jerk_m_s3 / fastest**3)


@dataclass(frozen=True)
class Beginning:
    """Where a plan begins, and with which motion.

    Attributes:
        place_m: ENU in the domain.
        velocity_m_s: East and north.
        acceleration_m_s2: Likewise; nothing at rest.
        halts: Whether the vehicle first comes to rest, straight ahead.
        lanes: What is left of visits that cover, which are under way.
        stays: What is left of stays.
        completes: Whether the way to the laps does what one that is under way lacks, and the laps none of that.
    """

    place_m: Point
    velocity_m_s: Point = (0.0, 0.0)
    acceleration_m_s2: Point = (0.0, 0.0)
    halts: bool = False
    lanes: tuple[LanesLeft, ...] = ()
    stays: tuple[StayLeft, ...] = ()
    completes: bool = False

    @property
    def moves(self) -> bool:
        """Whether the vehicle is in motion."""
        return self.velocity_m_s != (0.0, 0.0)

    def onward(self, pace: Pace) -> Onward | None:
        """How a curve begins, and the law with which it is flown; None at rest.

        What the acceleration has along the way is the law's, what it has across it the curve's. A slow vehicle's curve
        begins as fast as it goes on, but for how much it bends: so its parameter is even.
        """
        if not self.moves:
            return None
        velocity, acceleration = np.array(self.velocity_m_s), np.array(self.acceleration_m_s2)
        speed = float(np.hypot(*velocity))
        forward = velocity / speed
        along = float(acceleration @ forward)
        across = acceleration - along * forward
        bent = float(np.sqrt(pace.acceleration_m_s2 / max(float(np.hypot(*across)), _TINY)))
        slope_m_s = max(speed, min(pace.speed_m_s, bent * speed))
        return Onward(slope_m_s * forward, across * (slope_m_s / speed) ** 2, (speed / slope_m_s, along / slope_m_s))

    def each(self) -> Iterator["Beginning"]:
        """How it may go on, the best first: in motion, as it is, or with a halt."""
        yield self
        if self.moves and not self.halts:
            yield replace(self, halts=True)

    def lead_m(self, free: shapely.Geometry, pace: Pace) -> FloatArray:
        """The places through which a path begins, shape (n, 2): in motion, one straight ahead where there is room.

        Args:
            free: Where the path may be.
            pace: What the vehicle can do.
        """
        begin, onward = np.array(self.place_m), self.onward(pace)
        if onward is None:
            return begin[None]
        reach_s = self._stops(onward, pace).way
        for share in _THROUGH:
            lead = np.stack((begin, begin + share * reach_s * onward.slope_m_s))
            if shapely.covers(free, shapely.LineString(lead)):
                return lead
        return begin[None]

    def halt(self, free: shapely.Geometry, pace: Pace) -> BezierCurve:
        """The curve on which the vehicle comes to rest, for which it flies on as it does, straight in the end.

        Args:
            free: Where it may be.
            pace: What the vehicle can do.

        Raises:
            UnprovedError: There is no room.
        """
        begin, onward = np.array(self.place_m), self.onward(pace)
        if onward is not None:
            way = self._stops(onward, pace).way
            # r' = slope + bend s (1 - s / T)^2, in Bernstein polynomials.
            slopes = onward.slope_m_s + np.outer([0.0, 0.25, 1.0 / 6.0, 0.0, 0.0], onward.bend_m_s2) * way
            points = begin + np.concatenate((np.zeros((1, 2)), np.cumsum(slopes, axis=0))) * way / DEGREE
            if shapely.covers(free, shapely.MultiPoint(points).convex_hull):
                return BezierCurve(np.array([0.0, way]), points[None])
        raise UnprovedError("there is no room to come to rest", counterexample=(), where_s=None)

    @staticmethod
    def _stops(onward: Onward, pace: Pace) -> Stopping:
        """How the law comes to rest."""
        slope = float(np.hypot(*onward.slope_m_s))
        most, jerk = (_OF_LIMITS * limit / slope for limit in (pace.acceleration_m_s2, pace.jerk_m_s3))
        return stopping(*onward.law, most, jerk)
