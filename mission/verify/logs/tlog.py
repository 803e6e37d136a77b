"""Telemetry logs (.tlog) of ground stations: before each MAVLink frame, a big-endian 64-bit count of microseconds.

They hold both directions of a link, and of all vehicles on it. What counts is what autopilots say; when, by their own
clock, for frames may come in bunches, late or twice. A damaged stretch costs what is in it and no more.
"""

from contextlib import suppress
from typing import BinaryIO, Final

from mission.errors import GeometryError
from mission.geometry.geodesy import LatLon
from mission.link.framing import LONGEST_FRAME, frame_size
from mission.link.messages import AUTOPILOT_ARDUPILOT, AUTOPILOT_COMPONENT, AUTOPILOT_NONE, Codec, numbers_of
from mission.link.values import (
    Attitude,
    Body,
    GlobalPosition,
    Heartbeat,
    Image,
    LandedState,
    Landing,
    LocalPosition,
    Origin,
)
from mission.verify.logs.messages import Messages
from mission.verify.logs.telemetry import Collector, Log, LogError

KIND: Final = "telemetry log"

_TOLD: Final = numbers_of(
    (
        "LOCAL_POSITION_NED",
        "GLOBAL_POSITION_INT",
        "ATTITUDE",
        "HEARTBEAT",
        "EXTENDED_SYS_STATE",
        "GPS_GLOBAL_ORIGIN",
        "CAMERA_FEEDBACK",
        "CAMERA_IMAGE_CAPTURED",
        "CAMERA_TRIGGER",
    )
)
"""Messages that are read; others are passed over unseen."""

_STAMP: Final = 8
_V1: Final = 0xFE
_V2: Final = 0xFD
_LONGEST: Final = _STAMP + LONGEST_FRAME
_MS: Final = 1e-3
_US: Final = 1e-6
_ACTIVE: Final = 4
_STANDBY: Final = 3
"""MAV_STATE_STANDBY and MAV_STATE_ACTIVE: ArduPilot's multicopters say so on the ground, and in the air."""


def is_tlog(head: bytes) -> bool:
    """Whether two records follow each other near the beginning of a file, or one is all of it."""
    return any(_is_followed(head, at) for at in range(min(len(head), _LONGEST)))


def _is_followed(head: bytes, at: int) -> bool:
    size = _record_size(head, at)
    if size is None:
        return False
    stop = at + size
    return stop == len(head) or (stop + _STAMP < len(head) and head[stop + _STAMP] in (_V1, _V2))


def read_tlog(stream: BinaryIO, system: int | None) -> Log:
    """Read a telemetry log.

    Args:
        stream: Its bytes.
        system: Which vehicle, by its system id; None for the only one.

    Raises:
        LogError: There is no vehicle in it, or not this one, or several.
    """
    systems: dict[int, _Vehicle] = {}
    records = Messages(stream, _LONGEST, 1, size=_record_size, followed=_can_follow, onward=lambda _, at: at + 1)
    codec = Codec(0, 0)
    for record in records:
        stamp_us, data = int.from_bytes(record[:_STAMP], "big"), record[_STAMP:]
        for frame in codec.judged(data) if _number(data) in _TOLD else ():
            if frame.component_id == AUTOPILOT_COMPONENT:
                received = codec.read(frame)
                systems.setdefault(received.system_id, _Vehicle()).take(received.body, stamp_us * _US)
    for each in systems.values():
        each.told.finish()
    flying = {number: each for number, each in sorted(systems.items()) if each.flies}
    chosen = _chosen(flying, system)
    notes = [f"{records.skipped:,} bytes of the log are no frames and were passed over"] if records.skipped else []
    others = [str(number) for number in flying if number != chosen]
    if others:
        notes.append(f"the log has other vehicles, too: {', '.join(others)}")
    return Log(KIND, tuple(flying[chosen].told.boots), tuple(notes))


def _chosen(flying: "dict[int, _Vehicle]", system: int | None) -> int:
    listed = ", ".join(map(str, flying))
    if not flying:
        raise LogError("the log has no positions of any autopilot: no LOCAL_POSITION_NED and no GLOBAL_POSITION_INT")
    if system is None:
        if len(flying) > 1:
            raise LogError(f"the log has several vehicles; choose one with --system: {listed}")
        return next(iter(flying))
    if system not in flying:
        raise LogError(f"the log has no positions of vehicle {system}; those it has are of {listed}")
    return system


class _Vehicle:
    """What one system told."""

    def __init__(self) -> None:
        self.told = Collector()
        self._station = False

    @property
    def flies(self) -> bool:
        """Whether it is a vehicle, and told where it was."""
        return not self._station and any(boot.local or boot.world for boot in self.told.boots)

    def take(self, body: Body, utc_s: float) -> None:
        """Take one message, logged at that time of the day."""
        told = self.told
        if isinstance(body, LocalPosition):
            told.local(body.time_boot_ms * _MS, *body.position_ned_m)
            told.note(lambda now, t_s: now.note_clock(t_s, utc_s))
        elif isinstance(body, GlobalPosition):
            told.world(body.time_boot_ms * _MS, body.latitude_deg, body.longitude_deg, body.height_above_home_m)
            told.note(lambda now, t_s: now.note_clock(t_s, utc_s))
        elif isinstance(body, Attitude):
            told.time(body.time_boot_ms * _MS)
        elif isinstance(body, Heartbeat):
            self._heartbeat(body)
        elif isinstance(body, Landing) and body.state is not LandedState.UNDEFINED:
            told.note(lambda now, t_s: now.note_airborne(t_s, body.state is not LandedState.ON_GROUND))
        elif isinstance(body, Origin):
            with suppress(GeometryError):  # noise with a right checksum
                place = LatLon(body.latitude_deg, body.longitude_deg)
                told.note(lambda now, t_s: now.origins.append((t_s, place)))
        elif isinstance(body, Image) and body.captured:
            # Of a release, the image itself may be told later, or on another link: by its number it is the same.
            told.note(lambda now, t_s: now.pictures.append((body.boot_s or t_s, body.number)))

    def _heartbeat(self, body: Heartbeat) -> None:
        if body.autopilot == AUTOPILOT_NONE:
            self._station = True
            return
        self.told.note(lambda now, t_s: now.note_armed(t_s, body.armed))
        if body.autopilot == AUTOPILOT_ARDUPILOT and body.system_status in (_STANDBY, _ACTIVE):
            self.told.note(lambda now, t_s: now.note_active(t_s, body.system_status == _ACTIVE))


def _can_follow(data: bytes, at: int) -> bool:
    """Whether a frame may begin after the count of microseconds there, or the log ends."""
    return at + _STAMP >= len(data) or data[at + _STAMP] in (_V1, _V2)


def _record_size(data: bytes, at: int) -> int | None:
    """How long the record is that begins there; None where none does."""
    size = frame_size(data, at + _STAMP)
    return None if size is None else _STAMP + size


def _number(frame: bytes) -> int:
    """Which message a frame says that it is."""
    return frame[5] if frame[0] == _V1 else frame[7] | frame[8] << 8 | frame[9] << 16
