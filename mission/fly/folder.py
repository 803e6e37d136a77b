"""The folder of a flight, written as the flight goes: a program that is killed leaves each file readable.

What is in it has one place each:

====================  ================================================================================================
flight.tlog           all that was said on the link, both ways, frame by frame
record.jsonl          where the vehicle was and what was asked of it, as this program judged it, and what came of that:
                      all that is needed to judge the flight again, and to go on with it
events.jsonl          what happened, for whoever looks at it: what the record has but positions and setpoints, each line
                      with the time of the day (``utc``) beside the vehicle's (``t_s``)
verdict.json          the verdict, once there is one
plan.json, ...        what was planned (``mission.cli.fly``, ``mission.library``)
====================  ================================================================================================
"""

import json
from collections.abc import Callable, Mapping
from contextlib import ExitStack, suppress
from datetime import UTC, datetime, timedelta
from pathlib import Path
from types import TracebackType
from typing import Final, Self

from mission.errors import reason
from mission.growing_file import GrowingFile, whole_lines
from mission.link.transport import Transport
from mission.link.wire_log import LoggedLink, whole_frames
from mission.report.record import PLACE, FlightRecord, json_line
from mission.whole_file import write_whole

LINK_FILE: Final = "flight.tlog"
EVENTS_FILE: Final = "events.jsonl"
VERDICT_FILE: Final = "verdict.json"

_SERIES: Final = ("telemetry", PLACE, "setpoint", "conditions", "truth")
_EPOCH: Final = datetime(1970, 1, 1, tzinfo=UTC)


class FlightFolder:
    """Writes what a flight leaves, line by line and frame by frame.

    Attributes:
        path: Where.
    """

    def __init__(self, record: FlightRecord, path: Path, utc_us: Callable[[], int]) -> None:
        """Write beside a record, or go on with what there is; a verdict that was there counts no more.

        Args:
            record: The flight's, which is in the folder and closed with it.
            path: The folder.
            utc_us: Says the time of the day, microseconds since 1970.

        Raises:
            OSError: The folder cannot be written to.
        """
        self.path = path
        self._record, self._utc_us = record, utc_us
        with ExitStack() as stack:
            stack.callback(record.close)
            (path / VERDICT_FILE).unlink(missing_ok=True)
            self._events = GrowingFile.at(path / EVENTS_FILE, whole_lines)
            stack.callback(self._events.close)
            self._frames = GrowingFile.at(path / LINK_FILE, whole_frames)
            stack.callback(self._frames.close)
            self._open = stack.pop_all()

    @classmethod
    def begun(cls, root: Path, mission: str, utc_us: Callable[[], int], stamp: str | None = None) -> Self:
        """Begin a new one, named as ``FlightRecord.in_folder`` does.

        Raises:
            OSError: It cannot be made.
        """
        record = FlightRecord.in_folder(root, mission, stamp)
        return cls(record, record.folder or root, utc_us)

    @classmethod
    def reopened(cls, path: Path, mission: str, utc_us: Callable[[], int], size: int) -> Self:
        """Go on with one whose record is of a mission and had so many bytes of whole lines when it was read.

        Raises:
            BlockingIOError: Another program still writes it.
            RecordError: Another program has written it since it was read.
            OSError: It cannot be written to.
        """
        return cls(FlightRecord.reopened(path, mission, size), path, utc_us)

    def logged(self, transport: Transport) -> LoggedLink:
        """A link whose frames are logged here."""
        return LoggedLink(transport, self._frames, self._utc_us)

    def write(self, kind: str, t_s: float | None, **values: object) -> None:
        """Write one line, as ``FlightRecord.write`` does; what cannot be written beside it is left out.

        Raises:
            TypeError: A value that JSON cannot hold.
            OSError: The record cannot be written.
        """
        try:
            self._record.write(kind, t_s, **values)
        finally:  # each is written whatever became of the others
            if kind not in _SERIES:
                self._repeat(kind, t_s, values)

    def _repeat(self, kind: str, t_s: float | None, values: Mapping[str, object]) -> None:
        utc = (_EPOCH + timedelta(microseconds=self._utc_us())).isoformat(timespec="milliseconds")
        line = json_line({"kind": kind, "utc": utc, "t_s": t_s, **values})
        with suppress(OSError):
            self._events.add(line)
        if kind == "verdict":
            with suppress(OSError):
                told = {name: value for name, value in json.loads(line).items() if name != "kind"}
                write_whole(self.path / VERDICT_FILE, json.dumps(told, indent=2) + "\n")

    @property
    def incomplete(self) -> dict[str, str]:
        """The files beside the record in which something is missing, each with why, in plain words."""
        files = {EVENTS_FILE: self._events, LINK_FILE: self._frames}
        return {name: reason(file.failure) for name, file in files.items() if file.failure}

    def close(self) -> None:
        """Write no more."""
        self._open.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()
