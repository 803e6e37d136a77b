"""Listening without forgetting to speak: one turn handles what has arrived until something is due.

Where speaking takes so long that something is always due, listening has as much time as the rest of a turn, and what
is due waits for that. Otherwise what waits to be handled would grow without end: each setpoint lets a simulator that
waits for setpoints go on, and say more than is handled between two of them.
"""

from typing import Final

from mission.clock import Clock
from mission.errors import LinkError
from mission.link.session import Session
from mission.link.transport import Transport

BEHIND_S: Final = 0.2
"""A flight that handles what the vehicle said this long ago, by the vehicle's time, does not keep up with it."""

_CAUGHT_UP: Final = 0.5
_AT_ONCE_S: Final = 1e-3
_LISTEN_S: Final = 0.05
"""The link is looked at this often, however much waits to be handled: what is out of date need not be handled."""


class Listening:
    """What is heard of the vehicle, and how far behind it this is.

    Attributes:
        behind_s: Vehicle time that what was handled last had waited.
        largest_behind_s: The largest of the flight.
        is_behind: Whether that is too much now.
    """

    def __init__(self, session: Session, clock: Clock) -> None:
        """Listen for a session, by the clock here."""
        self._session, self._clock = session, clock
        self._looked_s = clock.now_s()
        self._turned_s: float | None = None
        self.behind_s = self.largest_behind_s = 0.0
        self.is_behind = False
        self._rate = 1.0

    def turn(self, transport: Transport) -> bool:
        """Wait for messages and handle them until something is due.

        Returns:
            False where nothing has come and no time has passed, as in lock-step: then nothing can be due.

        Raises:
            LinkError: The link is broken.
            VehicleError: It is no vehicle that can be flown from here, or moved its origin in flight.
        """
        session, now_s = self._session, self._clock.now_s()
        spoke_s = 0.0 if self._turned_s is None else min(now_s - self._turned_s, _LISTEN_S)
        if not session.contact.inbox or now_s - self._looked_s >= _LISTEN_S:
            self._look(transport, now_s)
        heard, now_s = len(session.contact.inbox) > 0, self._clock.now_s()
        late_s, until_s = 0.0, now_s + spoke_s
        while session.contact.inbox:
            session.hear(now_s)
            late_s = max(late_s, session.contact.late_s)
            now_s = self._clock.now_s()
            if now_s >= until_s and session.wait_s(now_s) <= 0.0:
                break
        self._judge(late_s)
        passed, self._turned_s = now_s != self._turned_s, now_s
        return heard or passed

    def excuse(self) -> None:
        """Let what came up to now be no later than now: it waited for planning, not for want of time."""
        self._looked_s = self._clock.now_s()

    def _look(self, transport: Transport, now_s: float) -> None:
        before_s = self._looked_s
        try:
            pieces = transport.receive(0.0 if self._session.contact.inbox else self._session.wait_s(now_s))
        except LinkError:
            if not self._session.contact.inbox:
                raise
            pieces = []  # first what the vehicle said before
        self._looked_s = self._clock.now_s()
        # What was there at once has come since the last look, evenly as far as is known here.
        since_s = before_s if self._looked_s - now_s < _AT_ONCE_S else self._looked_s
        for number, piece in enumerate(pieces, 1):
            self._session.contact.listen(piece, since_s + (self._looked_s - since_s) * number / len(pieces))

    def _judge(self, late_s: float) -> None:
        if late_s < _LISTEN_S:  # what is handled late seems to come slower or faster than it did
            self._rate = max(self._session.vehicle.clock.rate, 1.0)
        self.behind_s = late_s * self._rate
        self.largest_behind_s = max(self.largest_behind_s, self.behind_s)
        self.is_behind = self.behind_s > (_CAUGHT_UP * BEHIND_S if self.is_behind else BEHIND_S)
