"""Identifiers of plans: a checksum over the items, by which a ground station sees that it knows the plan already.

PX4 sends them in extension fields that are younger than the dialect of many pymavlink releases, so they are appended
here. https://mavlink.io/en/services/mission.html. As in PX4's `mavlink_mission.cpp`, the checksum is CRC-32 (polynomial
0xEDB88320) without inversions over frame, command, autocontinue and the seven numbers of each item.
"""

from collections.abc import Iterable, Mapping
from struct import pack
from typing import Final
from zlib import crc32

from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.plan_store import PlanItem

_ONES: Final = 0xFFFFFFFF
_LENGTHS: Final[Mapping[int, int]] = {
    mavlink.MAVLINK_MSG_ID_MISSION_COUNT: 5,
    mavlink.MAVLINK_MSG_ID_MISSION_ACK: 4,
    mavlink.MAVLINK_MSG_ID_MISSION_CURRENT: 6,
}
"""Payload lengths before the identifiers (`common.xml`)."""


def plan_id(items: Iterable[PlanItem]) -> int:
    """Return the identifier of a plan; 0 for one without items."""
    checksum = 0
    for item in items:
        raw = pack("<BHB4fiif", item.frame, item.command, item.autocontinue, *item.params, item.x, item.y, item.z)
        checksum = crc32(raw, checksum ^ _ONES) ^ _ONES
    return checksum


def with_ids(message: Message, *ids: int) -> Message:
    """Return `message`, made to carry `ids` behind its other fields; it is one of those that have them."""
    pack_payload, length = message._pack, _LENGTHS[message.get_msgId()]  # noqa: SLF001 - pymavlink has no other way
    tail = pack(f"<{len(ids)}I", *ids)

    def pack_with_ids(mav: object, crc_extra: int, payload: bytes, **options: bool) -> bytes:
        packed: bytes = pack_payload(mav, crc_extra, payload[:length] + tail, **options)
        return packed

    message._pack = pack_with_ids  # noqa: SLF001 - as above
    return message
