"""What the sticks mean: the settings of flight by hand, in SI units."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntFlag
from math import radians
from typing import Final

from vehicle_sim.parameters.actions import Action
from vehicle_sim.parameters.store import Flavour, ParameterStore

_JOYSTICK_COUNTS: Final = frozenset((1, 2, 3))
_HALF_THROTTLE: Final = 500.0


class Stickless(IntFlag):
    """What may be flown without sticks, though they have been there; the values are the bits of PX4's COM_RCL_EXCEPT.

    HOLD covers the take-off, too.
    """

    NOTHING = 0
    MISSION = 1
    HOLD = 2
    GUIDED = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class HandSettings:
    """How far full stick goes, and which sticks count at all; metres, seconds, radians.

    Attributes:
        listens: Whether sticks that come by MAVLink count.
        timeout_s: Sticks that are silent for so long count no more.
        dead_zone: Share of the stick's way that counts as centred.
        climb_dead_zone: The same of the stick that climbs.
        speed_m_s: Horizontal speed in modes that keep the place.
        climb_m_s: Climb speed.
        descent_m_s: Descent speed.
        tilt_rad: Lean in modes that do not keep the place.
        turn_rad_s: Yaw rate.
        lost_after_s: Sticks that have been there and are silent for so long are lost.
        loss: What their loss leads to.
        stickless: Where it leads to nothing.
    """

    listens: bool
    timeout_s: float
    dead_zone: float
    climb_dead_zone: float
    speed_m_s: float
    climb_m_s: float
    descent_m_s: float
    tilt_rad: float
    turn_rad_s: float
    lost_after_s: float
    loss: Action
    stickless: Stickless


def hand_settings(store: ParameterStore) -> HandSettings:
    """Return the settings that the parameters of `store` amount to now."""
    if store.flavour is Flavour.PX4:
        return HandSettings(
            listens=int(store["COM_RC_IN_MODE"]) in _JOYSTICK_COUNTS,
            timeout_s=store["COM_RC_LOSS_T"],
            dead_zone=store["MAN_DEADZONE"],
            climb_dead_zone=store["MAN_DEADZONE"],
            speed_m_s=store["MPC_VEL_MANUAL"],
            climb_m_s=store["MPC_Z_VEL_MAX_UP"],
            descent_m_s=store["MPC_Z_VEL_MAX_DN"],
            tilt_rad=radians(store["MPC_MAN_TILT_MAX"]),
            turn_rad_s=radians(store["MPC_MAN_Y_MAX"]),
            lost_after_s=store["COM_RC_LOSS_T"],
            loss=_PX4_LOSS.get(int(store["NAV_RCL_ACT"]), Action.NOTHING),
            stickless=Stickless(int(store["COM_RCL_EXCEPT"])),
        )
    climb_m_s = store["PILOT_SPEED_UP"] / 100.0
    return HandSettings(
        listens=store["RC_OVERRIDE_TIME"] != 0.0,
        # Below 0 an override counts until it is taken back.
        timeout_s=store["RC_OVERRIDE_TIME"] if store["RC_OVERRIDE_TIME"] >= 0.0 else float("inf"),
        dead_zone=_ARDUPILOT_DEAD_ZONE,
        climb_dead_zone=store["THR_DZ"] / _HALF_THROTTLE,
        speed_m_s=store["LOIT_SPEED"] / 100.0,
        climb_m_s=climb_m_s,
        descent_m_s=store["PILOT_SPEED_DN"] / 100.0 or climb_m_s,
        tilt_rad=radians(store["ANGLE_MAX"] / 100.0),
        turn_rad_s=radians(store["PILOT_Y_RATE"]),
        # Without a receiver no input at all is left once the ground station's ends, whether it still counts or not.
        lost_after_s=store["RC_FS_TIMEOUT"],
        loss=_ARDUPILOT_LOSS.get(int(store["FS_THR_ENABLE"]), Action.NOTHING),
        stickless=Stickless.NOTHING,
    )


_ARDUPILOT_DEAD_ZONE: Final = 0.04
"""RCn_DZ is 20 of 500 microseconds for roll, pitch and yaw; its channels are not modelled."""

_ARDUPILOT_LOSS: Final[Mapping[int, Action]] = {
    1: Action.RETURN,
    2: Action.RETURN,
    3: Action.LAND,
    # Without SmartRTL and landing sequences the next best of each chain is flown.
    4: Action.RETURN,
    5: Action.LAND,
    6: Action.RETURN,
    7: Action.BRAKE,
}
_PX4_LOSS: Final[Mapping[int, Action]] = {
    1: Action.HOLD,
    2: Action.RETURN,
    3: Action.LAND,
    5: Action.TERMINATE,
    6: Action.DISARM,
}
