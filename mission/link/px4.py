"""PX4: hold, arm, take off (which ends in hold by itself), then a stream of setpoints, and only then OFFBOARD.

Observed on PX4 1.16: a take-off's height is above mean sea level; OFFBOARD without a fresh stream is acknowledged as
accepted and not entered; a stream that pauses for a second is a failure.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from mission.link.autopilot import COMMON_RATES_HZ, Autopilot
from mission.link.fence_rules import FenceRules
from mission.link.messages import AUTOPILOT_PX4, Stream, arm, change_mode, land, take_off
from mission.link.steps import Scene, Step, arm_steps, change_mode_step, climb_step
from mission.link.values import Command
from mission.monitor.stage import Stage
from mission.plan.guarding import Room

_AUTO, _MAIN_OFFBOARD = 4, 6
_SUB_TAKEOFF, _SUB_HOLD, _SUB_LAND = 2, 3, 6


def _number(main: int, sub: int = 0) -> int:
    """The custom mode of a heartbeat."""
    return main << 16 | sub << 24


_TAKEOFF, _HOLD, _LAND, _OFFBOARD = (
    _number(_AUTO, _SUB_TAKEOFF),
    _number(_AUTO, _SUB_HOLD),
    _number(_AUTO, _SUB_LAND),
    _number(_MAIN_OFFBOARD),
)
_MODE_NAMES: Final = {
    _number(1): "MANUAL",
    _number(2): "ALTCTL",
    _number(3): "POSCTL",
    _number(_AUTO, 1): "AUTO.READY",
    _TAKEOFF: "AUTO.TAKEOFF",
    _HOLD: "AUTO.LOITER",
    _number(_AUTO, 4): "AUTO.MISSION",
    _number(_AUTO, 5): "AUTO.RTL",
    _LAND: "AUTO.LAND",
    _number(5): "ACRO",
    _OFFBOARD: "OFFBOARD",
    _number(7): "STABILIZED",
}
_LEFT: Final = frozenset({_HOLD, _OFFBOARD, _number(3)})
"""Where setpoints stop, it goes into POSCTL as it comes (COM_OBL_RC_ACT 0), and holds its place without sticks."""

_HERE = float("nan")
_STREAM_FIRST_S: Final = 1.5


def _take_off(scene: Scene) -> Command:
    """Take off to the altitude above where the vehicle stands; the command counts from the sea."""
    place = scene.vehicle.place
    return take_off((place.altitude_amsl_m if place else 0.0) - scene.height_m + scene.altitude_m, _HERE)


def _stream_steps(modes: frozenset[int]) -> tuple[Step, ...]:
    """Stream setpoints, and then enter the mode that flies them, from one of these modes."""
    offboard = change_mode_step(
        Stage.OFFBOARD, change_mode("OFFBOARD", _MAIN_OFFBOARD), _OFFBOARD, "OFFBOARD", modes | {_OFFBOARD}
    )
    return (
        Step(
            stage=Stage.STREAM,
            confirmed=lambda scene: scene.in_step_s >= _STREAM_FIRST_S,
            missing="did not wait for setpoints",
            limit_s=10.0,
            modes=modes,
            armed=True,
            streaming=True,
        ),
        replace(offboard, streaming=True, armed=True),
    )


def _departure(altitude_m: float) -> tuple[Step, ...]:
    hold, rising = frozenset({_HOLD}), frozenset({_HOLD, _TAKEOFF})
    hold_command = change_mode("AUTO.LOITER", _AUTO, _SUB_HOLD)
    return (
        change_mode_step(Stage.MODE, hold_command, _HOLD, "AUTO.LOITER", None),
        *arm_steps(arm(), hold),
        Step(
            stage=Stage.TAKE_OFF,
            command=_take_off,
            confirmed=lambda scene: scene.vehicle.mode == _TAKEOFF or scene.airborne,
            missing="did not begin to take off",
            limit_s=15.0,
            patience_s=8.0,
            repeat_s=5.0,
            modes=rising,
            armed=True,
        ),
        climb_step(rising, altitude_m, _HOLD),
        *_stream_steps(rising),
    )


def _fence(before: Mapping[str, float], ceiling_m: float) -> Mapping[str, float]:
    """What the geofence has to be (navigator/geofence.cpp, commander's GF_ACTION).

    On a breach the vehicle holds: a return would lead straight home, through whatever is in between. GF_PREDICT would
    stop a vehicle that flies towards an outline and means to turn ahead of it.
    """
    watches = before["GF_ACTION"] > 0.0
    ceiling, radius = before["GF_MAX_VER_DIST"], before["GF_MAX_HOR_DIST"]
    return {
        "GF_MAX_VER_DIST": min(ceiling_m, ceiling) if watches and ceiling > 0.0 else ceiling_m,
        "GF_MAX_HOR_DIST": radius if watches else 0.0,
        "GF_PREDICT": 0.0,
    }


PX4: Final = Autopilot(
    name="PX4",
    number=AUTOPILOT_PX4,
    mode_names=_MODE_NAMES,
    offboard_mode=_OFFBOARD,
    hold_mode=_HOLD,
    land_mode=_LAND,
    hold=change_mode("AUTO.LOITER", _AUTO, _SUB_HOLD),
    land=land(_HERE),
    rates_hz={**COMMON_RATES_HZ, Stream.ESTIMATOR_STATUS: 2.0, Stream.WIND_COV: 0.5},
    bytewise=True,
    fence=FenceRules(
        switch="GF_ACTION",
        off=0.0,
        on=2.0,
        parameters=("GF_MAX_VER_DIST", "GF_MAX_HOR_DIST", "GF_PREDICT"),
        optional=frozenset({"GF_PREDICT"}),
        wanted=_fence,
        room=Room(total=64, area=0, corner=1, circle=1),  # DM_KEY_FENCE_POINTS_MAX
        sphere_m=6_371_000.0,
    ),
    departure=_departure,
    left_modes=_LEFT,
    return_to_setpoints=_stream_steps(_LEFT),
)
