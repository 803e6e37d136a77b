"""A flight of a log in the frame of a mission: where the vehicle was, and when."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from mission.errors import GeometryError
from mission.geometry.arrays import FloatArray, frozen_floats
from mission.geometry.geodesy import PLANE_M, REACH_M, LatLon, enu_offset_m
from mission.geometry.places import enu_offsets_m
from mission.monitor.gaps import GAP_S
from mission.spec.model import Point
from mission.verify.logs.flights import Airborne
from mission.verify.logs.telemetry import Clock, LogError

_SPHERE_SHARE: Final = 0.005
_AGREE_M: Final = 2.0
_MOST: Final = 0.9  # of the rows: the others may be damaged
_GLOBE_DEG: Final = (90.0, 180.0)
_LEFT_M: Final = 2.0
"""So far from where it took off a vehicle is on its way, and not at the mercy of the wind."""

_HEARTBEAT_S: Final = 1.0
_MOVED_M: Final = 0.5
"""An origin that is told anew so far away is another one."""


@dataclass(frozen=True, eq=False)
class Track:
    """Where a vehicle was during one flight.

    Attributes:
        t_s: The vehicle's time, ascending, shape (N,), N at least 1.
        position_m: East and north in the domain, shape (N, 2).
        word_from_s: From when on the flight spells its word; before, it must only keep out of what is restricted.
        begins_whole: Whether the log has the flight from its beginning.
        ends_whole: Whether the log has it to its end.
        pictures: Times and numbers of the pictures that the vehicle told of.
        clock: The time of the day.
        frame: What the positions are, and how they were brought into the domain, in words.
        planned_from_m: Where the vehicle stood when its plan was made anew; None where nothing is known of that.
        left: Times of reports after which nobody led the vehicle until the next one, and its velocity then, east and
            north: its autopilot brought it to rest, and held it.
        moves_from_s: By when its trajectory had begun, for it had left the place of take-off; None where
            ``word_from_s`` tells when that was.
        aloft_s: How long it was from arming to landing, at least and at most; None where the log does not tell.
    """

    t_s: FloatArray
    position_m: FloatArray
    word_from_s: float
    begins_whole: bool
    ends_whole: bool
    pictures: tuple[tuple[float, int], ...]
    clock: Clock
    frame: str
    planned_from_m: Point | None = None
    left: tuple[tuple[float, Point], ...] = ()
    moves_from_s: float | None = None
    aloft_s: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "t_s", frozen_floats(self.t_s))
        object.__setattr__(self, "position_m", frozen_floats(self.position_m))

    @property
    def began_by_s(self) -> float:
        """The latest time at which its trajectory may have begun; the earliest is ``word_from_s``."""
        return self.word_from_s if self.moves_from_s is None else self.moves_from_s


def track_of(flight: Airborne, origin: LatLon | None, start_m: Point) -> Track:
    """Bring a flight into the domain.

    Args:
        flight: As the log tells it.
        origin: Where the domain's (0, 0) lies on Earth; None where the mission lies wherever it is flown.
        start_m: Where the vehicle takes off in such a mission, ENU.

    Raises:
        LogError: The positions cannot be brought there.
    """
    told = flight.told
    local, world = _during(told.local_rows, flight, (REACH_M, REACH_M)), _during(told.world_rows, flight, _GLOBE_DEG)
    if not len(local) and not len(world):
        raise LogError("the log has no positions of this flight; was the vehicle sure of where it was?")
    frame = _local_origin(flight)
    if len(local) and (origin is None or frame is not None) and _is_local_better(local, world, origin):
        rows, name, places = local, "local positions", local[:, [2, 1]]
        if origin is not None and frame is not None:
            places = places + _apart(origin, frame)
    elif len(world):
        name = "positions on Earth"
        rows, places = _seen_from(origin or LatLon(*world[0, 1:3].tolist()), world)
    else:
        raise LogError(
            "the mission lies at a place on Earth, and the log has local positions only, without "
            "GPS_GLOBAL_ORIGIN; take `origin` out of a copy of the mission, so that it lies where the vehicle took off"
        )
    if origin is None:
        places = places - places[0] + start_m
        name += f", the place of take-off being the mission's start ({start_m[0]:g}, {start_m[1]:g})"
    else:
        name += ", seen from the mission's origin"
    times, left = rows[:, 0], np.hypot(*(places - places[0]).T) > _LEFT_M
    return Track(
        t_s=times,
        position_m=places,
        word_from_s=float(times[0]),
        begins_whole=flight.begins_whole and bool(times[0] - flight.begin_s <= GAP_S),
        ends_whole=flight.ends_whole and bool(flight.end_s - times[-1] <= GAP_S),
        pictures=_pictures(flight),
        clock=Clock.of(told.clock),
        frame=name,
        moves_from_s=float(times[int(np.argmax(left))] if left.any() else times[-1]),
        aloft_s=_aloft(flight),
    )


def _aloft(flight: Airborne) -> tuple[float, float] | None:
    """How long a flight was from arming to landing, each of which is told up to a heartbeat later."""
    if flight.armed_s is None or not flight.ends_whole or not (flight.told.airborne or flight.told.active):
        return None
    told_s = flight.end_s - flight.armed_s
    return max(told_s - _HEARTBEAT_S, 0.0), told_s + _HEARTBEAT_S


def _is_local_better(local: FloatArray, world: FloatArray, origin: LatLon | None) -> bool:
    """Which positions to take: a mission on Earth is flown there, and another one in the vehicle's own metres.

    Autopilots make metres of degrees by a sphere, which is up to 0.5 % off. Whichever has gaps that the other has not
    gives way, and so do local positions that are too far from those on Earth to be the vehicle's.
    """
    if not len(world):
        return True
    gaps_s = [float(np.diff(rows[:, 0]).max(initial=0.0)) for rows in (local, world)]
    if origin is not None:
        return gaps_s[1] > max(GAP_S, gaps_s[0])
    if gaps_s[0] > max(GAP_S, gaps_s[1]):
        return False
    world, moved = _seen_from(LatLon(*world[0, 1:3].tolist()), world)
    there = np.column_stack([np.interp(world[:, 0], local[:, 0], local[:, column]) for column in (2, 1)])
    apart = np.hypot(*(there - there[0] - moved).T) - _SPHERE_SHARE * np.hypot(*moved.T)
    return bool(np.mean(apart < _AGREE_M) >= _MOST)


def _seen_from(origin: LatLon, world: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Rows of positions on Earth and their offsets from a place; without those that are damaged.

    Raises:
        LogError: Most of them are beyond where a mission can be.
    """
    places, away = enu_offsets_m(origin, world[:, 1:3])
    near = away <= PLANE_M
    if near.mean() < _MOST:
        far_km = np.median(away) / 1000.0
        hint = "take `origin` out of a copy of the mission, so that it lies where the vehicle took off"
        raise LogError(f"the flight is {far_km:.0f} km away from the mission's origin; {hint}")
    return world[near], places[near]


