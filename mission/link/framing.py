"""MAVLink frames in bytes that may be damaged: what a checksum vouches for, and nothing else.

https://mavlink.io/en/guide/serialization.html. Noise may look like the beginning of a frame, and a damaged length lies
about where a frame ends; so a length is believed only with the checksum that covers it, and where that is wrong the
search goes on one byte later. A frame whose message the dialect does not have cannot be checked: it is passed over
byte by byte too, for what it seems to cover may be frames.
"""

import re
from typing import Final, NamedTuple

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.link.signing import TRAILER

_V1, _V2 = mavlink.PROTOCOL_MARKER_V1, mavlink.PROTOCOL_MARKER_V2
_MAGIC: Final = re.compile(b"[%c%c]" % (_V1, _V2))
_V1_HEADER: Final = 6
_V2_HEADER: Final = 10
_V1_SYSTEM: Final = 3
_V2_SYSTEM: Final = 5
_CHECKSUM: Final = 2
_SIGNED: Final = 1
LONGEST_FRAME: Final = _V2_HEADER + 255 + _CHECKSUM + TRAILER
_EXTRA: Final = {int(number): bytes((kind.crc_extra,)) for number, kind in mavlink.mavlink_map.items()}


class Frame(NamedTuple):
    """One whole frame: the number of its message, and all its bytes."""

    number: int
    data: bytes

    @property
    def sender(self) -> bytes:
        """The system and the component that it says that it comes from, a byte each."""
        at = _V1_SYSTEM if self.data[0] == _V1 else _V2_SYSTEM
        return self.data[at : at + 2]

    @property
    def payload(self) -> bytes:
        """What its message is unpacked from, without the zeros that were cut off its end."""
        begin = _V1_HEADER if self.data[0] == _V1 else _V2_HEADER
        return self.data[begin : begin + self.data[1]]

    @property
    def component_id(self) -> int:
        """Which component it says that it comes from."""
        return self.sender[1]


def split(data: bytes, *, goes_on: bool = False) -> tuple[list[Frame], int]:
    """Find the frames in what was received.

    Args:
        data: A datagram, or what has come of a stream.
        goes_on: Whether more bytes follow, so that a frame at the end may not be whole yet. A datagram stands alone.

    Returns:
        The frames of the dialect with right checksums, in order; and up to where ``data`` has been judged, which is
        its end unless it goes on and may end within a frame.
    """
    frames: list[Frame] = []
    at, end = 0, len(data)
    while (found := _MAGIC.search(data, at)) is not None:
        at = found.start()
        header = _V2_HEADER if data[at] == _V2 else _V1_HEADER
        if end - at >= header:
            number, flags = _number_and_flags(data, at)
            extra = _EXTRA.get(number)
            covered = at + header + data[at + 1]
            stop = covered + _CHECKSUM + (TRAILER if flags else 0)
            if extra is None or flags & ~_SIGNED:
                at += 1
                continue
            if stop <= end:
                if mavlink.x25crc(data[at + 1 : covered] + extra).crc == data[covered] | data[covered + 1] << 8:
                    frames.append(Frame(number, data[at:stop]))
                    at = stop
                else:
                    at += 1
                continue
        if goes_on:
            return frames, at
        at += 1
    return frames, end


def frame_size(data: bytes, at: int) -> int | None:
    """How long the frame is that begins there, by its own word, which no checksum vouches for; None where none does."""
    if len(data) < at + 3:
        return None
    magic, length, flags = data[at : at + 3]
    if magic == _V1:
        return _V1_HEADER + int(length) + _CHECKSUM
    if magic == _V2:
        return _V2_HEADER + int(length) + _CHECKSUM + (TRAILER if flags & _SIGNED else 0)
    return None


def _number_and_flags(data: bytes, at: int) -> tuple[int, int]:
    """The message and the incompatibility flags in the header that begins there; MAVLink 1 has no flags."""
    if data[at] == _V1:
        return data[at + 5], 0
    return data[at + 7] | data[at + 8] << 8 | data[at + 9] << 16, data[at + 2]


class Stream:
    """Cuts a stream of bytes where no frame is open, so that each piece stands alone as a datagram does."""

    def __init__(self) -> None:
        """Begin with a peer that has not sent anything yet."""
        self._rest = b""

    def take(self, data: bytes) -> bytes:
        """What has arrived and can be judged; the rest, less than one frame, waits for what follows."""
        data = self._rest + data
        _, judged = split(data, goes_on=True)
        self._rest = data[judged:]
        return data[:judged]
