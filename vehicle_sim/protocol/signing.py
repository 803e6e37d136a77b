"""MAVLink 2 signing: one key, the timestamps given with it, and the streams heard with it.

https://mavlink.io/en/guide/message_signing.html: a signature is the first 48 bits of the SHA-256 of the key, the frame
and the timestamp; timestamps count 10 microseconds since 2015-01-01 and rise within each stream (system, component,
link id). pymavlink's own check notes the timestamp of a frame before it knows whether the signature is right, so that
one forged frame from the future locks a stream out; here nothing is noted of a frame that is not accepted.
"""

from collections.abc import Callable
from hashlib import sha256
from hmac import compare_digest
from typing import Final

from vehicle_sim.protocol.dialect import MAGIC_V2

KEY_LENGTH: Final = 32
SIGNATURE_LENGTH: Final = 13
SIGNED_FLAG: Final = 0x01
EPOCH_UNIX_S: Final = 1_420_070_400
"""2015-01-01, 00:00 UTC, in seconds since 1970: the zero of timestamps."""

TICKS_PER_S: Final = 100_000
_OLDEST: Final = 60 * TICKS_PER_S
_RESERVED: Final = 10 * TICKS_PER_S
_LAST: Final = (1 << 48) - 1
_MOST_STREAMS: Final = 256


def _no_time() -> int:
    return 0


class Signer:
    """Signs for one vehicle on all its links, and judges what comes by them.

    Attributes:
        key: 32 bytes; None while nothing is signed.
        timestamp: The highest one given or accepted so far.
        on_reserve: Called with a timestamp before any up to it is given: whoever starts again from there uses none
            twice.
    """

    def __init__(
        self,
        key: bytes | None = None,
        *,
        now: Callable[[], int] = _no_time,
        timestamp: int = 0,
        on_reserve: Callable[[int], None] | None = None,
        on_ahead: Callable[[int, int, int], None] | None = None,
    ) -> None:
        """Begin.

        Args:
            key: The secret key, None for none.
            now: The time in units of 10 microseconds since 2015-01-01.
            timestamp: What was given or accepted last, by an earlier run; nothing up to it is accepted.
            on_reserve: See the attribute.
            on_ahead: Called with system id, component id and units of 10 microseconds when somebody's clock is so far
                ahead, for the first time, that those who sign by ours are not heard any more.

        Raises:
            ValueError: The key is not of 32 bytes.
        """
        self.timestamp = timestamp
        self.on_reserve = on_reserve
        self._on_ahead = on_ahead
        self._now = now
        self._reserved = -1
        self._streams: dict[bytes, int] = {}
        self.key: bytes | None = None
        self.install(key)
        self._begun = timestamp

    def install(self, key: bytes | None, timestamp: int = 0) -> None:
        """Take another key, or none; timestamps go on from where they are, or from `timestamp` where that is later.

        Raises:
            ValueError: The key is not of 32 bytes.
        """
        if key is not None and len(key) != KEY_LENGTH:
            raise ValueError(f"a signing key has {KEY_LENGTH} bytes, not {len(key)}")
        self.key = key
        self._begun = self.timestamp  # it may be a key from before: what was accepted of that is not accepted again
        self.timestamp = max(self.timestamp, min(timestamp, _LAST))
        self._streams.clear()

    def next_timestamp(self) -> int:
        """Return the timestamp of the next frame: the time, or one more than the last where the clock is behind."""
        self._reach(min(max(self.timestamp + 1, self._now()), _LAST))
        return self.timestamp

    def finish(self) -> None:
        """Give and accept no more: the next run may begin right after what was."""
        if self.key is not None and self.on_reserve is not None:
            self.on_reserve(self.timestamp)

    def _reach(self, timestamp: int) -> None:
        self.timestamp = timestamp
        if timestamp > self._reserved and self.on_reserve is not None:
            self._reserved = timestamp + _RESERVED
            self.on_reserve(self._reserved)

    def accepts(self, frame: bytes | bytearray) -> bool:
        """Whether a signed MAVLink 2 frame is genuine and new; only then its timestamp is noted."""
        if self.key is None or frame[0] != MAGIC_V2 or not frame[2] & SIGNED_FLAG:
            return False
        if not compare_digest(sha256(self.key + frame[:-6]).digest()[:6], frame[-6:]):
            return False
        timestamp, now = int.from_bytes(frame[-12:-6], "little"), self._now()
        if timestamp + _OLDEST < max(self.timestamp, now):
            return False
        stream = bytes((frame[5], frame[6], frame[-13]))
        if stream not in self._streams and len(self._streams) >= _MOST_STREAMS:
            return False  # forgetting one would let its past be replayed
        if timestamp <= self._streams.get(stream, self._begun):
            return False
        self._streams[stream] = timestamp
        self._reach(max(self.timestamp, timestamp))
        if self._on_ahead is not None and timestamp - now > _OLDEST:
            tell, self._on_ahead = self._on_ahead, None
            tell(frame[5], frame[6], timestamp - now)
        return True
