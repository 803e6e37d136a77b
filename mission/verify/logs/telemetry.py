"""What a log tells of a vehicle, whatever wrote it: positions, arming, take-offs, pictures, and what time it was.

Times are seconds of the vehicle's own clock, which begins anew when the autopilot does. Rows are kept in flat arrays,
32 bytes each, so that a log of gigabytes leaves tens of megabytes here.
"""

from array import array
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Final

import numpy as np

from mission.errors import MissionError
from mission.geometry.arrays import FloatArray, frozen_floats
from mission.geometry.geodesy import LatLon

STALE_S: Final = 1.0
"""A message that is so much older than others before it came late, by another way; or the autopilot began anew."""

LEAP_S: Final = 60.0
"""One that is so much newer has a time that is damaged; or nothing was logged in between."""

_BELIEVED: Final = 10
"""So many strange times in a row are believed."""

MOST_ROWS: Final = 20_000_000
_CLOCK_S: Final = 1.0
_WIDTH: Final = 4


class LogError(MissionError):
    """A log that cannot be used, with what to do about it."""

    exit_code = 2


@dataclass(eq=False)
class Telemetry:
    """What one vehicle told between two starts of its autopilot.

    Attributes:
        local: Rows of time, north, east, down; in the estimator's own frame.
        world: Rows of time, latitude, longitude, height above home (NaN where that is not told); degrees, metres.
        armed: Times at which this changed, and to what; what was before the first is the opposite where it is told by
            changes alone, and the same where it is told again and again.
        airborne: Likewise.
        active: Likewise, whether it said that it was active, which of some autopilots means the same; it counts where
            nothing else tells of take-offs.
        origins: Where the local frame has its origin, when that was told.
        pictures: Times and numbers of pictures.
        clock: Pairs of the vehicle's time and that of the day, seconds since 1970, at least a second apart.
    """

    local: "array[float]" = field(default_factory=lambda: array("d"))
    world: "array[float]" = field(default_factory=lambda: array("d"))
    armed: list[tuple[float, bool]] = field(default_factory=list)
    airborne: list[tuple[float, bool]] = field(default_factory=list)
    active: list[tuple[float, bool]] = field(default_factory=list)
    origins: list[tuple[float, LatLon]] = field(default_factory=list)
    pictures: list[tuple[float, int]] = field(default_factory=list)
    clock: list[tuple[float, float]] = field(default_factory=list)

    @property
    def local_rows(self) -> FloatArray:
        """``local`` in the order of time, shape (N, 4)."""
        return _ordered(self.local)

    @property
    def world_rows(self) -> FloatArray:
        """``world`` in the order of time, shape (N, 4)."""
        return _ordered(self.world)

    def note_armed(self, t_s: float, armed: bool) -> None:  # noqa: FBT001 - what it is about
        """The vehicle told that it was, or was not, armed."""
        _changed(self.armed, t_s, armed)

    def note_airborne(self, t_s: float, airborne: bool) -> None:  # noqa: FBT001 - what it is about
        """The vehicle told that it was in the air, or on the ground."""
        _changed(self.airborne, t_s, airborne)

    def note_active(self, t_s: float, active: bool) -> None:  # noqa: FBT001 - what it is about
        """The vehicle told that it was active, or standing by."""
        _changed(self.active, t_s, active)

    def note_clock(self, t_s: float, utc_s: float) -> None:
        """What time of the day it was."""
        if not self.clock or t_s - self.clock[-1][0] >= _CLOCK_S:
            self.clock.append((t_s, utc_s))


def began_otherwise(changes: list[tuple[float, bool]]) -> None:
    """Of a log that tells changes alone: before the first, it was the other way round."""
    if changes:
        changes.insert(0, (-np.inf, not changes[0][1]))


