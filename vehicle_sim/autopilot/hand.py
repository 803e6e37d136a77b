"""Flight by hand: the pilot's sticks, how long they count, and the task that flies by them.

They come by a radio, by a joystick, or by MAVLink in the place of channels of the radio. The radio's pilot does what is
fit until somebody says what the sticks do: the throttle is down on the ground and in the middle in the air.

A stick that is let go keeps what was reached: the height, and where the mode keeps the place, the place. Silent sticks
count as let go.
"""

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import replace
from math import cos, hypot, inf, isnan, sin
from typing import Final, NamedTuple

from vehicle_sim.autopilot.tasks import LevelTask, Task, stopping_place
from vehicle_sim.parameters import FlightSettings
from vehicle_sim.parameters.hand import Channel, HandSettings
from vehicle_sim.signals import Estimate, PartialVector, Setpoint


class Sticks(NamedTuple):
    """How far each stick is off its centre, -1 to 1: forward, to the right, clockwise, up."""

    forward: float
    right: float
    turn: float
    climb: float


CENTRED: Final = Sticks(0.0, 0.0, 0.0, 0.0)
_HELD_BELOW_M_S: Final = 0.5
"""A vehicle that brakes keeps the place where it has become so slow."""


_DOWN_US, _MIDDLE_US = 1000.0, 1500.0
_SETTLED_S: Final = 0.2
"""A mode switch counts once it has stood for so long."""


