"""The standard streams of the process: what they cannot take is lost, and nothing else with it."""

import io
import os
import sys
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer

_STANDARD = (0, 1, 2)


class _Stream(io.FileIO):
    """A standard stream that fails once at most; from then on what is written goes nowhere.

    So neither a later word nor the interpreter's last flush fails once more.

    Attributes:
        failure: Why it takes nothing any more; None while it does.
    """

    def __init__(self, number: int, *, tells: bool) -> None:
        super().__init__(number, "w", closefd=False)
        self.failure: OSError | None = None
        self._tells = tells

    def write(self, data: "ReadableBuffer", /) -> int:
        if self.failure is None:
            try:
                return super().write(data)
            except OSError as error:
                self.failure = error
                if self._tells:
                    raise
        return memoryview(data).nbytes


def take_streams() -> None:
    """Take over standard output and standard error.

    Standard output raises once what stops it, so that the program learns of it; standard error never does: whoever
    cannot hear what is wrong still gets the exit code. One that is closed is like one that nobody reads, and what the
    program opens later is not taken for it.
    """
    for number in _STANDARD:
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest number that is free: this one
    sys.stdout = _taken(sys.stdout, 1, tells=True)
    sys.stderr = _taken(sys.stderr, 2, tells=False)


def output_failure() -> OSError | None:
    """Why standard output has not taken all that was written; None where it has, or was not taken over."""
    raw = _raw(sys.stdout)
    return raw.failure if isinstance(raw, _Stream) else None


def _raw(stream: TextIO | None) -> object:
    """What a text stream writes to in the end."""
    buffer = getattr(stream, "buffer", None)
    return getattr(buffer, "raw", buffer)


def _taken(stream: TextIO | None, number: int, *, tells: bool) -> TextIO:
    if stream is not None and type(_raw(stream)) is not io.FileIO:
        return stream  # a console that takes characters, not bytes
    return io.TextIOWrapper(
        io.BufferedWriter(_Stream(number, tells=tells)),
        encoding="utf-8" if stream is None else stream.encoding,
        errors="replace",  # a terminal without, say, an umlaut gets a question mark instead of an exception
        line_buffering=True,
    )
