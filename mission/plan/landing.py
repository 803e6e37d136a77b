"""Where a flight may end, so that its landing stays where it may be.

The tube holds as long as the vehicle is led. It lands by itself, wherever in the tube it is then, and may drift from
there (``Flight.landing_m``). So the end keeps as far as that from the rim of where it may be; where there is less room,
it is in the middle.
"""

from typing import Final

import shapely

from mission.geometry.shapes import Area, narrowed, polygonal
from mission.spec.model import Flight

_HALVINGS: Final = 6
_WHOLE: Final = 1e-6


def room_to_land(ends: Area, free: Area, landing_m: float) -> Area:
    """Of the places where the tube may end those that leave room to land, or which are in the middle.

    Args:
        ends: The places; none is empty.
        free: Where the vehicle comes to them. What room there is counts in each of its parts.
        landing_m: How far a landing may drift.
    """
    found = []
    for part in shapely.get_parts(free):
        here = polygonal(shapely.intersection(ends, part))
        if here.is_empty:
            continue
        roomy = narrowed(here, landing_m)
        found.append(_middle(here, landing_m) if roomy.is_empty else roomy)
    return polygonal(shapely.union_all(found))


def _middle(ends: Area, landing_m: float) -> Area:
    """The places farthest from the rim of an area, or about that."""
    found, least_m, most_m = ends, 0.0, landing_m
    for _ in range(_HALVINGS):
        drift_m = 0.5 * (least_m + most_m)
        there = narrowed(ends, drift_m)
        found, least_m, most_m = (found, least_m, drift_m) if there.is_empty else (there, drift_m, most_m)
    return found


def little_room_to_land(flight: Flight, landing_m: float) -> str:
    """A warning where a plan leaves a landing less room than it may need; empty where it leaves enough.

    Args:
        flight: How the mission is flown.
        landing_m: What is proved of the landing.
    """
    if landing_m >= flight.landing_m * (1.0 - _WHOLE):
        return ""
    return (
        f"a landing may drift by {flight.landing_m:.3g} m from the tube, and where the flight ends there is room for "
        f"{landing_m:.2f} m: beyond that, nothing is proved of it; a larger last region, or "
        "less clearance, leaves it more room"
    )
