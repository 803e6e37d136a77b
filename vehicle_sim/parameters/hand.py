"""What the sticks mean: the settings of flight by hand, in SI units."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntFlag
from math import inf, radians
from typing import Final, NamedTuple

from vehicle_sim.parameters.actions import Action
from vehicle_sim.parameters.store import Flavour, ParameterStore

_JOYSTICK_COUNTS: Final = frozenset((1, 2, 3))
_RADIO_COUNTS: Final = frozenset((0, 2, 3))
_KEEPS_FIRST: Final = 3
_HALF_THROTTLE: Final = 500.0
_CHECK_ALL, _CHECK_RADIO = 1, 1 << 6
_SWITCH_US: Final = (1230.0, 1360.0, 1490.0, 1620.0, 1749.0)
"""The greatest pulse of each position of ArduPilot's mode switch but the last (`RC_Channel.cpp`)."""
_POSITIONS: Final = 6
_DISARMS_TOO: Final = 2


class Stickless(IntFlag):
    """What may be flown without sticks, though they have been there; the values are the bits of PX4's COM_RCL_EXCEPT.

    HOLD covers the take-off, too.
    """

    NOTHING = 0
    MISSION = 1
    HOLD = 2
    GUIDED = 4


class Channel(NamedTuple):
    """How a channel of the radio is read: its number from 1, its ends and its middle in microseconds, and its sense.

    Number 0 is no channel.
    """

    number: int
    least_us: float
    middle_us: float
    most_us: float
    sense: float

    def share(self, pulse_us: float) -> float:
        """Return how far a stick with this pulse is off its middle, -1 to 1."""
        end_us = self.most_us if pulse_us > self.middle_us else self.least_us
        width_us = max(1.0, abs(end_us - self.middle_us))
        return self.sense * max(-1.0, min((pulse_us - self.middle_us) / width_us, 1.0))

    def pulse_us(self, share: float) -> float:
        """Return the pulse of a stick that is so far off its middle."""
        share *= self.sense
        end_us = self.most_us if share > 0.0 else self.least_us
        return self.middle_us + abs(share) * (end_us - self.middle_us)


