"""What was flown, as JSON lines: one object a line, each written in one piece the moment it is known.

A process that is killed leaves every whole line readable, and the reader skips a last line that was cut. The first
line is the header. Every line has ``kind`` and ``t_s`` (vehicle time, seconds; null where there is none); vectors are
in the domain's frame (ENU, origin of the domain, z above the take-off point), metres, seconds, radians:

======================  ==============================================================================================
kind                    values
======================  ==============================================================================================
header                  schema, mission
vehicle                 identity as the vehicle gave it, any names
telemetry               position_m, velocity_m_s, attitude_rad (roll, pitch, yaw: NED body angles, as MAVLink has them)
at                      m (east, north): a report of which only the place is written; height, velocity and attitude are
                        to be had from those around it, at most a quarter of a second away (``mission.fly.recording``)
setpoint                position_m, velocity_m_s, acceleration_m_s2, yaw_rad, trajectory_s (time on the planned
                        trajectory; null for a setpoint that is not of the trajectory, as before and after it); those
                        that are left out follow from those around them, at most half a second away
visit                   triangle (-1 outside), labels: a new letter or triangle of the word that the vehicle spells
event                   name, and any values; of a gap (no position was told, or no setpoint sent and the trajectory
                        paused): missing, from_s, for_s; of a leg (another plan is flown from t_s on): number (from 2),
                        reason, amended (whether it is of a changed mission), returns (whether what was left is given up
                        for a return), fresh (whether other things are asked for), taken_up (whether nobody led the
                        vehicle from the report before it on), start_m, laps_before, begun (whether the last of these is
                        only under way), duration_s; the plan is beside the record in plan-NUMBER.json, and trajectory_s
                        is about it; of a request (of somebody who watches the flight): request, which is hold, resume,
                        return or land; of a request answered: request, granted, reason
image                   of a picture that the vehicle told of: number (as the autopilot counts), utc_us (microseconds
                        since 1970), latitude_deg, longitude_deg, altitude_amsl_m, position_m, attitude_rad,
                        accuracy_m and height_accuracy_m (of the place, as the receiver told it), trajectory_s; what is
                        not known is null
charge                  percent, drawn_mah: of the battery, each per cent once; what is not known is null
conditions              once a second: delay_s (of the link, both ways), lost (share of the requests for the time that
                        stayed without an answer in the last ten seconds), wind_m_s and wind_from_deg as the vehicle
                        tells them; what is not known is null
truth                   m (east, north): where a simulated vehicle really was, as far as it tells that
text                    severity (MAVLink), text: a STATUSTEXT
verdict                 achieved, reason, and any values; of a flight that came to its end also what was known of the
                        word: so_far (true, false, open), done and total (progress of the automaton), awaited (regions)
======================  ==============================================================================================

Numbers that are not finite are written as null and read as NaN. The bytes follow from the values alone.
"""

import json
import math
import os
import re
from collections.abc import Mapping
from enum import Enum
from io import FileIO
from pathlib import Path
from types import TracebackType
from typing import Self

from mission.errors import RecordError
from mission.growing_file import GrowingFile, Sink, whole_lines

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

SCHEMA = 2
READ_SCHEMAS = (1, 2)
"""Of the first, ``at`` is not known, and every setpoint is there."""

PLACE = "at"
RECORD_FILE = "record.jsonl"
LONGEST_FOLDER_NAME = 80


