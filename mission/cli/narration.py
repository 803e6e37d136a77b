"""What happens in a flight, line by line, for whoever wants to read along (``mission fly --verbose``)."""

from contextlib import suppress

from mission.cli.screen import err
from mission.fly.recording import RecordWriter

_NAMES = {"text": "vehicle", "vehicle": "found", "verdict": "verdict"}
_KEPT = frozenset({"event", *_NAMES})
"""What comes now and then; positions, setpoints and visits come many times a second."""

_PLAIN = frozenset({"command", "stage", "text"})
"""What needs no word before it."""

_LONGEST = 160


class Narrated:
    """A record whose lines are told as they are written, but for those that come all the time."""

    def __init__(self, record: RecordWriter) -> None:
        """Write to a record."""
        self._record = record

    def write(self, kind: str, t_s: float | None, **values: object) -> None:
        """Write one line, at a vehicle time, and tell it."""
        self._record.write(kind, t_s, **values)
        if kind not in _KEPT:
            return
        told = {**values}
        name = _NAMES.get(kind) or str(told.pop("name", kind))
        words = ", ".join(str(value) if key in _PLAIN else f"{key} {value}" for key, value in told.items())
        when = "" if t_s is None else f"{t_s:.1f} s"
        with suppress(OSError):  # nobody reads it: the flight goes on
            err.print(f"{when:>9}  {name}{': ' if words else ''}{words}"[:_LONGEST], markup=False)
