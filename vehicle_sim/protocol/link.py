"""One MAVLink link: bytes of its peer to messages, messages to datagrams.

MAVLink 2 serialisation: https://mavlink.io/en/guide/serialization.html. A link starts in MAVLink 2; it falls back to
MAVLink 1 for a peer that was heard to speak only that, and returns for good with the first MAVLink 2 frame.
"""

import re
from collections import deque
from struct import pack
from typing import Final

from vehicle_sim.protocol.dialect import (
    AUTOPILOT_COMPONENT,
    LAST_V1_ID,
    MAGIC_V1,
    MAGIC_V2,
    V1_PAYLOAD_LENGTHS,
    Message,
    mavlink,
)
from vehicle_sim.protocol.framing import frame_of, message_of
from vehicle_sim.protocol.policy import SigningPolicy
from vehicle_sim.protocol.signing import SIGNATURE_LENGTH, SIGNED_FLAG, Signer
from vehicle_sim.protocol.streams import StreamSchedule

MAX_DATAGRAM: Final = 1400
"""Bytes of MAVLink put into one datagram: under any usual MTU."""

_MAX_WAITING: Final = 1024
_MAGIC: Final = re.compile(b"[%c%c]" % (MAGIC_V1, MAGIC_V2))
_V1_HEADER: Final = 6
_V1_OVERHEAD: Final = 8
_V2_OVERHEAD: Final = 12
_LEAST_HEADER: Final = 3


