"""What the vehicle has said of itself so far, and whether that is enough to fly."""

import math
from collections import deque
from typing import Final, NamedTuple

from mission.link.texts import Text, TextAssembler
from mission.link.values import (
    Attitude,
    Battery,
    Body,
    Estimates,
    EstimatorReport,
    Fix,
    GlobalPosition,
    Health,
    Heartbeat,
    Home,
    LandedState,
    Landing,
    LocalPosition,
    Origin,
    Sensors,
    TruePlace,
    Version,
    Wind,
    Words,
)
from mission.link.vehicle_clock import VehicleClock

_MOST_TEXTS: Final = 64
_FRESH_S: Final = 2.0
HEARTBEATS: Final = 2
"""How many in a row are believed: one alone may have been late on its way."""

_BEATLESS_S: Final = 2.5
_SILENT_S: Final = 1.0
"""Vehicle time without a heartbeat, or time here without a word, after which the next is not waited for."""

_DOUBLED_S: Final = 0.3
"""The same heartbeat within this time is one that came twice; vehicles beat once a second."""

_PARTS: Final = ((Sensors.GYRO, "gyro"), (Sensors.ACCELEROMETER, "accelerometer"), (Sensors.COMPASS, "compass"))
_NEEDED: Final = (
    (Estimates.ATTITUDE, "attitude"),
    (Estimates.VELOCITY_HORIZONTAL, "horizontal velocity"),
    (Estimates.VELOCITY_VERTICAL, "vertical velocity"),
    (Estimates.HEIGHT_ABSOLUTE, "height"),
)


class Heard(NamedTuple):
    """A text, with when it was heard, vehicle time; minus infinity before that was known."""

    at_s: float
    text: Text


