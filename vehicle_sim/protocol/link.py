"""One MAVLink link: bytes of its peer to messages, messages to datagrams.

MAVLink 2 serialisation: https://mavlink.io/en/guide/serialization.html. A link starts in MAVLink 2; it falls back to
MAVLink 1 for a peer that was heard to speak only that, and returns for good with the first MAVLink 2 frame.
"""

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
from vehicle_sim.protocol.framing import frame_of
from vehicle_sim.protocol.streams import StreamSchedule

MAX_DATAGRAM: Final = 1400
"""Bytes of MAVLink put into one datagram: under any usual MTU."""

_MAX_WAITING: Final = 1024
_V1_HEADER: Final = 6


class Link:
    """Parser, serialiser and stream schedule of one peer.

    Attributes:
        name: What the user and the routing call it.
        streams: When which message is due on it.
    """

    def __init__(self, name: str, *, system_id: int, byte_stream: bool = False) -> None:
        """Open the link.

        Args:
            name: Unique among the links of an endpoint.
            system_id: System id of the vehicle, the source of what is sent.
            byte_stream: Whether a frame may be split between two receptions (TCP, serial); a datagram is whole.
        """
        self.name = name
        self.streams = StreamSchedule()
        self._byte_stream = byte_stream
        self._mav = mavlink.MAVLink(None, srcSystem=system_id, srcComponent=AUTOPILOT_COMPONENT)
        self._mav.robust_parsing = True
        self._speaks_v1 = False
        self._heard_v2 = False
        self._filling = bytearray()
        self._waiting: deque[bytes] = deque(maxlen=_MAX_WAITING)  # a peer that never reads loses the oldest

    @property
    def speaks_v1(self) -> bool:
        """Whether the peer is answered in MAVLink 1."""
        return self._speaks_v1

    def decode(self, data: bytes) -> list[Message]:
        """Return the valid messages of the dialect in what was received; all else is dropped.

        pymavlink's parser takes the length byte of a false start on trust and skips what it covers. Here parsing
        resumes one byte after each false start, so that noise never swallows a frame that follows it.
        """
        mav = self._mav
        messages: list[Message] = []
        message = mav.parse_char(data)
        while True:
            if message is None:
                left = b"" if self._byte_stream else bytes(mav.buf[mav.buf_index + 1 :])
                if not self._byte_stream:
                    mav.buf, mav.buf_index = bytearray(), 0
                if not left:
                    return messages
                message = mav.parse_char(left)
                continue
            if isinstance(message, mavlink.MAVLink_bad_data):
                self._resume_after(message.data)
            elif isinstance(message, mavlink.MAVLink_unknown):
                self._resume_after(message.get_msgbuf() or message.data)
            else:
                self._note_version(message)
                messages.append(message)
            message = mav.parse_char(b"")

    def _resume_after(self, false_start: bytes) -> None:
        if not false_start or false_start[0] not in (MAGIC_V1, MAGIC_V2):
            return
        mav = self._mav
        if mav.buf_index:
            mav.buf_index -= len(false_start) - 1
        else:
            mav.buf = bytearray(false_start[1:])

    def _note_version(self, message: Message) -> None:
        if message.get_msgbuf()[0] == MAGIC_V2:
            self._heard_v2, self._speaks_v1 = True, False
        elif not self._heard_v2:
            self._speaks_v1 = True

    def send(self, message: Message) -> None:
        """Queue a message of the vehicle; what MAVLink 1 cannot carry is left out on a link that speaks it."""
        mav = self._mav
        if not self._speaks_v1:
            frame = frame_of(message, mav)
        elif message.get_msgId() <= LAST_V1_ID:
            frame = _without_extensions(message, message.pack(mav, force_mavlink1=True))
        else:
            return
        mav.seq = (mav.seq + 1) & 0xFF
        self._queue(frame)

    def forward(self, frame: bytes) -> None:
        """Queue a frame of another system as it came; never MAVLink 2 to a peer that only speaks MAVLink 1."""
        if frame[0] == MAGIC_V1 or not self._speaks_v1:
            self._queue(frame)

    def _queue(self, frame: bytes) -> None:
        if self._filling and len(self._filling) + len(frame) > MAX_DATAGRAM:
            self._waiting.append(bytes(self._filling))
            self._filling = bytearray()
        self._filling += frame

    def drain(self) -> list[bytes]:
        """Return the queued datagrams, oldest first, and forget them."""
        if self._filling:
            self._waiting.append(bytes(self._filling))
            self._filling = bytearray()
        if not self._waiting:
            return []
        datagrams = list(self._waiting)
        self._waiting.clear()
        return datagrams


def _without_extensions(message: Message, frame: bytes) -> bytes:
    """Cut a MAVLink 1 frame, as pymavlink packs it, to the fields that MAVLink 1 knows."""
    length = V1_PAYLOAD_LENGTHS.get(message.get_msgId(), frame[1])
    if frame[1] <= length:
        return frame
    covered = bytes((length,)) + frame[2 : _V1_HEADER + length]
    checksum = mavlink.x25crc(covered + bytes((message.crc_extra,))).crc
    return bytes((MAGIC_V1,)) + covered + pack("<H", checksum)
