"""Where a return leads: home or a rally point."""

from collections.abc import Sequence
from math import hypot, inf
from typing import NamedTuple

from vehicle_sim.parameters import FlightSettings, RallyChoice
from vehicle_sim.signals import Geodetic, Vector


class RallyPoint(NamedTuple):
    """A safe place to land, and the height above home at which one comes there."""

    place: Geodetic
    height_m: float


class Destination(NamedTuple):
    """Where to land (NED of the estimator's origin, on the ground), and the height above home of the way there."""

    ned_m: Vector
    height_m: float


def destination(
    here_ned_m: Vector, home_ned_m: Vector, rally: Sequence[tuple[Vector, float]], settings: FlightSettings
) -> Destination:
    """Return where a return leads from here.

    `rally` are the rally points: place (NED; only north and east count) and height above home. The ground is level
    with home, so the landing is too.
    """
    rules = settings.rally
    home = Destination(home_ned_m, settings.return_height_m)

    def away_m(place: Vector) -> float:
        return hypot(place[0] - here_ned_m[0], place[1] - here_ned_m[1])

    within = [(away_m(place), place, height) for place, height in rally]
    within = [candidate for candidate in within if candidate[0] <= rules.limit_m]
    if rules.choice is RallyChoice.HOME or not within:
        return home
    distance_m, (north, east, _), height_m = min(within)
    if distance_m >= (away_m(home_ned_m) if rules.choice is RallyChoice.NEAREST else inf):
        return home
    way_m = max(height_m, 0.0) if rules.names_height else height_m + settings.return_height_m
    return Destination((north, east, home_ned_m[2]), way_m)
