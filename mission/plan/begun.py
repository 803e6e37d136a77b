"""Visits under way: what is left of the lanes of a region, or of a stay, when a flight is planned anew."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import shapely

from mission.coverage.flown import covered_share
from mission.plan.covering import CoveredVisit, swath_along
from mission.plan.flight_plan import FlightPlan
from mission.steering.rounded import RoundedPolyline

_SAME_S: Final = 1e-6
_STEP_S: Final = 0.1
_SIMPLER: Final = 2e-4  # of the spacing: by how much what was covered may be less than it was


@dataclass(frozen=True, eq=False)
class LanesLeft:
    """The lanes of a visit that are not flown yet.

    Attributes:
        curve: On which they are flown: the rest of the one that was planned.
        visit: What is covered on it; its times count from the begin of the curve.
    """

    curve: RoundedPolyline
    visit: CoveredVisit

    @property
    def region(self) -> str:
        """The region that they cover."""
        return self.visit.region

    def at(self, start_s: float) -> CoveredVisit:
        """The visit, if the curve is flown from a steering time on."""
        first_s = self.visit.first_s
        return replace(
            self.visit,
            start_s=start_s,
            lanes_s=start_s + self.visit.lanes_s,
            first_s=None if first_s is None else start_s + first_s,
        )


@dataclass(frozen=True)
class StayLeft:
    """A stay that is not over.

    Attributes:
        region: In which the vehicle stands.
        seconds: How much longer.
    """

    region: str
    seconds: float


def lanes_left(plan: FlightPlan, flown_s: float, met: frozenset[str]) -> Iterator[LanesLeft]:
    """What is left of the visits that cover regions which were entered.

    Args:
        plan: What was flown until then.
        flown_s: Time on its trajectory, of the first lap.
        met: The regions that were entered.
    """
    place_s = float(plan.trajectory.parameter([flown_s])[0])
    for visit in plan.covers:
        if visit.region not in met or place_s >= float(visit.lanes_s[-1, 1]) - _SAME_S:
            continue
        number = int(np.argmin(np.abs(plan.curve.joints_s[:-1] - visit.start_s)))
        curve = plan.curve.pieces[number]
        if isinstance(curve, RoundedPolyline):
            yield _left(plan, visit, curve, max(0.0, place_s - visit.start_s))


def stays_left(plan: FlightPlan, flown_s: float, met: frozenset[str]) -> Iterator[StayLeft]:
    """What is left of the stays in regions which were entered; the arguments are those of ``lanes_left``."""
    loitering = [region.name for region in plan.spec.regions if region.loiter_s > 0.0 and region.name in met]
    for s, seconds in plan.stops:
        left_s = float(plan.trajectory.time_at(s, leaving=True)[0]) - flown_s
        if left_s > _SAME_S:
            place = shapely.Point(*plan.curve.position([s])[0])
            for name in loitering:
                if shapely.intersects(plan.area_of(name), place):
                    yield StayLeft(name, min(seconds, left_s))


def _left(plan: FlightPlan, visit: CoveredVisit, curve: RoundedPolyline, place_s: float) -> LanesLeft:
    lanes_s = visit.lanes_s - visit.start_s
    flown = lanes_s[:, 0] < place_s
    rest = curve.rest(place_s)
    left = lanes_s[:, 1] > place_s + _SAME_S
    lanes_m = visit.lanes_m[left].copy()
    if (flown & left).any():
        lanes_m[0, 0] = rest.corners_m[0]
    before = [] if visit.before is None else [visit.before]
    if flown.any():
        before.append(swath_along(curve, np.minimum(lanes_s[flown], place_s), visit.spacing_m))
    covered = shapely.simplify(shapely.union_all(before), _SIMPLER * visit.spacing_m) if before else None
    own_s = np.maximum(lanes_s[left] - place_s, 0.0)
    swath = swath_along(rest, own_s, visit.spacing_m)
    share = covered_share(plan.area_of(visit.region), swath if covered is None else shapely.union_all([covered, swath]))
    ways_m = rest.lengths_m.sum() - np.diff(own_s, axis=1).sum() * rest.speed_m_s
    return LanesLeft(
        rest,
        replace(
            visit,
            start_s=0.0,
            lanes_m=lanes_m,
            lanes_s=own_s,
            ways_m=max(0.0, float(ways_m)),
            planned_share=share,
            before=covered,
            first_s=_next_image_s(visit, curve, int(np.argmax(left)), place_s),
        ),
    )


def _next_image_s(visit: CoveredVisit, curve: RoundedPolyline, number: int, place_s: float) -> float | None:
    """How long after a place on the curve, in a lane or before it, its next image is due; None where none are taken."""
    if visit.trigger_m is None:
        return None
    begin_s, end_s = (visit.lanes_s[number] - visit.start_s).tolist()
    if number == 0 and visit.first_s is not None:
        begin_s = visit.first_s - visit.start_s
    if place_s <= begin_s:
        return float(begin_s) - place_s
    s = np.linspace(begin_s, end_s, 2 + int((end_s - begin_s) / _STEP_S))
    steps = np.diff(curve.position(s), axis=0)
    flown_m = np.concatenate(([0.0], np.cumsum(np.hypot(steps[:, 0], steps[:, 1]))))
    taken = int(np.interp(place_s, s, flown_m) / visit.trigger_m)
    return float(np.interp((taken + 1) * visit.trigger_m, flown_m, s)) - place_s
