"""Clocks of both ends: TIMESYNC (https://mavlink.io/en/services/timesync.html) and PING."""

from typing import TYPE_CHECKING

from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.host import Host, Sender

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from vehicle_sim.protocol.telemetry import Builder


class TimeService:
    """Answers with the vehicle's clock, and asks for its peers' where that is streamed."""

    def __init__(self, host: Host) -> None:
        self._host = host
        self._pings = 0
        self.messages: Mapping[int, Callable[[Sender, Message], None]] = {
            mavlink.MAVLINK_MSG_ID_TIMESYNC: self.on_timesync,
            mavlink.MAVLINK_MSG_ID_PING: self.on_ping,
        }
        self.telemetry: Mapping[int, Builder] = {
            mavlink.MAVLINK_MSG_ID_TIMESYNC: self._ask_for_time,
            mavlink.MAVLINK_MSG_ID_PING: self._ping,
        }

    def on_timesync(self, sender: Sender, message: Message) -> None:
        """Answer a request (tc1 is 0) with the time since boot in ns; an answer to the own request needs none."""
        if message.tc1 == 0:
            sender.link.send(mavlink.MAVLink_timesync_message(self._host.now_us * 1000, message.ts1))

    def on_ping(self, sender: Sender, message: Message) -> None:
        """Return a ping that was sent to all (target 0) to its sender, where the autopilot does that."""
        if self._host.table.answers_ping and message.target_system == 0:
            sender.link.send(
                mavlink.MAVLink_ping_message(message.time_usec, message.seq, sender.system_id, sender.component_id)
            )

    def _ask_for_time(self, _host: Host) -> Message | None:
        return mavlink.MAVLink_timesync_message(0, self._host.now_us * 1000)

    def _ping(self, _host: Host) -> Message | None:
        self._pings += 1
        return mavlink.MAVLink_ping_message(self._host.now_us, self._pings & 0xFFFFFFFF, 0, 0)