class Gesture(NamedTuple):
    """How sticks arm and disarm: throttle down and full turn, to the right or to the left.

    Attributes:
        hold_s: For how long.
        turn: Share of the turning stick's way that counts as full.
        throttle: Up to here the throttle is down, -1 to 1.
        centred: How far the other two sticks may be off their middle.
        arms: Whether the one to the right does.
        disarms: Whether the one to the left does.
    """

    hold_s: float
    turn: float
    throttle: float
    centred: float
    arms: bool
    disarms: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class HandSettings:
    """How far full stick goes, and which sticks count at all; metres, seconds, radians.

    Attributes:
        joystick: Whether the sticks of a joystick count as such.
        radio: Whether the radio's do, or what MAVLink puts in their place.
        keeps_first: Whether the first of both that is heard remains the one that counts.
        channels: The channels of the sticks, in the order of `Sticks`: forward, right, turn, climb.
        least_throttle_us: Shorter pulses of the throttle mean that the receiver has lost its transmitter; 0 none do.
        switch: The channel of the mode switch, 0 for none.
        switch_us: The greatest pulse of each of its positions but the last.
        switch_modes: The mode at each position, as the parameters number it.
        radio_checked: Whether arming waits for a radio.
        gesture: How sticks arm and disarm.
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

    joystick: bool
    radio: bool
    keeps_first: bool
    channels: tuple[Channel, Channel, Channel, Channel]
    least_throttle_us: float
    switch: int
    switch_us: tuple[float, ...]
    switch_modes: tuple[int, ...]
    radio_checked: bool
    gesture: Gesture
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
        sources, switch = int(store["COM_RC_IN_MODE"]), int(store["RC_MAP_FLTMODE"])
        gesture = bool(store["MAN_ARM_GESTURE"])
        return HandSettings(
            joystick=sources in _JOYSTICK_COUNTS,
            radio=sources in _RADIO_COUNTS,
            keeps_first=sources == _KEEPS_FIRST,
            channels=(
                _px4_channel(store, "PITCH"),
                _px4_channel(store, "ROLL"),
                _px4_channel(store, "YAW"),
                _px4_channel(store, "THROTTLE"),
            ),
            least_throttle_us=store["RC_FAILS_THR"],
            switch=switch,
            switch_us=_px4_positions(store, switch),
            switch_modes=tuple(int(store[f"COM_FLTMODE{number}"]) for number in range(1, _POSITIONS + 1)),
            radio_checked=False,
            gesture=Gesture(1.0, 0.9, -0.8, 0.1, gesture, gesture),
            timeout_s=store["COM_RC_LOSS_T"],
            dead_zone=store["MAN_DEADZONE"],
            climb_dead_zone=store["MAN_DEADZONE"],
            speed_m_s=store["MPC_VEL_MANUAL"],
            climb_m_s=store["MPC_Z_VEL_MAX_UP"],
            descent_m_s=store["MPC_Z_VEL_MAX_DN"],
            tilt_rad=radians(store["MPC_MAN_TILT_MAX"]),
            turn_rad_s=radians(store["MPC_MAN_Y_MAX"]),
            lost_after_s=store["COM_RC_LOSS_T"],
            loss=PX4_LINK_LOSS.get(int(store["NAV_RCL_ACT"]), Action.NOTHING),
            stickless=Stickless(int(store["COM_RCL_EXCEPT"])),
        )
    climb_m_s, roll = store["PILOT_SPEED_UP"] / 100.0, int(store["RCMAP_ROLL"])
    options, checks = int(store["FS_OPTIONS"]), int(store["ARMING_CHECK"])
    loss = _ARDUPILOT_LOSS.get(int(store["FS_THR_ENABLE"]), Action.NOTHING)
    rudder = int(store["ARMING_RUDDER"])
    return HandSettings(
        joystick=False,
        radio=True,
        keeps_first=False,
        channels=(
            # Pitch is low for forward.
            _ardupilot_channel(store, "PITCH", -1.0),
            _ardupilot_channel(store, "ROLL", 1.0),
            _ardupilot_channel(store, "YAW", 1.0),
            _ardupilot_channel(store, "THROTTLE", 1.0),
        ),
        least_throttle_us=store["FS_THR_VALUE"] if loss else 0.0,
        switch=int(store["FLTMODE_CH"]),
        switch_us=_SWITCH_US,
        switch_modes=tuple(int(store[f"FLTMODE{number}"]) for number in range(1, _POSITIONS + 1)),
        radio_checked=bool(loss) and bool(checks & (_CHECK_ALL | _CHECK_RADIO)),
        # Full is 40 of 45 degrees; down is what RC3_DZ covers, 30 of 1000 microseconds.
        gesture=Gesture(3.0, 40.0 / 45.0, -0.94, inf, rudder > 0, rudder == _DISARMS_TOO),
        # Below 0 an override counts until it is taken back.
        timeout_s=store["RC_OVERRIDE_TIME"] if store["RC_OVERRIDE_TIME"] >= 0.0 else inf,
        dead_zone=store[f"RC{roll}_DZ"] / _HALF_THROTTLE,
        climb_dead_zone=store["THR_DZ"] / _HALF_THROTTLE,
        speed_m_s=store["LOIT_SPEED"] / 100.0,
        climb_m_s=climb_m_s,
        descent_m_s=store["PILOT_SPEED_DN"] / 100.0 or climb_m_s,
        tilt_rad=radians(store["ANGLE_MAX"] / 100.0),
        turn_rad_s=radians(store["PILOT_Y_RATE"]),
        # Without a receiver no input at all is left once the ground station's ends, whether it still counts or not.
        lost_after_s=store["RC_FS_TIMEOUT"],
        loss=loss,
        stickless=_CONTINUED[options & 1] | _CONTINUED[options & 4],
    )


def _ardupilot_channel(store: ParameterStore, stick: str, sense: float) -> Channel:
    number = int(store[f"RCMAP_{stick}"])
    return _channel(store, number, stick, -sense if store[f"RC{number}_REVERSED"] else sense)


def _px4_channel(store: ParameterStore, stick: str) -> Channel:
    number = int(store[f"RC_MAP_{stick}"])
    return _channel(store, number, stick, store[f"RC{number}_REV"]) if number else _NO_CHANNEL


def _channel(store: ParameterStore, number: int, stick: str, sense: float) -> Channel:
    """Return a channel by what both autopilots call alike; the throttle has no middle of its own."""
    least_us, most_us = store[f"RC{number}_MIN"], store[f"RC{number}_MAX"]
    middle_us = (least_us + most_us) / 2.0 if stick == "THROTTLE" else store[f"RC{number}_TRIM"]
    return Channel(number, least_us, middle_us, most_us, sense)


def _px4_positions(store: ParameterStore, switch: int) -> tuple[float, ...]:
    """Return where one position of PX4's mode switch ends, each a sixth of the way (`rc_update.cpp`)."""
    least_us, most_us = (store[f"RC{switch}_MIN"], store[f"RC{switch}_MAX"]) if switch else (1000.0, 2000.0)
    return tuple(least_us + (most_us - least_us) * number / _POSITIONS for number in range(1, _POSITIONS))


_NO_CHANNEL: Final = Channel(0, 1000.0, 1500.0, 2000.0, 1.0)
_CONTINUED: Final[Mapping[int, Stickless]] = {0: Stickless.NOTHING, 1: Stickless.MISSION, 4: Stickless.GUIDED}
"""What goes on without sticks by the bits of FS_OPTIONS."""

_ARDUPILOT_LOSS: Final[Mapping[int, Action]] = {
    1: Action.RETURN,
    2: Action.RETURN,
    3: Action.LAND,
    4: Action.RETRACE,
    5: Action.RETRACE_OR_LAND,
    # Without landing sequences the next best of the chain is flown.
    6: Action.RETURN,
    7: Action.BRAKE,
}
PX4_LINK_LOSS: Final[Mapping[int, Action]] = {
    1: Action.HOLD,
    2: Action.RETURN,
    3: Action.LAND,
    5: Action.TERMINATE,
    6: Action.DISARM,
}
