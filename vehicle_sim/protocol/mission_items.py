"""Items of a mission between MAVLink and the autopilot: which commands and frames each flavour takes.

ArduPilot (`AP_Mission.cpp`) looks at each item's numbers when it comes. PX4 (`mavlink_mission.cpp`) only looks at
command and frame, and at the whole mission later: items that it stores and then does not fly carry the reason.
"""

from collections.abc import Callable, Mapping
from math import isfinite, isinf, isnan, radians
from typing import Any, Final, NamedTuple

from vehicle_sim.autopilot import Command, Datum, MissionItem, Place, SpeedAxis
from vehicle_sim.autopilot.mission_items import FOREVER
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.camera_orders import order_of_item
from vehicle_sim.protocol.dialect import mavlink
from vehicle_sim.protocol.places import AMSL_FRAMES, GLOBAL_FRAMES, HOME_FRAMES, is_latitude, is_longitude
from vehicle_sim.protocol.plan_store import PlanItem
from vehicle_sim.protocol.units import E7

_Fields = Mapping[str, Any]
_Params = tuple[float, float, float, float]

_ARDUPILOT_FRAMES: Final = GLOBAL_FRAMES | {mavlink.MAV_FRAME_MISSION}
_PX4_PLACED_FRAMES: Final = AMSL_FRAMES | HOME_FRAMES
_HIGHEST_M: Final = 83000.0
_WIDEST_CIRCLE_M: Final = 2550.0
_INVALID_PARAM: Final = (
    mavlink.MAV_MISSION_INVALID_PARAM1,
    mavlink.MAV_MISSION_INVALID_PARAM2,
    mavlink.MAV_MISSION_INVALID_PARAM3,
    mavlink.MAV_MISSION_INVALID_PARAM4,
)
_AXES: Final = {0: SpeedAxis.HORIZONTAL, 1: SpeedAxis.HORIZONTAL, 2: SpeedAxis.UP, 3: SpeedAxis.DOWN}
_ROI_NONE: Final = mavlink.MAV_ROI_NONE
_ROI_MODES: Final = (_ROI_NONE, mavlink.MAV_ROI_LOCATION)


def _number(value: float) -> float:
    return value if isfinite(value) else 0.0


def _yaw(value: float) -> float | None:
    return radians(value) if isfinite(value) else None


def _none(_params: _Params) -> _Fields:
    return {}


def _waypoint(params: _Params) -> _Fields:
    return {"seconds": max(_number(params[0]), 0.0), "radius_m": abs(_number(params[1])), "yaw_rad": _yaw(params[3])}


def _turn_in_place(params: _Params) -> _Fields:
    return {"yaw_rad": _yaw(params[3])}


def _loiter_time(params: _Params) -> _Fields:
    return {"seconds": max(_number(params[0]), 0.0), "yaw_rad": _yaw(params[3])}


def _loiter_turns(params: _Params) -> _Fields:
    radius_m = min(abs(params[2]), _WIDEST_CIRCLE_M)
    return {"turns": max(params[0], 0.0), "radius_m": radius_m, "clockwise": params[2] >= 0.0}


def _seconds(params: _Params) -> _Fields:
    return {"seconds": max(_number(params[0]), 0.0)}


def _metres(params: _Params) -> _Fields:
    return {"radius_m": max(_number(params[0]), 0.0)}


def _turn(params: _Params) -> _Fields:
    return {
        "yaw_rad": radians(params[0]),
        "yaw_rate_rad_s": radians(abs(params[1])),
        "clockwise": params[2] >= 0.0,
        "relative": params[3] > 0.0,
    }


def _speed(params: _Params) -> _Fields:
    kind = params[0]
    return {"axis": _AXES.get(int(kind)) if isfinite(kind) else None, "speed_m_s": _number(params[1])}


def _jump(params: _Params) -> _Fields:
    target, repeats = _number(params[0]), _number(params[1])
    return {"target": int(target), "repeats": FOREVER if repeats < 0.0 else int(repeats)}


class _Row(NamedTuple):
    """What becomes of one command of MAVLink.

    `name` is ArduPilot's in texts; `placed` says whether it stands at a place; `any_yaw` whether its fourth parameter
    may be NaN on ArduPilot.
    """

    command: Command
    name: str
    fields: Callable[[_Params], _Fields] = _none
    placed: bool = False
    any_yaw: bool = False


