"""How a plan begins: at a place, at rest or in motion."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import numpy as np
import shapely

from mission.errors import NoRollingStartError, UnprovedError
from mission.geometry.arrays import FloatArray
from mission.plan.begun import LanesLeft, StayLeft
from mission.spec.model import Point
from mission.steering.bezier import DEGREE, BezierCurve
from mission.steering.grid import Limits
from mission.steering.known_laws import KnownLaw, known_law
from mission.steering.motion import Motion, Pace
from mission.steering.stopping import Stopping, stopping

_TINY: Final = 1e-12
_BRAKES: Final = ((0.75, 0.75), (0.4, 0.4), (0.86, 0.95))
"""With which the vehicle brakes, in what acceleration and jerk it can do: straight on, in a bend, with little room."""

_OF_JERK: Final = 0.5
"""What the curve takes of it at first; the rest is left for the law to slow down."""

_THROUGH: Final = (1.5, 1.0, 0.5, 0.25)
"""How far ahead a path goes straight on at first, in ways on which the vehicle comes to rest."""

_SHARPEST: Final = float(np.cos(np.radians(75.0)))
"""The cosine of a turn; for the path behind one that is sharper there hardly ever is a time law."""


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

    def each(self, way_m: FloatArray, pace: Pace) -> Iterator["Beginning"]:
        """How it may go on, the best first: in motion, as it is, or with a halt.

        Args:
            way_m: Shape (n, 2), about where it will lead.
            pace: What the vehicle can do.
        """
        onward = self.onward(pace)
        if onward is None:
            yield self
            return
        steps = way_m - np.array(self.place_m)
        beyond = steps[np.hypot(steps[:, 0], steps[:, 1]) > self._stops_m(onward, pace)][:1]
        back = any(_is_sharp(onward, step) for step in beyond)
        yield from (replace(self, halts=halts) for halts in ((True, False) if back else (False, True)))

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

    def halt(
        self, onward: Onward, free: shapely.Geometry, pace: Pace, limits: Callable[[BezierCurve], Limits]
    ) -> tuple[BezierCurve, tuple[KnownLaw, ...]]:
        """The curve on which the vehicle comes to rest, for which it flies on as it does, straight in the end.

        Args:
            onward: How it flies on.
            free: Where it may be.
            pace: What the vehicle can do.
            limits: Of the law, on a curve.

        Returns:
            The curve, and its law, if one is known.

        Raises:
            UnprovedError: There is no room.
        """
        begin = np.array(self.place_m)
        roomy: BezierCurve | None = None
        for brake in _BRAKES:
            stop = self._stops(onward, pace, brake)
            # r' = slope + bend s (1 - s / T)^2, in Bernstein polynomials.
            slopes = onward.slope_m_s + np.outer([0.0, 0.25, 1.0 / 6.0, 0.0, 0.0], onward.bend_m_s2) * stop.way
            points = begin + np.concatenate((np.zeros((1, 2)), np.cumsum(slopes, axis=0))) * stop.way / DEGREE
            if not shapely.covers(free, shapely.MultiPoint(points).convex_hull):
                continue
            curve = BezierCurve(np.array([0.0, stop.way]), points[None])
            law = stop.law(onward.law[0])
            known = (KnownLaw(curve, law),)
            if known_law(curve, (0.0, stop.way), known, limits(curve), (), begins=onward.law) is not None:
                return curve, known
            roomy = roomy or curve
        if roomy is None:
            raise UnprovedError("there is no room to come to rest", counterexample=(), where_s=None)
        return roomy, ()

    def check_turn(self, line_m: FloatArray, pace: Pace) -> None:
        """See to it that a path does not turn back behind its lead.

        Args:
            line_m: Shape (n, 2), the taut line from the end of the lead to the first rest.
            pace: What the vehicle can do.

        Raises:
            NoRollingStartError: It turns so sharply, on the way on which the vehicle comes to rest, that it would.
        """
        onward = self.onward(pace)
        if onward is None or self.halts:
            return
        steps = np.diff(line_m, axis=0)
        gone_m = np.concatenate(([0.0], np.cumsum(np.hypot(steps[:, 0], steps[:, 1]))))
        reach_m = min(self._stops_m(onward, pace), float(gone_m[-1]))
        ahead = np.array([np.interp(reach_m, gone_m, axis) for axis in line_m.T]) - line_m[0]
        if _is_sharp(onward, ahead):
            raise NoRollingStartError("the path turns too sharply to be gone on to in flight")

    def _stops_m(self, onward: Onward, pace: Pace) -> float:
        """On how long a way the vehicle comes to rest."""
        return self._stops(onward, pace).way * float(np.hypot(*onward.slope_m_s))

    @staticmethod
    def _stops(onward: Onward, pace: Pace, brake: tuple[float, float] = _BRAKES[0]) -> Stopping:
        """How the law comes to rest."""
        slope = float(np.hypot(*onward.slope_m_s))
        most, jerk = brake[0] * pace.acceleration_m_s2 / slope, brake[1] * pace.jerk_m_s3 / slope
        return stopping(*onward.law, most, jerk)


def _is_sharp(onward: Onward, step_m: FloatArray) -> bool:
    """Whether the vehicle has to turn sharply to go somewhere, shape (2,)."""
    return bool(step_m @ onward.slope_m_s < _SHARPEST * np.hypot(*step_m) * np.hypot(*onward.slope_m_s))
