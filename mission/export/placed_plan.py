"""A plan at its place on Earth, with its route and its fence: what all files are written from."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from mission.errors import Fault, SpecError
from mission.export.route import Route, route_of
from mission.geometry.arrays import FloatArray
from mission.geometry.geodesy import LatLon
from mission.geometry.places import places_at_offsets
from mission.monitor.flight import FlightMonitor
from mission.monitor.verdict import Verdict
from mission.plan import FlightPlan
from mission.plan.fence import Fence, fence_of, rally_points

_HINT = "give `--tolerance` less, so that the legs come nearer to the path that is proved"


@dataclass(frozen=True, eq=False)
class PlacedPlan:
    """A plan, where it lies, and the straight legs that it is flown on.

    Attributes:
        plan: The plan.
        origin: Where its domain's (0, 0) lies.
        route: The legs.
        word: What they spell: labels in order, equal neighbours once.
    """

    plan: FlightPlan
    origin: LatLon
    route: Route
    word: tuple[frozenset[str], ...]

    @property
    def word_text(self) -> str:
        """The word for readers: ``{home} {} {field}``."""
        return " ".join("{" + ",".join(sorted(letter)) + "}" for letter in self.word)

    @cached_property
    def fence(self) -> Fence:
        """The geofence, ENU in the domain."""
        return fence_of(self.plan)

    @cached_property
    def rally_m(self) -> FloatArray:
        """Places to return to, shape (P, 2), ENU in the domain."""
        return np.array(rally_points(self.plan)).reshape(-1, 2)

    @cached_property
    def clearance_m(self) -> float:
        """How far the legs are from the rim of the fence, at their nearest."""
        legs = shapely.LineString([waypoint.place_m for waypoint in self.route.once])
        return self.fence.distance_m(legs)

    def places(self, points_m: FloatArray) -> list[LatLon]:
        """Places on Earth of points of the domain, shape (P, 2)."""
        return [LatLon(*place) for place in places_at_offsets(self.origin, points_m).tolist()]


def placed_plan(plan: FlightPlan, origin: LatLon, tolerance_m: float) -> PlacedPlan:
    """Lay straight legs along a plan's path, and see that who flies them satisfies what the plan satisfies.

    Args:
        plan: The plan.
        origin: Where its domain's (0, 0) lies.
        tolerance_m: How far the legs may be from the smooth path.

    Raises:
        SpecError: The legs do not satisfy it; a smaller tolerance helps. Where regions move, legs without times are
            for looking at alone, and are not asked.
    """
    route = route_of(plan, tolerance_m)
    if plan.spec.moves:
        return PlacedPlan(plan, origin, route, plan.certificate.word)
    judged = FlightMonitor(plan).monitor
    # In triangles the order counts and not the time.
    for number, waypoint in enumerate(route.once):
        judged.observe(float(number), waypoint.place_m)
    if plan.run.recurrent:
        fault = "they violate the specification" * (judged.verdict is Verdict.FALSE or judged.laps < 1)
    else:
        outcome = judged.verdict_at_end(stays=True)
        fault = "" if outcome.achieved else outcome.reason
    if fault:
        message = f"the legs that stay within {tolerance_m:g} m of the path do not fly the mission: {fault}"
        raise SpecError((Fault(0, 0, "--tolerance", message, _HINT),))
    word = [letter for i, letter in enumerate(judged.word) if i == 0 or letter != judged.word[i - 1]]
    return PlacedPlan(plan, origin, route, tuple(word))