class Link:
    """Parser, serialiser and stream schedule of one peer.

    Attributes:
        name: What the user and the routing call it.
        streams: When which message is due on it.
        signing: What it asks of signatures while there is a key.
        is_secure: Whether nobody can listen or speak in between: a line that does not leave the machine.
        unknown: Frames of messages that the dialect does not know, oldest first; whoever reads it empties it. Their
            checksums cannot be checked. While signing is required they are rightly signed.
        is_full: Whether its line takes no more for now: what is streamed waits, and is as new as can be when it goes.
        tells_position: Whether a LOCAL_POSITION_NED waits to be sent, which tells those who fly where they are.
    """

    def __init__(
        self,
        name: str,
        *,
        system_id: int,
        component_id: int = AUTOPILOT_COMPONENT,
        byte_stream: bool = False,
        signer: Signer | None = None,
        signing: SigningPolicy = SigningPolicy.REQUIRED,
        link_id: int = 0,
        is_secure: bool = False,
    ) -> None:
        """Open the link.

        Args:
            name: Unique among the links of an endpoint.
            system_id: System id of the vehicle, the source of what is sent.
            component_id: Its component id.
            byte_stream: Whether a frame may be split between two receptions (TCP, serial); a datagram is whole.
            signer: Holds the vehicle's key, if it has one.
            signing: See the attribute.
            link_id: Goes into signatures.
            is_secure: See the attribute.
        """
        self.name = name
        self.streams = StreamSchedule()
        self.signing = signing
        self.is_secure = is_secure
        self.unknown: list[bytes] = []
        self._byte_stream = byte_stream
        self._signer = Signer() if signer is None else signer
        self._mav = mavlink.MAVLink(None, srcSystem=system_id, srcComponent=component_id)
        self._mav.signing.link_id = link_id
        self._reader = mavlink.MAVLink(None)  # holds no key: signatures are judged here
        self._speaks_v1 = False
        self._heard_v2 = False
        self._rest = b""
        self.is_full = False
        self.tells_position = False
        self._filling = bytearray()
        self._waiting: deque[bytes] = deque(maxlen=_MAX_WAITING)  # a peer that never reads loses the oldest
        self._last: Message | None = None

    def speak_for(self, system_id: int) -> None:
        """Send as another system from now on."""
        self._mav.srcSystem = system_id

    @property
    def speaks_v1(self) -> bool:
        """Whether the peer is answered in MAVLink 1, which cannot be signed."""
        return self._speaks_v1 and (self._signer.key is None or self.signing is not SigningPolicy.REQUIRED)

    @property
    def checks_signatures(self) -> bool:
        """Whether signatures are made and judged here: there is a key, and the link does not do without."""
        return self._signer.key is not None and self.signing is not SigningPolicy.OFF

    def decode(self, data: bytes) -> list[Message]:
        """Return the valid messages of the dialect in what was received; all else is dropped.

        Where a frame turns out to be none, parsing resumes one byte after its start, so that noise never swallows a
        frame that follows it.
        """
        data = self._rest + data
        messages: list[Message] = []
        at, end, unknown_until = 0, len(data), 0
        while (start := _MAGIC.search(data, at)) is not None:
            at = start.start()
            if end - at < _LEAST_HEADER:
                break
            stop = at + _frame_length(data, at)
            if stop > end and self._byte_stream:
                break
            frame = bytearray(data[at:stop])
            message = self._read(frame) if at < stop <= end else None
            if message is not None and not isinstance(message, mavlink.MAVLink_unknown):
                messages.append(message)
                at = stop
                continue
            if message is not None and at >= unknown_until:
                self.unknown.append(bytes(frame))
                unknown_until = stop
            at += 1  # nothing vouches for what its message is unknown: what it covers may be frames
        else:
            at = end
        self._rest = data[at:] if self._byte_stream else b""
        return messages

    def _read(self, frame: bytearray) -> Message | None:
        """Return the message of a frame, None where it is none, or none that this link may hear."""
        is_v2 = frame[0] == MAGIC_V2
        is_signed = is_v2 and bool(frame[2] & SIGNED_FLAG)
        if self.checks_signatures and not is_signed and self.signing is SigningPolicy.REQUIRED:
            return None  # not even RADIO_STATUS, which may be excepted: nothing here makes use of it
        try:
            message = message_of(frame, self._reader)
        except mavlink.MAVError:
            return None
        if is_signed and self.checks_signatures and not self._signer.accepts(frame):
            return None
        if not isinstance(message, mavlink.MAVLink_unknown):
            self._heard_v2 |= is_v2
            self._speaks_v1 = not self._heard_v2
        return message

    def send(self, message: Message) -> None:
        """Queue a message of the vehicle; what MAVLink 1 cannot carry is left out on a link that speaks it."""
        frame = self._packed(message)
        if frame:
            self.tells_position |= message.get_msgId() == mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED
            self._queue(frame)

    def send_last(self, message: Message) -> None:
        """Send a message behind all that waits now, and behind what is queued until then."""
        self._last = message  # packed when it goes, for what is signed earlier must be sent earlier

    def _packed(self, message: Message) -> bytes:
        mav = self._mav
        mav.signing.sign_outgoing = self.checks_signatures and not self.speaks_v1
        if mav.signing.sign_outgoing:
            mav.signing.secret_key = self._signer.key
            mav.signing.timestamp = self._signer.next_timestamp()
        if not self.speaks_v1:
            frame = frame_of(message, mav)
        elif message.get_msgId() <= LAST_V1_ID:
            frame = _without_extensions(message, message.pack(mav, force_mavlink1=True))
        else:
            return b""
        mav.seq = (mav.seq + 1) & 0xFF
        return frame

    def forward(self, frame: bytes) -> None:
        """Queue a frame of another system as it came; never MAVLink 2 to a peer that only speaks MAVLink 1."""
        if frame[0] == MAGIC_V1 or not self.speaks_v1:
            self._queue(frame)

    def _queue(self, frame: bytes) -> None:
        if self._filling and len(self._filling) + len(frame) > MAX_DATAGRAM:
            self._waiting.append(bytes(self._filling))
            self._filling = bytearray()
        self._filling += frame

    def drain(self) -> list[bytes]:
        """Return the queued datagrams, oldest first, and forget them."""
        self.tells_position = False
        if self._filling:
            self._waiting.append(bytes(self._filling))
            self._filling = bytearray()
        if not self._waiting:
            return []
        datagrams = list(self._waiting)
        self._waiting.clear()
        return datagrams

    def closed(self, datagrams: list[bytes]) -> list[bytes]:
        """Return the datagrams with the last message behind them, if there is one, and forget it."""
        if self._last is None:
            return datagrams
        last, self._last = self._packed(self._last), None
        if last and datagrams and len(datagrams[-1]) + len(last) <= MAX_DATAGRAM:
            return [*datagrams[:-1], datagrams[-1] + last]
        return [*datagrams, last] if last else datagrams


def _frame_length(data: bytes, at: int) -> int:
    """Return the length of the frame that begins at `at`; 0 where it asks for what nobody here can do."""
    if data[at] == MAGIC_V1:
        return data[at + 1] + _V1_OVERHEAD
    flags = data[at + 2]
    if flags & ~SIGNED_FLAG:
        return 0
    return data[at + 1] + _V2_OVERHEAD + (SIGNATURE_LENGTH if flags else 0)


def _without_extensions(message: Message, frame: bytes) -> bytes:
    """Cut a MAVLink 1 frame, as pymavlink packs it, to the fields that MAVLink 1 knows."""
    length = V1_PAYLOAD_LENGTHS.get(message.get_msgId(), frame[1])
    if frame[1] <= length:
        return frame
    covered = bytes((length,)) + frame[2 : _V1_HEADER + length]
    checksum = mavlink.x25crc(covered + bytes((message.crc_extra,))).crc
    return bytes((MAGIC_V1,)) + covered + pack("<H", checksum)