class VehicleState:
    """The newest of each message, of one vehicle; None where there was none yet.

    Attributes:
        clock: The vehicle's own time.
        beats: How many heartbeats were heard.
        heartbeats_in_mode: How many heartbeats in a row have shown the present mode.
        heartbeats_armed: How many in a row have shown armed motors.
        heartbeats_disarmed: Likewise disarmed ones.
        armed: Whether the motors are armed: one heartbeat is enough to say so, two in a row to say otherwise.
        position_at_s: Vehicle time of ``position``.
        fix: What its satellite receiver says.
        wind: Its own estimate, if it makes one.
        true_place: Where it really is, if it is a simulator that tells.
        home: Where it was armed, by its own word; None where it has not told.
    """

    def __init__(self) -> None:
        """Start knowing nothing."""
        self.clock = VehicleClock()
        self.heartbeat: Heartbeat | None = None
        self.beats = self.heartbeats_in_mode = self.heartbeats_armed = self.heartbeats_disarmed = 0
        self.armed = False
        self._beat_at_s = -math.inf
        self.position: LocalPosition | None = None
        self.position_at_s = -math.inf
        self.place: GlobalPosition | None = None
        self.attitude: Attitude | None = None
        self.origin: Origin | None = None
        self.health: Health | None = None
        self.battery: Battery | None = None
        self.estimator: EstimatorReport | None = None
        self.landed = LandedState.UNDEFINED
        self.version: Version | None = None
        self.fix: Fix | None = None
        self.wind: Wind | None = None
        self.true_place: TruePlace | None = None
        self.home: Home | None = None
        self.heard_kinds: set[type[Body]] = set()
        self._no_numbers: set[type[Body]] = set()
        self._told_at_s: dict[type[Body], float] = {}
        self._texts = TextAssembler()
        self._heard: deque[Heard] = deque(maxlen=_MOST_TEXTS)

    @property
    def mode(self) -> int:
        """The autopilot's own number of the present mode; -1 before the first heartbeat."""
        return -1 if self.heartbeat is None else self.heartbeat.custom_mode

    def is_silent(self, local_s: float) -> bool:
        """Whether heartbeats, or all that it says, fail to come."""
        at_s = self.clock.now_s(local_s)
        return at_s is None or at_s - self._beat_at_s > _BEATLESS_S or local_s - self.clock.heard_s > _SILENT_S

    @property
    def battery_critical(self) -> bool:
        """Whether the vehicle calls its battery critical or worse."""
        return self.battery is not None and self.battery.critical

    def take(self, body: Body, local_s: float) -> list[Text]:
        """Take note of a message that arrived at ``local_s``; returns the texts that it completes."""
        self.heard_kinds.add(type(body))
        if isinstance(body, (LocalPosition, GlobalPosition, Attitude)):
            self._take_motion(body, local_s)
        elif isinstance(body, Heartbeat):
            self._take_heartbeat(body, local_s)
        elif isinstance(body, Words):
            return self._note(self._texts.take(body, local_s), local_s)
        elif isinstance(body, Landing):
            self.landed = body.state
        elif isinstance(body, Origin):
            self.origin = body
        else:
            self._take_health(body)
        return []

    def overdue_texts(self, local_s: float) -> list[Text]:
        """Texts of which a piece was lost."""
        return self._note(self._texts.overdue(local_s), local_s)

    def told_failsafe_since(self, at_s: float) -> bool:
        """Whether the vehicle said since then, vehicle time, that it acts by itself."""
        return any(heard.at_s >= at_s and heard.text.tells_failsafe for heard in self._heard)

    def words_since(self, at_s: float) -> str:
        """What the vehicle said to explain itself since then, vehicle time, each text once, in its own words."""
        said = [heard.text.text for heard in self._heard if heard.at_s >= at_s and heard.text.grave]
        return "; ".join(dict.fromkeys(text for text in said if text))

    def unready(self, *, absolute: bool, aloft: bool = False) -> str:
        """Why it cannot be flown yet, for people; empty where it can.

        Args:
            absolute: Whether the mission lies at a place on Earth, so that a relative position is not enough.
            aloft: Whether it is taken over in the air, with motors on.
        """
        still = "its motors are armed" if self.armed and not aloft else ""
        return still or self._unestimated(absolute=absolute) or self._unplaced(absolute=absolute) or self._unwell()

    @property
    def estimate_trusted(self) -> bool:
        """Whether the estimator still vouches for attitude, velocity and position."""
        flags = Estimates(0) if self.estimator is None else self.estimator.flags
        return bool(flags & Estimates.ATTITUDE) and bool(
            flags & (Estimates.POSITION_ABSOLUTE | Estimates.POSITION_RELATIVE)
        )

    @property
    def accuracy_m(self) -> tuple[float, float] | None:
        """How far off the receiver's place may be, level and in height."""
        return None if self.fix is None else self.fix.accuracy_m

    @property
    def armable(self) -> bool:
        """Whether its own checks before arming are passed, as far as it tells."""
        health = self.health
        checks = health is not None and bool(health.enabled & Sensors.PREARM_CHECK)
        return health is None or not checks or bool(health.healthy & Sensors.PREARM_CHECK)

    def _unestimated(self, *, absolute: bool) -> str:
        if self.estimator is None:
            return "no report of its estimator yet"
        flags = self.estimator.flags
        lacking = [name for flag, name in _NEEDED if not flags & flag]
        placed = Estimates.POSITION_ABSOLUTE | (Estimates(0) if absolute else Estimates.POSITION_RELATIVE)
        if not flags & placed:
            lacking.append("position")
        return f"its estimator has no {', no '.join(lacking)} yet" if lacking else ""

    def _unplaced(self, *, absolute: bool) -> str:
        newest_s = self.clock.newest_s
        for kind, name in ((LocalPosition, "local position"), (Attitude, "attitude")):
            if kind in self._no_numbers:
                return f"its {name} is no number"
            if kind not in self._told_at_s or newest_s is None:
                return f"no {name} yet"
            if newest_s - self._told_at_s[kind] > _FRESH_S:
                return f"its {name} is not renewed"
        if self.place is None:
            return "no global position and height yet"
        return "it has not told the origin of its local frame yet" if absolute and self.origin is None else ""

    def _unwell(self) -> str:
        health = self.health
        if health is None:
            return "no report of its sensors yet"
        bad = [name for part, name in _PARTS if health.enabled & part and not health.healthy & part]
        return f"its {' and '.join(bad)} {'is' if len(bad) == 1 else 'are'} not well" if bad else ""

    def _take_heartbeat(self, body: Heartbeat, local_s: float) -> None:
        """Count heartbeats that agree."""
        at_s = self.clock.now_s(local_s)
        if at_s is not None:
            if body == self.heartbeat and at_s - self._beat_at_s < _DOUBLED_S:
                return
            self._beat_at_s = at_s
        self.beats += 1
        same = self.heartbeat is not None and self.heartbeat.custom_mode == body.custom_mode
        self.heartbeats_in_mode = self.heartbeats_in_mode + 1 if same else 1
        self.heartbeats_armed = self.heartbeats_armed + 1 if body.armed else 0
        self.heartbeats_disarmed = 0 if body.armed else self.heartbeats_disarmed + 1
        self.armed = body.armed or (self.armed and self.heartbeats_disarmed < HEARTBEATS)
        self.heartbeat = body

    def _take_motion(self, body: LocalPosition | GlobalPosition | Attitude, local_s: float) -> None:
        """Keep numbers, and the newer of two: what was reordered on the way never moves the vehicle back."""
        kind = type(body)
        if not self.clock.observe(body.time_boot_ms, local_s):
            return
        if not _is_finite(body):
            self._no_numbers.add(kind)
            return
        self._no_numbers.discard(kind)
        at_s = self.clock.unwrapped_s(body.time_boot_ms)
        if at_s <= self._told_at_s.get(kind, -math.inf):
            return
        self._told_at_s[kind] = at_s
        if isinstance(body, LocalPosition):
            self.position, self.position_at_s = body, at_s
        elif isinstance(body, GlobalPosition):
            self.place = body
        else:
            self.attitude = body

    def _take_health(self, body: Body) -> None:
        if isinstance(body, Health):
            self.health = body
        elif isinstance(body, Battery):
            self.battery = body
        elif isinstance(body, EstimatorReport):
            self.estimator = body
        elif isinstance(body, Version):
            self.version = body
        elif isinstance(body, Fix):
            self.fix = body
        elif isinstance(body, Home):
            self.home = body
        elif isinstance(body, TruePlace):
            self.true_place = body
        elif isinstance(body, Wind):
            self.wind = body if math.isfinite(body.speed_m_s + body.from_deg) else None

    def _note(self, texts: list[Text], local_s: float) -> list[Text]:
        if not texts:
            return texts
        at_s = self.clock.now_s(local_s)
        self._heard.extend(Heard(-math.inf if at_s is None else at_s, text) for text in texts)
        return texts


def _is_finite(body: LocalPosition | GlobalPosition | Attitude) -> bool:
    """Whether all that was told are numbers; an estimator that has none yet, or no longer, says so by NaN."""
    if isinstance(body, LocalPosition):
        return all(map(math.isfinite, (*body.position_ned_m, *body.velocity_ned_m_s)))
    return isinstance(body, GlobalPosition) or all(map(math.isfinite, body.angles_rad))
