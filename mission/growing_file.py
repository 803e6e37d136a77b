"""Files that grow by whole entries: a program that is killed leaves all of them, and at most cuts the last."""

import errno
import os
from collections.abc import Callable
from io import FileIO
from pathlib import Path
from typing import Protocol, Self


class Sink(Protocol):
    """Where entries go: an unbuffered binary stream, or one in memory."""

    def write(self, data: bytes, /) -> int:
        """Take the first of these bytes at once; return how many."""

    def close(self) -> None:
        """Take no more."""


class GrowingFile:
    """Writes entries one after the other, each at once: what ``add`` returned from is out of this process.

    Attributes:
        failure: Why an entry was lost first; None where all were written.
    """

    def __init__(self, sink: Sink) -> None:
        """Go on at the end of ``sink``."""
        self.failure: OSError | None = None
        self._sink = sink
        self._rest = b""

    @classmethod
    def at(cls, path: Path, whole: Callable[[bytes], int]) -> Self:
        """Begin a file, or go on with one that is there; an entry at its end that was cut goes.

        Args:
            path: Where.
            whole: How many of a file's bytes are of whole entries.

        Raises:
            OSError: It cannot be written to.
        """
        stream = path.open("ab", buffering=0)
        stream.truncate(whole(path.read_bytes()))
        return cls(stream)

    def add(self, entry: bytes) -> None:
        """Write one entry; one that was cut by a failure is completed before, so that the file stays readable.

        Raises:
            OSError: The disk is full, say, or the file was removed; this entry is lost, or begun and completed by the
                next call.
        """
        try:
            if isinstance(self._sink, FileIO) and os.fstat(self._sink.fileno()).st_nlink == 0:
                raise FileNotFoundError(errno.ENOENT, "removed")
            self._put(b"")
            self._put(entry)
        except OSError as error:
            self.failure = self.failure or error
            raise

    def _put(self, entry: bytes) -> None:
        """Write what is left of the last entry, or else this one: whole, or begun, or not at all."""
        rest = self._rest or entry
        while rest:  # an unbuffered file may take less than it was given
            rest = rest[self._sink.write(rest) :]
            self._rest = rest

    def close(self) -> None:
        """Take no more."""
        self._sink.close()


def whole_lines(data: bytes) -> int:
    """How many bytes of a text are of lines that have their ends."""
    return data.rfind(b"\n") + 1