class Pilot:
    """What is known of the pilot at the sticks.

    Attributes:
        hand: What full stick means, and which sticks count; whoever changes the settings changes it.
        sticks: How those of the joystick stood when they were last heard.
        switched: The position from 0 that the mode switch has been put to; whoever has seen to it sets it to None.
        arming: Whether the sticks have asked to be armed, or to be disarmed; None once somebody has seen to it.
    """

    def __init__(self, hand: HandSettings) -> None:
        """Nobody has been heard."""
        self.hand = hand
        self.sticks = CENTRED
        self.switched: int | None = None
        self.arming: bool | None = None
        self._gesture: tuple[int, float] = (0, 0.0)
        self._joystick_s: float | None = None
        self._radio_s: float | None = None
        self._radio_first = True
        self._overrides: dict[int, tuple[float, float]] = {}
        self.receive(())
        self._landed = True
        self._position: int | None = None
        self._moved: tuple[int, float] | None = None

    def receive(self, sent_us: Sequence[float]) -> None:
        """Note what the radio receives from now on.

        Args:
            sent_us: The pulse of each channel in microseconds, from channel 1 on, not a number where the pilot does
                what is fit; empty while nothing is received.
        """
        channels = list(enumerate(sent_us, start=1))
        self._fit = frozenset(number for number, us in channels if isnan(us))
        self._grounded = {number: _DOWN_US if isnan(us) else us for number, us in channels}
        self._airborne = {number: _MIDDLE_US if isnan(us) else us for number, us in channels}

    @property
    def _received(self) -> dict[int, float]:
        return self._grounded if self._landed else self._airborne

    def move(self, sticks: Sticks, now_s: float) -> None:
        """Note how the joystick stands; what is beyond its ends is at its ends."""
        self._radio_first = self._radio_first and self._radio_s is not None
        self._joystick_s = now_s
        forward, right, turn, climb = (max(-1.0, min(value, 1.0)) for value in sticks)
        self.sticks = Sticks(forward, right, turn, climb)

    def override(self, channel: int, pulse_us: float | None, now_s: float) -> None:
        """Put a pulse in the place of a channel of the radio, from 1 on; None gives the channel back."""
        if pulse_us is None or self.hand.timeout_s <= 0.0:
            self._overrides.pop(channel, None)
        else:
            self._overrides[channel] = (pulse_us, now_s)
            self._hear(now_s)

    def _hear(self, now_s: float) -> None:
        self._radio_first = self._radio_first or self._joystick_s is None
        self._radio_s = now_s

    def listen(self, now_s: float, *, landed: bool) -> None:
        """Note what the radio receives now, whether the mode switch has been moved, and whether the sticks arm."""
        self._landed = landed
        if self._grounded:
            self._hear(now_s)
        self._watch_gesture(now_s)
        pulse_us = self.pulse_us(self.hand.switch, now_s) if self.hand.radio else None
        if pulse_us is None:
            return
        position = bisect_left(self.hand.switch_us, pulse_us)
        if position == self._position:
            self._moved = None
        elif self._position is None:
            self._position = position  # as it stands at the start
        elif self._moved is None or self._moved[0] != position:
            self._moved = (position, now_s)
        elif now_s - self._moved[1] >= _SETTLED_S:
            self.switched = self._position = position

    def _watch_gesture(self, now_s: float) -> None:
        """Note which gesture has been held for long enough, once."""
        gesture, (direction, since_s) = self.hand.gesture, self._gesture
        if not gesture.arms:
            return
        sticks, held = self.standing(now_s), 0
        if abs(sticks.turn) > gesture.turn and max(abs(sticks.forward), abs(sticks.right)) <= gesture.centred:
            down = (sticks.climb if self.hand.joystick else self.throttle(now_s)) <= gesture.throttle
            held = (1 if sticks.turn > 0.0 else -1) if down else 0
        if held != direction:
            self._gesture = (held, now_s)
        elif held and now_s - since_s >= gesture.hold_s:
            self._gesture = (held, inf)
            self.arming = held > 0 if held > 0 or gesture.disarms else None

    def leave(self) -> None:
        """Note that the sticks are given back: they are as unknown as before."""
        self._joystick_s = self._radio_s = None
        self._overrides.clear()
        self.sticks = CENTRED

    @property
    def heard_s(self) -> float | None:
        """Vehicle time at which sticks that count were last heard, None before the first time."""
        joystick_s, radio_s = self._joystick_s, self._radio_s
        if joystick_s is None or not self.hand.joystick:
            return radio_s if self.hand.radio else None
        return joystick_s if radio_s is None or not self.hand.radio else max(joystick_s, radio_s)

    def silent_s(self, now_s: float) -> float:
        """Return for how long the sticks have been silent, infinity where they were never heard."""
        return inf if self.heard_s is None else now_s - self.heard_s

    def is_lost(self, now_s: float) -> bool:
        """Whether somebody has been at the sticks and is there no more."""
        heard_s = self.heard_s
        return heard_s is not None and (now_s - heard_s > self.hand.lost_after_s or self.is_low(now_s))

    def is_low(self, now_s: float) -> bool:
        """Whether the throttle is where a receiver puts it that has lost its transmitter."""
        least_us = self.hand.least_throttle_us
        pulse_us = self.pulse_us(self.hand.channels[3].number, now_s) if least_us else None
        return pulse_us is not None and pulse_us < least_us

    def counts(self, now_s: float) -> bool:
        """Whether somebody is at the sticks now: they have been heard lately, and they are listened to."""
        return (self.hand.radio and bool(self._grounded)) or self.silent_s(now_s) <= self.hand.timeout_s

    def pulse_us(self, channel: int, now_s: float) -> float | None:
        """Return the pulse of a channel of the radio, or of what counts in its place; None where there is none."""
        override = self._overrides.get(channel)
        if override is not None and now_s - override[1] <= self.hand.timeout_s:
            return override[0]
        return self._received.get(channel)

    def channels(self, now_s: float) -> dict[int, float]:
        """Return the pulse of each channel that has one, by its number from 1."""
        counting = {n: us for n, (us, at_s) in self._overrides.items() if now_s - at_s <= self.hand.timeout_s}
        return self._received | counting

    def throttle(self, now_s: float) -> float:
        """Return where the throttle of the radio stands, -1 to 1; down where there is none."""
        channel = self.hand.channels[3]
        pulse_us = self.pulse_us(channel.number, now_s)
        return -1.0 if pulse_us is None else channel.share(pulse_us)

    def standing(self, now_s: float) -> Sticks:
        """Return how the sticks stand that count now."""
        hand = self.hand
        has_radio = hand.radio and (bool(self._grounded) or self._is_fresh(self._radio_s, now_s))
        has_joystick = hand.joystick and self._is_fresh(self._joystick_s, now_s)
        if has_joystick and not (has_radio and (self._radio_first or not hand.keeps_first)):
            return self.sticks
        return Sticks(*(self._stick(channel, now_s) for channel in hand.channels)) if has_radio else CENTRED

    def _is_fresh(self, heard_s: float | None, now_s: float) -> bool:
        return heard_s is not None and now_s - heard_s <= self.hand.timeout_s

    def _stick(self, channel: Channel, now_s: float) -> float:
        if channel.number in self._fit and channel.number not in self._overrides:
            return 0.0
        pulse_us = self.pulse_us(channel.number, now_s)
        return 0.0 if pulse_us is None else channel.share(pulse_us)

    def asked(self, now_s: float) -> Sticks:
        """Return what the sticks ask for now, without their dead zones; nothing where they do not count."""
        if not self.counts(now_s):
            return CENTRED
        hand = self.hand
        forward, right, turn, climb = self.standing(now_s)
        zone = hand.dead_zone
        return Sticks(
            _beyond(forward, zone), _beyond(right, zone), _beyond(turn, zone), _beyond(climb, hand.climb_dead_zone)
        )