_C = Command
_COMMON: Final[Mapping[str, _Row]] = {
    "NAV_WAYPOINT": _Row(_C.WAYPOINT, "WP", _waypoint, placed=True, any_yaw=True),
    "NAV_LOITER_UNLIM": _Row(_C.LOITER_UNLIMITED, "LoitUnlim", _turn_in_place, placed=True),
    "NAV_LOITER_TIME": _Row(_C.LOITER_TIME, "LoitTime", _loiter_time, placed=True),
    "NAV_LOITER_TO_ALT": _Row(_C.LOITER_TO_ALTITUDE, "LoitAltitude", placed=True),
    "NAV_LAND": _Row(_C.LAND, "Land", placed=True, any_yaw=True),
    "NAV_TAKEOFF": _Row(_C.TAKEOFF, "Takeoff", _turn_in_place, placed=True, any_yaw=True),
    "NAV_RETURN_TO_LAUNCH": _Row(_C.RETURN, "RTL"),
    "NAV_DELAY": _Row(_C.DELAY, "Delay", _seconds),
    "DO_JUMP": _Row(_C.JUMP, "Jump", _jump),
    "DO_CHANGE_SPEED": _Row(_C.CHANGE_SPEED, "ChangeSpeed", _speed),
    "DO_SET_HOME": _Row(_C.SET_HOME, "SetHome", placed=True),
    "DO_SET_ROI": _Row(_C.LOOK_AT, "SetROI", placed=True),
    "DO_SET_ROI_LOCATION": _Row(_C.LOOK_AT, "SetROI", placed=True),
    "DO_SET_ROI_NONE": _Row(_C.LOOK_AHEAD, "SetROI"),
    "DO_LAND_START": _Row(_C.NOTHING, "LandStart", placed=True),
    "DO_DIGICAM_CONTROL": _Row(_C.PHOTOGRAPH, "DigiCamCtrl"),
    "DO_SET_CAM_TRIGG_DIST": _Row(_C.PHOTOGRAPH, "SetCamTrigDst"),
    "IMAGE_START_CAPTURE": _Row(_C.PHOTOGRAPH, "ImageStartCapture"),
    "IMAGE_STOP_CAPTURE": _Row(_C.PHOTOGRAPH, "ImageStopCapture"),
    # The mount looks down whatever it is told; there is no video and no servo.
    "DO_MOUNT_CONTROL": _Row(_C.NOTHING, "MountControl"),
    "SET_CAMERA_ZOOM": _Row(_C.NOTHING, "SetCameraZoom"),
    "SET_CAMERA_FOCUS": _Row(_C.NOTHING, "SetCameraFocus"),
    "VIDEO_START_CAPTURE": _Row(_C.NOTHING, "VideoStartCapture"),
    "VIDEO_STOP_CAPTURE": _Row(_C.NOTHING, "VideoStopCapture"),
    "DO_GIMBAL_MANAGER_PITCHYAW": _Row(_C.NOTHING, "GimbalPitchYaw"),
}
_ARDUPILOT_ALONE: Final[Mapping[str, _Row]] = {
    # Flown as a straight leg.
    "NAV_SPLINE_WAYPOINT": _Row(_C.WAYPOINT, "SplineWP", _seconds, placed=True),
    "NAV_LOITER_TURNS": _Row(_C.LOITER_TURNS, "LoitTurns", _loiter_turns, placed=True),
    "CONDITION_DELAY": _Row(_C.WAIT, "CondDelay", _seconds),
    "CONDITION_DISTANCE": _Row(_C.WITHIN_DISTANCE, "CondDist", _metres),
    "CONDITION_YAW": _Row(_C.TURN, "CondYaw", _turn),
    "DO_DIGICAM_CONFIGURE": _Row(_C.NOTHING, "DigiCamCfg"),
    "DO_SET_SERVO": _Row(_C.NOTHING, "SetServo"),
    "DO_SET_RELAY": _Row(_C.NOTHING, "SetRelay"),
    "DO_REPEAT_SERVO": _Row(_C.NOTHING, "RepeatServo"),
    "DO_REPEAT_RELAY": _Row(_C.NOTHING, "RepeatRelay"),
    "DO_GRIPPER": _Row(_C.NOTHING, "Gripper"),
}
_PX4_ALONE: Final[Mapping[str, _Row]] = {
    "CONDITION_DELAY": _Row(_C.WAIT, ""),
    "CONDITION_DISTANCE": _Row(_C.WITHIN_DISTANCE, ""),
    "DO_CONTROL_VIDEO": _Row(_C.NOTHING, ""),
    "DO_GIMBAL_MANAGER_CONFIGURE": _Row(_C.NOTHING, ""),
    "DO_MOUNT_CONFIGURE": _Row(_C.NOTHING, ""),
    "DO_TRIGGER_CONTROL": _Row(_C.PHOTOGRAPH, ""),
    "DO_SET_CAM_TRIGG_INTERVAL": _Row(_C.PHOTOGRAPH, ""),
    "SET_CAMERA_MODE": _Row(_C.NOTHING, ""),
    "DO_GRIPPER": _Row(_C.NOTHING, ""),
}
_PX4_NOT_FLOWN: Final = frozenset((mavlink.MAV_CMD_CONDITION_DELAY, mavlink.MAV_CMD_CONDITION_DISTANCE))
_PX4_PLACED: Final = frozenset(
    getattr(mavlink, f"MAV_CMD_{name}")
    for name, row in _COMMON.items()
    if row.placed and name not in ("DO_SET_HOME", "DO_LAND_START")
)


def _numbered(*tables: Mapping[str, _Row]) -> Mapping[int, _Row]:
    return {getattr(mavlink, f"MAV_CMD_{name}"): row for table in tables for name, row in table.items()}


