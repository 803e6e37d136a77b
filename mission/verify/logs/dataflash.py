"""DataFlash logs (.bin) of ArduPilot: messages of formats that the log itself describes.

https://ardupilot.org/copter/docs/logmessages.html. Each message begins with 0xA3 0x95 and the number of its type, and
is as long as a message FMT (type 128) of that type says. A damaged stretch costs what is in it and no more.
"""

import struct
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import BinaryIO, Final, NamedTuple

from mission.errors import GeometryError
from mission.geometry.geodesy import LatLon
from mission.verify.logs.messages import Messages
from mission.verify.logs.telemetry import Collector, Log, LogError, Telemetry, began_otherwise

KIND: Final = "DataFlash log of ArduPilot"
HEAD: Final = b"\xa3\x95"

_HEADER: Final = 3
_FORMAT: Final = 128
_FORMAT_BODY: Final = struct.Struct("<BB4s16s64s")
_LONGEST: Final = 256
_US: Final = 1e-6
_MS: Final = 1e-3
_E7: Final = 1e-7

_TYPES: Final = {
    "a": "64s", "b": "b", "B": "B", "g": "e", "h": "h", "H": "H", "i": "i", "I": "I", "f": "f", "n": "4s", "N": "16s",
    "Z": "64s", "c": "h", "C": "H", "e": "i", "E": "I", "L": "i", "d": "d", "M": "B", "q": "q", "Q": "Q",
}  # fmt: skip
"""Letters of formats as those of ``struct``."""

_DEGREES: Final = "L"

_ARMED, _DISARMED, _LANDED, _NOT_LANDED = 10, 11, 18, 28
"""Numbers of EV."""

_GPS_EPOCH_S: Final = 315_964_800
_WEEK_S: Final = 604_800
_LEAP_S: Final = 18  # since 2017
_FIX_3D: Final = 3


class _Layout(NamedTuple):
    """How to read the messages of one type."""

    name: str
    unpack: Callable[[bytes], tuple[object, ...]]
    columns: dict[str, int]
    degrees: frozenset[int]

    def values(self, body: bytes) -> dict[str, float]:
        """The numbers of a message by their names; texts are left out."""
        row = self.unpack(body)
        return {
            name: row[place] * _E7 if place in self.degrees else row[place]  # type: ignore[operator, misc]
            for name, place in self.columns.items()
            if isinstance(row[place], (int, float))
        }


def read_dataflash(stream: BinaryIO) -> Log:
    """Read a DataFlash log.

    Raises:
        LogError: There are no positions in it.
    """
    told = _Told()
    layouts = _Layouts()
    messages = Messages(stream, _LONGEST, _HEADER, size=layouts.size, followed=_can_follow, onward=_next_head)
    for name, values in filter(None, map(layouts.read, messages)):
        told.take(name, values)
    boots = told.finished()
    if not any(boot.local or boot.world for boot in boots):
        raise LogError("the log has no positions: no POS, and no XKF1 or NKF1 with an origin; set LOG_BITMASK so")
    notes = [f"{messages.skipped:,} bytes of the log are no messages and were passed over"] if messages.skipped else []
    return Log(KIND, tuple(boots), tuple(notes))


