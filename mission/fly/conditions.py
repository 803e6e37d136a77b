"""What a flight is made in: once a second the link and the wind; of a simulated vehicle, where it really is."""

from collections import deque
from contextlib import suppress
from typing import TYPE_CHECKING, Final

from mission.errors import GeometryError
from mission.fly.recording import Recording
from mission.geometry.geodesy import LatLon, enu_offset_m
from mission.link.session import Session

if TYPE_CHECKING:
    from mission.link.values import TruePlace

EVERY_S: Final = 1.0
_WINDOW: Final = 10
"""Losses are those of so many seconds."""


class Conditions:
    """Writes them down."""

    def __init__(self, session: Session, record: Recording) -> None:
        """Nothing was written yet."""
        self._session, self._record = session, record
        self._due_s: float | None = None
        self._true_place: TruePlace | None = None
        self._counted: deque[tuple[int, int]] = deque(maxlen=_WINDOW)

    def turn(self) -> None:
        """Write what is known, where a second of vehicle time has passed."""
        vehicle, arrival = self._session.vehicle, self._session.contact.arrival
        newest_s = vehicle.clock.newest_s
        if vehicle.true_place is not self._true_place:
            self._true_place = vehicle.true_place
            self._write_truth(newest_s)
        if newest_s is None or (self._due_s is not None and newest_s < self._due_s):
            return
        self._due_s = newest_s + EVERY_S
        self._counted.append((arrival.asked, arrival.answered))
        asked, answered = arrival.asked - self._counted[0][0], arrival.answered - self._counted[0][1]
        self._record.write(
            "conditions",
            newest_s,
            delay_s=round(arrival.measured_s, 4) if arrival.answered else None,
            # The last one may be on its way still.
            lost=round(max(0.0, 1.0 - (answered + 1) / asked), 3) if asked else None,
            wind_m_s=None if vehicle.wind is None else round(vehicle.wind.speed_m_s, 2),
            wind_from_deg=None if vehicle.wind is None else round(vehicle.wind.from_deg, 1),
        )

    def _write_truth(self, newest_s: float | None) -> None:
        """Write where it really is, once it is known where the mission lies in its frame."""
        place, origin, guidance = self._true_place, self._session.vehicle.origin, self._session.guidance
        if place is None or origin is None or guidance is None:
            return
        with suppress(GeometryError):  # a place that is none, or is far away
            east, north = enu_offset_m(
                LatLon(origin.latitude_deg, origin.longitude_deg), LatLon(place.latitude_deg, place.longitude_deg)
            )
            true_m = guidance.anchor.to_domain((north, east, 0.0))[:2]
            self._record.write("truth", newest_s, m=[round(part, 3) for part in true_m])
