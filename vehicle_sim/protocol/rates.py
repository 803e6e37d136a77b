"""Who gets which message how often: stream groups, message intervals, single requests.

https://mavlink.io/en/messages/common.html#MAV_CMD_SET_MESSAGE_INTERVAL and #REQUEST_DATA_STREAM.
"""

from math import isfinite
from typing import TYPE_CHECKING, Final

from vehicle_sim.autopilot import Outcome, Severity
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.commands import Request
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.host import Host, Sender
from vehicle_sim.protocol.link import Link
from vehicle_sim.protocol.units import whole_number

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

HEARTBEAT_US: Final = 1_000_000
_HEARTBEAT: Final = mavlink.MAVLINK_MSG_ID_HEARTBEAT
_SECOND_US: Final = 1_000_000
_OFF: Final = -1
_DEFAULT: Final = 0
_LONGEST_US: Final = 1 << 31


class RateService:
    """Sets the streams of each link as its peer asks for them.

    Attributes:
        requests: Who answers REQUEST_MESSAGE for messages whose request has parameters of its own.
    """

    def __init__(self, host: Host) -> None:
        self._host = host
        self.requests: dict[int, Callable[[Request], Outcome]] = {}
        self.messages: Mapping[int, Callable[[Sender, Message], None]] = {
            mavlink.MAVLINK_MSG_ID_REQUEST_DATA_STREAM: self.on_request_data_stream,
        }
        self.commands: Mapping[int, Callable[[Request], Outcome]] = {
            mavlink.MAV_CMD_SET_MESSAGE_INTERVAL: self._set_interval,
            mavlink.MAV_CMD_GET_MESSAGE_INTERVAL: self._get_interval,
            mavlink.MAV_CMD_REQUEST_MESSAGE: self._request_message,
            mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES: lambda request: self._give(
                request, mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION
            ),
            mavlink.MAV_CMD_GET_HOME_POSITION: lambda request: self._give(
                request, mavlink.MAVLINK_MSG_ID_HOME_POSITION
            ),
        }

    def start_defaults(self, link: Link) -> None:
        """Start what is streamed on a new link unasked."""
        link.streams.clear()
        link.streams.start(_HEARTBEAT, HEARTBEAT_US, self._host.now_us)
        for message_id, hertz in self._defaults_hz(link).items():
            link.streams.start(message_id, round(_SECOND_US / hertz), self._host.now_us)

    def on_request_data_stream(self, sender: Sender, message: Message) -> None:
        """Start or stop a group of messages; it is never acknowledged."""
        groups = self._host.table.stream_groups
        asked: list[int] = []
        if not groups:
            asked = [message.req_stream_id]
        elif message.req_stream_id == mavlink.MAV_DATA_STREAM_ALL:
            asked = [message_id for group in groups.values() for message_id in group]
        else:
            asked.extend(groups.get(message.req_stream_id, ()))
        wanted = message.start_stop == 1 and message.req_message_rate > 0
        streams = sender.link.streams
        for message_id in asked:
            if message_id == _HEARTBEAT or not self._host.has_telemetry(message_id):
                continue
            if wanted:
                streams.start(message_id, round(_SECOND_US / message.req_message_rate), self._host.now_us)
            else:
                streams.stop(message_id)

    def _set_interval(self, request: Request) -> Outcome:
        message_id = whole_number(request.params[0])
        interval_us = request.params[1]
        if message_id is None or not self._host.has_telemetry(message_id):
            if self._host.table.flavour is Flavour.ARDUPILOT:
                named = "?" if message_id is None else message_id
                self._host.say(Severity.INFO, f"No ap_message for mavlink id ({named})")
            return self._host.table.no_stream
        streams = request.sender.link.streams
        if not isfinite(interval_us) or interval_us < _OFF or interval_us > _LONGEST_US:
            return Outcome.DENIED
        if interval_us == _DEFAULT:
            default_us = self._default_us(request.sender.link, message_id)
            if default_us is None:
                streams.stop(message_id)
            else:
                streams.start(message_id, default_us, self._host.now_us)
        elif interval_us < 0:
            if message_id == _HEARTBEAT:
                return Outcome.DENIED  # without it a vehicle is lost
            streams.stop(message_id)
        else:
            streams.start(message_id, max(round(interval_us), 1), self._host.now_us)
        return Outcome.ACCEPTED

    def _defaults_hz(self, link: Link) -> dict[int, float]:
        """Return what is streamed on a link unasked: by the flavour's table, and by the parameters that are set."""
        table, purpose = self._host.table, self._host.rates_of(link)
        defaults = dict(table.default_rates_hz[purpose])
        for group, name in table.stream_parameters.get(purpose, {}).items():
            if hertz := self._host.vehicle.parameters[name]:
                defaults.update(dict.fromkeys(table.stream_groups[group], hertz))
        return defaults

    def _default_us(self, link: Link, message_id: int) -> int | None:
        if message_id == _HEARTBEAT:
            return HEARTBEAT_US
        hertz = self._defaults_hz(link).get(message_id)
        return None if hertz is None else round(_SECOND_US / hertz)

    def _get_interval(self, request: Request) -> Outcome:
        """Answer with MESSAGE_INTERVAL: -1 for a message that is not streamed, 0 for one that it does not have."""
        message_id = whole_number(request.params[0])
        if message_id is None or message_id > 0xFFFF:  # noqa: PLR2004 - MESSAGE_INTERVAL holds 16 bits of it
            return Outcome.FAILED
        interval_us = request.sender.link.streams.interval_us(message_id)
        if not self._host.has_telemetry(message_id):
            interval_us = _DEFAULT
        elif interval_us is None:
            interval_us = _OFF
        request.sender.link.send(mavlink.MAVLink_message_interval_message(message_id, interval_us))
        return Outcome.ACCEPTED

    def _request_message(self, request: Request) -> Outcome:
        message_id = whole_number(request.params[0])
        if message_id is None:
            return self._host.table.no_message
        answer = self.requests.get(message_id)
        return self._give(request, message_id) if answer is None else answer(request)

    def _give(self, request: Request, message_id: int) -> Outcome:
        """Send one telemetry message to whoever asked for it."""
        if not self._host.has_telemetry(message_id):
            return self._host.table.no_message
        message = self._host.telemetry(message_id)
        if message is None:
            return self._host.table.no_message
        request.sender.link.send(message)
        return Outcome.ACCEPTED
