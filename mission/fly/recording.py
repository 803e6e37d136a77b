"""The record of a flight that goes on where its record cannot."""

from collections.abc import Callable
from typing import Protocol

from mission.errors import reason


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
