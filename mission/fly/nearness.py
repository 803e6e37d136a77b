"""How near a vehicle is to what it must not enter."""

import math

import shapely

from mission.plan import FlightPlan
from mission.spec.model import Point
from mission.spec.restricted import restricted_as_drawn


class Nearness:
    """Measures distances to the restricted regions of a plan, whose shapes it keeps until there is another plan."""

    def __init__(self) -> None:
        """Know no plan yet."""
        self._plan: FlightPlan | None = None
        self._shapes: dict[str, shapely.Geometry] = {}

    def of(self, plan: FlightPlan, place_m: Point) -> tuple[str, float] | None:
        """The restricted region that is nearest to a place, as it is drawn, and its distance in metres, 0 inside.

        None where the plan has none, or the place is not known.
        """
        if plan is not self._plan:
            self._plan = plan
            self._shapes = restricted_as_drawn(plan.spec, plan.partition, plan.labelling)
            shapely.prepare([*self._shapes.values()])
        if not all(map(math.isfinite, place_m)):
            return None
        place = shapely.Point(place_m)
        distances = {name: float(shapely.distance(shape, place)) for name, shape in self._shapes.items()}
        nearest = min(distances, key=distances.__getitem__, default=None)
        return None if nearest is None else (nearest, distances[nearest])
