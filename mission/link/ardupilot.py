"""ArduCopter: GUIDED first, then arm, then take off inside GUIDED; setpoints need no other mode.

Observed on ArduCopter 4.7: a take-off is counted from home, which is where it was armed; it fails while disarmed and
for some seconds after arming becomes possible, until the position is usable; setpoints during the climb would end it.
LOITER obeys the throttle stick, so without a pilot the mode that holds is BRAKE.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from mission.link.autopilot import COMMON_RATES_HZ, Autopilot
from mission.link.fence_rules import FenceRules
from mission.link.messages import AUTOPILOT_ARDUPILOT, Stream, arm, change_mode, land, take_off
from mission.link.steps import Scene, Step, arm_steps, change_mode_step, climb_step
from mission.link.values import Command
from mission.monitor.stage import Stage
from mission.plan.guarding import Room

_GUIDED, _BRAKE, _LAND = 4, 17, 9
_MODE_NAMES: Final = {
    0: "STABILIZE",
    1: "ACRO",
    2: "ALT_HOLD",
    3: "AUTO",
    4: "GUIDED",
    5: "LOITER",
    6: "RTL",
    7: "CIRCLE",
    9: "LAND",
    11: "DRIFT",
    13: "SPORT",
    14: "FLIP",
    15: "AUTOTUNE",
    16: "POSHOLD",
    17: "BRAKE",
    18: "THROW",
    19: "AVOID_ADSB",
    20: "GUIDED_NOGPS",
    21: "SMART_RTL",
    22: "FLOWHOLD",
    23: "FOLLOW",
    24: "ZIGZAG",
    27: "AUTO_RTL",
}
_HERE = 0.0
_BRAKES = 4.0
_CEILING, _AREAS = 1, 4
_LOCKS_MODE = 1
_LEAST_CEILING_M = 10.0


def _take_off(scene: Scene) -> Command:
    """Take off to the altitude above where the vehicle stands; the command counts from home."""
    place = scene.vehicle.place
    return take_off((place.height_above_home_m if place else 0.0) + scene.altitude_m, _HERE)


def _departure(altitude_m: float) -> tuple[Step, ...]:
    guided = frozenset({_GUIDED})
    return (
        change_mode_step(Stage.MODE, change_mode("GUIDED", _GUIDED), _GUIDED, "GUIDED", None),
        *arm_steps(arm(), guided),
        Step(
            stage=Stage.TAKE_OFF,
            command=_take_off,
            confirmed=lambda scene: scene.airborne,
            missing="did not leave the ground",
            limit_s=25.0,
            patience_s=15.0,
            repeat_s=8.0,
            modes=guided,
            armed=True,
        ),
        climb_step(guided, altitude_m, _GUIDED),
    )


def _fence(before: Mapping[str, float], ceiling_m: float) -> Mapping[str, float]:
    """What the geofence has to be (AC_Fence.cpp, ArduCopter/fence.cpp).

    On a breach the vehicle brakes: a return would lead straight home, through whatever is in between. FENCE_OPTIONS
    would keep the pilot from taking a vehicle that stands beyond the fence. FENCE_MARGIN is left alone: it slows down
    setpoints of velocity alone, and those that have a place beyond the fence are refused whatever it is.
    """
    kinds = int(before["FENCE_TYPE"]) if before["FENCE_ENABLE"] > 0.0 else 0
    ceiling_m = max(ceiling_m, _LEAST_CEILING_M)
    return {
        "FENCE_TYPE": float(kinds | _CEILING | _AREAS),
        "FENCE_ACTION": _BRAKES,
        "FENCE_ALT_MAX": min(ceiling_m, before["FENCE_ALT_MAX"]) if kinds & _CEILING else ceiling_m,
        "FENCE_OPTIONS": float(int(before.get("FENCE_OPTIONS", 0.0)) & ~_LOCKS_MODE),
    }


ARDUPILOT: Final = Autopilot(
    name="ArduPilot",
    number=AUTOPILOT_ARDUPILOT,
    mode_names=_MODE_NAMES,
    offboard_mode=_GUIDED,
    hold_mode=_BRAKE,
    land_mode=_LAND,
    hold=change_mode("BRAKE", _BRAKE),
    land=land(_HERE),
    rates_hz={**COMMON_RATES_HZ, Stream.EKF_STATUS_REPORT: 2.0, Stream.WIND: 0.5, Stream.SIMSTATE: 4.0},
    bytewise=False,
    fence=FenceRules(
        switch="FENCE_ENABLE",
        off=0.0,
        on=1.0,
        parameters=("FENCE_TYPE", "FENCE_ACTION", "FENCE_ALT_MAX", "FENCE_OPTIONS"),
        optional=frozenset({"FENCE_OPTIONS"}),
        wanted=_fence,
        # Bytes of the area of its storage on a board of 16 KiB or more, without its head and its end.
        room=Room(total=555, area=2, corner=8, circle=13),
        sphere_m=6_378_100.0,
    ),
    departure=_departure,
    left_modes=frozenset({_GUIDED, _BRAKE}),
    return_to_setpoints=(
        replace(
            change_mode_step(
                Stage.MODE, change_mode("GUIDED", _GUIDED), _GUIDED, "GUIDED", frozenset({_GUIDED, _BRAKE})
            ),
            armed=True,
        ),
    ),
)
