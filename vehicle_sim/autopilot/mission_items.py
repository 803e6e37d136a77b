"""The items of a mission as values: what to do, where, how long.

https://mavlink.io/en/services/mission.html. Numbers are in SI units and
radians; how they travel is the protocol's business.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum, auto
from typing import Final, NamedTuple

from vehicle_sim.signals import CameraOrder, Geodetic


class SpeedAxis(Enum):
    """Which speed a request or an item is about."""

    HORIZONTAL = auto()
    UP = auto()
    DOWN = auto()


class Command(Enum):
    """What an item asks for."""

    TAKEOFF = auto()
    WAYPOINT = auto()
    LOITER_UNLIMITED = auto()
    LOITER_TIME = auto()
    LOITER_TURNS = auto()
    LOITER_TO_ALTITUDE = auto()
    LAND = auto()
    RETURN = auto()
    DELAY = auto()
    WAIT = auto()
    WITHIN_DISTANCE = auto()
    TURN = auto()
    CHANGE_SPEED = auto()
    SET_HOME = auto()
    LOOK_AT = auto()
    LOOK_AHEAD = auto()
    PHOTOGRAPH = auto()
    NOTHING = auto()
    JUMP = auto()


class Kind(Enum):
    """How an item takes part: it is flown, waits beside what is flown, acts at once, or leads elsewhere."""

    NAVIGATE = auto()
    CONDITION = auto()
    ACT = auto()
    JUMP = auto()


KINDS: Final[Mapping[Command, Kind]] = {
    Command.TAKEOFF: Kind.NAVIGATE,
    Command.WAYPOINT: Kind.NAVIGATE,
    Command.LOITER_UNLIMITED: Kind.NAVIGATE,
    Command.LOITER_TIME: Kind.NAVIGATE,
    Command.LOITER_TURNS: Kind.NAVIGATE,
    Command.LOITER_TO_ALTITUDE: Kind.NAVIGATE,
    Command.LAND: Kind.NAVIGATE,
    Command.RETURN: Kind.NAVIGATE,
    Command.DELAY: Kind.NAVIGATE,
    Command.WAIT: Kind.CONDITION,
    Command.WITHIN_DISTANCE: Kind.CONDITION,
    Command.TURN: Kind.CONDITION,
    Command.CHANGE_SPEED: Kind.ACT,
    Command.SET_HOME: Kind.ACT,
    Command.LOOK_AT: Kind.ACT,
    Command.LOOK_AHEAD: Kind.ACT,
    Command.PHOTOGRAPH: Kind.ACT,
    Command.NOTHING: Kind.ACT,
    Command.JUMP: Kind.JUMP,
}
"""How each command takes part in a mission."""

FOREVER: Final = -1
"""Number of repetitions of a jump that never ends."""


class Datum(Enum):
    """What the height of a place counts from."""

    SEA = auto()
    HOME = auto()


class Place(NamedTuple):
    """Where an item is; a latitude or a height of None is where the vehicle is then."""

    lat_deg: float | None
    lon_deg: float
    height_m: float | None
    datum: Datum

    def geodetic(self, home: Geodetic | None, here: Geodetic) -> Geodetic:
        """Return the place on earth; heights count from `home`, without one from `here`."""
        lat, lon = (here.lat_deg, here.lon_deg) if self.lat_deg is None else (self.lat_deg, self.lon_deg)
        if self.height_m is None:
            return Geodetic(lat, lon, here.alt_m)
        zero = 0.0 if self.datum is Datum.SEA else (home or here).alt_m
        return Geodetic(lat, lon, zero + self.height_m)


@dataclass(frozen=True, slots=True, kw_only=True)
class MissionItem:
    """One item; which fields matter depends on its command.

    Attributes:
        command: What it asks for.
        name: What the autopilot calls it in texts.
        place: Where, for commands that have a place.
        seconds: Stay at a waypoint, time of a loiter, delay.
        radius_m: Acceptance radius of a waypoint or radius of a circle, 0 for the parameter's; distance to come within.
        turns: Circles to fly.
        clockwise: Direction of a circle or of a relative turn.
        yaw_rad: Where to look; None leaves it to the parameters.
        yaw_rate_rad_s: How fast to turn, 0 for the parameter's.
        relative: Whether the yaw counts from the present one.
        axis: Which speed to change.
        speed_m_s: To what.
        target: Index of the item to jump to.
        repeats: How often to jump; `FOREVER` never ends.
        order: What the camera is to do.
        continues: Whether the next item follows by itself.
        unflyable: Why a flavour that accepts the item does not fly it; empty if it does.
    """

    command: Command
    name: str = ""
    place: Place | None = None
    seconds: float = 0.0
    radius_m: float = 0.0
    turns: float = 1.0
    clockwise: bool = True
    yaw_rad: float | None = None
    yaw_rate_rad_s: float = 0.0
    relative: bool = False
    axis: SpeedAxis | None = None
    speed_m_s: float = 0.0
    target: int = 0
    repeats: int = 0
    order: CameraOrder | None = None
    continues: bool = True
    unflyable: str = ""

    @property
    def kind(self) -> Kind:
        """How the item takes part in a mission."""
        return KINDS[self.command]
