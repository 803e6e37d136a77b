"""ULog files (.ulg) of PX4, read by pyulog. https://docs.px4.io/main/en/dev_log/ulog_file_format.html."""

import io
from contextlib import redirect_stdout, suppress
from typing import Any, BinaryIO, Final

import numpy as np

from mission.errors import GeometryError
from mission.geometry.arrays import BoolArray, FloatArray
from mission.geometry.geodesy import LatLon
from mission.verify.logs.telemetry import Log, LogError, Telemetry

KIND: Final = "ULog of PX4"
HEAD: Final = b"ULog\x01\x12\x35"

_US: Final = 1e-6
_ARMED: Final = 2  # vehicle_status.arming_state
_TOPICS: Final = (
    "vehicle_local_position",
    "vehicle_global_position",
    "vehicle_status",
    "vehicle_land_detected",
    "vehicle_gps_position",
    "sensor_gps",
    "camera_capture",
)
_MISSING: Final = "files of PX4 are read by pyulog, which is not there: install ltl-mission with its extra `ulog`"


def read_ulog(stream: BinaryIO) -> Log:
    """Read a ULog; only the topics that are needed are kept.

    Raises:
        LogError: It is damaged at its beginning, or has no positions; or pyulog is not installed.
    """
    try:
        import pyulog  # noqa: PLC0415 - an extra
    except ImportError as error:
        raise LogError(_MISSING) from error
    try:
        with redirect_stdout(io.StringIO()):  # it prints what it thinks of damaged files
            log = pyulog.ULog(stream, list(_TOPICS))
    except Exception as error:  # whatever a damaged file makes of a parser
        raise LogError(f"the log cannot be read: {error or type(error).__name__}") from error
    topics: dict[str, Any] = {each.name: each.data for each in reversed(log.data_list)}  # the first of several
    told = Telemetry()
    try:
        _positions(told, topics)
        _states(told, topics)
    except KeyError as error:
        raise LogError(f"a topic of the log has no field {error}: it is of another kind than is known here") from error
    if not (told.local or told.world):
        raise LogError(
            "the log has no positions: neither vehicle_local_position nor vehicle_global_position; "
            "set SDLOG_PROFILE so that they are logged"
        )
    notes = ["a part of the log is damaged and was passed over"] if log.file_corruption else []
    if log.dropouts:
        lost_s = sum(each.duration for each in log.dropouts) * 1e-3
        notes.append(f"the log has {len(log.dropouts):,} dropouts, {lost_s:.1f} s in all")
    return Log(KIND, (told,), tuple(notes))


def _positions(told: Telemetry, topics: dict[str, Any]) -> None:
    local, world = topics.get("vehicle_local_position"), topics.get("vehicle_global_position")
    if local is not None:
        told.local.extend(_rows(local, ("x", "y", "z"), _flag(local, "xy_valid")).ravel().tolist())
        _origins(told, local)
    if world is not None:
        rows = _rows(world, ("lat", "lon", "alt"), _flag(world, "lat_lon_valid"))
        rows[:, 3] = np.nan  # above the sea, not above home
        told.world.extend(rows.ravel().tolist())


def _rows(topic: Any, names: tuple[str, ...], valid: BoolArray) -> FloatArray:  # noqa: ANN401 - pyulog ships no types
    """Time and values where they are valid, shape (N, 1 + names)."""
    columns = [topic["timestamp"][valid] * _US, *(topic[name][valid] for name in names)]
    return np.column_stack([column.astype(np.float64) for column in columns])


def _origins(told: Telemetry, local: Any) -> None:  # noqa: ANN401 - pyulog ships no types
    """Each place of the origin, from when on it was told."""
    if not {"ref_lat", "ref_lon", "xy_global"} <= set(local):
        return
    known = _flag(local, "xy_global") & np.isfinite(local["ref_lat"]) & np.isfinite(local["ref_lon"])
    times, places = local["timestamp"][known] * _US, np.column_stack((local["ref_lat"], local["ref_lon"]))[known]
    if not len(times):
        return
    for at in np.flatnonzero(np.append(True, (np.diff(places, axis=0) != 0.0).any(axis=1))):
        with suppress(GeometryError):
            told.origins.append((float(times[at]), LatLon(float(places[at, 0]), float(places[at, 1]))))


def _states(now: Telemetry, topics: dict[str, Any]) -> None:
    status, landing = topics.get("vehicle_status"), topics.get("vehicle_land_detected")
    if status is not None:
        for t_us, state in zip(status["timestamp"].tolist(), status["arming_state"].tolist(), strict=True):
            now.note_armed(t_us * _US, state == _ARMED)
    if landing is not None:
        for t_us, landed in zip(landing["timestamp"].tolist(), landing["landed"].tolist(), strict=True):
            now.note_airborne(t_us * _US, not landed)
    for name in ("vehicle_gps_position", "sensor_gps"):
        told_by = topics.get(name)
        if told_by is not None and not now.clock:
            for t_us, utc_us in zip(told_by["timestamp"].tolist(), told_by["time_utc_usec"].tolist(), strict=True):
                if utc_us:
                    now.note_clock(t_us * _US, utc_us * _US)
    pictures = topics.get("camera_capture")
    if pictures is not None:
        pairs = zip(pictures["timestamp"].tolist(), pictures["seq"].tolist(), strict=True)
        now.pictures.extend((t_us * _US, int(number)) for t_us, number in pairs)


def _flag(topic: Any, name: str) -> BoolArray:  # noqa: ANN401 - pyulog ships no types
    """Where a flag is set; everywhere where the topic has no such flag."""
    times: FloatArray = topic["timestamp"]
    flags: BoolArray = topic[name] != 0 if name in topic else np.ones(len(times), dtype=np.bool_)
    return flags
