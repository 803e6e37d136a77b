"""What a flight is made in, written down once a second: how long the link takes, what it loses, and the wind."""

from collections import deque
from typing import Final

from mission.fly.recording import Recording
from mission.link.session import Session

EVERY_S: Final = 1.0
_WINDOW: Final = 10
"""Losses are those of so many seconds."""


class Conditions:
    """Writes them down."""

    def __init__(self, session: Session, record: Recording) -> None:
        """Nothing was written yet."""
        self._session, self._record = session, record
        self._due_s: float | None = None
        self._counted: deque[tuple[int, int]] = deque(maxlen=_WINDOW)

    def turn(self) -> None:
        """Write what is known, where a second of vehicle time has passed."""
        vehicle, arrival = self._session.vehicle, self._session.contact.arrival
        newest_s = vehicle.clock.newest_s
        if newest_s is None or (self._due_s is not None and newest_s < self._due_s):
            return
        self._due_s = newest_s + EVERY_S
        self._counted.append((arrival.asked, arrival.answered))
        asked, answered = arrival.asked - self._counted[0][0], arrival.answered - self._counted[0][1]
        self._record.write(
            "conditions",
            newest_s,
            delay_s=round(arrival.measured_s, 4) if arrival.answered else None,
            lost=round(max(0.0, 1.0 - answered / asked), 3) if asked else None,
            wind_m_s=None if vehicle.wind is None else round(vehicle.wind.speed_m_s, 2),
            wind_from_deg=None if vehicle.wind is None else round(vehicle.wind.from_deg, 1),
        )
