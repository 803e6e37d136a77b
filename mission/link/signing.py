"""Signed packets: proof that a frame comes from a holder of the key, and was not heard before.

https://mavlink.io/en/guide/message_signing.html. A signed MAVLink 2 frame ends in a link id, a timestamp in units of 10
microseconds since 2015-01-01, and 48 bits of the SHA-256 of key and frame. Time is an argument, given as a function.
"""

import hashlib
import hmac
from collections.abc import Callable
from typing import Final

TICKS_PER_S: Final = 100_000
EPOCH_UNIX_S: Final = 1_420_070_400
"""2015-01-01, 00:00 UTC, the zero of timestamps."""

TRAILER: Final = 13
_HASH: Final = 6
_V2: Final = 0xFD
_SIGNED: Final = 0x01
_LATE: Final = 60 * TICKS_PER_S
_AHEAD: Final = 10 * TICKS_PER_S
_HIGHEST: Final = 2**48 - 1
_MOST_SENDERS: Final = 64


class Signatures:
    """The ground side's use of one key: timestamps for what goes out, a judgement of what comes in.

    Attributes:
        key: 32 bytes.
        refused: Frames that were not accepted so far.
    """

    def __init__(
        self, key: bytes, now: Callable[[], int], *, begin: int = 0, keep: Callable[[int], None] | None = None
    ) -> None:
        """Begin after an earlier run.

        Args:
            key: 32 bytes.
            now: The time in ticks since the epoch of signing.
            begin: No timestamp up to this one is used.
            keep: Is given a bound for the timestamps to come, before any of them is used; the next run begins there.
        """
        self.key = key
        self.refused = 0
        self._now, self._keep = now, keep
        self._highest = begin
        self._kept = -1
        self._senders: dict[tuple[int, int, int], int] = {}

    def stamp(self) -> int:
        """The timestamp of the next frame: the present time, or later where that was used already."""
        self._highest = min(max(self._now(), self._highest + 1), _HIGHEST)
        if self._keep is not None and self._highest > self._kept:
            self._kept = self._highest + _AHEAD
            self._keep(self._kept)
        return self._highest

    def take(self, frame: bytes) -> bool:
        """Whether a whole frame is signed with the key and newer than all before it from its sender."""
        if self.is_genuine(frame):
            sender, stamp = (frame[5], frame[6], frame[-TRAILER]), int.from_bytes(frame[-12:-_HASH], "little")
            known = self._senders.get(sender)
            is_new = stamp > known if known is not None else len(self._senders) < _MOST_SENDERS
            if is_new and stamp >= max(self._highest, self._now()) - _LATE:
                self._senders[sender] = stamp
                self._highest = max(self._highest, stamp)
                return True
        self.refused += 1
        return False

    def is_genuine(self, frame: bytes) -> bool:
        """Whether a whole frame is signed with the key, be it new or heard before."""
        if frame[0] != _V2 or not frame[2] & _SIGNED:
            return False
        digest = hashlib.sha256(self.key)
        digest.update(frame[:-_HASH])
        return hmac.compare_digest(digest.digest()[:_HASH], frame[-_HASH:])
