"""A placed plan as what a ground station uploads: take-off, waypoints, landing; fence; rally points."""

import math
from typing import Final

import numpy as np

from mission.export.placed_plan import PlacedPlan
from mission.export.route import Waypoint
from mission.interchange.autopilot_plan import (
    AS_IT_IS,
    EVER_AGAIN,
    AutopilotPlan,
    Command,
    FencePolygon,
    Item,
)

_OVER_GROUND: Final = 1.0
_SAME_THROTTLE: Final = -1.0
_ACCEPT_M: Final = (0.5, 2.0)
"""A vehicle that must come nearer than the first may miss it; the second is what autopilots take by themselves."""


def autopilot_plan(placed: PlacedPlan) -> AutopilotPlan:
    """Everything that an autopilot needs to fly a plan by itself."""
    plan = placed.plan
    rings = [(True, placed.fence.inclusion_m), *((False, ring) for ring in placed.fence.exclusions_m)]
    return AutopilotPlan(
        home=placed.places(np.array([plan.start_m]))[0],
        items=_items(placed),
        fence=tuple(FencePolygon(inclusion, tuple(placed.places(ring))) for inclusion, ring in rings),
        rally=tuple((place, plan.trajectory.altitude_m) for place in placed.places(placed.rally_m)),
        speed_m_s=speed_m_s(placed),
    )


def speed_m_s(placed: PlacedPlan) -> float:
    """The speed over ground that is asked of the autopilot: the plan's reference speed, within the vehicle's limit."""
    return min(placed.plan.spec.flight.speed_m_s, placed.plan.spec.limits.speed_m_s)


def _items(placed: PlacedPlan) -> tuple[Item, ...]:
    route, height_m = placed.route, placed.plan.trajectory.altitude_m
    start, end = placed.places(np.array([route.once[0].place_m, route.once[-1].place_m]))
    items = [
        Item(Command.TAKEOFF, (0.0, 0.0, 0.0, AS_IT_IS), start, height_m),
        Item(Command.CHANGE_SPEED, (_OVER_GROUND, speed_m_s(placed), _SAME_THROTTLE, 0.0)),
    ]
    for number, part in enumerate(route.parts):
        begins = len(items)
        # Each part begins where the vehicle is: at the take-off, or at the end of the part before.
        places = placed.places(np.array([waypoint.place_m for waypoint in part[1:]]))
        for waypoint, place in zip(part[1:], places, strict=True):
            params = (_whole(waypoint), _accept_m(placed), 0.0, AS_IT_IS)
            items += [Item(Command.WAYPOINT, params, place, height_m), *_images(waypoint)]
        if number == route.lap and route.laps != 1:
            again = EVER_AGAIN if route.laps is None else route.laps - 1
            items.append(Item(Command.JUMP, (float(begins), float(again), 0.0, 0.0)))
    return (*items, Item(Command.LAND, (0.0, 0.0, 0.0, AS_IT_IS), end, 0.0))


def _images(waypoint: Waypoint) -> tuple[Item, ...]:
    """Images by distance from a waypoint on, the first one there; or no more."""
    distance_m = waypoint.trigger_m
    if distance_m is None:
        return ()
    return (Item(Command.TRIGGER_CAMERA, (distance_m, 0.0, float(distance_m > 0.0), 0.0)),)


def _whole(waypoint: Waypoint) -> float:
    """Seconds to stand still, never less than asked: ArduPilot counts whole ones."""
    return float(math.ceil(waypoint.hold_s))


def _accept_m(placed: PlacedPlan) -> float:
    """How near to a waypoint is there: what the legs leave of the tube, for so much of a corner may be cut off."""
    least, most = _ACCEPT_M
    return min(most, max(least, placed.plan.certificate.tube_m - placed.route.deviation_m))
