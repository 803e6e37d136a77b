"""A flight of a log in the frame of a mission: where the vehicle was, and when."""

from dataclasses import dataclass
from typing import Final

from mission.errors import GeometryError
from mission.geometry.arrays import FloatArray, frozen_floats
from mission.geometry.geodesy import REACH_M, LatLon, enu_offset_m
from mission.geometry.places import enu_offsets_m
from mission.monitor.gaps import GAP_S
from mission.spec.model import Point
from mission.verify.logs.flights import Airborne
from mission.verify.logs.telemetry import Clock, LogError

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
    """

    t_s: FloatArray
    position_m: FloatArray
    word_from_s: float
    begins_whole: bool
    ends_whole: bool
    pictures: tuple[tuple[float, int], ...]
    clock: Clock
    frame: str

    def __post_init__(self) -> None:
        object.__setattr__(self, "t_s", frozen_floats(self.t_s))
        object.__setattr__(self, "position_m", frozen_floats(self.position_m))


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
    local, world = _during(told.local_rows, flight), _during(told.world_rows, flight)
    if not len(local) and not len(world):
        raise LogError("the log has no positions of this flight; was the vehicle sure of where it was?")
    frame = _local_origin(flight)
    # The estimator's own frame is the finer one; where it is told less often, or not placed, the globe serves.
    if len(local) >= len(world) and (origin is None or frame is not None):
        rows, name = local, "local positions"
        places = local[:, [2, 1]]
        if origin is not None and frame is not None:
            places = places + _apart(origin, frame)
    elif len(world):
        rows, name = world, "positions on Earth"
        seen_from = origin or LatLon(*world[0, 1:3].tolist())
        places, away = enu_offsets_m(seen_from, world[:, 1:3])
        if away.max() > REACH_M:
            raise LogError(f"the flight is {away.max() / 1000.0:.0f} km away from the mission's origin")
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
    times = rows[:, 0]
    return Track(
        t_s=times,
        position_m=places,
        word_from_s=float(times[0]),
        begins_whole=flight.begins_whole and bool(times[0] - flight.begin_s <= GAP_S),
        ends_whole=flight.ends_whole and bool(flight.end_s - times[-1] <= GAP_S),
        pictures=tuple(each for each in told.pictures if flight.begin_s <= each[0] <= flight.end_s),
        clock=Clock.of(told.clock),
        frame=name,
    )


def _during(rows: FloatArray, flight: Airborne) -> FloatArray:
    return rows[(rows[:, 0] >= flight.begin_s) & (rows[:, 0] <= flight.end_s)]


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
