"""Flight by hand: the pilot's sticks, how long they count, and the task that flies by them.

A stick that is let go keeps what was reached: the height, and where the mode keeps the place, the place. Silent sticks
count as let go.
"""

from dataclasses import replace
from math import cos, inf, sin
from typing import Final, NamedTuple

from vehicle_sim.autopilot.tasks import HoldTask, LevelTask, Task, stopping_place
from vehicle_sim.parameters import FlightSettings
from vehicle_sim.parameters.hand import HandSettings
from vehicle_sim.signals import Estimate, PartialVector, Setpoint


class Sticks(NamedTuple):
    """How far each stick is off its centre, -1 to 1: forward, to the right, clockwise, up."""

    forward: float
    right: float
    turn: float
    climb: float


CENTRED: Final = Sticks(0.0, 0.0, 0.0, 0.0)


class Pilot:
    """What is known of the pilot at the sticks.

    Attributes:
        hand: What full stick means, and which sticks count; whoever changes the settings changes it.
        heard_s: Vehicle time at which the sticks were last heard, None before the first time.
        sticks: How they stood then.
    """

    def __init__(self, hand: HandSettings) -> None:
        """Nobody has been heard."""
        self.hand = hand
        self.heard_s: float | None = None
        self.sticks = CENTRED

    def move(self, sticks: Sticks, now_s: float) -> None:
        """Note how the sticks stand; what is beyond their ends is at their ends."""
        self.heard_s = now_s
        forward, right, turn, climb = (max(-1.0, min(value, 1.0)) for value in sticks)
        self.sticks = Sticks(forward, right, turn, climb)

    def leave(self) -> None:
        """Note that the sticks are given back: they are as unknown as before."""
        self.heard_s = None
        self.sticks = CENTRED

    def silent_s(self, now_s: float) -> float:
        """Return for how long the sticks have been silent, infinity where they were never heard."""
        return inf if self.heard_s is None else now_s - self.heard_s

    def is_lost(self, now_s: float) -> bool:
        """Whether somebody has been at the sticks and is there no more."""
        heard_s, hand = self.heard_s, self.hand
        return heard_s is not None and hand.listens and now_s - heard_s > hand.lost_after_s

    def counts(self, now_s: float) -> bool:
        """Whether somebody is at the sticks now: they have been heard lately, and they are listened to."""
        return self.hand.listens and self.silent_s(now_s) <= self.hand.timeout_s

    def asked(self, now_s: float) -> Sticks:
        """Return what the sticks ask for now, without their dead zones; nothing where they do not count."""
        if not self.counts(now_s):
            return CENTRED
        hand = self.hand
        forward, right, turn, climb = self.sticks
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
        at_rest = HoldTask(estimate, settings) if keeps_place else LevelTask(estimate)
        super().__init__(at_rest.setpoint)
        self._settings, self._pilot = settings, pilot
        self._keeps_place = keeps_place
        self._asked = CENTRED
        self._take_limits()

    def _take_limits(self) -> None:
        hand = self._pilot.hand
        self.speed_m_s, self.climb_m_s, self.descent_m_s = hand.speed_m_s, hand.climb_m_s, hand.descent_m_s

    def lifts(self, estimate: Estimate) -> bool:
        """Leave the ground when the pilot asks for a climb."""
        return self._pilot.asked(estimate.time_s).climb > 0.0

    def advance(self, now_s: float, estimate: Estimate) -> None:
        """Bring the setpoint up to date with the sticks."""
        asked, before = self._pilot.asked(now_s), self._asked
        self._asked = asked
        if asked == before == CENTRED:
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
            north, east, _ = stopping_place(estimate, self._settings)
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
