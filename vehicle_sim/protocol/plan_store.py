"""Plans that a ground station leaves with the vehicle: mission, geofence, rally points, as items of MAVLink.

https://mavlink.io/en/services/mission.html. The items are kept as sent; `place_fault` says what is wrong
with one of a fence or of rally points, `mission_items` what is wrong with one of a mission.
"""

from enum import IntEnum
from math import isfinite
from typing import Final, NamedTuple

from vehicle_sim.protocol.dialect import mavlink
from vehicle_sim.protocol.places import GLOBAL_FRAMES, is_longitude, is_place
from vehicle_sim.protocol.units import E7

MOST_ITEMS: Final = 1000
"""An upload of more is refused for lack of space."""


class PlanKind(IntEnum):
    """Which plan; the values are those of MAV_MISSION_TYPE."""

    MISSION = 0
    FENCE = 1
    RALLY = 2


class PlanItem(NamedTuple):
    """One item; `x` and `y` as in MISSION_ITEM_INT (degrees * 1e7 in a global frame).

    `is_current` marks the item to begin at.
    """

    frame: int
    command: int
    autocontinue: int
    params: tuple[float, float, float, float]
    x: int
    y: int
    z: float
    is_current: bool = False


def _commands(*names: str) -> frozenset[int]:
    return frozenset(getattr(mavlink, f"MAV_CMD_{name}") for name in names)


_COMMANDS: Final = {
    PlanKind.FENCE: _commands(
        "NAV_FENCE_RETURN_POINT",
        "NAV_FENCE_POLYGON_VERTEX_INCLUSION",
        "NAV_FENCE_POLYGON_VERTEX_EXCLUSION",
        "NAV_FENCE_CIRCLE_INCLUSION",
        "NAV_FENCE_CIRCLE_EXCLUSION",
    ),
    PlanKind.RALLY: _commands("NAV_RALLY_POINT"),
}


def place_fault(kind: PlanKind, item: PlanItem) -> int:
    """Return the MAV_MISSION_RESULT of an item of a fence or of rally points: accepted, or what is wrong with it."""
    if item.command not in _COMMANDS[kind]:
        return int(mavlink.MAV_MISSION_UNSUPPORTED)
    if item.frame not in GLOBAL_FRAMES:
        return int(mavlink.MAV_MISSION_UNSUPPORTED_FRAME)
    if not is_longitude(item.y / E7):
        return int(mavlink.MAV_MISSION_INVALID_PARAM6_Y)
    if not is_place(item.x / E7, item.y / E7):
        return int(mavlink.MAV_MISSION_INVALID_PARAM5_X)
    if not isfinite(item.z):
        return int(mavlink.MAV_MISSION_INVALID_PARAM7)
    return int(mavlink.MAV_MISSION_ACCEPTED)


class PlanStore:
    """The plans that the vehicle holds now.

    Attributes:
        plans: The items of each kind.
        ids: The opaque identifier of each plan; 0 where the flavour has none, or the plan no items.
    """

    def __init__(self) -> None:
        self.plans: dict[PlanKind, tuple[PlanItem, ...]] = dict.fromkeys(PlanKind, ())
        self.ids: dict[PlanKind, int] = dict.fromkeys(PlanKind, 0)

    def replace(self, kind: PlanKind, items: tuple[PlanItem, ...], plan_id: int = 0) -> None:
        """Put a plan in the place of the one of its kind."""
        self.plans[kind] = items
        self.ids[kind] = plan_id