class FlightRecord:
    """Writes one flight's record.

    Attributes:
        folder: Where the flight's files go; None for a record that is kept in memory.
    """

    def __init__(self, sink: Sink, *, mission: str, folder: Path | None = None, begins: bool = True) -> None:
        """Write a record on ``sink`` (an ``io.BytesIO`` will do), which begins with its header line."""
        self.folder = folder
        self._file = GrowingFile(sink)
        if begins:
            self.write("header", None, schema=SCHEMA, mission=mission)

    @classmethod
    def in_folder(cls, root: Path, mission: str, stamp: str | None = None) -> Self:
        """Begin a record in a new folder ``root/<mission>-<stamp>``, numbered where there is no stamp or it is taken.

        Raises:
            OSError: The folder cannot be made.
        """
        folder = new_flight_folder(root, mission, stamp)
        # Unbuffered: what write() returned from is out of this process, so killing it loses nothing.
        return cls(_claimed((folder / RECORD_FILE).open("xb", buffering=0)), mission=mission, folder=folder)

    @classmethod
    def reopened(cls, folder: Path, mission: str, size: int) -> Self:
        """Go on with the record in a folder; a last line that was cut goes, for what is not written did not happen.

        Args:
            folder: Where it is.
            mission: Its name, for a record without a header.
            size: Bytes of its whole lines when it was read.

        Raises:
            BlockingIOError: Another program still writes it.
            RecordError: Another program has written it since it was read.
            OSError: It cannot be written to.
        """
        file = folder / RECORD_FILE
        stream = _claimed(file.open("ab", buffering=0))
        whole = whole_lines(file.read_bytes())
        if whole != size:
            stream.close()
            raise RecordError("another program has flown this flight on since it was read; try again", line=0)
        stream.truncate(whole)
        return cls(stream, mission=mission, folder=folder, begins=not whole)

    def write(self, kind: str, t_s: float | None, **values: object) -> None:
        """Write one line; ``values`` may hold numpy arrays and scalars, enums, sets, and numbers that are not finite.

        A line that was cut by a failure is completed before the next one is written, so that the file stays readable.

        Raises:
            TypeError: A value that JSON cannot hold.
            OSError: The disk is full, say; this line is lost.
        """
        self._file.add(json_line({"kind": kind, "t_s": t_s, **{name: values[name] for name in sorted(values)}}))

    def close(self) -> None:
        """End the record; a record in memory is left open for whoever owns its stream."""
        if self.folder is not None:
            self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()


def is_written(folder: Path) -> bool:
    """Whether a program writes the record in a folder, or may: where locks are unknown that cannot be told.

    Raises:
        OSError: There is none that can be read.
    """
    with (folder / RECORD_FILE).open("rb") as stream:
        try:
            if fcntl is not None:
                fcntl.flock(stream, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except OSError:  # it is another program's, or a file system without locks
            return True
    return fcntl is None


def _claimed(stream: FileIO) -> FileIO:
    """A record that is ours until this process ends, however it ends, where the system can tell that to others.

    Raises:
        BlockingIOError: It is another program's.
    """
    if fcntl is not None:
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            stream.close()
            raise
        except OSError:  # a file system without locks
            return stream
    return stream


def new_flight_folder(root: Path, mission: str, stamp: str | None = None) -> Path:
    """Make and return a folder that did not exist: ``<mission>-<stamp>``, or the lowest free ``<mission>-<n>``.

    The mission's name comes from a file, so whatever is no letter, digit, dot, dash or underscore is replaced.

    Raises:
        OSError: ``root`` cannot be written to.
    """
    stem = _file_name(mission)
    root.mkdir(parents=True, exist_ok=True)
    number = 1
    while True:
        suffix = str(number) if stamp is None else _file_name(stamp) + (f"-{number}" if number > 1 else "")
        folder = root / f"{stem}-{suffix}"
        try:
            folder.mkdir()  # atomic, so of two flights that begin at once each gets a folder of its own
        except FileExistsError:
            number += 1
        else:
            return folder


def _file_name(text: str) -> str:
    """A name for a folder that is safe in every file system."""
    return re.sub(r"[^A-Za-z0-9._-]+", "-", text)[:LONGEST_FOLDER_NAME].strip(".-") or "mission"


def json_line(values: Mapping[str, object]) -> bytes:
    """Values as one line of JSON; those of numpy and numbers that are not finite, too.

    Raises:
        TypeError: A value that JSON cannot hold.
    """
    try:
        text = _ENCODER.encode(values)
    except ValueError:  # something in it is not finite: rare, so only then is every value looked at
        text = json.dumps(_finite(values), allow_nan=False, separators=(",", ":"))
    return text.encode("ascii") + b"\n"


def _plain(value: object) -> object:
    """A value of this project as one that JSON knows."""
    if isinstance(value, (frozenset, set)):
        return sorted(value)
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    to_list = getattr(value, "tolist", None)  # numpy arrays and scalars
    if to_list is None:
        raise TypeError(f"a record cannot hold {type(value).__name__}")
    return to_list()


_ENCODER = json.JSONEncoder(allow_nan=False, default=_plain, separators=(",", ":"))


def _finite(value: object) -> object:
    """The same with null for every number that is not finite."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if value is None or isinstance(value, (bool, int, str)):
        return value
    if isinstance(value, Mapping):
        return {str(name): _finite(part) for name, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(part) for part in value]
    return _finite(_plain(value))
