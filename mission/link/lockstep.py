"""A link to a vehicle whose time stands still until it has been answered, and the clock that goes with it.

Such a vehicle ends each turn of its time with a PING, and begins the next one when that is answered. Here a turn is
taken as a whole, and the clock shows the time that the PING told. So whatever is decided by this clock is decided by
vehicle time alone, and neither the speed at which that passes nor what else this machine does can change a flight.
"""

from typing import TYPE_CHECKING, Final

from mission.clock import Clock
from mission.link.messages import asked_last
from mission.link.transport import Transport

if TYPE_CHECKING:
    from mission.link.values import Ping

STILL_S: Final = 10.0
"""Wall time that may pass within one turn: a vehicle that lets more pass hangs, and the clock here goes on alone."""

_LOOK_S: Final = 0.1


class LockstepLink:
    """Transport and clock in one."""

    def __init__(self, transport: Transport, wall: Clock) -> None:
        """Begin at 0, with the first turn; ``transport`` gives whole frames, and is closed by whoever opened it."""
        self._transport, self._wall = transport, wall
        self._ahead_s = self._told_s = 0.0
        self._since_s = wall.now_s()
        self._last: Ping | None = None
        self._pieces: list[bytes] = []

    def now_s(self) -> float:
        """Vehicle time at the end of the last turn, and what the vehicle hung."""
        return self._told_s + self._ahead_s + self._overdue_s()

    def _overdue_s(self) -> float:
        return max(self._wall.now_s() - self._since_s - STILL_S, 0.0)

    def send(self, data: bytes) -> None:
        """Send one or more whole frames.

        Raises:
            LinkError: The link is closed or broken.
        """
        self._transport.send(data)

    def receive(self, within_s: float) -> list[bytes]:
        """All of the next turn; nothing where it is not over within a moment of wall time, whatever ``within_s`` is.

        Raises:
            LinkError: The link is broken, and all that had arrived before was taken.
        """
        del within_s  # that is vehicle time, of which none passes here
        over = False
        for piece in self._transport.receive(_LOOK_S):
            ping = asked_last(piece)
            if ping is not None and ping == self._last:
                continue  # asked again, and answered already
            if ping is not None:
                self._last, over = ping, True
            self._pieces.append(piece)
        if not over or self._last is None:
            return []
        told_s = self._last.time_us * 1e-6
        # A vehicle that was restarted begins at 0 again; a clock never runs backwards.
        self._ahead_s = max(told_s + self._ahead_s + self._overdue_s(), self.now_s()) - told_s
        self._told_s, self._since_s = told_s, self._wall.now_s()
        turn, self._pieces = self._pieces, []
        return turn

    def close(self) -> None:
        """Leave the link to whoever opened it."""