_ROWS: Final[Mapping[Flavour, Mapping[int, _Row]]] = {
    Flavour.ARDUPILOT: _numbered(_COMMON, _ARDUPILOT_ALONE),
    Flavour.PX4: _numbered(_COMMON, _PX4_ALONE),
}


def item_fault(flavour: Flavour, item: PlanItem) -> int:
    """Return the MAV_MISSION_RESULT of an item: accepted, or the first thing that the flavour finds wrong with it."""
    row = _ROWS[flavour].get(item.command)
    if row is None:
        return int(mavlink.MAV_MISSION_UNSUPPORTED)
    result = _px4_fault(item) if flavour is Flavour.PX4 else _ardupilot_fault(row, item)
    return int(result)


def _ardupilot_fault(row: _Row, item: PlanItem) -> int:
    for place, value in enumerate(item.params):
        if isinf(value) or (isnan(value) and not (row.any_yaw and place == len(item.params) - 1)):
            return int(_INVALID_PARAM[place])
    if not row.placed:
        return int(mavlink.MAV_MISSION_ACCEPTED)
    if item.frame not in _ARDUPILOT_FRAMES:
        return int(mavlink.MAV_MISSION_UNSUPPORTED_FRAME)
    if not is_latitude(item.x / E7):
        return int(mavlink.MAV_MISSION_INVALID_PARAM5_X)
    if not is_longitude(item.y / E7):
        return int(mavlink.MAV_MISSION_INVALID_PARAM6_Y)
    return int(mavlink.MAV_MISSION_ACCEPTED if abs(item.z) < _HIGHEST_M else mavlink.MAV_MISSION_INVALID_PARAM7)


def _px4_fault(item: PlanItem) -> int:
    is_placed = item.command in _PX4_PLACED
    roi = item.command == mavlink.MAV_CMD_DO_SET_ROI
    if item.frame == mavlink.MAV_FRAME_MISSION:
        if is_placed and not roi:
            return int(mavlink.MAV_MISSION_UNSUPPORTED)
        modes: tuple[int, ...] = (_ROI_NONE,)
    elif item.frame in _PX4_PLACED_FRAMES:
        if not is_placed:
            return int(mavlink.MAV_MISSION_UNSUPPORTED)
        # A height that is no number would be no place to fly to, whatever the rest of the mission is.
        if not isfinite(item.z):
            return int(mavlink.MAV_MISSION_INVALID_PARAM7)
        modes = _ROI_MODES
    else:
        return int(mavlink.MAV_MISSION_UNSUPPORTED_FRAME)
    if roi and item.params[0] not in modes:
        return int(mavlink.MAV_MISSION_INVALID_PARAM1)
    return int(mavlink.MAV_MISSION_ACCEPTED)


def mission_item(flavour: Flavour, item: PlanItem) -> MissionItem:
    """Return what an accepted item asks for.

    ArduPilot keeps its own headings and acceptance radius whatever the item says, and ignores `autocontinue`.
    """
    row, px4 = _ROWS[flavour][item.command], flavour is Flavour.PX4
    fields: dict[str, Any] = dict(row.fields(item.params))
    command = row.command
    if not px4:
        fields.pop("yaw_rad" if command is not Command.TURN else "", None)
        if command is Command.WAYPOINT:
            fields.pop("radius_m", None)
    is_blank = (item.x, item.y, item.z) == (0, 0, 0.0)
    looks_at_nothing = item.params[0] == _ROI_NONE and item.command == mavlink.MAV_CMD_DO_SET_ROI if px4 else is_blank
    if command is Command.LOOK_AT and looks_at_nothing:
        command = Command.LOOK_AHEAD
    wants_place = row.placed and command is not Command.LOOK_AHEAD
    here = command is Command.SET_HOME and (item.params[0] == 1.0 or is_blank)
    return MissionItem(
        command=command,
        name=row.name,
        place=_place(item, px4=px4) if wants_place and not here else None,
        continues=bool(item.autocontinue) or not px4,
        order=order_of_item(flavour, item.command, (*item.params, _shot(item), float(item.y), item.z)),
        unflyable=f"unsupported cmd: {item.command}" if px4 and item.command in _PX4_NOT_FLOWN else "",
        **fields,
    )


def _shot(item: PlanItem) -> float:
    """Return the fifth parameter of what stands at no place; a float in a global frame was taken for degrees."""
    return item.x / E7 if item.frame in GLOBAL_FRAMES and abs(item.x) >= E7 else float(item.x)


def _place(item: PlanItem, *, px4: bool) -> Place:
    """Return an item's place; the ground is flat, so heights above terrain are heights above home."""
    datum = Datum.SEA if item.frame not in GLOBAL_FRAMES or item.frame in AMSL_FRAMES else Datum.HOME
    # To ArduPilot zeros mean where the vehicle is.
    lat_deg = None if not px4 and item.x == 0 and item.y == 0 else item.x / E7
    height_m = None if not px4 and item.z == 0.0 else item.z
    return Place(lat_deg, item.y / E7, height_m, datum)
