"""Writes logs: telemetry logs by pymavlink, DataFlash logs by the layout that their own messages describe."""

import struct
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.geometry.arrays import FloatArray
from mission.geometry.geodesy import LatLon
from mission.geometry.places import places_at_offsets

HOME = LatLon(47.397742, 8.545594)
UTC_US = 1_790_000_000_000_000

Told = tuple[float, Any]
"""Seconds since boot, and a message."""


def tlog(told: Iterable[Told], system: int = 1, component: int = 1) -> bytes:
    """A telemetry log of one sender, as it tells."""
    return b"".join(entries(told, system, component))


def entries(told: Iterable[Told], system: int = 1, component: int = 1) -> list[bytes]:
    packer = mavlink.MAVLink(None, srcSystem=system, srcComponent=component)
    return [struct.pack(">Q", UTC_US + int(t_s * 1e6)) + bytes(message.pack(packer)) for t_s, message in told]


def interleaved(*logs: list[bytes]) -> bytes:
    """Entries of several senders in the order of time."""
    every = [(entry[:8], entry) for log in logs for entry in log]
    return b"".join(entry for _, entry in sorted(every))


def heartbeat(t_s: float, *, armed: bool, flying: bool) -> Told:
    """As ArduPilot's multicopters send it."""
    mode = mavlink.MAV_MODE_FLAG_SAFETY_ARMED if armed else 0
    state = mavlink.MAV_STATE_ACTIVE if flying else mavlink.MAV_STATE_STANDBY
    return t_s, mavlink.MAVLink_heartbeat_message(
        mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA, mode, 0, state, 3
    )


def local(t_s: float, east_m: float, north_m: float, up_m: float = 5.0) -> Told:
    boot_ms = round(t_s * 1e3)
    return t_s, mavlink.MAVLink_local_position_ned_message(boot_ms, north_m, east_m, -up_m, 0.0, 0.0, 0.0)


def world(t_s: float, east_m: float, north_m: float, up_m: float = 5.0) -> Told:
    """East and north of ``HOME``."""
    ((latitude, longitude),) = places_at_offsets(HOME, np.array([[east_m, north_m]])).tolist()
    return t_s, mavlink.MAVLink_global_position_int_message(
        round(t_s * 1e3), round(latitude * 1e7), round(longitude * 1e7), 0, round(up_m * 1e3), 0, 0, 0, 0
    )


def origin(t_s: float, place: LatLon = HOME) -> Told:
    return t_s, mavlink.MAVLink_gps_global_origin_message(
        round(place.latitude_deg * 1e7), round(place.longitude_deg * 1e7), 0
    )


def picture(t_s: float, number: int) -> Told:
    """As ArduPilot tells of one."""
    values = (0.0,) * 6
    return t_s, mavlink.MAVLink_camera_feedback_message(int(t_s * 1e6), 1, 0, number, 0, 0, *values, 0)


def flight(t_s: FloatArray, position_m: FloatArray, kind: Any = local) -> list[Told]:  # noqa: ANN401 - local or world
    """A whole flight along positions (N, 2): armed, up, there, down and disarmed."""
    places = position_m.tolist()
    begin, end = float(t_s[0]), float(t_s[-1])
    return [
        heartbeat(begin - 2.0, armed=False, flying=False),
        kind(begin - 1.5, *places[0], 0.0),
        heartbeat(begin - 1.0, armed=True, flying=False),
        kind(begin - 0.1, *places[0], 0.0),
        heartbeat(begin - 0.05, armed=True, flying=True),
        *(kind(at, *place) for at, place in zip(t_s.tolist(), places, strict=True)),
        heartbeat(end + 0.05, armed=True, flying=False),
        kind(end + 1.0, *places[-1], 0.0),
        heartbeat(end + 1.1, armed=False, flying=False),
        kind(end + 2.0, *places[-1], 0.0),
    ]


_FORMATS = {
    "FMT": (128, "BBnNZ", "Type,Length,Name,Format,Columns"),
    "XKF1": (64, "QBfff", "TimeUS,C,PN,PE,PD"),
    "POS": (65, "QLLfff", "TimeUS,Lat,Lng,Alt,RelHomeAlt,RelOriginAlt"),
    "ORGN": (66, "QBLLe", "TimeUS,Type,Lat,Lng,Alt"),
    "EV": (67, "QB", "TimeUS,Id"),
    "GPS": (68, "QBBIH", "TimeUS,I,Status,GMS,GWk"),
    "CAM": (69, "QH", "TimeUS,Img"),
    "IMU": (70, "Qf", "TimeUS,GyrX"),
}
_CODES = {"Q": "Q", "B": "B", "f": "f", "L": "i", "e": "i", "I": "I", "H": "H", "n": "4s", "N": "16s", "Z": "64s"}


def dataflash(messages: Iterable[tuple[str, Sequence[Any]]]) -> bytes:
    """A DataFlash log of messages by their names, their values as they are stored; formats come first."""
    formats = [
        ("FMT", (number, 3 + _layout(letters).size, name.encode(), letters.encode(), columns.encode()))
        for name, (number, letters, columns) in _FORMATS.items()
    ]
    return b"".join(_packed(name, values) for name, values in (*formats, *messages))


def dataflash_flight(t_s: FloatArray, position_m: FloatArray) -> list[tuple[str, Sequence[Any]]]:
    """A whole flight: its messages, in the order of time."""
    begin, end = int(t_s[0] * 1e6), int(t_s[-1] * 1e6)
    rows = np.column_stack((t_s, position_m)).tolist()
    return [
        ("ORGN", (begin - 2_000_000, 0, round(HOME.latitude_deg * 1e7), round(HOME.longitude_deg * 1e7), 0)),
        ("XKF1", (begin - 1_500_000, 0, rows[0][2], rows[0][1], 0.0)),
        ("EV", (begin - 50_000, 28)),
        *(("XKF1", (round(at * 1e6), 0, north, east, -5.0)) for at, east, north in rows),
        ("EV", (end + 50_000, 18)),
        ("XKF1", (end + 500_000, 0, rows[-1][2], rows[-1][1], 0.0)),
        ("EV", (end + 1_000_000, 11)),
    ]


def _layout(letters: str) -> struct.Struct:
    return struct.Struct("<" + "".join(_CODES[letter] for letter in letters))


def _packed(name: str, values: Sequence[Any]) -> bytes:
    number, letters, _ = _FORMATS[name]
    return b"\xa3\x95" + bytes((number,)) + _layout(letters).pack(*values)
