"""What of a plan is flown as it was: the ways from rest to rest that the next plan would make again.

A mission that is planned anew in flight mostly ends as it would have ended: only the way to the next rest is another
one. A taut path from elsewhere comes to the same rests but for a hair, from which everything that follows would differ
by a hair as well, and be made anew for nothing. So a rest close to one of the plan before is moved there, where that is
allowed and no longer; and a way between two such rests, with the same bends, has the curve and the law that it had.
What comes of it is proved like any other path.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
import shapely

from mission.geometry.arrays import FloatArray
from mission.plan.flight_plan import FlightPlan
from mission.spec.model import CORRIDOR, MissionSpec
from mission.steering.bezier import BezierCurve
from mission.steering.known_laws import KnownLaw, laws_of
from mission.steering.polyline import Polyline
from mission.steering.taut import Stretch, TautLine

_SAME_M: Final = 1e-6
_NEAR: Final = 0.01  # of the shorter way to it or from it: how far a rest is moved at most
_LONGER: Final = 1e-3  # by what part these may be longer then


@dataclass(frozen=True, eq=False)
class KeptWay:
    """A way from rest to rest.

    Attributes:
        points_m: Shape (n, 2), the corners of the taut line.
        flown: The curve along it, and its law.
    """

    points_m: FloatArray
    flown: KnownLaw


@dataclass(frozen=True, eq=False)
class Kept:
    """The ways of a plan that may be flown as they were.

    Attributes:
        ways: One after the other.
    """

    ways: tuple[KeptWay, ...] = ()

    @staticmethod
    def of(known: FlightPlan | None, spec: MissionSpec) -> "Kept":
        """Those of a plan, for a mission that is flown in the same manner; none of others."""
        if known is None or spec.smoothing != CORRIDOR or not flown_alike(known.spec, spec):
            return Kept()
        return Kept(tuple(_ways(known))) if isinstance(known.path, Polyline) else Kept()

    @cached_property
    def laws(self) -> tuple[KnownLaw, ...]:
        """The laws of all pieces."""
        return tuple(way.flown for way in self.ways)

    def curve(self, points_m: FloatArray) -> BezierCurve | None:
        """The curve along a taut line from rest to rest, its corners shape (n, 2); None where there is none."""
        for way in self.ways:
            piece = way.flown.piece
            if (
                isinstance(piece, BezierCurve)
                and way.points_m.shape == points_m.shape
                and float(np.abs(way.points_m - points_m).max()) <= _SAME_M
                and (piece.controls_m[[0, -1], [0, -1]] == points_m[[0, -1]]).all()
            ):
                return piece
        return None

    def moved(
        self, lines: Sequence[TautLine], stretches: Sequence[Stretch], rests: Sequence[bool]
    ) -> tuple[TautLine, ...]:
        """Lines whose rests are where the plan before had them, if these are close.

        Args:
            lines: One after the other, flown once.
            stretches: What they do, by their ``stage``.
            rests: Whether the vehicle rests at the end of each line, and may do so anywhere in its target.
        """
        found = list(lines)
        for number, line in enumerate(found):
            end_m = self._end_near(found[number : number + 2]) if rests[number] else None
            if end_m is None or shapely.distance(stretches[line.stage].target, shapely.Point(end_m)) > _SAME_M:
                continue
            around = [replace(line, points_m=np.concatenate((line.points_m[:-1], end_m[None])))]
            around += [
                replace(after, points_m=np.concatenate((end_m[None], after.points_m[1:])))
                for after in found[number + 1 : number + 2]
            ]
            longest_m = (1.0 + _LONGER) * sum(each.length_m for each in found[number : number + 2])
            if sum(each.length_m for each in around) <= longest_m and all(map(_is_free, around)):
                found[number : number + 2] = around
        return tuple(found)

    def _end_near(self, lines: Sequence[TautLine]) -> FloatArray | None:
        """The rest of the plan before next to where the first of some lines ends."""
        near_m = _NEAR * min(line.length_m for line in lines)
        ends = [controls[-1, -1] for way in self.ways if (controls := _controls(way)) is not None]
        ends += [controls[0, 0] for way in self.ways if (controls := _controls(way)) is not None]
        away = [float(np.hypot(*(end - lines[0].points_m[-1]))) for end in ends]
        return ends[int(np.argmin(away))] if away and min(away) <= near_m else None


def _controls(way: KeptWay) -> FloatArray | None:
    return way.flown.piece.controls_m if isinstance(way.flown.piece, BezierCurve) else None


def _is_free(line: TautLine) -> bool:
    """Whether a line stays where it may be, but for rounding."""
    if len(line.points_m) < 2:  # noqa: PLR2004 - a line
        return True
    return bool(shapely.length(shapely.difference(shapely.LineString(line.points_m), line.free)) <= _SAME_M)


def flown_alike(one: MissionSpec, other: MissionSpec) -> bool:
    """Whether the same path is flown in the same manner in two missions."""
    slow = [[region for region in spec.regions if region.speed_m_s is not None] for spec in (one, other)]
    flight = replace(one.flight, laps=other.flight.laps)
    return slow[0] == slow[1] and (flight, one.limits, one.smoothing) == (other.flight, other.limits, other.smoothing)


def _ways(plan: FlightPlan) -> Iterator[KeptWay]:
    """The ways of a plan, with the part of the taut path that belongs to each."""
    points = plan.path.points_m if isinstance(plan.path, Polyline) else np.empty((0, 2))
    points = points[np.append(True, np.abs(np.diff(points, axis=0)).max(axis=1) > 0.0)]
    first = 0
    for flown in (known for leg in plan.trajectory.legs for known in laws_of(leg.curve, leg.law)):
        if not isinstance(flown.piece, BezierCurve):
            continue
        begin, end = flown.piece.controls_m[0, 0], flown.piece.controls_m[-1, -1]
        near = np.flatnonzero(np.abs(points[first:] - begin).max(axis=1) <= _SAME_M)
        if not len(near):
            continue
        begins = first + int(near[0])
        ends = np.flatnonzero(np.abs(points[begins + 1 :] - end).max(axis=1) <= _SAME_M)
        if len(ends):
            first = begins + 1 + int(ends[0])
            yield KeptWay(points[begins : first + 1], flown)
