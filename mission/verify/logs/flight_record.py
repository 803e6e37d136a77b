"""Flights that this program has recorded itself (record.jsonl)."""

import math
from pathlib import Path
from typing import Final

import numpy as np

from mission.monitor.stage import ALOFT, GUARDED, LANDED, WATCHED, Stage
from mission.report.reading import LEG, Record, read_record
from mission.verify.logs.telemetry import Clock, LogError
from mission.verify.logs.track import Track

KIND: Final = "flight record"
HEAD: Final = b'{"kind":"header"'


def recorded_track(file: Path) -> Track:
    """The flight of a record, which is in the mission's domain already.

    Raises:
        OSError: It cannot be read.
        RecordError: It is none.
        LogError: It has no flight.
    """
    return track_of_record(read_record(file))


def track_of_record(record: Record) -> Track:
    """The same of a record that was read.

    Raises:
        LogError: It has no flight.
    """
    track = record.track
    flying = np.array([stage in (*GUARDED, *WATCHED) for stage in track.stages], dtype=np.bool_)
    known = flying & np.isfinite(track.t_s) & np.isfinite(track.position_m[:, :2]).all(axis=1)
    times, first = np.unique(track.t_s[known], return_index=True)
    if not len(times):
        raise LogError("the record has no positions of a flight: the vehicle never took off")
    begun = [t_s for t_s, stage in zip(track.t_s.tolist(), track.stages, strict=True) if stage is Stage.FLY]
    starts = [event.values["start_m"] for event in record.events if event.text == "planned"]
    stages = [event.values.get("stage") for event in record.events if event.text == "stage"]
    taken_up_s = [event.t_s for event in record.events if event.text == LEG and event.values.get("taken_up") is True]
    velocity, left = np.nan_to_num(track.velocity_m_s[known][first]), np.searchsorted(times, taken_up_s) - 1
    left = left[left >= 0]
    return Track(
        t_s=times,
        position_m=track.position_m[known, :2][first],
        word_from_s=min(begun, default=float(times[-1])),
        begins_whole=bool(begun),
        ends_whole=bool(stages) and stages[-1] in LANDED,
        pictures=tuple((each.t_s, each.number) for each in record.pictures),
        clock=Clock.of(()),
        frame="positions in the mission's domain, as they were recorded",
        left=tuple((float(times[k]), (float(velocity[k, 0]), float(velocity[k, 1]))) for k in left.tolist()),
        aloft_s=_aloft(record),
        planned_from_m=(float(starts[-1][0]), float(starts[-1][1])) if starts else None,
    )


def _aloft(record: Record) -> tuple[float, float] | None:
    """How long a flight was from arming to landing, by the stages that it entered; None where it has not both."""
    entered = [
        (event.t_s, event.values.get("stage"))
        for event in record.events
        if event.text == "stage" and math.isfinite(event.t_s)
    ]
    armed = [t_s for t_s, stage in entered if stage in ALOFT]
    landed = [t_s for t_s, stage in entered if stage in LANDED]
    return (landed[0] - armed[0],) * 2 if armed and landed else None
