"""How near a vehicle is to what it must not enter."""

import math

import shapely

from mission.plan import FlightPlan
from mission.spec.model import Point
from mission.spec.restricted import ShapeAt, restricted_as_drawn, restricted_that_move


class Nearness:
    """Measures distances to the restricted regions of a plan, whose shapes it keeps until there is another plan."""

    def __init__(self) -> None:
        """Know no plan yet."""
        self._plan: FlightPlan | None = None
        self._shapes: dict[str, shapely.Geometry] = {}
        self._moving: dict[str, ShapeAt] = {}

    def of(self, plan: FlightPlan, place_m: Point, since_s: float = 0.0) -> tuple[str, float] | None:
        """The restricted region that is nearest to a place, as it is drawn, and its distance in metres, 0 inside.

        None where the plan has none, or the place is not known.

        Args:
            plan: The plan.
            place_m: The place.
            since_s: How long ago the trajectory began, for where what moves is.
        """
        if plan is not self._plan:
            self._plan = plan
            self._shapes = restricted_as_drawn(plan.spec, plan.partition, plan.labelling)
            shapely.prepare([*self._shapes.values()])
            self._moving = restricted_that_move(plan.spec, plan.labelling, plan.moving)
        if not all(map(math.isfinite, place_m)):
            return None
        place = shapely.Point(place_m)
        shapes = self._shapes | {name: shape_at(since_s) for name, shape_at in self._moving.items()}
        distances = {name: float(shapely.distance(shape, place)) for name, shape in shapes.items()}
        nearest = min(distances, key=distances.__getitem__, default=None)
        return None if nearest is None else (nearest, distances[nearest])
