"""What becomes of the route of a flight that a file has: it is no region, but a few waypoints are places to visit."""

from collections.abc import Sequence
from typing import Final

import numpy as np
import shapely

from mission.decimals import decimal
from mission.draft.frame import Frame
from mission.draft.pieces import RADIUS_M
from mission.interchange.features import Feature, Point, Polygon, Role, Spot

MOST_TURNS: Final = 12
"""As many places somebody has put down one by one; more are the legs of a curve, or lanes that a program has laid."""

_SHARE: Final = 0.4
_LEAST_RADIUS_M: Final = 1.0


def turns_of(route: Sequence[Point], features: Sequence[Feature], frame: Frame) -> tuple[list[Feature], list[str]]:
    """Further features of a route, and what is to be said of it.

    The waypoints are visited, in their order, where they are few and nothing else is there to be surveyed. Where no
    feature is home, that is where the route begins.

    Args:
        route: Waypoints in order.
        features: All that is drawn beside it.
        frame: Where they lie.
    """
    if not route:
        return [], []
    homes = [feature for feature in features if feature.role is Role.HOME]
    begin = [] if homes else [Feature("home", (Spot(route[0]),), Role.HOME, "where the route begins")]
    surveyed = [
        feature
        for feature in features
        if feature.role is Role.SURVEY
        or (feature.role is None and any(isinstance(shape, Polygon) for shape in feature.shapes))
    ]
    if surveyed or len(route) > MOST_TURNS:
        asked = "" if surveyed else "; what it was flown for is not in the file: draw that as polygons"
        return begin, [f"the route of {len(route)} waypoints is left out: a way is no region{asked}"]
    places = shapely.points(frame.metres(route))
    # Shapely 2.1.0 locks what it is given meanwhile, and does not free two views of one array.
    apart_m = shapely.distance(places[:, None].copy(), places)
    nearest_m = float(apart_m[apart_m > 0.0].min(initial=np.inf))
    radius_m = float(np.round(np.clip(_SHARE * nearest_m, _LEAST_RADIUS_M, RADIUS_M), 1))
    reason = f"a waypoint of the route; the circle of {decimal(radius_m)} m about it is this draft's"
    turns = [
        Feature(f"waypoint_{turn}", (Spot(place, radius_m),), Role.SURVEY, reason, turn=turn)
        for turn, place in enumerate(route, start=1)
    ]
    return [*begin, *turns], []