def _beyond(value: float, zone: float) -> float:
    """Return the share of the way between the dead zone and the end."""
    size = abs(value)
    if size <= zone:
        return 0.0
    return (size - zone) / (1.0 - zone) * (1.0 if value > 0.0 else -1.0)


class HandTask(Task):
    """Fly by the sticks: a velocity where the mode keeps the place, a lean where it does not."""

    def __init__(self, estimate: Estimate, settings: FlightSettings, pilot: Pilot, *, keeps_place: bool) -> None:
        """Begin with sticks that are let go."""
        at_rest = LevelTask(estimate).setpoint
        super().__init__(replace(at_rest, velocity_ned_m_s=(0.0, 0.0, None)) if keeps_place else at_rest)
        self._settings, self._pilot = settings, pilot
        self._keeps_place = keeps_place
        self._asked = CENTRED
        self._take_limits()

    def _take_limits(self) -> None:
        hand = self._pilot.hand
        self.speed_m_s, self.climb_m_s, self.descent_m_s = hand.speed_m_s, hand.climb_m_s, hand.descent_m_s

    @property
    def _brakes(self) -> bool:
        return self._keeps_place and self.setpoint.position_ned_m[0] is None

    def lifts(self, estimate: Estimate) -> bool:
        """Leave the ground when the pilot asks for a climb."""
        return self._pilot.asked(estimate.time_s).climb > 0.0

    def advance(self, now_s: float, estimate: Estimate) -> None:
        """Bring the setpoint up to date with the sticks."""
        asked, before = self._pilot.asked(now_s), self._asked
        self._asked = asked
        if asked == before == CENTRED and not self._brakes:
            return
        self._take_limits()
        hand, place = self._pilot.hand, self.setpoint.position_ned_m
        down, sink = place[2], None
        if asked.climb != 0.0:
            down, sink = None, -asked.climb * (hand.climb_m_s if asked.climb > 0.0 else hand.descent_m_s)
        elif down is None:
            down = stopping_place(estimate, self._settings)[2]
        setpoint = replace(
            self.setpoint,
            yaw_rad=None if asked.turn != 0.0 or before.turn != 0.0 else self.setpoint.yaw_rad,
            yaw_rate_rad_s=asked.turn * hand.turn_rad_s,
        )
        if self._keeps_place:
            self.setpoint = self._going(setpoint, estimate, down, sink)
        else:
            self.setpoint = self._leaning(setpoint, estimate, down, sink)

    def _going(self, setpoint: Setpoint, estimate: Estimate, down: float | None, sink: float | None) -> Setpoint:
        asked, hand = self._asked, self._pilot.hand
        north, east, _ = setpoint.position_ned_m
        velocity: PartialVector = (None, None, sink)
        if asked.forward != 0.0 or asked.right != 0.0:
            north = east = None
            ahead, aside = _turned(asked, estimate.yaw_rad)
            velocity = (hand.speed_m_s * ahead, hand.speed_m_s * aside, sink)
        elif north is None:
            velocity = (0.0, 0.0, sink)
            if hypot(*estimate.velocity_ned_m_s[:2]) < _HELD_BELOW_M_S:
                north, east, _ = estimate.position_ned_m
                velocity = (None, None, sink)
        return replace(setpoint, position_ned_m=(north, east, down), velocity_ned_m_s=velocity)

    def _leaning(self, setpoint: Setpoint, estimate: Estimate, down: float | None, sink: float | None) -> Setpoint:
        ahead, aside = _turned(self._asked, estimate.yaw_rad)
        return replace(
            setpoint,
            position_ned_m=(None, None, down),
            velocity_ned_m_s=(None, None, sink),
            lean_ne_rad=(self._pilot.hand.tilt_rad * ahead, self._pilot.hand.tilt_rad * aside),
        )


def _turned(sticks: Sticks, yaw_rad: float) -> tuple[float, float]:
    """Turn forward and right to north and east."""
    return (
        sticks.forward * cos(yaw_rad) - sticks.right * sin(yaw_rad),
        sticks.forward * sin(yaw_rad) + sticks.right * cos(yaw_rad),
    )
