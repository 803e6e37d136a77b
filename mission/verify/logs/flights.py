"""Which part of a log is a flight: from take-off to touch-down, while the motors are armed."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.verify.logs.telemetry import Log, LogError, Telemetry

_HIGH_M: Final = 2.0
"""Where nothing is told of take-offs, what is so high above where the flight begins is in the air."""

Span = tuple[float, float]


@dataclass(frozen=True, eq=False)
class Airborne:
    """One flight of a log.

    Attributes:
        told: What the vehicle told since its autopilot started.
        begin_s: When it took off, or the log begins.
        end_s: When it touched down, or the log ends.
        begins_whole: Whether it took off then.
        ends_whole: Whether it touched down then.
        armed_s: When its motors were armed; None where the log does not tell.
    """

    told: Telemetry
    begin_s: float
    end_s: float
    begins_whole: bool
    ends_whole: bool
    armed_s: float | None = None

    @property
    def duration_s(self) -> float:
        """How long it is, as far as the log has it."""
        return self.end_s - self.begin_s


def flights_of(log: Log) -> tuple[Airborne, ...]:
    """All flights of a log, in order.

    Raises:
        LogError: There are none.
    """
    positions = [boot for boot in log.boots if boot.local or boot.world]
    if not positions:
        raise LogError("the log has no positions")
    found = [flight for boot in positions for flight in _flights(boot)]
    if not found:
        armed = any(now for boot in positions for _, now in boot.armed)
        raise LogError(
            "the log has no flight: "
            + ("the vehicle was armed and stayed on the ground" if armed else "the vehicle was never armed")
        )
    return tuple(found)


def chosen_flight(flights: Sequence[Airborne], number: int | None) -> tuple[int, Airborne]:
    """A flight by its number from 1, or else the longest; and its number.

    Raises:
        LogError: There is none of this number.
    """
    if number is None:
        number = 1 + int(np.argmax([flight.duration_s for flight in flights]))
    if number > len(flights):
        listed = "one flight" if len(flights) == 1 else f"{len(flights)} flights"
        raise LogError(f"there is no flight {number}: the log has {listed}")
    return number, flights[number - 1]


def _flights(boot: Telemetry) -> list[Airborne]:
    first_s, last_s = _told_from_to(boot)
    airborne = boot.airborne or boot.active
    found = []
    for begin_s, end_s in _spans(boot.armed) if boot.armed else [(-np.inf, np.inf)]:
        begin, end = begin_s, end_s
        if airborne:
            within = [span for span in _spans(airborne) if span[1] > begin_s and span[0] < end_s]
            if not within:
                continue
            # A touch on the way is no landing: what counts is that the motors went on.
            begin, end = max(within[0][0], begin_s), min(within[-1][1], end_s)
        if begin < last_s and end > first_s:
            begins, ends = begin > first_s, end <= last_s
            if not airborne:
                low_begin, low_end = _low_ends(boot)
                begins, ends = begins or low_begin, ends or low_end
            # Where it was armed as the log begins, nothing tells since when.
            armed_s = begin_s if boot.armed and begin_s > boot.armed[0][0] else None
            found.append(Airborne(boot, max(begin, first_s), min(end, last_s), begins, ends, armed_s))
    return found


def _spans(changes: Sequence[tuple[float, bool]]) -> list[Span]:
    """From when to when something was so."""
    ends = [t_s for t_s, _ in changes[1:]] + [np.inf]
    return [(t_s, end_s) for (t_s, now), end_s in zip(changes, ends, strict=True) if now]


def _low_ends(boot: Telemetry) -> tuple[bool, bool]:
    """Whether the vehicle was on the ground at the first and at the last report, by the heights of all of them."""
    heights = _heights(boot)[:, 1]
    low = heights - min(0.0, heights.min()) < _HIGH_M
    return bool(low[0]), bool(low[-1])


def _heights(boot: Telemetry) -> FloatArray:
    """Times and heights, shape (N, 2), of whichever rows tell them."""
    world = boot.world_rows
    if len(world) and np.isfinite(world[:, 3]).any():
        return world[np.isfinite(world[:, 3])][:, [0, 3]]
    local = boot.local_rows
    heights: FloatArray = local[:, [0, 3]] * (1.0, -1.0)
    return heights


def _told_from_to(boot: Telemetry) -> Span:
    times = np.concatenate((boot.local_rows[:, 0], boot.world_rows[:, 0]))
    return float(times.min()), float(times.max())
