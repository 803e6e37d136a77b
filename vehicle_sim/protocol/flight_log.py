"""The log of each armed period: the vehicle's own telemetry, as a ground station would have recorded it.

A log is a stream in the format of telemetry logs (.tlog): before each MAVLink 2 frame stand eight bytes, big-endian,
of UTC in microseconds, whose two lowest bits are zero. It is neither ArduPilot's .BIN nor PX4's .ulg, and never named
so. What is in it: the messages of `RATES_HZ` that the flavour has, all texts, and the heartbeat that says disarmed.
"""

from collections import deque
from struct import pack
from typing import TYPE_CHECKING, Final

from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.framing import frame_of
from vehicle_sim.protocol.host import Host
from vehicle_sim.protocol.streams import StreamSchedule

if TYPE_CHECKING:
    from collections.abc import Callable

MOST_BYTES: Final = 16 << 20
"""What all logs of a vehicle hold together, at most: the oldest go first."""

MOST_BYTES_EACH: Final = 4 << 20
"""A log that reaches this goes on in another one; that is about an hour in the air."""

MOST_LOGS: Final = 128

RATES_HZ: Final = {
    mavlink.MAVLINK_MSG_ID_HEARTBEAT: 1.0,
    mavlink.MAVLINK_MSG_ID_SYS_STATUS: 1.0,
    mavlink.MAVLINK_MSG_ID_SYSTEM_TIME: 0.2,
    mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: 1.0,
    mavlink.MAVLINK_MSG_ID_ATTITUDE: 4.0,
    mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED: 4.0,
    mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: 4.0,
    mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED: 4.0,
    mavlink.MAVLINK_MSG_ID_VFR_HUD: 1.0,
    mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW: 1.0,
    mavlink.MAVLINK_MSG_ID_MISSION_CURRENT: 0.5,
    mavlink.MAVLINK_MSG_ID_BATTERY_STATUS: 0.5,
    mavlink.MAVLINK_MSG_ID_VIBRATION: 0.5,
    mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: 0.5,
    mavlink.MAVLINK_MSG_ID_HOME_POSITION: 0.2,
}
"""How often each message is put into a log."""

_RESERVED: Final = 0b11
_SECOND_US: Final = 1_000_000


class FlightLog:
    """One log; it grows at its end only.

    Attributes:
        number: Counts the logs of the vehicle from 1 up.
        utc_us: When it begins, in microseconds since 1970; since boot where the vehicle did not know the date.
        data: What is in it.
    """

    def __init__(self, number: int, utc_us: int) -> None:
        self.number = number
        self.utc_us = utc_us
        self.data = bytearray()

    def read(self, start: int, stop: int) -> bytes:
        """Return the bytes from `start` to `stop`."""
        with memoryview(self.data) as view:
            return bytes(view[start:stop])


class FlightRecorder:
    """Writes the logs of one vehicle and keeps the newest of them.

    Attributes:
        is_recording: Whether a log is being written.
        on_finished: Called with each log that has come to its end.
    """

    def __init__(self, host: Host) -> None:
        self._host = host
        self._logs: deque[FlightLog] = deque()
        self._kept_bytes = 0
        self._begun = 0
        self._schedule = StreamSchedule()
        self._boot_utc_us = 0
        self._mav = mavlink.MAVLink(None)
        self.is_recording = False
        self.on_finished: Callable[[FlightLog], None] | None = None

    @property
    def logs(self) -> tuple[FlightLog, ...]:
        """The logs that are kept, oldest first; the last one may still be growing."""
        return tuple(self._logs)

    def begin(self) -> None:
        """Begin a log, with all of its messages in the coming step."""
        host = self._host
        knows_date = host.vehicle.readings.gps is not None
        self._boot_utc_us = host.utc_of_boot_us if knows_date else 0
        self._mav.srcSystem, self._mav.srcComponent = host.system_id, host.component_id
        self._open()
        self._schedule.clear()
        for message_id, hertz in RATES_HZ.items():
            if host.has_telemetry(message_id):
                self._schedule.start(message_id, round(_SECOND_US / hertz), host.now_us)
        self.is_recording = True

    def advance(self) -> None:
        """Put into the log what is due, and end it where the vehicle is no longer armed."""
        if not self.is_recording:
            return
        if self._schedule.next_due_us <= self._host.now_us:
            for message_id in self._schedule.due(self._host.now_us):
                self._take_telemetry(message_id)
        if not self._host.vehicle.autopilot.armed:
            self._take_telemetry(mavlink.MAVLINK_MSG_ID_HEARTBEAT)
            self.finish()

    def take(self, message: Message) -> None:
        """Put a message into the log, if there is one."""
        if not self.is_recording:
            return
        frame = frame_of(message, self._mav)
        self._mav.seq = (self._mav.seq + 1) & 0xFF
        utc_us = self._boot_utc_us + self._host.now_us
        entry = pack(">Q", utc_us & ~_RESERVED) + frame
        if len(self._logs[-1].data) + len(entry) > MOST_BYTES_EACH:
            self._close()
            self._open()
        self._logs[-1].data += entry
        self._kept_bytes += len(entry)
        while self._kept_bytes > MOST_BYTES:
            self._drop_oldest()

    def finish(self) -> None:
        """End the log that is being written, if there is one."""
        if self.is_recording:
            self.is_recording = False
            self._close()

    def erase(self) -> None:
        """Drop all logs but the one that is being written."""
        while len(self._logs) > self.is_recording:
            self._drop_oldest()

    def _take_telemetry(self, message_id: int) -> None:
        message = self._host.telemetry(message_id)
        if message is not None:
            self.take(message)

    def _open(self) -> None:
        self._begun += 1
        self._logs.append(FlightLog(self._begun, self._boot_utc_us + self._host.now_us))
        if len(self._logs) > MOST_LOGS:
            self._drop_oldest()

    def _close(self) -> None:
        if self.on_finished is not None:
            self.on_finished(self._logs[-1])

    def _drop_oldest(self) -> None:
        self._kept_bytes -= len(self._logs.popleft().data)
