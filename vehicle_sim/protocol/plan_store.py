"""Plans that a ground station leaves with the vehicle: mission, geofence, rally points, as items of MAVLink.

https://mavlink.io/en/services/mission.html. The items are kept as sent; `fault` says what is wrong with one.
"""

from enum import IntEnum
from math import isfinite
from typing import Final, NamedTuple

from vehicle_sim.protocol.dialect import mavlink
from vehicle_sim.protocol.places import GLOBAL_FRAMES, is_place
from vehicle_sim.protocol.units import E7

MOST_ITEMS: Final = 1000
"""An upload of more is refused for lack of space."""


class PlanKind(IntEnum):
    """Which plan; the values are those of MAV_MISSION_TYPE."""

    MISSION = 0
    FENCE = 1
    RALLY = 2


class PlanItem(NamedTuple):
    """One item; `x` and `y` as in MISSION_ITEM_INT (degrees * 1e7 in a global frame)."""

    frame: int
    command: int
    autocontinue: int
    params: tuple[float, float, float, float]
    x: int
    y: int
    z: float


def _commands(*names: str) -> frozenset[int]:
    return frozenset(getattr(mavlink, f"MAV_CMD_{name}") for name in names)


_PLACED: Final = {
    PlanKind.MISSION: _commands(
        "NAV_WAYPOINT",
        "NAV_LOITER_UNLIM",
        "NAV_LOITER_TURNS",
        "NAV_LOITER_TIME",
        "NAV_LAND",
        "NAV_TAKEOFF",
        "NAV_SPLINE_WAYPOINT",
        "DO_SET_HOME",
        "DO_SET_ROI",
        "DO_SET_ROI_LOCATION",
        "DO_LAND_START",
    ),
    PlanKind.FENCE: _commands(
        "NAV_FENCE_RETURN_POINT",
        "NAV_FENCE_POLYGON_VERTEX_INCLUSION",
        "NAV_FENCE_POLYGON_VERTEX_EXCLUSION",
        "NAV_FENCE_CIRCLE_INCLUSION",
        "NAV_FENCE_CIRCLE_EXCLUSION",
    ),
    PlanKind.RALLY: _commands("NAV_RALLY_POINT"),
}
_UNPLACED: Final = {
    PlanKind.MISSION: _commands(
        "NAV_RETURN_TO_LAUNCH",
        "NAV_DELAY",
        "CONDITION_DELAY",
        "CONDITION_DISTANCE",
        "CONDITION_YAW",
        "DO_JUMP",
        "DO_CHANGE_SPEED",
        "DO_SET_ROI_NONE",
        "DO_MOUNT_CONTROL",
        "DO_DIGICAM_CONTROL",
        "DO_SET_CAM_TRIGG_DIST",
        "DO_SET_SERVO",
        "DO_SET_RELAY",
    ),
    PlanKind.FENCE: frozenset(),
    PlanKind.RALLY: frozenset(),
}
_FRAMES: Final = GLOBAL_FRAMES | {mavlink.MAV_FRAME_MISSION}


def fault(kind: PlanKind, item: PlanItem) -> int:
    """Return the MAV_MISSION_RESULT of an item: accepted, or the first thing that is wrong with it."""
    is_placed = item.command in _PLACED[kind]
    if not is_placed and item.command not in _UNPLACED[kind]:
        return int(mavlink.MAV_MISSION_UNSUPPORTED)
    if item.frame not in _FRAMES:
        return int(mavlink.MAV_MISSION_UNSUPPORTED_FRAME)
    if is_placed and not is_place(item.x / E7, 0.0):
        return int(mavlink.MAV_MISSION_INVALID_PARAM5_X)
    if is_placed and not is_place(0.0, item.y / E7):
        return int(mavlink.MAV_MISSION_INVALID_PARAM6_Y)
    if is_placed and not isfinite(item.z):  # clients leave what a command does not use without a value
        return int(mavlink.MAV_MISSION_INVALID_PARAM7)
    return int(mavlink.MAV_MISSION_ACCEPTED)


class PlanStore:
    """The plans that the vehicle holds now.

    Attributes:
        plans: The items of each kind.
        current: The mission's item that is next.
    """

    def __init__(self) -> None:
        self.plans: dict[PlanKind, tuple[PlanItem, ...]] = dict.fromkeys(PlanKind, ())
        self.current = 0

    def replace(self, kind: PlanKind, items: tuple[PlanItem, ...]) -> None:
        """Put a plan in the place of the one of its kind; a new mission starts at its beginning."""
        self.plans[kind] = items
        if kind is PlanKind.MISSION:
            self.current = 0
