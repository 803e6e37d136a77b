"""Where a drafted mission begins and ends: homes that are drawn, or a place with room around it."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely
from shapely.ops import polylabel

from mission.draft.frame import Frame
from mission.draft.pieces import RADIUS_M, Piece, circle_keys, together, unused
from mission.geometry.arrays import FloatArray
from mission.geometry.shapes import Area, disc
from mission.interchange.features import Role, Spot


def homes_of(
    regions: Sequence[Piece], surveyed: Sequence[Piece], free: Area, frame: Frame
) -> tuple[list[Piece], FloatArray, str, list[str]]:
    """The homes that can be landed on, the centre of the first in metres, the same as it is written; and remarks."""
    homes, places, remarks = [], [], []
    for piece in (piece for piece in regions if piece.role is Role.HOME):
        spot = piece.shapes[0]
        around = shapely.Point(piece.area.centroid if isinstance(spot, Spot) else piece.area.representative_point())
        room_m = float(shapely.distance(around, free.boundary)) if free.contains(around) else 0.0
        if room_m <= 0.1 * RADIUS_M:
            remarks.append(f"{piece.name} lies outside the boundary or where it is restricted, and is left out")
            continue
        if isinstance(spot, Spot) and spot.radius_m is None:
            radius_m = min(RADIUS_M, 0.8 * room_m)
            keys = circle_keys(frame.as_drawn(spot.centre), radius_m)
            piece = replace(piece, area=around.buffer(radius_m), keys=keys)  # noqa: PLW2901 - the same piece
        centre_m = shapely.get_coordinates(around)[0]
        homes.append(piece)
        places.append((centre_m, frame.as_drawn(spot.centre) if isinstance(spot, Spot) else frame.as_made(centre_m)))
    if homes:
        return homes, *places[0], remarks
    centre_m, room_m = _room_for_home(surveyed, free)
    radius_m = min(RADIUS_M, 0.8 * room_m)
    start = frame.as_made(centre_m)
    comment = "the file has no home that will do; this is a place with room around it: where does the vehicle start?"
    area = disc(centre_m, radius_m, outside=False)
    name = unused("home", (piece.name for piece in regions if piece.role is not Role.HOME))
    return [Piece(name, Role.HOME, area, circle_keys(start, radius_m), (comment,))], centre_m, start, remarks


def _room_for_home(surveyed: Sequence[Piece], free: Area) -> tuple[FloatArray, float]:
    """The middle of the largest circle beside what is surveyed, or anywhere in free ground, and its radius."""
    ground = together(surveyed)
    parts = [part for part in shapely.get_parts(free) if isinstance(part, shapely.Polygon)]
    if surveyed:
        parts = sorted(parts, key=lambda part: -part.intersection(ground).area)[:1]
    near = ground.buffer(4.0 * RADIUS_M)
    for wanted in (parts[0].intersection(near).difference(ground), parts[0].intersection(near), parts[0]):
        rooms = [part for part in shapely.get_parts(wanted) if isinstance(part, shapely.Polygon) and part.area > 1.0]
        if rooms:
            centre = polylabel(max(rooms, key=lambda part: float(part.area)), tolerance=0.5)
            room_m = float(shapely.distance(centre, free.boundary))
            if room_m > 1.0 or wanted is parts[0]:
                return shapely.get_coordinates(centre)[0], room_m
    raise AssertionError("a part of free ground is a polygon")


def inradius_m(area: Area) -> float:
    """The radius of the largest circle in an area, to some tenths of itself."""
    parts = [part for part in shapely.get_parts(area) if isinstance(part, shapely.Polygon) and part.area > 0.0]
    if not parts:
        return 0.0
    part = max(parts, key=lambda each: float(each.area))
    centre = polylabel(part, tolerance=max(0.01, 0.02 * float(np.sqrt(part.area))))
    return float(shapely.distance(centre, part.boundary))
