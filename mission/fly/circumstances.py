"""What goes on beside a flight, told when it changes: pace, camera, geofence, clock, battery and other vehicles."""

import math
from dataclasses import asdict
from typing import Final

from mission.clock import SteadyClock
from mission.fly.listening import Listening
from mission.fly.recording import Recording
from mission.link.session import Session

FIRMWARE: Final = "firmware"
GEOFENCE: Final = "geofence"
GEOFENCE_RENEWED: Final = "geofence renewed"


class Circumstances:
    """Tells of them."""

    def __init__(self, session: Session, listening: Listening, clock: SteadyClock, record: Recording) -> None:
        """Nothing was told yet."""
        self._session, self._listening, self._clock, self._record = session, listening, clock, record
        self._behind = self._warned_behind = self._troubled = self._fenced = self._unfenced = False
        self._left_out_s = 0.0
        self._percent = 0
        self._others: set[int] = set()

    def turn(self) -> None:
        """Tell what is new."""
        newest_s = self._session.vehicle.clock.newest_s
        self._tell_pace(newest_s)
        self._tell_trouble()
        self._tell_fence(newest_s)
        self._tell_leap(newest_s)
        self._tell_charge(newest_s)
        self._tell_company(newest_s)

    def _tell_pace(self, newest_s: float | None) -> None:
        """Say when this computer begins not to keep up with the vehicle, and when it has caught up again."""
        listening = self._listening
        if listening.is_behind == self._behind:
            return
        self._behind = listening.is_behind
        self._record.write(
            "event",
            newest_s,
            name="this computer does not keep up" if listening.is_behind else "this computer keeps up again",
            behind_s=listening.behind_s,
            largest_behind_s=listening.largest_behind_s,
            left_out=self._session.contact.inbox.left_out,
        )
        if listening.is_behind and not self._warned_behind:
            self._warned_behind = True
            self._record.warn(
                f"this computer does not keep up: it is {listening.behind_s:.1f} s behind what the vehicle says"
            )

    def _tell_trouble(self) -> None:
        """Say at once when something goes wrong with the camera."""
        trouble = self._session.contact.photography.trouble
        if trouble and not self._troubled:
            self._troubled = True
            self._record.warn(f"{trouble}; the flight goes on")

    def _tell_fence(self, newest_s: float | None) -> None:
        """Write down what the vehicle's geofence was, before anything of it is changed, and what it is to be."""
        guard = self._session.contact.fence
        if guard is not None and guard.is_set and guard.failure is not None and not self._unfenced:
            self._unfenced = True
            self._record.warn(f"the vehicle may have no geofence now: {guard.failure}; the flight goes on")
        if guard is None or guard.before is None or self._fenced:
            return
        self._fenced = True
        if (theirs := len(guard.before.items)) and not guard.is_set:
            self._record.warn(f"the vehicle's own geofence, of {theirs} items, gives way to that of this mission")
        self._record.write(
            "event",
            newest_s,
            name=GEOFENCE,
            parameters_before=guard.before.parameters,
            items_before=[asdict(item) for item in guard.before.items],
            parameters=guard.parameters,
            items=[asdict(item) for item in guard.items],
        )

    def _tell_leap(self, newest_s: float | None) -> None:
        """Say that this program stood still, or that its clock was set."""
        leapt_s = self._clock.left_out_s - self._left_out_s
        if leapt_s > 0.0:
            self._left_out_s = self._clock.left_out_s
            self._record.write("event", newest_s, name="this computer stood still", for_s=leapt_s)

    def _tell_charge(self, newest_s: float | None) -> None:
        """Write down what is left of the battery, each per cent once."""
        battery, health = self._session.vehicle.battery, self._session.vehicle.health
        percent = battery.percent if battery is not None else None
        if percent is None and health is not None and health.battery_percent >= 0:
            percent = float(health.battery_percent)
        if percent is not None and math.ceil(percent) != self._percent:
            self._percent = math.ceil(percent)
            drawn_mah = None if battery is None else battery.consumed_mah
            self._record.write("charge", newest_s, percent=percent, drawn_mah=drawn_mah)

    def _tell_company(self, newest_s: float | None) -> None:
        """Say which other vehicles are heard; aloud where that is news after the check before the flight."""
        session, contact = self._session, self._session.contact
        new = contact.company.systems - {contact.system_id} - self._others
        if contact.autopilot is None or not new:
            return
        self._others |= new
        self._record.write("event", newest_s, name="other vehicles are heard", system_ids=sorted(new))
        if session.departed and not contact.options.vehicle_id:
            also = ", ".join(map(str, sorted(new)))
            self._record.warn(
                f"vehicles of other system ids are heard now: {also}; the flight stays with {contact.system_id}"
            )
