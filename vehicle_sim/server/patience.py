"""When vehicle time waits for whoever flies the vehicle.

At many times real time, a moment in which the machine lets a client pause is seconds of the vehicle's, and its
failsafes would answer for the machine. So the vehicle never flies on by a setpoint that is old by its own clock, nor
without the heartbeats of a client that keeps up with it: vehicle time stands still until the next one is there. What
comes seldom by the vehicle's clock, as the heartbeat of a ground station that goes by the clock on the wall, is no
stream and not waited for. The wait is bounded: a stream that has ended is given up, and vehicle time goes on to
whatever failsafe is due.

Both clocks are arguments: vehicle time tells how late a message is, wall time how long it has been waited for.
"""

from dataclasses import dataclass
from enum import Enum
from typing import Final, NamedTuple

_LESS_STRICT: Final = 4.0
_MOST_STREAMS: Final = 64


class StreamKind(Enum):
    """What is waited for.

    Attributes:
        late_s: Vehicle time after which the next message is late.
        break_s: Vehicle time without a message that is no part of a stream.
        stream_after: How many gaps shorter than that make a stream.
    """

    HEARTBEAT = (2.0, 1.5, 3)
    SETPOINT = (0.15, 3.0, 1)

    def __init__(self, late_s: float, break_s: float, stream_after: int) -> None:
        """Take the three; heartbeats come once a second, and the second setpoint already tells of a stream."""
        self.late_s = late_s
        self.break_s = break_s
        self.stream_after = stream_after


class Source(NamedTuple):
    """Where a stream comes from: the link, and the MAVLink ids of the sender."""

    link: str
    system_id: int
    component_id: int
    kind: StreamKind


@dataclass(slots=True)
class _Stream:
    """One stream: when it was last heard, of how many gaps it is, and after how long its next message is late."""

    heard_s: float
    kind: StreamKind
    late_s: float
    gaps: int = 0

    def hear(self, vehicle_s: float) -> None:
        if 0.0 < vehicle_s - self.heard_s <= self.kind.break_s:  # what came in one burst tells nothing
            self.gaps += 1
        self.heard_s = vehicle_s

    def is_late(self, vehicle_s: float) -> bool:
        return self.gaps >= self.kind.stream_after and vehicle_s - self.heard_s >= self.late_s

    def give_up(self) -> None:
        """Wait for it no more; one that comes again has to show anew that it is one, and may be slower by design."""
        self.gaps = 0
        self.late_s *= _LESS_STRICT


class Patience:
    """Decides whether vehicle time waits.

    Attributes:
        waited_s: Wall time for which it has waited in all.
    """

    def __init__(self, most_s: float) -> None:
        """Wait at most this long, in wall time, for any message; 0 never waits.

        Raises:
            ValueError: The time is negative or not a number.
        """
        if not most_s >= 0.0:
            raise ValueError("patience is a time, and not negative")
        self.waited_s = 0.0
        self._most_s = most_s
        self._streams: dict[Source, _Stream] = {}
        self._since_s: float | None = None
        self._looked_s = 0.0

    def hear(self, source: Source, vehicle_s: float) -> None:
        """Note a message of a stream."""
        stream = self._streams.get(source)
        if stream is not None:
            stream.hear(vehicle_s)
            return
        if len(self._streams) >= _MOST_STREAMS:
            del self._streams[min(self._streams, key=lambda known: self._streams[known].heard_s)]
        self._streams[source] = _Stream(vehicle_s, source.kind, source.kind.late_s)

    def waits(self, vehicle_s: float, now_s: float, *, by_setpoints: bool) -> bool:
        """Return whether vehicle time stands still now.

        Args:
            vehicle_s: Vehicle time.
            now_s: Wall time.
            by_setpoints: Whether the vehicle flies by setpoints now; else the end of their stream is meant.
        """
        late = [
            stream
            for source, stream in self._streams.items()
            if (by_setpoints or source.kind is StreamKind.HEARTBEAT) and stream.is_late(vehicle_s)
        ]
        if self._since_s is not None:
            self.waited_s += now_s - self._looked_s
        self._looked_s = now_s
        if not late:
            self._since_s = None
            return False
        if self._since_s is None:
            self._since_s = now_s
        if now_s - self._since_s < self._most_s:
            return True
        self._since_s = None
        for stream in late:
            stream.give_up()
        return False