def _pictures(flight: Airborne) -> tuple[tuple[float, int], ...]:
    """Pictures of a flight, each once: they may be told twice, by release and image, or on several links."""
    first: dict[int, float] = {}
    for t_s, number in flight.told.pictures:
        if flight.begin_s <= t_s <= flight.end_s:
            first.setdefault(number, t_s)
    return tuple((t_s, number) for number, t_s in first.items())


def _during(rows: FloatArray, flight: Airborne, most: Point) -> FloatArray:
    """Rows of a flight; damaged ones, beyond what a coordinate can be, are left out."""
    inside = (rows[:, 0] >= flight.begin_s) & (rows[:, 0] <= flight.end_s)
    return rows[inside & (np.abs(rows[:, 1:3]) <= most).all(axis=1)]


def _apart(origin: LatLon, frame: LatLon) -> Point:
    try:
        return enu_offset_m(origin, frame)
    except GeometryError as error:
        raise LogError(f"the flight was elsewhere than the mission: {error}") from error


def _local_origin(flight: Airborne) -> LatLon | None:
    """Where the local frame had its origin all through a flight; None where that is not told, or it moved."""
    origins = flight.told.origins
    before = [place for t_s, place in origins if t_s <= flight.begin_s][-1:]
    during = [place for t_s, place in origins if flight.begin_s < t_s <= flight.end_s]
    places = [*before, *during] or [place for _, place in origins[:1]]
    if not places or any(max(map(abs, _apart(places[0], place))) > _MOVED_M for place in places[1:]):
        return None
    return places[0]
