"""A placed plan as what a ground station uploads: take-off, waypoints, landing; fence; rally points."""

from typing import Final

import numpy as np

from mission.errors import Fault, SpecError
from mission.export.nose import nose_items
from mission.export.placed_plan import PlacedPlan
from mission.export.route import Waypoint
from mission.interchange.autopilot_plan import (
    AS_IT_IS,
    EVER_AGAIN,
    AutopilotPlan,
    Command,
    Item,
)
from mission.plan.fence import placed as on_earth

_OVER_GROUND: Final = 1.0
_SAME_THROTTLE: Final = -1.0
_ACCEPT_M: Final = (0.5, 2.0)
"""A vehicle that must come nearer than the first may miss it; the second is what autopilots take by themselves."""

_SHORTEST_STOP_S: Final = 1.0


def autopilot_plan(placed: PlacedPlan, firmware: str) -> AutopilotPlan:
    """Everything that an autopilot needs to fly a plan by itself; ``firmware`` is a key of ``FIRMWARE``.

    Raises:
        SpecError: The plan keeps bounds in seconds, or regions move, and whoever flies waypoints keeps no time law.
    """
    plan = placed.plan
    if plan.required.timed or plan.spec.moves:
        what = f"{plan.required.timed[0]} is" if plan.required.timed else "what it meets of regions that move is"
        message = f"{what} proved of the trajectory, and who flies waypoints keeps no time law"
        hint = "fly it with `mission fly`, or export .kml, .geojson or .gpx to look at"
        raise SpecError((Fault(0, 0, "mission", message, hint),), plan.spec.name)
    return AutopilotPlan(
        home=placed.places(np.array([plan.start_m]))[0],
        items=_items(placed, firmware),
        fence=on_earth(placed.fence, placed.origin),
        rally=tuple((place, plan.trajectory.altitude_m) for place in placed.places(placed.rally_m)),
        speed_m_s=speed_m_s(placed),
    )


def speed_m_s(placed: PlacedPlan) -> float:
    """The speed over ground that is asked of the autopilot: the plan's reference speed, within the vehicle's limit."""
    return min(placed.plan.spec.flight.speed_m_s, placed.plan.spec.limits.speed_m_s)


def _items(placed: PlacedPlan, firmware: str) -> tuple[Item, ...]:
    route, height_m = placed.route, placed.plan.trajectory.altitude_m
    start, end = placed.places(np.array([route.once[0].place_m, route.once[-1].place_m]))
    usual_m_s, nose = speed_m_s(placed), nose_items(placed, firmware)
    items = [
        Item(Command.TAKEOFF, (0.0, 0.0, 0.0, AS_IT_IS), start, height_m),
        _speed(usual_m_s),
    ]
    for number, part in enumerate(route.parts):
        begins, flown_m_s, imaging, imaged = len(items), usual_m_s, False, None
        # Each part begins where the vehicle is: at the take-off, or at the end of the part before.
        places = placed.places(np.array([waypoint.place_m for waypoint in part[1:]]))
        for waypoint, place, held in zip(part[1:], places, _held(placed, part), strict=True):
            asked_m_s = min(usual_m_s, waypoint.speed_m_s)
            items += [*[_speed(asked_m_s)] * (asked_m_s != flown_m_s), *nose.before(imaging=imaging, imaged=imaged)]
            params = (held, _accept_m(placed), 0.0, AS_IT_IS if imaging else nose.heading_deg)
            items += [Item(Command.WAYPOINT, params, place, height_m), *_images(waypoint)]
            flown_m_s, imaged = asked_m_s, imaging
            imaging = imaging if waypoint.trigger_m is None else waypoint.trigger_m > 0.0
        # What comes next begins with the usual speed, another lap too.
        items += [_speed(usual_m_s)] * (flown_m_s != usual_m_s)
        if number == route.lap and route.laps != 1:
            again = EVER_AGAIN if route.laps is None else route.laps - 1
            items.append(Item(Command.JUMP, (float(begins), float(again), 0.0, 0.0)))
    return (*items, *nose.after(), Item(Command.LAND, (0.0, 0.0, 0.0, AS_IT_IS), end, 0.0))


def _speed(speed: float) -> Item:
    return Item(Command.CHANGE_SPEED, (_OVER_GROUND, speed, _SAME_THROTTLE, 0.0))


def _images(waypoint: Waypoint) -> tuple[Item, ...]:
    """Images by distance from a waypoint on, the first one there; or no more."""
    distance_m = waypoint.trigger_m
    if distance_m is None:
        return ()
    return (Item(Command.TRIGGER_CAMERA, (distance_m, 0.0, float(distance_m > 0.0), 0.0)),)


def _held(placed: PlacedPlan, part: tuple[Waypoint, ...]) -> list[float]:
    """Seconds to stand still at each waypoint of a part but its first, never less than the plan asks for.

    Where it need not stand still, an autopilot goes round the corner on an arc that touches both legs at the distance d
    from it, the acceptance radius or half a leg, and passes it d tan(theta / 4) away when it turns by theta. Where this
    is more than may be missing it stops, and so it does where the plan rests, at the end of a part.
    """
    legs = np.diff([waypoint.place_m for waypoint in part], axis=0)
    lengths = np.hypot(*legs.T)
    before, after = legs[:-1], legs[1:]
    crosses = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    turns = np.abs(np.arctan2(crosses, (before * after).sum(axis=1)))
    reach_m = np.minimum(_ACCEPT_M[1], 0.5 * np.minimum(lengths[:-1], lengths[1:]))
    deviation_m = placed.route.deviation_m
    missing_m = max(placed.plan.certificate.tube_m - deviation_m, deviation_m)
    stops = np.append(reach_m * np.tan(0.25 * turns) > missing_m, True)
    # ArduPilot counts whole seconds.
    asked = np.ceil([waypoint.hold_s for waypoint in part[1:]])
    held: list[float] = np.maximum(asked, stops * _SHORTEST_STOP_S).tolist()
    return held


def _accept_m(placed: PlacedPlan) -> float:
    """How near to a waypoint is there: what the legs leave of the tube, for so much of a corner may be cut off."""
    least, most = _ACCEPT_M
    return min(most, max(least, placed.plan.certificate.tube_m - placed.route.deviation_m))
