"""The geofence that guards a flight: a plan's fence in the frame that is flown in, as the autopilot takes it."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any, Final

from mission.errors import GeometryError, VehicleError
from mission.fly.circumstances import GEOFENCE, GEOFENCE_RENEWED
from mission.fly.recording import Recording
from mission.geometry.geodesy import LatLon
from mission.link.contact import Contact
from mission.link.fence_guard import FenceBefore, FenceGuard, fence_items
from mission.link.frames import Anchor, Anchoring, enu_from_ned
from mission.link.plan_values import PlanItem
from mission.plan import FlightPlan
from mission.plan.fence import fence_of, placed
from mission.plan.guarding import frame_share, opened, reach_m, thinned
from mission.report.reading import Entry

_CEILING_SHARE: Final = 0.2
_LEAST_ABOVE_M: Final = 5.0
"""How far the ceiling is above the altitude that is flown: that share of it, and this at least."""


_UNPLACED: Final = "the vehicle has not told where on Earth it is, which a geofence needs"


def guarded(plan: FlightPlan, anchoring: Anchoring, contact: Contact, *, keep: bool) -> tuple[FenceGuard, Anchoring]:
    """What guards the flight of a plan, and how that is tied to the vehicle's frame from now on.

    The fence is laid in the local frame that is flown in and goes to Earth by what the vehicle says of that frame's
    origin. Where the vehicle stands now decides, and no longer where it stands when it is armed, so that the path is
    where the fence was made for it.

    Args:
        plan: What is flown.
        anchoring: How its domain is tied to the vehicle's frame.
        contact: The vehicle, which has told where it is.
        keep: Whether the fence stays after the flight.

    Raises:
        VehicleError: The vehicle has not told where it is, or has no room for the fence.
    """
    vehicle, kind = contact.vehicle, contact.autopilot
    if vehicle.position is None or kind is None:
        raise VehicleError(_UNPLACED)
    north_m, east_m, _ = anchoring(vehicle.position.position_ned_m).origin_ned_m
    guard = FenceGuard(
        items_of(plan, (north_m, east_m), contact),
        kind.fence,
        ceiling_m=_ceiling_m(plan),
        own=contact.own,
        bytewise=kind.bytewise,
        keep=keep,
    )
    return guard, anchored_at(north_m, east_m, anchoring)


def items_of(plan: FlightPlan, origin_ned_m: tuple[float, float], contact: Contact) -> tuple[PlanItem, ...]:
    """The fence of a plan as the vehicle is to keep it, where its domain's (0, 0) lies there in the vehicle's frame.

    Raises:
        VehicleError: The vehicle has not told where it is, or has no room for the fence.
    """
    vehicle, kind = contact.vehicle, contact.autopilot
    if vehicle.origin is None or kind is None:
        raise VehicleError(_UNPLACED)
    shift = enu_from_ned((*origin_ned_m, 0.0))[:2]
    origin = LatLon(vehicle.origin.latitude_deg, vehicle.origin.longitude_deg)
    fence = fence_of(plan)
    off = frame_share(kind.fence.sphere_m, origin.latitude_deg, vehicle.origin.altitude_amsl_m)
    fitting = thinned(opened(fence, off * reach_m(fence, shift)), kind.fence.room)
    if fitting is None:
        raise VehicleError(
            f"{kind.name} has no room for a geofence of this mission, of {len(fence.rims)} areas; draw fewer, or let "
            f"`--no-fence` fly it without one"
        )
    try:
        return fence_items(placed(fitting, origin, shift))
    except GeometryError as error:
        raise VehicleError(f"the vehicle cannot be fenced in: {error}") from error


def renew(
    guard: FenceGuard,
    plans: tuple[FlightPlan, FlightPlan],
    origin_ned_m: tuple[float, float],
    contact: Contact,
    record: Recording,
) -> None:
    """Let the geofence follow where another plan has other areas, or needs less of them, than the one before it."""
    one, other = (plan.spec for plan in plans)
    try:
        items = items_of(plans[1], origin_ned_m, contact)
        if (one.regions, one.domain) == (other.regions, other.domain) and {*guard.items} <= {*items}:
            return
        guard.renew(items)
    except VehicleError as error:
        record.warn(f"the geofence stays as it was: {error}")
    newest_s = contact.vehicle.clock.newest_s
    record.write("event", newest_s, name=GEOFENCE_RENEWED, items=[asdict(item) for item in guard.items])


def guarded_again(events: Sequence[Entry], plan: FlightPlan, contact: Contact, *, keep: bool) -> FenceGuard | None:
    """What guards a flight that is taken up again: the fence that it set, to be put back to what was there before.

    Args:
        events: What its record says; of the fence, if it set one, what there was before and what it is to be now.
        plan: What is flown.
        contact: The vehicle.
        keep: Whether the fence stays after the flight.
    """
    kind = contact.autopilot
    told = [event for event in events if event.text in {GEOFENCE, GEOFENCE_RENEWED}]
    if kind is None or not told:
        return None
    values = next(event.values for event in reversed(told) if event.text == GEOFENCE)
    *earlier, items = (tuple(map(_item, event.values["items"])) for event in told)
    before = tuple(map(_item, values["items_before"]))
    parameters = {str(name): float(value) for name, value in values["parameters_before"].items()}
    return FenceGuard(
        items,
        kind.fence,
        ceiling_m=_ceiling_m(plan),
        own=contact.own,
        bytewise=kind.bytewise,
        keep=keep,
        before=FenceBefore(parameters, before),
        earlier=earlier,
    )


def _item(values: Mapping[str, Any]) -> PlanItem:
    first, second, third, fourth = values["params"]
    return PlanItem(**{**values, "params": (first, second, third, fourth)})


def _ceiling_m(plan: FlightPlan) -> float:
    altitude_m = plan.trajectory.altitude_m
    return altitude_m + max(_LEAST_ABOVE_M, _CEILING_SHARE * altitude_m)


def anchored_at(north_m: float, east_m: float, anchoring: Anchoring) -> Anchoring:
    """The same anchor whatever the vehicle's place, but for its height."""
    return lambda vehicle_ned_m: Anchor((north_m, east_m, anchoring(vehicle_ned_m).origin_ned_m[2]))
