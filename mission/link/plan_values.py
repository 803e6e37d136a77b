"""What is said of the vehicle's plans, of which its geofence is one: https://mavlink.io/en/services/mission.html."""

from dataclasses import dataclass
from enum import IntEnum


class PlanKind(IntEnum):
    """Which plan of the vehicle (MAV_MISSION_TYPE); of its mission nothing is known here."""

    FENCE = 1


@dataclass(frozen=True, slots=True)
class Partner:
    """Whom a message of a plan is for; 0 is everybody."""

    system_id: int
    component_id: int


@dataclass(frozen=True, slots=True)
class PlanItem:
    """What MISSION_ITEM_INT says of one item: degrees times 1e7, and a height."""

    frame: int
    command: int
    params: tuple[float, float, float, float]
    latitude_e7: int
    longitude_e7: int
    height_m: float
    autocontinue: int = 1

    def same_as(self, other: "PlanItem") -> bool:
        """Whether both ask for the same of a fence: autopilots keep neither the frame nor the height of its corners."""
        mine, theirs = ((item.command, item.params[0], item.latitude_e7, item.longitude_e7) for item in (self, other))
        return mine == theirs


@dataclass(frozen=True, slots=True)
class PlanCount:
    """MISSION_COUNT: how many items there are."""

    partner: Partner
    kind: int
    count: int


@dataclass(frozen=True, slots=True)
class PlanRequest:
    """MISSION_REQUEST or MISSION_REQUEST_INT: which item is wanted."""

    partner: Partner
    kind: int
    number: int


@dataclass(frozen=True, slots=True)
class PlanPart:
    """MISSION_ITEM_INT: one item, with its number."""

    partner: Partner
    kind: int
    number: int
    item: PlanItem


@dataclass(frozen=True, slots=True)
class PlanAnswer:
    """MISSION_ACK: a MAV_MISSION_RESULT, 0 where all is well."""

    partner: Partner
    kind: int
    result: int


PlanBody = PlanCount | PlanRequest | PlanPart | PlanAnswer
