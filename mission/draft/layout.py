"""What the pieces of a drawing are for, where nobody has said it; the boundary, and a home."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import shapely

from mission.decimals import decimal
from mission.draft.frame import Frame
from mission.draft.homes import homes_of, inradius_m
from mission.draft.pieces import WIDTH_M, Piece, polygon_piece, together, unused
from mission.errors import Fault, SpecError
from mission.geometry.arrays import FloatArray
from mission.geometry.shapes import Area
from mission.interchange.features import Line, Point, Polygon, Role, Spot

_INSIDE: Final = 0.99
_WORTH_A_REGION: Final = 0.01
_SMALLEST_MARGIN_M: Final = 5.0
_LARGEST_MARGIN_M: Final = 20.0
_MARGIN_SHARE: Final = 0.15
_TUBE_SHARE: Final = 0.15
_WIDEST_TUBE_M: Final = 0.5
"""The disturbance that is allowed for: as much, or as the narrowest region that is visited has room for."""
_LEAST_ROOM_M: Final = 0.2
_ROOM_FOR_LANES_M: Final = 2.0
_ROOM_ALONG_M: Final = 0.75
_LONG: Final = 30.0
"""A field with less room is covered, too, where it is long: its area is so many times the square of the room."""

_SPACING_M: Final = 10.0
_LANE_SPACINGS: Final = 6.0  # that lanes are long on average, at least, where houses cut them
_MANY_LANES: Final = 40
"""A field that lanes of the usual spacing cross more often gets wider ones."""

_TIDY_M: Final = 5.0
_MOST_WALLS: Final = 60
_CLOSEST_LANES_M, _FARTHEST_LANES_M = 0.5, 10_000.0


@dataclass(frozen=True)
class Guesses:
    """What a draft assumes where no file tells it.

    Attributes:
        tube_share: How much of the usual disturbance is allowed for.
        only_visited: Names of regions to survey that are not covered by lanes.
        in_a_row: Whether regions are visited in one order even where they are few.
    """

    tube_share: float = 1.0
    only_visited: frozenset[str] = frozenset()
    in_a_row: bool = False


USUAL: Final = Guesses()


@dataclass(frozen=True)
class Layout:
    """A mission as far as it is ground.

    Attributes:
        boundary: Its piece, with the keys of an area.
        regions: In the order of the file.
        visited: Names of those to survey that can be reached from home.
        homes: Names of those to return to.
        start: As the mission file has it.
        ordered: Whether they are to be visited in this order.
        covered: The distance between lanes of each region that is wide enough for some, m, by its name.
        tube_m: A distance to keep with which the regions to survey can be visited.
        remarks: What was left out.
    """

    boundary: Piece
    regions: tuple[Piece, ...]
    visited: tuple[str, ...]
    ordered: bool
    homes: tuple[str, ...]
    start: str
    covered: dict[str, float]
    tube_m: float
    remarks: tuple[str, ...]


def laid_out(
    pieces: Sequence[Piece],
    frame: Frame,
    *,
    route: Sequence[Point] = (),
    start: Point | None = None,
    tube_m: float | None = None,
    guesses: Guesses = USUAL,
) -> Layout:
    """A mission of the pieces: roles, a boundary around them, and a home that all can be visited from.

    Args:
        pieces: At least one, or there is a route.
        frame: Where they lie.
        route: Places that the boundary holds, too.
        start: Where the flight begins, if that is known.
        tube_m: How far to keep from where the vehicle must not go, if a mission was planned of them that is known: then
            nothing is added to it.
        guesses: For all that is not.

    Raises:
        SpecError: Nothing is left to fly in.
    """
    known = _with_roles(pieces)
    boundary = _boundary([piece for piece in known if piece.role is Role.BOUNDARY], known, route, frame)
    shapely.prepare(boundary.area)
    regions, remarks = [], []
    for piece in known:
        inside = piece.area.intersection(boundary.area).area
        if piece.role is Role.BOUNDARY:
            continue
        # Of what is restricted, the smallest part counts.
        if inside <= (0.0 if piece.role is Role.RESTRICTED else _WORTH_A_REGION * piece.area.area):
            remarks.append(f"{piece.name} lies outside the boundary and is left out")
            continue
        regions.append(piece)
        if piece.role is Role.SURVEY and tube_m is None:
            regions.extend(_kept_off_holes(piece, known, frame))
    restricted = shapely.union_all([piece.kept for piece in regions if piece.role is Role.RESTRICTED])
    surveyed = [piece for piece in regions if piece.role is Role.SURVEY]
    free = boundary.kept.difference(restricted)
    if inradius_m(free) < _LEAST_ROOM_M:
        message = "nothing is left to fly in: what is restricted, with clearances, covers all that the boundary holds"
        raise SpecError((Fault(0, 0, "", message, "draw the boundary wider, or name what is not restricted"),))
    homes, centre_m, written, said = homes_of(regions, surveyed, free, frame)
    if start is not None:
        (place_m,) = frame.metres([start])
        if free.contains(shapely.Point(place_m)):
            centre_m, written = place_m, frame.as_drawn(start)
        else:
            remarks.append("where the flight of the file took off is not free here, and it begins elsewhere")
    ground = _part_with(free, centre_m)
    rooms = {piece.name: inradius_m(piece.kept.intersection(ground)) for piece in (*homes, *surveyed)}
    visited = [piece for piece in surveyed if rooms[piece.name] >= _LEAST_ROOM_M]
    barred = [piece for piece in surveyed if piece not in visited]
    remarks.extend(_why_not(barred, [piece for piece in regions if piece.role is Role.RESTRICTED], ground, boundary))
    narrowest_m = min(rooms[piece.name] for piece in (*homes, *visited))
    others = [piece for piece in regions if piece.role is not Role.HOME]
    return Layout(
        boundary,
        (*homes, *others),
        tuple(piece.name for piece in _in_a_row(visited, centre_m)),
        guesses.in_a_row or any(piece.turn for piece in visited),
        tuple(piece.name for piece in homes),
        written,
        {
            piece.name: _spacing_m(piece, rooms[piece.name])
            for piece in visited
            if _is_covered(piece, rooms[piece.name], told=tube_m is not None, guesses=guesses)
        },
        round(guesses.tube_share * min(_WIDEST_TUBE_M, _TUBE_SHARE * narrowest_m), 2) if tube_m is None else tube_m,
        (*remarks, *said),
    )


def _why_not(barred: Sequence[Piece], restricted: Sequence[Piece], ground: Area, boundary: Piece) -> Iterator[str]:
    """Why regions are not asked for: they are too narrow, or something keeps them apart from home."""
    opened: list[tuple[str, Area]] = []
    for wall in restricted if barred and len(restricted) <= _MOST_WALLS else ():
        others = shapely.union_all([each.kept for each in restricted if each is not wall])
        parts = shapely.get_parts(boundary.kept.difference(others))
        opened.append((wall.name, shapely.union_all(parts[shapely.intersects(parts, ground)])))
    for piece in barred:
        room_m = inradius_m(piece.kept)
        if room_m < _LEAST_ROOM_M:
            yield f"{piece.name} is too narrow to be visited, with room for a circle of {decimal(round(room_m, 3))} m"
            continue
        wall_name = next((name for name, open_to in opened if open_to.intersection(piece.kept).area > 0.0), "")
        why = f": {wall_name} lies between or over it" if wall_name else ""
        yield f"{piece.name} cannot be reached from home{why}"


def _with_roles(pieces: Sequence[Piece]) -> list[Piece]:
    """The pieces, each with a role: what holds everything is the boundary, and something there is to survey."""
    # A line that does not close bounds nothing.
    pieces = [
        replace(piece, role=None) if piece.role is Role.BOUNDARY and isinstance(piece.shapes[0], Line) else piece
        for piece in pieces
    ]
    untold = [piece for piece in pieces if piece.role is None and isinstance(piece.shapes[0], Polygon)]
    told = [piece for piece in pieces if piece.role is Role.SURVEY]
    around = _holding_all(untold, pieces) if not any(piece.role is Role.BOUNDARY for piece in pieces) else None
    if around is not None and (told or len(untold) > 1):
        untold.remove(around)
        found = around.also("it holds everything else: is it where the vehicle may fly?", role=Role.BOUNDARY)
        pieces = [found if piece is around else piece for piece in pieces]
    if not told:
        chosen = untold or [piece for piece in pieces if piece.role is None]
        question = "nothing in the file tells what it is: is it to be surveyed?"
        pieces = [piece.also(question, role=Role.SURVEY) if piece in chosen else piece for piece in pieces]
    question = "nothing in the file tells what it is: survey, restricted, home, or an area like any other?"
    return [piece if piece.role else piece.also(question, role=Role.AREA) for piece in pieces]


def _holding_all(untold: Sequence[Piece], pieces: Sequence[Piece]) -> Piece | None:
    if not untold or len(pieces) == 1:
        return None
    largest = max(untold, key=lambda piece: float(shapely.Polygon(shapely.get_parts(piece.area)[0].exterior).area))
    # What lies in a hole is held, too.
    hull = shapely.union_all([shapely.Polygon(part.exterior) for part in shapely.get_parts(largest.area)])
    others = [piece.area for piece in pieces if piece is not largest]
    held = all(hull.intersection(area).area >= _INSIDE * area.area for area in others)
    return largest if held else None


def _is_covered(piece: Piece, room_m: float, *, told: bool, guesses: Guesses) -> bool:
    """Whether a region gets lanes: as its file has it, or where it is wide enough and no mere place."""
    if piece.lanes:
        return True
    shape = piece.shapes[0]
    is_place = piece.turn > 0 or (isinstance(shape, Spot) and shape.radius_m is None)
    is_long = room_m >= _ROOM_ALONG_M and piece.area.area >= _LONG * room_m**2
    return not (told or is_place or piece.name in guesses.only_visited) and (room_m >= _ROOM_FOR_LANES_M or is_long)


def _boundary(told: Sequence[Piece], pieces: Sequence[Piece], route: Sequence[Point], frame: Frame) -> Piece:
    if len(told) == 1:
        return told[0]
    polygons = [shape for piece in told for shape in piece.shapes if isinstance(shape, Polygon)]
    if told and polygons:
        return polygon_piece("boundary", Role.BOUNDARY, polygons, frame, "several are drawn: any of them will do")
    if told:
        return told[0].also("the file has several circles: this one alone is taken")
    ground = shapely.union_all([piece.area for piece in pieces] + [shapely.MultiPoint(frame.metres(route))])
    west, south, east, north = ground.bounds
    margin_m = float(np.clip(_MARGIN_SHARE * max(east - west, north - south), _SMALLEST_MARGIN_M, _LARGEST_MARGIN_M))
    around = ground.convex_hull.buffer(margin_m, join_style="mitre", mitre_limit=1.5).simplify(0.05 * margin_m)
    corners = shapely.get_coordinates(around.exterior)[:-1]
    ring = f"[{', '.join(map(frame.as_made, corners))}]"
    comment = f"the file has no boundary; this is {decimal(round(margin_m, 1))} m around everything: where may it fly?"
    return Piece("boundary", Role.BOUNDARY, around, (("polygon", ring),), (comment,))


def _kept_off_holes(piece: Piece, pieces: Sequence[Piece], frame: Frame) -> list[Piece]:
    """What is cut out of a piece and drawn by no other, as a region to keep out of."""
    others = together(other for other in pieces if other is not piece and other.role is not Role.BOUNDARY)
    holes = [
        Polygon(hole)
        for shape in piece.shapes
        if isinstance(shape, Polygon)
        for hole in shape.holes
        if shapely.Polygon(frame.metres(hole)).difference(others).area > 0.5 * shapely.Polygon(frame.metres(hole)).area
    ]
    if not holes:
        return []
    comment = f"what is cut out of {piece.name}: may it be flown over? then take this region away"
    name = unused(f"{piece.name}_holes", (other.name for other in pieces))
    return [polygon_piece(name, Role.RESTRICTED, holes, frame, comment)]


def _spacing_m(piece: Piece, room_m: float) -> float:
    """As it was planned before; one lane along a line; or so that several lanes and not very many are in what is wide.

    Lanes lie along the longer side of what is around a field, so that they are as many as the shorter one has room for.
    Where houses stand in it they are cut: a line through an area is inside of it for pi times area over circumference
    on average (Cauchy), and lanes are to be several times as long as the ways from one to the next.
    """
    if piece.lanes and piece.lanes.spacing_m:
        return min(max(_CLOSEST_LANES_M, piece.lanes.spacing_m), _FARTHEST_LANES_M)
    shape = piece.shapes[0]
    if isinstance(shape, Line):
        return shape.width_m or WIDTH_M
    if room_m < _ROOM_FOR_LANES_M:
        return round(2.0 * room_m, 1)  # one lane along the middle
    sides_m = np.hypot(*np.diff(shapely.get_coordinates(piece.area.minimum_rotated_rectangle)[:3], axis=0).T)
    widest_m = _TIDY_M * np.ceil(sides_m.min() / (_TIDY_M * _MANY_LANES))
    widest_m = max(min(_SPACING_M, round(room_m)), widest_m if widest_m > _SPACING_M else 0.0)
    if not any(len(part.interiors) for part in shapely.get_parts(piece.area)):
        return float(widest_m)
    cut_m = math.pi * piece.area.area / piece.area.length / _LANE_SPACINGS
    return float(max(min(widest_m, math.floor(2.0 * cut_m) / 2.0), _CLOSEST_LANES_M))


def _part_with(free: Area, centre_m: FloatArray) -> Area:
    """The part of free ground that a point lies in."""
    parts = shapely.get_parts(free)
    return parts[int(np.argmin(shapely.distance(parts, shapely.Point(centre_m))))]


def _in_a_row(pieces: Sequence[Piece], begin_m: FloatArray) -> list[Piece]:
    """Waypoints in their order, then each the nearest to the one before, from where the vehicle starts."""
    turns = sorted((piece for piece in pieces if piece.turn), key=lambda piece: piece.turn)
    return turns + _nearest_first([piece for piece in pieces if not piece.turn], begin_m)


def _nearest_first(pieces: Sequence[Piece], begin_m: FloatArray) -> list[Piece]:
    left, row, at = list(pieces), [], shapely.Point(begin_m)
    while left:
        near = min(left, key=lambda piece: float(shapely.distance(at, piece.area)))
        left.remove(near)
        row.append(near)
        at = near.area.centroid
    return row
