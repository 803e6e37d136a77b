"""Reads a flight's record back, as arrays; also of a flight whose process was killed."""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from mission.errors import RecordError
from mission.geometry.arrays import FloatArray, frozen_floats
from mission.monitor.stage import Stage
from mission.plan import FlightPlan
from mission.report.record import PLACE, READ_SCHEMAS, RECORD_FILE

Line = Mapping[str, Any]
LEG = "leg"
"""The event of a plan that is taken over in flight."""
GAP = "gap"
"""The event of a while without positions or setpoints."""

LARGEST_RECORD_BYTES = 2**30
_LARGEST = 3.5e38
"""Of a float on the link: what exceeds it was told by nobody, and its square would be infinite."""
_REPORTS = {PLACE: "telemetry"}


@dataclass(frozen=True, eq=False)
class Track:
    """What the vehicle reported: times shape (N,), the rest (N, 3); domain ENU; NaN where it said nothing.

    ``stages`` has the stage of the flight in which each report came, N of them; None before the first.
    """

    t_s: FloatArray
    position_m: FloatArray
    velocity_m_s: FloatArray
    attitude_rad: FloatArray
    stages: tuple[Stage | None, ...]


@dataclass(frozen=True, eq=False)
class Setpoints:
    """What the vehicle was asked for: shapes (K,) and (K, 3); ``trajectory_s`` is NaN off the planned trajectory."""

    t_s: FloatArray
    position_m: FloatArray
    velocity_m_s: FloatArray
    acceleration_m_s2: FloatArray
    trajectory_s: FloatArray


@dataclass(frozen=True)
class Visit:
    """The vehicle came into a triangle (-1: outside the domain) with these labels."""

    t_s: float
    triangle: int
    labels: frozenset[str]


@dataclass(frozen=True)
class Picture:
    """A picture that the vehicle told of; what it did not say is NaN. Degrees, metres, domain ENU, radians.

    ``place`` is latitude, longitude and height above mean sea level, ``attitude_rad`` roll, pitch and yaw against NED,
    ``accuracy_m`` how far off the place may be, level and in height.
    """

    t_s: float
    number: int
    place: tuple[float, float, float]
    position_m: tuple[float, float, float]
    attitude_rad: tuple[float, float, float]
    accuracy_m: tuple[float, float]


@dataclass(frozen=True)
class Charge:
    """What was left of the battery, per cent, and what was drawn of it, mAh; NaN where it was not told."""

    t_s: float
    percent: float
    drawn_mah: float


@dataclass(frozen=True, eq=False)
class Conditions:
    """The link and the wind, once a second: all of shape (N,), NaN where it was not known.

    ``delay_s`` is both ways, ``lost`` a share from 0 to 1, ``wind_from_deg`` clockwise from north.
    """

    t_s: FloatArray
    delay_s: FloatArray
    lost: FloatArray
    wind_m_s: FloatArray
    wind_from_deg: FloatArray


@dataclass(frozen=True, eq=False)
class Truth:
    """Where a simulated vehicle really was: shapes (N,) and (N, 2), domain ENU."""

    t_s: FloatArray
    position_m: FloatArray


NO_TRUTH = Truth(frozen_floats([]), frozen_floats(np.empty((0, 2))))
NO_CONDITIONS = Conditions(*(frozen_floats([]) for _ in range(5)))
"""Of records of an earlier version."""


@dataclass(frozen=True)
class Entry:
    """A line with a time and a text: an event's name or the vehicle's own words, with the other values."""

    t_s: float
    text: str
    values: Line


@dataclass(frozen=True, eq=False)
class LaterPlan:
    """A plan that was made in flight: flown from a vehicle time on, after so many laps, the last perhaps begun only."""

    from_s: float
    plan: FlightPlan
    laps_before: int
    begun: bool = False


