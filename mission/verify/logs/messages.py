"""The messages of a log one after the other, of whatever format, read a part at a time; damage costs what is in it."""

from collections.abc import Callable, Iterator
from typing import BinaryIO, Final

_CHUNK: Final = 1 << 20


class Messages:
    """The messages of a log.

    Args:
        stream: Its bytes.
        longest: Length of the longest message, bytes.
        least: So few bytes at the end are none, and do not count as damaged.
        size: How long the message is that begins at a place; None where none does.
        followed: Whether what begins at a place can follow a message, or nothing does.
        onward: Where the next message may begin, after a place at which none does.

    Attributes:
        skipped: Bytes that belong to none.
    """

    def __init__(
        self,
        stream: BinaryIO,
        longest: int,
        least: int,
        *,
        size: Callable[[bytes, int], int | None],
        followed: Callable[[bytes, int], bool],
        onward: Callable[[bytes, int], int],
    ) -> None:
        self.skipped = 0
        self._stream, self._longest, self._least = stream, longest, least
        self._size, self._followed, self._onward = size, followed, onward

    def __iter__(self) -> Iterator[bytes]:
        """Each with its header."""
        data, at, ended = b"", 0, False
        while True:
            if not ended and len(data) - at < 2 * self._longest:
                more = self._stream.read(_CHUNK)
                ended = not more
                data, at = data[at:] + more, 0
                continue
            if len(data) - at < self._least:
                return
            size = self._size(data, at)
            stop = at + (size or 0)
            if ended and size is not None and stop > len(data):
                return  # the last one is cut, as in most logs
            if size is not None and self._followed(data, stop):
                yield data[at:stop]
            else:
                stop = self._onward(data, at)
                self.skipped += stop - at
            at = stop
