"""What the program is doing while nothing else is seen of it: a line on the terminal, which is gone when that is done.

Modules are loaded and missions planned for seconds on a slow machine. This loads hardly anything itself, and has no
thread, so the line stands at once. On what is no terminal it is not written: what is to stay has other lines.
"""

import os
import shutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from mission.printable import printable

_said: list[str] = []


@contextmanager
def doing(words: str) -> Iterator[None]:
    """Say on the terminal what is being done, until it is done or has failed; nothing else may be printed meanwhile.

    What is done within it has the line until that is done.
    """
    if not _is_seen():
        yield
        return
    erase()
    # A line that is as wide as the terminal, or letters that take two columns, would go on in the next one.
    width = shutil.get_terminal_size().columns - 1
    shown = printable(f"{words} ...")
    _said.append(shown[: width if shown.isascii() else width // 2])
    try:
        _write(_said[-1])
        yield
    finally:
        erase()
        _said.pop()
        if _said:
            _write(_said[-1])


def erase() -> None:
    """Take the line away, also where the program is about to end on the spot."""
    if _said:
        blank = " " * min(2 * len(_said[-1]), shutil.get_terminal_size().columns - 1)
        _write(f"\r{blank}\r")


def _is_seen() -> bool:
    return sys.stderr is not None and sys.stderr.isatty() and os.environ.get("TERM") != "dumb"


def _write(text: str) -> None:
    with suppress(OSError, RuntimeError):  # within a handler of signals the stream may be in use
        sys.stderr.write(text)
        sys.stderr.flush()
