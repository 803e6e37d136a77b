"""The log protocol: logs are listed and read in parts, paced so that telemetry goes on beside them.

https://mavlink.io/en/messages/common.html#LOG_REQUEST_LIST and the messages after it; ArduPilot
`AP_Logger_MAVLinkLogTransfer.cpp`, PX4 `mavlink_log_handler.cpp`. Both send what was asked for once and leave it to
the client to ask for holes again; neither answers a request for a log that it does not have.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from vehicle_sim.autopilot import Severity
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.flight_log import FlightLog, FlightRecorder
from vehicle_sim.protocol.host import Host, Sender
from vehicle_sim.protocol.link import Link

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

DATA_BYTES: Final = 90
"""Bytes of a log in one LOG_DATA."""

DATA_PER_STEP: Final = 8
"""LOG_DATA that are sent in one step on one link, at most: 880 bytes of frames, so 88 kB/s at steps of 10 ms."""

ENTRIES_PER_STEP: Final = 4
_SECOND_US: Final = 1_000_000
_NO_DATE: Final = 0


@dataclass(slots=True)
class _Listing:
    """Which LOG_ENTRY is sent next, and which last."""

    following: int
    last: int


@dataclass(slots=True)
class _Transfer:
    """A log on its way: the next byte, and the one after the last."""

    log: FlightLog
    log_id: int
    following: int
    stop: int


class LogService:
    """Lists, sends and erases the vehicle's logs.

    A list and a part of a log may be on their way on each link; a new request takes the place of the older one there.
    As in ArduPilot, whose logs are numbered from 1, no log is told about in flight, and only one link is served at a
    time; PX4 numbers from 0.

    Attributes:
        is_sending: Whether `advance` has anything to send.
    """

    def __init__(self, host: Host, recorder: FlightRecorder) -> None:
        self._host = host
        self._recorder = recorder
        self._is_ardupilot = host.table.flavour is Flavour.ARDUPILOT
        self._first_id = 1 if self._is_ardupilot else 0
        self._sending: dict[Link, _Listing | _Transfer] = {}
        self._has_warned = False
        self.messages: Mapping[int, Callable[[Sender, Message], None]] = {
            mavlink.MAVLINK_MSG_ID_LOG_REQUEST_LIST: self.on_request_list,
            mavlink.MAVLINK_MSG_ID_LOG_REQUEST_DATA: self.on_request_data,
            mavlink.MAVLINK_MSG_ID_LOG_REQUEST_END: self.on_request_end,
            mavlink.MAVLINK_MSG_ID_LOG_ERASE: self.on_erase,
        }

    @property
    def is_sending(self) -> bool:
        """Whether `advance` has anything to send."""
        return bool(self._sending)

    def forget(self, link: Link) -> None:
        """Stop what is under way on a link that is gone."""
        self._sending.pop(link, None)

    def on_request_list(self, sender: Sender, message: Message) -> None:
        """Start the list of the logs from one id to another; without any log, one entry says so."""
        if not self._may_serve(sender.link):
            return
        count = len(self._recorder.logs)
        if count == 0:
            self._sending.pop(sender.link, None)
            sender.link.send(mavlink.MAVLink_log_entry_message(0, 0, 0, _NO_DATE, 0))
            return
        newest = self._first_id + count - 1
        last = min(max(message.end, self._first_id), newest)
        self._sending[sender.link] = _Listing(min(max(message.start, self._first_id), last), last)

    def on_request_data(self, sender: Sender, message: Message) -> None:
        """Start a part of a log; of one past its end, an empty part is sent."""
        if not self._may_serve(sender.link):
            return
        logs, place = self._recorder.logs, message.id - self._first_id
        if not 0 <= place < len(logs):
            self._sending.pop(sender.link, None)
            return
        log = logs[place]
        stop = min(message.ofs + message.count, len(log.data))
        self._sending[sender.link] = _Transfer(log, message.id, message.ofs, stop)

    def on_request_end(self, sender: Sender, _message: Message) -> None:
        """Stop sending."""
        self.forget(sender.link)

    def on_erase(self, sender: Sender, _message: Message) -> None:
        """Erase the logs."""
        if self._may_serve(sender.link):
            self._sending.clear()
            self._recorder.erase()

    def advance(self) -> None:
        """Send the next few parts on each link."""
        if self._is_ardupilot and self._host.vehicle.autopilot.armed:
            return
        for link, task in list(self._sending.items()):
            is_done = self._send_entries(link, task) if isinstance(task, _Listing) else _send_data(link, task)
            if is_done:
                del self._sending[link]

    def _may_serve(self, link: Link) -> bool:
        if not self._is_ardupilot:
            return True
        if self._host.vehicle.autopilot.armed:
            if not self._has_warned:
                self._host.say(Severity.ERROR, "Disarm for log download")
            self._has_warned = True
            return False
        self._has_warned = False
        if any(other is not link for other in self._sending):
            self._host.say(Severity.INFO, "Log download in progress")
            return False
        return True

    def _send_entries(self, link: Link, listing: _Listing) -> bool:
        logs = self._recorder.logs
        for _ in range(ENTRIES_PER_STEP):
            place = listing.following - self._first_id
            if place >= len(logs):
                return True
            log = logs[place]
            newest = self._first_id + len(logs) - 1
            last, date_s = min(listing.last, newest), log.utc_us // _SECOND_US
            link.send(mavlink.MAVLink_log_entry_message(listing.following, len(logs), last, date_s, len(log.data)))
            if listing.following >= last:
                return True
            listing.following += 1
        return False


def _send_data(link: Link, transfer: _Transfer) -> bool:
    for _ in range(DATA_PER_STEP):
        following = min(transfer.following + DATA_BYTES, transfer.stop)
        part = transfer.log.read(transfer.following, following) if following > transfer.following else b""
        link.send(
            mavlink.MAVLink_log_data_message(
                transfer.log_id, transfer.following, len(part), tuple(part.ljust(DATA_BYTES, b"\0"))
            )
        )
        transfer.following += len(part)
        if transfer.following >= transfer.stop:
            return True
    return False
