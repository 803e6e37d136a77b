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
        self,
        key: bytes,
        now: Callable[[], int],
        *,
        begin: int = 0,
        keep: Callable[[int], None] | None = None,
        on_ahead: Callable[[tuple[int, int], int], None] | None = None,
    ) -> None:
        """Begin after an earlier run.

        Args:
            key: 32 bytes.
            now: The time in ticks since the epoch of signing.
            begin: No timestamp up to this one is used, nor accepted: an earlier run may have heard it.
            keep: Is given a bound for the timestamps to come, before any of them is used, and after the last; the next
                run begins there.
            on_ahead: Is told of the first sender, by system and component id, whose clock is so far ahead that those
                who sign by ours will not be heard any more, and of how many ticks it is ahead.
        """
        self.key = key
        self.refused = 0
        self._now, self._keep, self._on_ahead = now, keep, on_ahead
        self._begin = self._highest = begin
        self._kept = -1
        self._senders: dict[tuple[int, int, int], int] = {}

    def stamp(self) -> int:
        """The timestamp of the next frame: the present time, or later where that was used already."""
        self._reach(min(max(self._now(), self._highest + 1), _HIGHEST))
        return self._highest

    def end(self) -> None:
        """Use no more: the next run may begin right after what was used and accepted."""
        if self._keep is not None:
            self._keep(self._highest)

    def take(self, frame: bytes) -> bool:
        """Whether a whole frame is signed with the key and newer than all before it from its sender."""
        if self.is_genuine(frame):
            sender, stamp = (frame[5], frame[6], frame[-TRAILER]), int.from_bytes(frame[-12:-_HASH], "little")
            has_room = sender in self._senders or len(self._senders) < _MOST_SENDERS
            is_new = has_room and stamp > self._senders.get(sender, self._begin)
            now = self._now()
            if is_new and stamp >= max(self._highest, now) - _LATE:
                self._senders[sender] = stamp
                self._reach(max(self._highest, stamp))
                if self._on_ahead is not None and stamp - now > _LATE:
                    tell, self._on_ahead = self._on_ahead, None
                    tell(sender[:2], stamp - now)
                return True
        self.refused += 1
        return False

    def _reach(self, stamp: int) -> None:
        self._highest = stamp
        if self._keep is not None and stamp > self._kept:
            self._kept = stamp + _AHEAD
            self._keep(self._kept)

    def is_genuine(self, frame: bytes) -> bool:
        """Whether a whole frame is signed with the key, be it new or heard before."""
        if frame[0] != _V2 or not frame[2] & _SIGNED:
            return False
        digest = hashlib.sha256(self.key)
        digest.update(frame[:-_HASH])
        return hmac.compare_digest(digest.digest()[:_HASH], frame[-_HASH:])
