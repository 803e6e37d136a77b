"""All that goes over a link, in both directions, as ground stations log it (.tlog).

Before each frame, as it was on the wire, stands a big-endian 64-bit count of microseconds since 1970. That is what
MAVProxy and QGroundControl write, and what they and pymavlink read.
"""

from collections.abc import Callable, Iterable
from contextlib import suppress
from typing import Final

from mission.growing_file import GrowingFile
from mission.link.framing import frame_size, split
from mission.link.transport import Transport

STAMP: Final = 8
"""Bytes of the count before a frame."""


class LoggedLink:
    """A link that logs what it carries; what cannot be logged, as on a full disk, is carried all the same."""

    def __init__(self, transport: Transport, log: GrowingFile, utc_us: Callable[[], int]) -> None:
        """Carry what ``transport`` does, and log it in ``log``, with what ``utc_us`` says that the time is."""
        self._transport, self._log, self._utc_us = transport, log, utc_us

    def send(self, data: bytes) -> None:
        """Send one or more whole frames.

        Raises:
            LinkError: The link is closed or broken; what was not sent is not logged.
        """
        self._transport.send(data)
        self._note((data,))

    def receive(self, within_s: float) -> list[bytes]:
        """Take what has arrived.

        Raises:
            LinkError: The link is broken, and all that had arrived before was taken.
        """
        pieces = self._transport.receive(within_s)
        self._note(pieces)
        return pieces

    def close(self) -> None:
        """Close the link; the log is left to whoever opened it."""
        self._transport.close()

    def _note(self, pieces: Iterable[bytes]) -> None:
        stamp = self._utc_us().to_bytes(STAMP, "big")
        entries = b"".join(stamp + frame for piece in pieces for frame in _frames(piece))
        if entries:
            with suppress(OSError):
                self._log.add(entries)


def whole_frames(log: bytes) -> int:
    """How many bytes of a log are of whole frames, as far as they follow each other."""
    at = 0
    while (size := frame_size(log, at + STAMP)) is not None and at + STAMP + size <= len(log):
        at += STAMP + size
    return at


def _frames(piece: bytes) -> list[bytes]:
    """The frames of a piece by their own lengths, of any dialect; of one with noise in it, those that a checksum finds.

    What belongs to no frame would make the log unreadable from there on.
    """
    frames, at = [], 0
    while at < len(piece):
        size = frame_size(piece, at)
        if size is None or at + size > len(piece):
            return [frame.data for frame in split(piece)[0]]
        frames.append(piece[at : at + size])
        at += size
    return frames
