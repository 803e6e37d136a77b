"""Any log, by what it begins with: flight records, telemetry logs, DataFlash logs and ULogs, packed by gzip or not."""

import gzip
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Final, cast

from mission.geometry.geodesy import LatLon
from mission.report.record import RECORD_FILE
from mission.spec.model import Point
from mission.verify.logs import dataflash, flight_record, tlog, ulog
from mission.verify.logs.flights import chosen_flight, flights_of
from mission.verify.logs.telemetry import Log, LogError
from mission.verify.logs.track import Track, track_of

_HEAD: Final = 4096
_GZIP: Final = b"\x1f\x8b"
_KINDS: Final = "a flight record (record.jsonl), a telemetry log (.tlog), a DataFlash log (.bin) or a ULog (.ulg)"


@dataclass(frozen=True, eq=False)
class LoggedFlight:
    """A flight that was found in a log.

    Attributes:
        kind: What kind of log it is.
        number: Which of its flights it is, from 1.
        flights: How many there are.
        track: Where the vehicle was.
        notes: What whoever reads the verdict should know.
    """

    kind: str
    number: int
    flights: int
    track: Track
    notes: tuple[str, ...]


def read_flight(
    file: Path, *, origin: LatLon | None, start_m: Point, system: int | None = None, number: int | None = None
) -> LoggedFlight:
    """Read a flight.

    Args:
        file: The log; of a flight of this program, its folder serves too.
        origin: Where the domain's (0, 0) lies on Earth; None where the mission lies wherever it is flown.
        start_m: Where the vehicle takes off in such a mission, ENU.
        system: The system id of the vehicle, of a telemetry log.
        number: Which flight, from 1; the longest by default.

    Raises:
        OSError: It cannot be read.
        LogError: It is no log, or has no such flight.
        RecordError: It is a record that is damaged.
    """
    file = file / RECORD_FILE if file.is_dir() else file
    with file.open("rb") as plain:
        packed = plain.read(2) == _GZIP
        plain.seek(0)
        stream = cast("BinaryIO", gzip.GzipFile(fileobj=plain)) if packed else plain
        try:
            head = stream.read(_HEAD)
            stream.seek(0)
            log = None if head.startswith(flight_record.HEAD) else _read(stream, head, system)
        except (EOFError, zlib.error, gzip.BadGzipFile) as error:
            raise LogError("what was packed by gzip is damaged; unpack what can be saved, and name that") from error
    if log is None:
        track = flight_record.recorded_track(file)
        return LoggedFlight(flight_record.KIND, chosen_only(number), 1, track, _left(track))
    flights = flights_of(log)
    number, flight = chosen_flight(flights, number)
    return LoggedFlight(log.kind, number, len(flights), track_of(flight, origin, start_m), log.notes)


def _left(track: Track) -> tuple[str, ...]:
    """When nobody led the vehicle, and what is believed of it then."""
    times = [(t_s, float(track.t_s[track.t_s > t_s][0])) for t_s, _ in track.left]
    return tuple(
        f"nobody led the vehicle from {track.clock.text(from_s)} to {track.clock.text(to_s)}: by its limits it "
        "stopped, and it held until it was taken up again"
        for from_s, to_s in times
    )


def chosen_only(number: int | None) -> int:
    """The number of the only flight.

    Raises:
        LogError: Another was asked for.
    """
    if number not in (None, 1):
        raise LogError(f"there is no flight {number}: a record has one flight")
    return 1


def _read(stream: BinaryIO, head: bytes, system: int | None) -> Log:
    """Read a log; the kinds that say at their beginning what they are come first."""
    of_one = {dataflash.HEAD: dataflash.read_dataflash, ulog.HEAD: ulog.read_ulog}
    for begin, read in of_one.items():
        if head.startswith(begin):
            if system is not None:
                raise LogError("this log is of one vehicle: leave --system out")
            return read(stream)
    if tlog.is_tlog(head):
        return tlog.read_tlog(stream, system)
    raise LogError(f"this is no log that can be read: name {_KINDS}")