@dataclass(frozen=True, eq=False)
class Record:
    """A flight as it was recorded.

    Attributes:
        mission: Name of the mission; empty where not even the header is whole.
        vehicle: Identity of the vehicle, the first one recorded; empty where none was. Others may have answered since.
        verdict: The last verdict recorded; None for a flight that did not come to its end.
        cut: Whether the last line was cut, as by a kill in mid-write.
        later: The plans that were flown after the first, which lie beside the record (``takeovers``).
        size: Bytes of its whole lines.
        charges: What was left of the battery, as it changed.
        conditions: The link and the wind.
        truth: Where it really was; empty where nobody told.
    """

    mission: str
    vehicle: Line
    track: Track
    setpoints: Setpoints
    visits: tuple[Visit, ...]
    events: tuple[Entry, ...]
    pictures: tuple[Picture, ...]
    texts: tuple[Entry, ...]
    verdict: Line | None
    cut: bool
    later: tuple[LaterPlan, ...] = ()
    size: int = 0
    charges: tuple[Charge, ...] = ()
    conditions: Conditions = NO_CONDITIONS
    truth: Truth = NO_TRUTH

    @property
    def takeovers(self) -> tuple[tuple[float, int, int, bool], ...]:
        """Of each plan that was taken over: when, its number, from 2, laps before it, whether the last is under way."""
        return tuple(
            (
                event.t_s,
                int(event.values["number"]),
                int(event.values.get("laps_before") or 0),
                bool(event.values.get("begun")),
            )
            for event in self.events
            if event.text == LEG
        )


def read_record(path: Path) -> Record:
    """Read ``record.jsonl``, or the one in the folder ``path``.

    Raises:
        OSError: There is no such file.
        RecordError: The file is no record, or of a schema that this version does not know, or damaged before its end.
    """
    file = path / RECORD_FILE if path.is_dir() else path
    if file.stat().st_size > LARGEST_RECORD_BYTES:
        raise RecordError(f"{file.name} is larger than {LARGEST_RECORD_BYTES} bytes", line=0)
    return parse_record(file.read_bytes())


def parse_record(data: bytes) -> Record:
    """Read a record from its bytes.

    Raises:
        RecordError: As in ``read_record``.
    """
    *whole, rest = data.split(b"\n")
    lines = [_parse_line(number, raw) for number, raw in enumerate(whole, start=1)]
    if lines and (lines[0]["kind"] != "header" or lines[0].get("schema") not in READ_SCHEMAS):
        raise RecordError(f"this is not a flight record of a schema up to {max(READ_SCHEMAS)}", line=1)
    kinds: dict[str, list[Line]] = {}
    for line in lines:
        kind = str(line["kind"])
        kinds.setdefault(_REPORTS.get(kind, kind), []).append(line)
    try:
        record = replace(_record(kinds, _stages(lines), cut=bool(rest)), size=len(data) - len(rest))
        if all(number > 1 for _, number, *_ in record.takeovers):
            return record
    except (TypeError, ValueError, KeyError, OverflowError) as error:
        raise RecordError(f"a value of the record has the wrong type: {error}", line=0) from error
    raise RecordError("a later plan of the record has no number from 2 on", line=0)


def _parse_line(number: int, raw: bytes) -> Line:
    try:
        line = json.loads(raw, parse_constant=_refused)
    except (ValueError, RecursionError) as error:
        raise RecordError(f"line {number} of the record is not JSON", line=number) from error
    if not isinstance(line, dict) or not isinstance(line.get("kind"), str):
        raise RecordError(f"line {number} of the record has no kind", line=number)
    return line


def _refused(name: str) -> None:
    raise ValueError(f"{name} is no number of JSON")


def _record(kinds: Mapping[str, Sequence[Line]], stages: tuple[Stage | None, ...], *, cut: bool) -> Record:
    def of(kind: str) -> Sequence[Line]:
        return kinds.get(kind, ())

    telemetry, setpoints = of("telemetry"), of("setpoint")
    return Record(
        mission=str(of("header")[0].get("mission", "")) if of("header") else "",
        vehicle=_values(of("vehicle")[0]) if of("vehicle") else {},
        track=_track(telemetry, stages),
        setpoints=Setpoints(
            t_s=_numbers(setpoints, "t_s"),
            position_m=_vectors(setpoints, "position_m"),
            velocity_m_s=_vectors(setpoints, "velocity_m_s"),
            acceleration_m_s2=_vectors(setpoints, "acceleration_m_s2"),
            trajectory_s=_numbers(setpoints, "trajectory_s"),
        ),
        visits=tuple(
            Visit(_number(line["t_s"]), int(line["triangle"]), frozenset(map(str, line["labels"])))
            for line in of("visit")
        ),
        events=_events(of("event")),
        pictures=tuple(_picture(line) for line in of("image")),
        texts=_entries(of("text"), "text"),
        verdict=_verdict(of("verdict")[-1]) if of("verdict") else None,
        cut=cut,
        charges=tuple(
            Charge(_number(line["t_s"]), _number(line["percent"]), _number(line["drawn_mah"])) for line in of("charge")
        ),
        conditions=Conditions(
            *(_numbers(of("conditions"), name) for name in ("t_s", "delay_s", "lost", "wind_m_s", "wind_from_deg"))
        ),
        truth=Truth(
            _numbers(of("truth"), "t_s"),
            frozen_floats(np.array([_numbers_of(line["m"]) for line in of("truth")]).reshape(-1, 2)),
        ),
    )


