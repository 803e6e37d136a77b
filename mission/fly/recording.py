"""The record of a flight that goes on where its record cannot, and how much of what is routine is written."""

import math
from collections.abc import Callable
from typing import Final, Protocol

from mission.errors import reason
from mission.link.events import Moved, SetpointSent
from mission.link.frames import Vector
from mission.report.record import PLACE

_DIGITS: Final = 4
"""Of metres, radians and seconds in what is routine: a tenth of a millimetre."""

_WHOLE_S: Final = 0.25
_WHOLE_M_S: Final = 0.2
"""A report is written whole where the last one that was is so old, or the velocity has changed by so much since."""

_SETPOINT_S: Final = 0.5
_PACE_S: Final = 1e-3
"""A setpoint is written where the last one that was is so old, or the trajectory is so far from its pace since then."""


class RecordWriter(Protocol):
    """Where the flight is written down, a line at a time."""

    def write(self, kind: str, t_s: float | None, **values: object) -> None:
        """Write one line, at a vehicle time."""
        ...


class Recording:
    """Writes what can be written: a line that cannot, as on a full disk, costs a warning and not the flight.

    Attributes:
        lost: How many lines could not be written.
        warn: Takes what is to be said at once.
    """

    def __init__(self, record: RecordWriter, warn: Callable[[str], None]) -> None:
        """Write to ``record``; ``warn`` is told, once when the first line is lost."""
        self.lost = 0
        self.warn = warn
        self._record = record
        self._told = 0

    @property
    def lost_text(self) -> str:
        """How much could not be written, in plain words; empty where all was."""
        return (
            f"{self.lost:,} line{'s' if self.lost != 1 else ''} of the record could not be written" if self.lost else ""
        )

    def write(self, kind: str, t_s: float | None, **values: object) -> None:
        """Write one line, after one that says how many were lost before it, if any were."""
        try:
            if self.lost > self._told:
                self._record.write("event", t_s, name="lines lost", lines=self.lost - self._told)
                self._told = self.lost
            self._record.write(kind, t_s, **values)
        except (OSError, ValueError) as error:  # the second: the file was closed
            self.lost += 1
            if self.lost == 1:
                self.warn(f"the record cannot be written: {reason(error)}; the flight goes on without it")


class Routine:
    """Writes where the vehicle is and what is asked of it, some ten times a second each, in few words.

    Every place that is reported is written, for it is judged, yet velocity, height and attitude only as often as they
    are needed to draw a curve through; of the setpoints those are left out that follow from the ones around them.
    """

    def __init__(self, record: RecordWriter, *, everything: bool = False) -> None:
        """Write to ``record``; ``everything``: each report and setpoint whole, to measure by."""
        self._record = record
        self._whole_s, self._setpoint_s = (0.0, 0.0) if everything else (_WHOLE_S, _SETPOINT_S)
        self._whole: Moved | None = None
        self._largest_m_s = 0.0
        self._written: SetpointSent | None = None
        self._rate = 1.0
        self._left_out: SetpointSent | None = None

    def moved(self, event: Moved) -> Moved:
        """Write a report; returns it as it was written, which is what is to be judged."""
        event = event._replace(t_s=round(event.t_s, _DIGITS), position_m=_rounded(event.position_m))
        if self._is_whole(event):
            self._whole = event
            self._record.write(
                "telemetry",
                event.t_s,
                position_m=event.position_m,
                velocity_m_s=_rounded(event.velocity_m_s),
                attitude_rad=None if event.attitude_rad is None else _rounded(event.attitude_rad),
            )
        else:
            self._record.write(PLACE, event.t_s, m=event.position_m[:2])
        return event

    def sent(self, event: SetpointSent) -> None:
        """Write a setpoint, or leave it out; where the trajectory leaps or changes its pace, the one before, too."""
        last, before = self._written, self._left_out
        if last is None or self._is_off(last, event):
            if before is not None:
                self._write(before)
            self._write(event)
        elif event.t_s - last.t_s >= self._setpoint_s:
            self._write(event)
        else:
            self._left_out = event

    def settle(self) -> None:
        """Write the setpoint that was left out last, as something else begins."""
        if self._left_out is not None:
            self._write(self._left_out)

    def _is_whole(self, event: Moved) -> bool:
        off_m_s = [abs(is_m_s - planned) for is_m_s, planned in zip(event.velocity_m_s, event.planned_m_s, strict=True)]
        farther = event.trajectory_s is not None and max(off_m_s[:2]) > self._largest_m_s
        if farther:
            self._largest_m_s = max(off_m_s[:2])
        last = self._whole
        return (
            farther
            or last is None
            or not 0.0 <= event.t_s - last.t_s < self._whole_s
            or not math.dist(event.velocity_m_s, last.velocity_m_s) < _WHOLE_M_S
            or (last.attitude_rad is None) is not (event.attitude_rad is None)
            or not all(map(math.isfinite, (*event.position_m, *event.velocity_m_s)))
        )

    def _is_off(self, last: SetpointSent, event: SetpointSent) -> bool:
        """Whether the time on the trajectory is not what it would be by the pace between the last two."""
        if last.trajectory_s is None or event.trajectory_s is None:
            return last.trajectory_s is not event.trajectory_s
        return abs(last.trajectory_s + self._rate * (event.t_s - last.t_s) - event.trajectory_s) > _PACE_S

    def _write(self, event: SetpointSent) -> None:
        last, self._written, self._left_out = self._written, event, None
        self._rate = 1.0
        if last is not None and last.trajectory_s is not None and event.trajectory_s is not None:
            self._rate = (event.trajectory_s - last.trajectory_s) / max(event.t_s - last.t_s, _PACE_S)
        reference = event.reference
        self._record.write(
            "setpoint",
            round(event.t_s, _DIGITS),
            position_m=_rounded(reference.position_m),
            velocity_m_s=_rounded(reference.velocity_m_s),
            acceleration_m_s2=_rounded(reference.acceleration_m_s2),
            yaw_rad=round(event.yaw_rad, _DIGITS),
            trajectory_s=None if event.trajectory_s is None else round(event.trajectory_s, _DIGITS),
        )


def _rounded(vector: Vector) -> Vector:
    x, y, z = vector
    return round(x, _DIGITS) + 0.0, round(y, _DIGITS) + 0.0, round(z, _DIGITS) + 0.0  # no minus before a 0
