"""The way back along the path that was flown, ArduPilot's SMART_RTL: what is kept of the path, and the task.

After `AP_SmartRTL.cpp`: a place is kept where it is farther from the last than the accuracy. Before the way back, and
where there is no room left, places that lie on straight lines are dropped (Ramer, Douglas, Peucker), and so are loops,
where two stretches come near each other.
"""

from math import hypot
from typing import Final

import numpy as np

from vehicle_sim.autopilot.legs import CruiseTask, Reference, corner_speed, distance_m
from vehicle_sim.autopilot.mission_items import SpeedAxis
from vehicle_sim.autopilot.tasks import LandTask, Task, stopping_place
from vehicle_sim.parameters import FlightSettings
from vehicle_sim.signals import Estimate, Setpoint, Vector

_PATIENCE_S: Final = 15.0
_STRAIGHT, _NEAR = 0.5, 0.99
"""How far from a line, and from each other's, in accuracies."""
_ABOVE_HOME_M: Final = 2.0


class FlownPath:
    """The places that lead back to where the vehicle was armed, from there on; without any there is no way back."""

    def __init__(self) -> None:
        """Nothing is known."""
        self.places: list[Vector] = []
        self._begun = False
        self._good_s = 0.0

    def begin(self, estimate: Estimate) -> None:
        """Begin at where the vehicle is, if that is known."""
        self._begun = estimate.status.position_ok
        self.places = [estimate.position_ned_m] if self._begun else []
        self._good_s = estimate.time_s

    def advance(self, estimate: Estimate, settings: FlightSettings, *, keeps: bool) -> str:
        """Keep where the vehicle is now, if it `keeps` its path; return why that ends, empty if it does not."""
        if not self._begun and estimate.status.position_ok and settings.path_places and settings.path_accuracy_m > 0.0:
            self.begin(estimate)
        if not self.places or not keeps:
            return ""
        if not estimate.status.position_ok:
            return self._end("bad position") if estimate.time_s - self._good_s > _PATIENCE_S else ""
        self._good_s = estimate.time_s
        if distance_m(self.places[-1], estimate.position_ned_m) < settings.path_accuracy_m:
            return ""
        if len(self.places) >= settings.path_places:
            self.clean(settings.path_accuracy_m)
        if len(self.places) >= settings.path_places:
            return self._end("buffer full")
        self.places.append(estimate.position_ned_m)
        return ""

    def _end(self, why: str) -> str:
        self.places = []
        return f"SmartRTL deactivated: {why}"

    def clean(self, accuracy_m: float) -> None:
        """Drop what the way back does not need."""
        self.places = _without_loops(_straightened(self.places, _STRAIGHT * accuracy_m), _NEAR * accuracy_m)


def _straightened(places: list[Vector], most_m: float) -> list[Vector]:
    """Return the places without those that lie within `most_m` of the lines between the others."""
    if len(places) <= 2:  # noqa: PLR2004 - the ends of a line
        return places
    offs = [_gap(places[0], places[-1], place, place)[0] for place in places]
    at = int(np.argmax(offs))
    if offs[at] <= most_m:
        return [places[0], places[-1]]
    return _straightened(places[: at + 1], most_m)[:-1] + _straightened(places[at:], most_m)


def _without_loops(places: list[Vector], least_m: float) -> list[Vector]:
    """Return the places without what lies between two stretches that come within `least_m` of each other."""
    kept, first = list(places), 0
    while first < len(kept) - 3:
        for second in range(len(kept) - 2, first + 1, -1):
            gap, middle = _gap(kept[first], kept[first + 1], kept[second], kept[second + 1])
            if gap < least_m:
                kept[first + 1 : second + 1] = [middle]
                break
        first += 1
    return kept


def _gap(a: Vector, b: Vector, c: Vector, d: Vector) -> tuple[float, Vector]:
    """Return how near two stretches come to each other, and the place in the middle of there."""
    p, u, r, v = np.array(a), np.subtract(b, a), np.array(c), np.subtract(d, c)
    uu, vv, uv, s = u @ u, v @ v, u @ v, 0.0
    square = uu * vv - uv * uv
    if square > 0.0:
        s = float(np.clip((uv * (v @ (p - r)) - vv * (u @ (p - r))) / square, 0.0, 1.0))
    t = float(np.clip(v @ (p + s * u - r) / vv, 0.0, 1.0)) if vv else 0.0
    s = float(np.clip(u @ (r + t * v - p) / uu, 0.0, 1.0)) if uu else 0.0
    one, other = p + s * u, r + t * v
    north, east, down = 0.5 * (one + other)
    return hypot(*(one - other)), (float(north), float(east), float(down))


class RetraceTask(Task):
    """Fly back from place to place, 2 m above the first, and land there; places that were reached are forgotten."""

    def __init__(
        self, estimate: Estimate, settings: FlightSettings, path: FlownPath, speeds: dict[SpeedAxis, float]
    ) -> None:
        """Begin where the vehicle comes to rest."""
        path.clean(settings.path_accuracy_m)
        self._settings, self._path, self._speeds = settings, path, speeds
        self._home = path.places[0]
        self._land: LandTask | None = None
        here = stopping_place(estimate, settings)
        super().__init__(Setpoint(position_ned_m=here, yaw_rad=estimate.yaw_rad))
        self._leg = self._next(here, Reference(estimate.position_ned_m, estimate.velocity_ned_m_s))

    def _next(self, start: Vector, reference: Reference) -> CruiseTask:
        settings, above = self._settings, (*self._home[:2], self._home[2] - _ABOVE_HOME_M)
        ahead = [above, *self._path.places[1:]]
        corner = 0.0
        if len(ahead) > 1:
            corner = corner_speed(start, ahead[-1], ahead[-2], settings.accept_m, settings.acceleration_m_s2)
        return CruiseTask(
            reference,
            settings,
            start=start,
            end=ahead[-1],
            speeds=self._speeds,
            accept_m=settings.accept_m,
            accept_height_m=settings.accept_height_m,
            corner_m_s=min(corner, settings.cruise_m_s),
            yaw_rad=self.setpoint.yaw_rad,
        )

    def advance(self, now_s: float, estimate: Estimate) -> None:
        """Go from place to place, and down in the end."""
        part = self._land or self._leg
        part.advance(now_s, estimate)
        self.setpoint = part.setpoint
        if self.landing or not self._leg.finished:
            return
        if len(self._path.places) > 1:
            reached = self._path.places.pop()
            self._leg = self._next(reached, self._leg.reference)
        else:
            self.landing = True
            place = (*self._home[:2], None)
            self._land = LandTask(estimate, self._settings, home_down_m=self._home[2], place=place)
