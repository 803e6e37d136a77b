"""The guard: sees failures come and go, and says what is done about them.

What is set for each failure comes from the parameters; how it begins and ends is each flavour's habit. After PX4
`failsafe.cpp` and ArduCopter `events.cpp`, `fence.cpp`, `ekf_check.cpp`. ArduCopter has no failsafe of its own for
lost setpoints (it stops, see `GuidedTask`) and none for wind.
"""

from collections.abc import Mapping
from math import hypot, inf
from typing import Final, NamedTuple

from vehicle_sim.autopilot import texts
from vehicle_sim.autopilot.failsafe import QUIET, Decision, FailsafeMonitor, Response
from vehicle_sim.autopilot.fence import FenceWatch, names
from vehicle_sim.autopilot.modes import MODES, Failsafe, Mode, Severity, StatusText
from vehicle_sim.autopilot.tasks import stopping_place
from vehicle_sim.battery import BatteryLevel
from vehicle_sim.parameters import Action, FenceType, Flavour, FlightSettings
from vehicle_sim.parameters.hand import Stickless
from vehicle_sim.signals import Estimate, Vector

_DOUBT_S: Final = 1.0
_WIND_REMINDER_S: Final = 60.0
_AP, _PX4 = Flavour.ARDUPILOT, Flavour.PX4


class _Habit(NamedTuple):
    """Whether a response ends with its failure, and whether a hold may come before it."""

    ends: bool
    pauses: bool


_HABITS: Final[Mapping[Flavour, Mapping[Failsafe, _Habit]]] = {
    _AP: dict.fromkeys(Failsafe, _Habit(ends=False, pauses=False)),
    _PX4: {
        Failsafe.BATTERY_LOW: _Habit(ends=True, pauses=True),
        Failsafe.SETPOINTS_LOST: _Habit(ends=True, pauses=False),
        Failsafe.STICKS_LOST: _Habit(ends=False, pauses=True),
        Failsafe.GROUND_LOST: _Habit(ends=False, pauses=True),
        Failsafe.WIND: _Habit(ends=False, pauses=True),
        Failsafe.FENCE: _Habit(ends=False, pauses=True),
        Failsafe.ESTIMATOR: _Habit(ends=True, pauses=False),
        Failsafe.BATTERY_CRITICAL: _Habit(ends=True, pauses=True),
        Failsafe.BATTERY_EMERGENCY: _Habit(ends=True, pauses=True),
    },
}


_STICKLESS: Final[Mapping[Mode, Stickless]] = {
    Mode.AUTO: Stickless.MISSION,
    Mode.HOLD: Stickless.HOLD,
    Mode.TAKEOFF: Stickless.HOLD,
    Mode.GUIDED: Stickless.GUIDED,
}


class Situation(NamedTuple):
    """What the guard goes by, as of now.

    Attributes:
        intended: The mode that the pilot chose last.
        stream_fresh: Whether setpoints come.
        sticks_lost: Whether a pilot who has been at the sticks is there no more.
        ground_lost: Whether a ground station that has been there is silent.
        wind_ned_m_s: The wind that the vehicle feels.
    """

    now_s: float
    estimate: Estimate
    flying: bool
    intended: Mode
    stream_fresh: bool
    sticks_lost: bool
    ground_lost: bool
    battery: BatteryLevel
    wind_ned_m_s: Vector
    home_ned_m: Vector