class Collector:
    """Takes what a vehicle tells in the order in which it is logged, and finds where its clock begins anew.

    Attributes:
        boots: What was told between two starts, in order.
        newest_s: The newest time that was told since the last start; minus infinity before the first.
    """

    def __init__(self) -> None:
        """Know of nothing yet."""
        self.boots = [Telemetry()]
        self.newest_s = -np.inf
        self._rows = 0
        # What has a strange time, and with it what was told without one: of whichever start it is.
        self._strange_s: list[float] = []
        self._waiting: list[Callable[[], None]] = []

    @property
    def now(self) -> Telemetry:
        """What was told since the last start."""
        return self.boots[-1]

    def time(self, t_s: float) -> None:
        """Some message of this time."""
        self._take(t_s, lambda: None)

    def local(self, t_s: float, north_m: float, east_m: float, down_m: float) -> None:
        """A position in the estimator's frame."""
        self._take(t_s, lambda: self._add(self.now.local, (t_s, north_m, east_m, down_m)))

    def world(self, t_s: float, latitude_deg: float, longitude_deg: float, height_m: float) -> None:
        """A position on Earth."""
        if latitude_deg or longitude_deg:  # both 0 where it is not known
            self._take(t_s, lambda: self._add(self.now.world, (t_s, latitude_deg, longitude_deg, height_m)))

    def note(self, told: Callable[[Telemetry, float], None]) -> None:
        """Something that was told without a time: it is given what was told since the start, and the newest time."""
        if self._strange_s:
            self._waiting.append(lambda: told(self.now, self.newest_s))
        else:
            told(self.now, self.newest_s)

    def finish(self) -> list[Telemetry]:
        """What was told between two starts, in order; strange times at the end are believed if they are later ones."""
        if self._strange_s and min(self._strange_s) > self.newest_s:
            self._believe()
        return self.boots

    def _take(self, t_s: float, add: Callable[[], None]) -> None:
        if self._fits(t_s):
            # The strange ones came late, or were damaged; what came with them and had no time is not.
            waiting, self._waiting, self._strange_s = self._waiting, [], []
            for each in waiting:
                each()
            self.newest_s = max(self.newest_s, t_s)
            add()
            return
        self._strange_s.append(t_s)
        self._waiting.append(lambda: self._take_again(t_s, add))
        if len(self._strange_s) == _BELIEVED:
            self._believe()

    def _fits(self, t_s: float) -> bool:
        return np.isinf(self.newest_s) or self.newest_s - STALE_S <= t_s <= self.newest_s + LEAP_S

    def _believe(self) -> None:
        """The clock began anew, or nothing was logged for long."""
        if not min(self._strange_s) > self.newest_s:
            self.boots.append(Telemetry())
        self.newest_s = -np.inf
        waiting, self._waiting, self._strange_s = self._waiting, [], []
        for each in waiting:
            each()

    def _take_again(self, t_s: float, add: Callable[[], None]) -> None:
        """Take what had a strange time, where that is believed by now; else it is left out."""
        if self._fits(t_s):
            self.newest_s = max(self.newest_s, t_s)
            add()

    def _add(self, rows: "array[float]", row: tuple[float, ...]) -> None:
        self._rows += 1
        if self._rows > MOST_ROWS:
            raise LogError(f"the log has more than {MOST_ROWS:,} positions; cut it to the flight")
        rows.extend(row)


@dataclass(frozen=True, eq=False)
class Log:
    """A log of one vehicle.

    Attributes:
        kind: What wrote it, in words.
        boots: What was told, from start to start of the autopilot.
        notes: What whoever reads the verdict should know of the log.
    """

    kind: str
    boots: tuple[Telemetry, ...]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Clock:
    """The time of the day.

    Attributes:
        t_s: The vehicle's time, ascending.
        utc_s: Seconds since 1970 at these; empty where it is not known.
    """

    t_s: FloatArray
    utc_s: FloatArray

    @classmethod
    def of(cls, pairs: Sequence[tuple[float, float]]) -> "Clock":
        """From pairs; those that go back are left out."""
        kept: list[tuple[float, float]] = list(pairs[:1])
        for _, pair in pairwise(pairs):
            if pair[0] > kept[-1][0] and pair[1] >= kept[-1][1]:
                kept.append(pair)
        rows = np.array(kept, dtype=np.float64).reshape(-1, 2)
        return cls(frozen_floats(rows[:, 0]), frozen_floats(rows[:, 1]))

    def utc(self, t_s: float) -> float | None:
        """Seconds since 1970; None where that is not known."""
        if not len(self.t_s):
            return None
        beyond = t_s - float(np.clip(t_s, self.t_s[0], self.t_s[-1]))
        return float(np.interp(t_s, self.t_s, self.utc_s)) + beyond

    def text(self, t_s: float) -> str:
        """The time of the day, UTC, to a tenth of a second; of the vehicle's clock where that is not known."""
        utc_s = self.utc(t_s)
        if utc_s is None:
            return f"{t_s:.1f} s"
        tenths = round(utc_s * 10.0) % 864_000
        seconds, tenth = divmod(tenths, 10)
        return f"{seconds // 3600:02d}:{seconds // 60 % 60:02d}:{seconds % 60:02d}.{tenth}"


def _changed(changes: list[tuple[float, bool]], t_s: float, now: bool) -> None:  # noqa: FBT001 - a value
    if not changes or changes[-1][1] is not now:
        changes.append((t_s, now))


def _ordered(flat: "array[float]") -> FloatArray:
    """Rows by time; of those of one time, the first."""
    rows = np.frombuffer(flat, dtype=np.float64).reshape(-1, _WIDTH) if len(flat) else np.zeros((0, _WIDTH))
    rows = rows[np.isfinite(rows[:, :3]).all(axis=1)]
    _, first = np.unique(rows[:, 0], return_index=True)
    ordered: FloatArray = rows[first]
    return ordered