class _Told:
    """What the messages say."""

    def __init__(self) -> None:
        self._told = Collector()
        self._estimator = ""
        self._core = 0
        self._takers: dict[str, Callable[[float, dict[str, float]], None]] = {
            "POS": self._position,
            "XKF1": partial(self._estimate, "XKF1"),
            "NKF1": partial(self._estimate, "NKF1"),
            "XKF4": partial(self._primary, "XKF1"),
            "NKF4": partial(self._primary, "NKF1"),
            "ORGN": self._origin,
            "EV": self._event,
            "ARM": self._arming,
            "GPS": self._satellites,
            "CAM": self._picture,
        }

    def take(self, name: str, values: dict[str, float]) -> None:
        """Take one message; what lacks what it should have is left out."""
        with suppress(KeyError, GeometryError):
            t_s = values["TimeUS"] * _US
            self._told.time(t_s)
            self._takers[name](t_s, values)

    def finished(self) -> list[Telemetry]:
        """What was told, from start to start; arming and landing are told when they change."""
        for boot in self._told.finish():
            began_otherwise(boot.armed)
            began_otherwise(boot.airborne)
        return self._told.boots

    def _position(self, t_s: float, values: dict[str, float]) -> None:
        self._told.world(t_s, values["Lat"], values["Lng"], values["RelHomeAlt"])

    def _estimate(self, name: str, t_s: float, values: dict[str, float]) -> None:
        self._estimator = self._estimator or name  # two kinds may run side by side
        if self._estimator == name and values.get("C", 0) == self._core:
            self._told.local(t_s, values["PN"], values["PE"], values["PD"])

    def _primary(self, name: str, _: float, values: dict[str, float]) -> None:
        if self._estimator == name:
            self._core = int(values["PI"])

    def _origin(self, t_s: float, values: dict[str, float]) -> None:
        if values["Type"] == 0:  # that of the estimator; 1 is home
            place = LatLon(values["Lat"], values["Lng"])
            self._told.note(lambda now, _: now.origins.append((t_s, place)))

    def _event(self, t_s: float, values: dict[str, float]) -> None:
        number = values["Id"]
        if number in (_ARMED, _DISARMED):
            self._told.note(lambda now, _: now.note_armed(t_s, number == _ARMED))
        elif number in (_LANDED, _NOT_LANDED):
            self._told.note(lambda now, _: now.note_airborne(t_s, number == _NOT_LANDED))

    def _arming(self, t_s: float, values: dict[str, float]) -> None:
        armed = values["ArmState"] == 1
        self._told.note(lambda now, _: now.note_armed(t_s, armed))

    def _satellites(self, t_s: float, values: dict[str, float]) -> None:
        if values["Status"] >= _FIX_3D and values["GWk"] > 0:
            utc_s = _GPS_EPOCH_S + values["GWk"] * _WEEK_S + values["GMS"] * _MS - _LEAP_S
            self._told.note(lambda now, _: now.note_clock(t_s, utc_s))

    def _picture(self, t_s: float, values: dict[str, float]) -> None:
        number = int(values["Img"])
        self._told.note(lambda now, _: now.pictures.append((t_s, number)))


_WANTED: Final = frozenset(("POS", "XKF1", "XKF4", "NKF1", "NKF4", "ORGN", "EV", "ARM", "GPS", "CAM"))


class _Layouts:
    """What the log has said so far of its own messages."""

    def __init__(self) -> None:
        self._sizes: dict[int, int] = {_FORMAT: _HEADER + _FORMAT_BODY.size}
        self._layouts: dict[int, _Layout] = {}

    def size(self, data: bytes, at: int) -> int | None:
        """How long the message is that begins there; None where none does."""
        return self._sizes.get(data[at + 2]) if data[at : at + 2] == HEAD else None

    def read(self, message: bytes) -> tuple[str, dict[str, float]] | None:
        """The name and the values of a message; None of one that is not wanted."""
        number, body = message[2], message[_HEADER:]
        if number == _FORMAT:
            self._learn(body)
        layout = self._layouts.get(number)
        return None if layout is None else (layout.name, layout.values(body))

    def _learn(self, body: bytes) -> None:
        number, size, name, letters, columns = _FORMAT_BODY.unpack(body)
        if number == _FORMAT or size < _HEADER:
            return
        self._sizes[number] = size
        self._layouts.pop(number, None)
        text, types = _text(name), _text(letters)
        if text not in _WANTED or not all(letter in _TYPES for letter in types):
            return
        layout = struct.Struct("<" + "".join(_TYPES[letter] for letter in types))
        if layout.size == size - _HEADER:
            places = {column: place for place, column in enumerate(_text(columns).split(",")) if place < len(types)}
            degrees = frozenset(place for place, letter in enumerate(types) if letter == _DEGREES)
            self._layouts[number] = _Layout(text, layout.unpack, places, degrees)


def _can_follow(data: bytes, at: int) -> bool:
    return data[at : at + 2] in (HEAD, HEAD[:1], b"")


def _next_head(data: bytes, at: int) -> int:
    found = data.find(HEAD, at + 1)
    return found if found >= 0 else max(at + 1, len(data) - 1)


def _text(raw: bytes) -> str:
    return raw.split(b"\0", 1)[0].decode("ascii", "replace")
