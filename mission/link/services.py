"""Messages of services: the vehicle's plans, such as its geofence, its parameters, and what is told to ground stations.

https://mavlink.io/en/services/mission.html and https://mavlink.io/en/services/parameter.html.
"""

import struct
from collections.abc import Callable, Mapping
from typing import Final

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.link.packing import Message
from mission.link.plan_values import (
    Partner,
    PlanAnswer,
    PlanCount,
    PlanItem,
    PlanKind,
    PlanPart,
    PlanRequest,
)
from mission.link.values import Body, ParameterValue

ACCEPTED: Final = int(mavlink.MAV_MISSION_ACCEPTED)
PASSING: Final = frozenset(
    (mavlink.MAV_MISSION_ERROR, mavlink.MAV_MISSION_INVALID_SEQUENCE, mavlink.MAV_MISSION_DENIED)
)
"""Answers that may be about something else, such as an item that came twice, or that hold as long as an upload does.

ArduPilot denies to tell a plan while one is uploaded, and takes an upload that has stopped to last for 8 s.
"""

GLOBAL_FRAME: Final = int(mavlink.MAV_FRAME_GLOBAL)
CORNER_TO_STAY_IN: Final = int(mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION)
CORNER_TO_STAY_OUT_OF: Final = int(mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION)
CIRCLE_TO_STAY_IN: Final = int(mavlink.MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION)
CIRCLE_TO_STAY_OUT_OF: Final = int(mavlink.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION)

_BY_NAME: Final = -1
_INTEGERS: Final = frozenset(range(mavlink.MAV_PARAM_TYPE_UINT8, mavlink.MAV_PARAM_TYPE_INT64 + 1))
_AUTOPILOT: Final = 1
_PIECE_BYTES: Final = 50


def _partner(m: Message) -> Partner:
    return Partner(m.target_system, m.target_component)


def _item(m: Message) -> PlanPart:
    params = (m.param1, m.param2, m.param3, m.param4)
    return PlanPart(
        _partner(m), m.mission_type, m.seq, PlanItem(m.frame, m.command, params, m.x, m.y, m.z, m.autocontinue)
    )


def _parameter(m: Message) -> ParameterValue:
    """PARAM_VALUE: PX4 lays an integer's bytes where the number is, ArduPilot sends the number."""
    (as_bytes,) = struct.unpack("<i", struct.pack("<f", m.param_value))
    return ParameterValue(str(m.param_id), m.param_value, as_bytes, m.param_type in _INTEGERS, m.param_type)


READERS: Final[Mapping[str, Callable[[Message], Body]]] = {
    "MISSION_COUNT": lambda m: PlanCount(_partner(m), m.mission_type, m.count),
    "MISSION_REQUEST": lambda m: PlanRequest(_partner(m), m.mission_type, m.seq),
    "MISSION_REQUEST_INT": lambda m: PlanRequest(_partner(m), m.mission_type, m.seq),
    "MISSION_ITEM_INT": _item,
    "MISSION_ACK": lambda m: PlanAnswer(_partner(m), m.mission_type, m.type),
    "PARAM_VALUE": _parameter,
}


def beat_on_board() -> Message:
    """The HEARTBEAT of a computer that belongs to the vehicle."""
    return mavlink.MAVLink_heartbeat_message(
        mavlink.MAV_TYPE_ONBOARD_CONTROLLER, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, mavlink.MAV_STATE_ACTIVE, 3
    )


def named_value(t_s: float, name: str, value: float) -> Message:
    """A NAMED_VALUE_FLOAT at a vehicle time, of a name of at most ten letters."""
    return mavlink.MAVLink_named_value_float_message(round(t_s * 1e3) & 0xFFFFFFFF, name.encode(), value)


def text_pieces(severity: int, text: str, number: int) -> list[Message]:
    """A text as STATUSTEXT, in pieces that share ``number`` where it is longer than one holds.

    A piece that is full is followed by another: https://mavlink.io/en/messages/common.html#STATUSTEXT.
    """
    data = text.encode("ascii", "replace")
    if len(data) <= _PIECE_BYTES:
        return [mavlink.MAVLink_statustext_message(severity, data)]
    pieces = [data[start : start + _PIECE_BYTES] for start in range(0, len(data) + 1, _PIECE_BYTES)]
    return [mavlink.MAVLink_statustext_message(severity, piece, number, place) for place, piece in enumerate(pieces)]


def plan_count(system_id: int, kind: PlanKind, count: int) -> Message:
    """Begin to upload so many items."""
    return mavlink.MAVLink_mission_count_message(system_id, _AUTOPILOT, count, kind)


def plan_item(system_id: int, kind: PlanKind, number: int, item: PlanItem) -> Message:
    """Upload one item."""
    return mavlink.MAVLink_mission_item_int_message(
        system_id,
        _AUTOPILOT,
        number,
        item.frame,
        item.command,
        0,
        item.autocontinue,
        *item.params,
        item.latitude_e7,
        item.longitude_e7,
        item.height_m,
        kind,
    )


def plan_clearing(system_id: int, kind: PlanKind) -> Message:
    """Let the vehicle forget its items."""
    return mavlink.MAVLink_mission_clear_all_message(system_id, _AUTOPILOT, kind)


def plan_list_request(system_id: int, kind: PlanKind) -> Message:
    """Ask how many items there are."""
    return mavlink.MAVLink_mission_request_list_message(system_id, _AUTOPILOT, kind)


def plan_item_request(system_id: int, kind: PlanKind, number: int) -> Message:
    """Ask for one item."""
    return mavlink.MAVLink_mission_request_int_message(system_id, _AUTOPILOT, number, kind)


def plan_received(system_id: int, kind: PlanKind) -> Message:
    """Say that all items have come."""
    return mavlink.MAVLink_mission_ack_message(system_id, _AUTOPILOT, ACCEPTED, kind)


def plan_result_name(result: int) -> str:
    """A MAV_MISSION_RESULT in plain words."""
    entry = mavlink.enums["MAV_MISSION_RESULT"].get(result)
    name = f"result {result}" if entry is None else str(entry.name).removeprefix("MAV_MISSION_")
    return name.lower().replace("_", " ")


def parameter_request(system_id: int, name: str) -> Message:
    """Ask for a parameter."""
    return mavlink.MAVLink_param_request_read_message(system_id, _AUTOPILOT, name.encode(), _BY_NAME)


def parameter_setting(system_id: int, name: str, value: float, kind: int, *, bytewise: bool) -> Message:
    """Set a parameter of a MAV_PARAM_TYPE."""
    raw = value
    if bytewise and kind in _INTEGERS:
        (raw,) = struct.unpack("<f", struct.pack("<i", int(value)))
    return mavlink.MAVLink_param_set_message(system_id, _AUTOPILOT, name.encode(), raw, kind)