class Guard:
    """Watches one vehicle. Attributes to read: `fence`, `monitor`."""

    def __init__(self, flavour: Flavour, settings: FlightSettings) -> None:
        """Begin with nothing wrong."""
        self.fence = FenceWatch(settings.fence)
        self.monitor = FailsafeMonitor()
        self._flavour = flavour
        self._settings = settings
        self._position_good_s = 0.0
        self._wind_told_s = -inf

    def configure(self, settings: FlightSettings) -> None:
        """Go by other settings."""
        self._settings = settings
        self.fence.configure(settings.fence)

    def trust_position(self, now_s: float) -> None:
        """Take the position for good as of now."""
        self._position_good_s = now_s

    @property
    def in_failsafe(self) -> bool:
        """Whether the heartbeat calls the state critical.

        PX4: while a failsafe acts; ArduPilot: while there is a failure other than a breach of the fence.
        """
        if self._flavour is _PX4:
            return self.monitor.action > Action.NOTHING
        return bool(self.monitor.active - {Failsafe.FENCE})

    @property
    def is_outside(self) -> bool:
        """Whether a breach keeps the vehicle from being armed."""
        return self._settings.fence.reports and self.fence.breached != FenceType.NONE

    def is_blind(self, *, position_ok: bool, home: bool) -> bool:
        """Whether the fence cannot be watched, or not be returned from, for want of a position or home."""
        if self._flavour is _PX4:
            return self._settings.fence.action is Action.RETURN and not home
        return bool(self.fence.enabled & ~FenceType.ALTITUDE) and not (position_ok and home)

    @property
    def recovers(self) -> bool:
        """Whether the pilot may not leave the mode in which the vehicle gets back into its fence."""
        fence = self._settings.fence
        acts = self.monitor.action >= Action.HOLD and fence.action >= Action.HOLD
        return fence.locks_mode and acts and self.fence.breached != FenceType.NONE

    def look_at_fence(self, situation: Situation) -> FenceType:
        """Look at the fence alone, also before arming; return what is freshly breached."""
        estimate = situation.estimate
        if not self.fence.enabled or estimate.origin is None or not estimate.status.position_ok:
            return FenceType.NONE
        predicts = self._settings.fence.predicts and situation.flying
        place = stopping_place(estimate, self._settings) if predicts else estimate.position_ned_m
        return self.fence.look(situation.now_s, place, situation.home_ned_m, estimate.origin)

    def decide(self, situation: Situation, fresh: FenceType) -> tuple[Decision, list[StatusText]]:
        """Return what is to be done now, and what is to be said. `fresh`: what `look_at_fence` has just returned."""
        if fresh:
            self.monitor.renewed(Failsafe.FENCE)
        failures = self._failures(situation)
        if not failures and self.monitor.is_quiet:
            return QUIET, self._wind_reminder(situation)
        decision = self.monitor.assess(situation.now_s, failures, self._settings.failsafe_hold_s)
        said = [text for failsafe in decision.appeared for text in self._said_of(failsafe, fresh)]
        over = texts.OVER[self._flavour]
        said += [over[failsafe] for failsafe in decision.vanished if failsafe in over]
        if decision.pause_s > 0.0:
            said.append(texts.pausing(decision.pause_s))
        return decision, said + self._wind_reminder(situation)

    def _said_of(self, failsafe: Failsafe, fresh: FenceType) -> list[StatusText]:
        if failsafe is not Failsafe.FENCE:
            text = texts.FAILED[self._flavour].get(failsafe)
            return [] if text is None else [text]
        breached = fresh or self.fence.breached
        if self._flavour is _AP:
            return [StatusText(Severity.NOTICE, f"{names(breached)} breached")]
        return [text for kind, text in texts.PX4_BREACHES.items() if kind in breached]

    def _failures(self, situation: Situation) -> dict[Failsafe, Response]:
        """Return the failures that are present, with the responses that are set for them."""
        settings, flying = self._settings, situation.flying
        present = self._silences(situation)
        if flying and settings.wind.limit_m_s < inf and _speed(situation) > settings.wind.limit_m_s:
            present[Failsafe.WIND] = settings.wind.action
        if self.is_outside:
            present[Failsafe.FENCE] = self._fence_action()
        if flying and self._position_lost(situation):
            present[Failsafe.ESTIMATOR] = settings.estimator_loss
        if situation.battery is BatteryLevel.LOW:
            present[Failsafe.BATTERY_LOW] = settings.battery_low
        elif situation.battery is BatteryLevel.CRITICAL:
            present[Failsafe.BATTERY_CRITICAL] = settings.battery_critical
        elif situation.battery is BatteryLevel.EMERGENCY:
            present[Failsafe.BATTERY_EMERGENCY] = settings.battery_emergency
        if not present:
            return {}
        habits = _HABITS[self._flavour]
        return {failsafe: Response(action, *habits[failsafe]) for failsafe, action in present.items()}

    def _silences(self, situation: Situation) -> dict[Failsafe, Action]:
        """Return who of those that should be heard is not, with what is set for that."""
        settings, intended = self._settings, situation.intended
        present: dict[Failsafe, Action] = {}
        if self._flavour is _PX4 and intended is Mode.GUIDED and not situation.stream_fresh:
            # Modes by hand are no way out without a pilot.
            present[Failsafe.SETPOINTS_LOST] = settings.hand.loss if situation.sticks_lost else settings.setpoint_loss
        if situation.sticks_lost and settings.hand.loss and not _STICKLESS.get(intended, 0) & settings.hand.stickless:
            present[Failsafe.STICKS_LOST] = settings.hand.loss
        # Who has been told to land goes on with it.
        if situation.ground_lost and intended is not Mode.LAND:
            present[Failsafe.GROUND_LOST] = settings.ground_loss
        return present

    def _fence_action(self) -> Action:
        fence = self._settings.fence
        if fence.action is not Action.NOTHING and self.fence.distance_m > fence.give_up_m:
            return Action.LAND
        return fence.action

    def _position_lost(self, situation: Situation) -> bool:
        """Tell whether a position that is needed fails its checks, and has failed the noisy ones for a second."""
        settings, status = self._settings, situation.estimate.status
        ratio = max(status.position_horizontal_ratio, status.velocity_ratio)
        if ratio <= settings.estimator_ratio and status.horizontal_accuracy_m <= settings.estimator_accuracy_m:
            self._position_good_s = situation.now_s
        needed = MODES[self._flavour][situation.intended].needs_position or settings.estimator_in_manual
        return needed and (not status.position_ok or situation.now_s - self._position_good_s > _DOUBT_S)

    def _wind_reminder(self, situation: Situation) -> list[StatusText]:
        limits = self._settings.wind
        due = situation.now_s - self._wind_told_s > _WIND_REMINDER_S
        if limits.warning_m_s == inf or not (situation.flying and due):
            return []
        wind = _speed(situation)
        if not limits.warning_m_s < wind <= limits.limit_m_s or situation.intended in (Mode.RETURN, Mode.LAND):
            return []
        self._wind_told_s = situation.now_s
        return [texts.high_wind(wind)]


def _speed(situation: Situation) -> float:
    north, east, _ = situation.wind_ned_m_s
    return hypot(north, east)