def _track(lines: Sequence[Line], stages: tuple[Stage | None, ...]) -> Track:
    """Reports; what those of a place alone leave out is what a straight line between the ones around them has."""
    times_s, position_m = _numbers(lines, "t_s"), _vectors(lines, "position_m").copy()
    velocity_m_s, attitude_rad = _vectors(lines, "velocity_m_s"), _vectors(lines, "attitude_rad")
    brief = np.array([line["kind"] == PLACE for line in lines], dtype=np.bool_)
    if brief.any():
        position_m[brief, :2] = [_vector(line["m"]) for line in lines if line["kind"] == PLACE]

        def filled(values: FloatArray) -> FloatArray:
            between = [np.interp(times_s, times_s[~brief], axis) for axis in values[~brief].T]
            return np.where(brief[:, None], np.stack(between, axis=-1), values)

        if not brief.all():
            position_m[:, 2] = filled(position_m)[:, 2]
            velocity_m_s = filled(velocity_m_s)
            attitude_rad = np.arctan2(filled(np.sin(attitude_rad)), filled(np.cos(attitude_rad)))
    return Track(
        t_s=times_s,
        position_m=frozen_floats(position_m),
        velocity_m_s=frozen_floats(velocity_m_s),
        attitude_rad=frozen_floats(attitude_rad),
        stages=stages,
    )


def _picture(line: Line) -> Picture:
    latitude, longitude, altitude = (_number(line[n]) for n in ("latitude_deg", "longitude_deg", "altitude_amsl_m"))
    x, y, z = _vector(line["position_m"])
    roll, pitch, yaw = _vector(line["attitude_rad"])
    return Picture(
        t_s=_number(line["t_s"]),
        number=int(line["number"]),
        place=(latitude, longitude, altitude),
        position_m=(x, y, z),
        attitude_rad=(roll, pitch, yaw),
        accuracy_m=(_number(line["accuracy_m"]), _number(line["height_accuracy_m"])),
    )


def _stages(lines: Iterable[Line]) -> tuple[Stage | None, ...]:
    """The stage of each telemetry line: the one that was entered last before it."""
    stages: list[Stage | None] = []
    stage: Stage | None = None
    for line in lines:
        if line["kind"] == "event" and line.get("name") == "stage":
            stage = Stage(line["stage"])
        elif line["kind"] in ("telemetry", *_REPORTS):
            stages.append(stage)
    return tuple(stages)


def _entries(lines: Iterable[Line], text: str) -> tuple[Entry, ...]:
    return tuple(
        Entry(
            _number(line["t_s"]),
            str(line[text]),
            {name: value for name, value in line.items() if name not in ("kind", "t_s", text)},
        )
        for line in lines
    )


def _events(lines: Sequence[Line]) -> tuple[Entry, ...]:
    """All events; gaps are counted, so they must tell of what they are, and how long."""
    events = _entries(lines, "name")
    if not all(
        _number(each.values["for_s"]) >= 0.0 and "missing" in each.values for each in events if each.text == GAP
    ):
        raise ValueError("a gap has no length, or is of nothing")
    return events


def _verdict(line: Line) -> Line:
    if not isinstance(line.get("achieved"), bool | None):
        raise TypeError("a verdict is true, false or null")
    return _values(line)


def _values(line: Line) -> Line:
    return {name: value for name, value in line.items() if name != "kind"}


def _number(value: Any) -> float:  # noqa: ANN401 - whatever JSON holds
    number = math.nan if value is None else float(value)
    return number if abs(number) <= _LARGEST else math.nan


def _numbers_of(values: Sequence[Any]) -> list[float]:
    return [_number(value) for value in values]


def _numbers(lines: Sequence[Line], name: str) -> FloatArray:
    return frozen_floats([_number(line.get(name)) for line in lines])


def _vector(value: Any) -> list[float]:  # noqa: ANN401 - whatever JSON holds
    return [_number(part) for part in (value or (None, None, None))]


def _vectors(lines: Sequence[Line], name: str) -> FloatArray:
    rows = [_vector(line.get(name)) for line in lines]
    return frozen_floats(np.array(rows, dtype=np.float64).reshape(len(rows), 3))
