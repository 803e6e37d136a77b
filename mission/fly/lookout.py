"""When a flight is given up because going on would be wrong, from what has been so for a while."""

import math
from typing import Final

from mission.fly.by_field import is_sealed
from mission.fly.watch import FlightWatch
from mission.link.guidance import Guidance
from mission.link.session import Session
from mission.monitor.failsafe import Situation, reason_to_stop
from mission.monitor.stage import Stage

_STRAY_FOR_S: Final = 5.0
_UNTRUSTED_FOR_S: Final = 2.0
_CRITICAL_FOR_S: Final = 3.0
"""A vehicle that does something about its battery itself has told of that by then, in two heartbeats."""


class Lookout:
    """Remembers since when the vehicle is astray, its estimate not to be trusted, its battery critical."""

    def __init__(self, stray_m: float) -> None:
        """Look out for a vehicle that is farther than this from its trajectory."""
        self._stray_m = stray_m
        self._trusted_s = self._near_s = self._charged_s = self._looked_s = -math.inf

    def reason(self, session: Session, watch: FlightWatch) -> str:
        """Why the flight has to be given up, in plain words; empty where it goes on, or none is flown."""
        now_s = session.vehicle.clock.newest_s
        if session.stage is not Stage.FLY or now_s is None or watch.began_s is None or now_s == self._looked_s:
            return ""
        self._looked_s = now_s
        vehicle, tracking, seen_s = session.vehicle, watch.tracking, session.vehicle.clock.seen_s
        if math.isinf(self._near_s):
            self._trusted_s = self._near_s = self._charged_s = seen_s
        if vehicle.estimate_trusted:
            self._trusted_s = seen_s
        if not vehicle.battery_critical:
            self._charged_s = seen_s
        if tracking.error_m <= self._stray_m:
            self._near_s = seen_s
        return reason_to_stop(
            Situation(
                estimate_healthy=seen_s - self._trusted_s < _UNTRUSTED_FOR_S,
                battery_critical=seen_s - self._charged_s >= _CRITICAL_FOR_S,
                violation=watch.violation(),
                closing=_closing(session, watch, now_s),
                verdict=watch.monitor.verdict,
                astray=seen_s - self._near_s > _STRAY_FOR_S,
                error_m=tracking.error_m,
                sealed=is_sealed(session),
            )
        )


def _closing(session: Session, watch: FlightWatch, now_s: float) -> str:
    guidance = session.guidance
    # By the field nothing is late: it goes by where what moves is then.
    if not isinstance(guidance, Guidance) or not (watch.plan.closings or watch.plan.moving):
        return ""
    return watch.closing(now_s, guidance.flown_s(now_s), waits=guidance.course_at(now_s).waits)
