"""A bad line: packets that are dropped, delayed, reordered, duplicated and corrupted, in vehicle time and seeded.

What goes in is what the peer sent, what comes out is what the line has made of it; nothing here knows MAVLink. On a
byte stream a packet is what was written at once.
"""

from dataclasses import dataclass
from heapq import heappop, heappush
from typing import Final

import numpy as np

MOST_WAITING: Final = 4096
"""Packets on the way, at most; a line that is full loses what is added."""

_HELD_BACK_S: Final = 0.1
"""Upper end of the time for which a reordered packet is held back, so that those after it overtake it."""

_DRAWS: Final = 7
_BLOCK: Final = 64


@dataclass(frozen=True, slots=True, kw_only=True)
class LineFaults:
    """Likelihoods that a packet is dropped, duplicated, corrupted, reordered; delay and its jitter in seconds."""

    drop: float = 0.0
    duplicate: float = 0.0
    corrupt: float = 0.0
    reorder: float = 0.0
    delay_s: float = 0.0
    jitter_s: float = 0.0

    def joined(self, other: "LineFaults") -> "LineFaults":
        """Return what both do together, each on its own."""
        return LineFaults(
            drop=1.0 - (1.0 - self.drop) * (1.0 - other.drop),
            duplicate=1.0 - (1.0 - self.duplicate) * (1.0 - other.duplicate),
            corrupt=1.0 - (1.0 - self.corrupt) * (1.0 - other.corrupt),
            reorder=1.0 - (1.0 - self.reorder) * (1.0 - other.reorder),
            delay_s=self.delay_s + other.delay_s,
            jitter_s=self.jitter_s + other.jitter_s,
        )


CLEAR: Final = LineFaults()
"""A line that only passes on."""


class Line:
    """One direction of one link: packets enter with `put` and leave with `take`."""

    def __init__(self, seed: int, number: int) -> None:
        """Begin empty; `number` is another one for each line of the vehicle."""
        self._generator = np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=(100, number))))
        self._luck: list[list[float]] = []
        self._waiting: list[tuple[int, int, bytes]] = []
        self._count = 0
        self._last_us = 0

    @property
    def is_empty(self) -> bool:
        """Whether nothing is on its way."""
        return not self._waiting

    def put(self, packet: bytes, now_us: int, faults: LineFaults) -> None:
        """Send `packet` down the line now."""
        if not self._luck:
            # Every packet takes the same number of draws, so its fate depends on its place in the stream alone.
            self._luck = self._generator.random((_BLOCK, _DRAWS)).tolist()[::-1]
        dropped, doubled, corrupted, reordered, late, held, where = self._luck.pop()
        if dropped < faults.drop:
            return
        due_us = now_us + round((faults.delay_s + faults.jitter_s * late) * 1e6)
        if reordered < faults.reorder:
            due_us += round(held * _HELD_BACK_S * 1e6)
        else:
            # What is not reordered keeps its order, whatever the jitter.
            due_us = self._last_us = max(due_us, self._last_us)
        if corrupted < faults.corrupt and packet:
            bit = int(where * 8 * len(packet))
            broken = bytearray(packet)
            broken[bit >> 3] ^= 1 << (bit & 7)
            packet = bytes(broken)
        for _ in range(2 if doubled < faults.duplicate else 1):
            if len(self._waiting) < MOST_WAITING:
                self._count += 1
                heappush(self._waiting, (due_us, self._count, packet))

    def take(self, now_us: int) -> list[bytes]:
        """Return the packets that have come through by now, and forget them."""
        arrived = []
        while self._waiting and self._waiting[0][0] <= now_us:
            arrived.append(heappop(self._waiting)[2])
        return arrived
