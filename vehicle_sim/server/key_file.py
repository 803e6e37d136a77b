"""The file of a signing key, and beside it the timestamps that must never be used again.

The file holds 32 bytes, or 64 hexadecimal digits, or a passphrase: one line of text, whose SHA-256 is the key, as
MAVProxy's `signing setup` and other ground stations have it.
"""

import os
import stat
import time
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import Final

from vehicle_sim.errors import ConfigurationError
from vehicle_sim.protocol.signing import EPOCH_UNIX_S, KEY_LENGTH, TICKS_PER_S
from vehicle_sim.server.whole_file import write_whole

_NS_PER_TICK: Final = 1_000_000_000 // TICKS_PER_S
_LONGEST: Final = 4096
_OF_OTHERS: Final = stat.S_IRWXG | stat.S_IRWXO


def signing_time() -> int:
    """Return the time of this machine in units of 10 microseconds since 2015-01-01."""
    return max(time.time_ns() // _NS_PER_TICK - EPOCH_UNIX_S * TICKS_PER_S, 0)


def key_of(content: bytes) -> bytes:
    """Return the key that a file of this content holds.

    Raises:
        ValueError: It holds none; the message says why.
    """
    try:
        text = content.decode().removesuffix("\n").removesuffix("\r")
    except UnicodeDecodeError:
        text = ""
    if text and text.isprintable():
        if len(text) == 2 * KEY_LENGTH and all(digit in "0123456789abcdefABCDEF" for digit in text):
            key = bytes.fromhex(text)
        else:
            key = sha256(text.encode()).digest()
    elif len(content) == KEY_LENGTH:
        key = content
    else:
        raise ValueError("write 32 bytes, 64 hexadecimal digits or one line with a passphrase into it")
    if not any(key):
        raise ValueError("a key of zeros means no key")
    return key


class KeyFile:
    """One key, for one vehicle or several.

    Attributes:
        key: 32 bytes.
    """

    def __init__(self, path: Path, notify: Callable[[str], None]) -> None:
        """Read it; `notify` is told if others than its owner may.

        Raises:
            ConfigurationError: It cannot be read, or holds no key.
        """
        self._path = path
        try:
            with path.open("rb") as file:
                if os.name == "posix" and os.fstat(file.fileno()).st_mode & _OF_OTHERS:
                    notify(f"the signing key {path} can be read by others: chmod 600 {path}")
                self.key = key_of(file.read(_LONGEST))
        except OSError as error:
            raise ConfigurationError(f"signing key {path}: {error.strerror or error}") from error
        except ValueError as error:
            raise ConfigurationError(f"signing key {path}: {error}") from error

    def keep_key(self, key: bytes) -> None:
        """Write another key into the file, in hexadecimal digits, for its owner alone.

        Raises:
            ConfigurationError: It cannot be written.
        """
        try:
            write_whole(self._path, f"{key.hex()}\n".encode(), durable=True)
        except OSError as error:
            raise ConfigurationError(f"signing key {self._path}: {error.strerror or error}") from error

    def timestamp(self, system_id: int, component_id: int) -> int:
        """Return the timestamp from which a component may go on; 0 where it never signed.

        Raises:
            ConfigurationError: What is kept is damaged, or cannot be read.
        """
        path = self.beside(system_id, component_id)
        try:
            return int(path.read_text("ascii"))
        except FileNotFoundError:
            return 0
        except (OSError, ValueError) as error:
            raise ConfigurationError(f"{path}: no timestamp can be read from it; delete it to start anew") from error

    def keep_timestamp(self, system_id: int, component_id: int, timestamp: int) -> None:
        """Note that a component may have given timestamps up to this one.

        Raises:
            ConfigurationError: It cannot be written.
        """
        path = self.beside(system_id, component_id)
        try:
            write_whole(path, f"{timestamp}\n".encode(), durable=True)
        except OSError as error:
            raise ConfigurationError(
                f"{path}: {error.strerror or error}; signing keeps its timestamps beside the key, so put that where "
                "it can be written"
            ) from error

    def beside(self, system_id: int, component_id: int) -> Path:
        """Return where the timestamps of a component are kept."""
        return self._path.with_name(f"{self._path.name}.timestamp.{system_id}.{component_id}")
