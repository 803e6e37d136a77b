"""The MAVLink commands that files of missions and fences are made of, by number, and what these are here."""

from typing import Final

from mission.interchange.features import Role

WAYPOINT: Final = 16
TAKEOFF: Final = 22
SPEED: Final = 178
FLOWN_THROUGH: Final = frozenset({16, 17, 18, 19, 31, 82})
"""Waypoints, loiters and splines (MAV_CMD_NAV_*)."""

RETURN_POINT: Final = 5000
POLYGON: Final = {5001: Role.BOUNDARY, 5002: Role.RESTRICTED}
CIRCLE: Final = {5003: Role.BOUNDARY, 5004: Role.RESTRICTED}
RALLY_POINT: Final = 5100
"""MAV_CMD_NAV_FENCE_* and MAV_CMD_NAV_RALLY_POINT."""

FENCES: Final = {Role.BOUNDARY: "inclusion", Role.RESTRICTED: "exclusion"}


def fenced(shape_name: str, role: Role, number: int) -> tuple[str, Role, str]:
    """Name, role and reason of a part of a geofence, counted from 1."""
    return f"{FENCES[role]}_{shape_name}_{number}", role, f"an {FENCES[role]} fence"
