"""What ground stations upload to an autopilot: mission items, geofence and rally points, as values.

https://mavlink.io/en/services/mission.html and https://mavlink.io/en/messages/common.html#mav_commands.
"""

import math
from dataclasses import dataclass
from enum import IntEnum
from typing import Final

from mission.geometry.geodesy import LatLon
from mission.interchange import commands

AS_IT_IS: Final = math.nan
"""In the place of a heading: as the autopilot's parameters have it."""

EVER_AGAIN: Final = -1
"""In the place of the number of repetitions of a jump."""


class Command(IntEnum):
    """Values of MAV_CMD."""

    WAYPOINT = commands.WAYPOINT
    LAND = 21
    TAKEOFF = commands.TAKEOFF
    TURN = 115
    JUMP = 177
    CHANGE_SPEED = commands.SPEED
    LOOK_AT = 195
    LOOK_AHEAD = 197
    TRIGGER_CAMERA = 206


class Frame(IntEnum):
    """Values of MAV_FRAME: what the height of a place counts from, or that an item has none."""

    ABOVE_SEA = 0
    NO_PLACE = 2
    ABOVE_HOME = 3


@dataclass(frozen=True)
class Item:
    """One mission item.

    Attributes:
        command: A value of MAV_CMD.
        params: Its first four parameters; of a jump, the first is the index of its target among the items, from 0.
        place: Where; None for a command without a place.
        height_m: Above home, of a command with a place.
    """

    command: Command
    params: tuple[float, float, float, float]
    place: LatLon | None = None
    height_m: float = 0.0

    def numbered(self, home_items: int) -> tuple[float, float, float, float]:
        """The parameters where so many items stand before the first: a jump names its target by number."""
        if self.command is not Command.JUMP:
            return self.params
        return (self.params[0] + home_items, *self.params[1:])


@dataclass(frozen=True)
class FencePolygon:
    """A polygon to stay inside of, or outside; the last corner is joined to the first."""

    inclusion: bool
    corners: tuple[LatLon, ...]


@dataclass(frozen=True)
class FenceCircle:
    """A circle to stay inside of, or outside."""

    inclusion: bool
    centre: LatLon
    radius_m: float


@dataclass(frozen=True)
class AutopilotPlan:
    """Everything that is uploaded.

    Attributes:
        home: Where the vehicle takes off.
        items: The mission, in order.
        fence: Areas of the geofence.
        rally: Places to return to, each with a height above home.
        speed_m_s: Over ground.
    """

    home: LatLon
    items: tuple[Item, ...]
    fence: tuple[FencePolygon | FenceCircle, ...]
    rally: tuple[tuple[LatLon, float], ...]
    speed_m_s: float
