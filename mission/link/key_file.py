"""A signing key from a file, with what must outlive the program beside it.

The file holds the key as 32 bytes or 64 hexadecimal digits, or a passphrase in one line of text: then the key is its
SHA-256, as MAVProxy makes it.
"""

import hashlib
import os
import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final

from mission.errors import Fault, SpecError, reason
from mission.link.signing import EPOCH_UNIX_S, TICKS_PER_S, Signatures
from mission.whole_file import write_whole

_KEY_BYTES: Final = 32
_HEXADECIMAL: Final = re.compile(r"[0-9A-Fa-f]{64}")
_MOST_BYTES: Final = 4096
_NOTED_TICKS: Final = 60 * TICKS_PER_S
_DAY_TICKS: Final = 86_400 * TICKS_PER_S
_FORMS: Final = "write 32 bytes, 64 hexadecimal digits, or a passphrase in one line"


def open_signatures(path: Path, who: tuple[int, int], warn: Callable[[str], None]) -> Signatures:
    """Sign with the key in a file.

    Args:
        path: The key file. Timestamps are kept in a file of its name beside it, one for each sender.
        who: Our system and component id.
        warn: Told if others may read the key, if the timestamps lie in the future, and if someone's clock does.

    Raises:
        SpecError: It is no key file, or what is beside it cannot be read or written.
    """
    try:
        with path.open("rb") as file:
            if os.name == "posix" and os.fstat(file.fileno()).st_mode & 0o077:
                warn(f"others can read the signing key; chmod 600 {path}")
            key = _key(path, file.read(_MOST_BYTES))
    except OSError as error:
        raise _fault(f"{path} cannot be read: {reason(error)}", _FORMS) from error
    stamps = path.with_name(f"{path.name}.timestamp.{who[0]}.{who[1]}")
    begin = _kept(stamps)
    _keep(stamps, begin)
    afresh = (
        "whoever signs by the right time is not heard. To begin afresh, set all clocks right, end every program with "
        f"the key, delete {stamps} and the timestamps that the others keep, and start again"
    )
    ahead = begin - _now()
    if ahead > _NOTED_TICKS:
        warn(f"the timestamps in {stamps} are {_span(ahead)} ahead of this machine's clock: {afresh}")

    def tell(sender: tuple[int, int], ticks: int) -> None:
        who = f"system {sender[0]}, component {sender[1]}"
        warn(f"{who} signs by a clock {_span(ticks)} ahead of this machine's: {afresh}")

    return Signatures(key, _now, begin=begin, keep=_Keeping(stamps, warn), on_ahead=tell)


class _Keeping:
    """Keeps timestamps while packets go out; where it cannot, it says so once: the vehicle needs the packets."""

    def __init__(self, path: Path, warn: Callable[[str], None]) -> None:
        self._path, self._warn = path, warn
        self._warned = False

    def __call__(self, stamp: int) -> None:
        try:
            _keep(self._path, stamp)
        except SpecError as error:
            if not self._warned:
                self._warned = True
                self._warn(f"{error}; until this is mended, packets of this run may be taken for new after a restart")


def _span(ticks: int) -> str:
    """A time in words."""
    return f"{ticks / _DAY_TICKS:.1f} days" if ticks >= _DAY_TICKS else f"{ticks / TICKS_PER_S / 60.0:.1f} minutes"


def _now() -> int:
    return int(time.time() * TICKS_PER_S) - EPOCH_UNIX_S * TICKS_PER_S


def _key(path: Path, content: bytes) -> bytes:
    try:
        line = content.decode().rstrip("\r\n")
    except UnicodeDecodeError:
        line = ""
    if not line.isprintable() or not line:
        key = content
    elif _HEXADECIMAL.fullmatch(line):
        key = bytes.fromhex(line)
    else:
        key = hashlib.sha256(line.encode()).digest()
    if len(key) != _KEY_BYTES or not any(key):
        raise _fault(f"{path} holds no signing key", _FORMS)
    return key


def _kept(path: Path) -> int:
    try:
        return int(path.read_text("ascii"))
    except FileNotFoundError:
        return 0
    except (OSError, ValueError) as error:
        raise _fault(f"{path} should hold a timestamp, and cannot be read", "delete it to begin anew") from error


def _keep(path: Path, stamp: int) -> None:
    try:
        write_whole(path, f"{stamp}\n", private=True, durable=False)  # in flight, nothing waits for a disk
    except OSError as error:
        hint = "timestamps are kept beside the key: put it into a folder that can be written"
        raise _fault(f"{path} cannot be written: {reason(error)}", hint) from error


def _fault(message: str, hint: str) -> SpecError:
    return SpecError((Fault(0, 0, "--signing-key", message, hint),))
