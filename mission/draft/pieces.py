"""The features of drawings as pieces of a mission: each with a name, a shape in metres, and what is written of it."""

import itertools
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Final

import shapely

from mission.decimals import decimal, measure
from mission.draft.frame import Frame
from mission.draft.mending import mended
from mission.errors import Fault, SpecError
from mission.geometry.shapes import disc, grown, shrunk, strip, united
from mission.interchange.features import Feature, Lanes, Line, Point, Polygon, Role, Shape, Spot
from mission.printable import shows
from mission.spec.schema import MOST_REGIONS, OPERATOR_NAMES

WIDTH_M: Final = 10.0
RADIUS_M: Final = 5.0
"""Of lines and places whose file gives none."""

_LONGEST_NAME: Final = 50


@dataclass(frozen=True)
class Piece:
    """A part of a mission that is drawn.

    Attributes:
        name: That a region can have.
        role: What it is for; None while that is not known.
        area: Its shape in metres of the plane.
        keys: Keys of the mission file and their values, as text.
        comments: What the file should say of it.
        shapes: As it was drawn.
        lanes: Of a survey that was planned already.
        clearance_m: How far to keep from it, or from its rim inside.
        loiter_s: How long to stand still inside.
        turn: Of a waypoint, its place in the order, from 1; 0 of anything else.
    """

    name: str
    role: Role | None
    area: Any
    keys: tuple[tuple[str, str], ...]
    comments: tuple[str, ...]
    shapes: tuple[Shape, ...] = ()
    lanes: Lanes | None = None
    clearance_m: float = 0.0
    loiter_s: float = 0.0
    turn: int = 0

    @cached_property
    def kept(self) -> Any:  # noqa: ANN401 - shapely has no types
        """Its shape with the clearance: larger if it is restricted, or else smaller."""
        return (grown if self.role is Role.RESTRICTED else shrunk)(self.area, self.clearance_m)

    def also(self, *comments: str, role: Role | None = None) -> "Piece":
        """The piece with further comments, and with a role if one is given."""
        return replace(self, comments=self.comments + comments, role=role or self.role)


def pieces_of(features: Iterable[Feature], frame: Frame) -> list[Piece]:
    """The pieces of features, in their order; polygons of a feature are one piece, lines and places one each.

    Raises:
        SpecError: They are more than a mission can have regions.
    """
    pieces: list[Piece] = []
    for feature in features:
        for piece in _pieces(feature, frame):
            if len(pieces) == MOST_REGIONS:
                message = f"more than {MOST_REGIONS} areas are drawn"
                raise SpecError((Fault(0, 0, "", message, "put those of a kind into one feature of several parts"),))
            name = unused(_nameable(piece.name, piece.role), (each.name for each in pieces))
            pieces.append(replace(piece, name=name))
    return pieces


def polygon_piece(name: str, role: Role, polygons: Sequence[Polygon], frame: Frame, *comments: str) -> Piece:
    """A piece of polygons.

    Raises:
        SpecError: A ring of one crosses itself.
    """
    polygons, mends = mended(name, polygons, frame)
    area = united((frame.metres(each.outline), [frame.metres(hole) for hole in each.holes]) for each in polygons)
    drawn = [_polygon_keys(each, frame) for each in polygons]
    if len(drawn) == 1:
        keys = drawn[0]
    else:
        parts = ", ".join("{" + ", ".join(f"{key}: {value}" for key, value in part) + "}" for part in drawn)
        keys = (("polygons", f"[{parts}]"),)
    return Piece(name, role, area, keys, (*comments, *mends), tuple(polygons))


def circle_keys(centre: str, radius_m: float) -> tuple[tuple[str, str], ...]:
    """The keys of a circle."""
    return ("centre", centre), ("radius_m", decimal(round(radius_m, 2)))


def _pieces(feature: Feature, frame: Frame) -> Iterator[Piece]:
    for piece in _shaped(feature, frame):
        yield replace(
            piece,
            lanes=feature.lanes,
            clearance_m=feature.clearance_m,
            loiter_s=feature.loiter_s,
            turn=feature.turn,
        )


def _shaped(feature: Feature, frame: Frame) -> Iterator[Piece]:
    comments = [": ".join(part for part in (f'"{feature.name}"', feature.reason) if part)]
    if feature.height_m:
        comments.append(f"{measure(feature.height_m)} m high, says the file")
    polygons = [shape for shape in feature.shapes if isinstance(shape, Polygon)]
    if polygons:
        piece = polygon_piece(feature.name, Role.AREA, polygons, frame, *comments)
        yield replace(piece, role=feature.role)
    for shape in feature.shapes:
        if isinstance(shape, Line):
            yield _strip(feature, shape, frame, comments)
        elif isinstance(shape, Spot):
            radius_m = shape.radius_m or RADIUS_M
            of_place = [] if shape.radius_m else ["a place in the file; the circle about it is this draft's"]
            yield Piece(
                feature.name,
                feature.role,
                disc(frame.metres([shape.centre])[0], radius_m, outside=feature.role is Role.RESTRICTED),
                circle_keys(frame.as_drawn(shape.centre), radius_m),
                (*comments, *of_place),
                (shape,),
            )


def _strip(feature: Feature, line: Line, frame: Frame, comments: list[str]) -> Piece:
    width_m = line.width_m or WIDTH_M
    asked = [] if line.width_m else ["the file gives the line no width: is this one right?"]
    area = strip(frame.metres(line.points), width_m, outside=feature.role is Role.RESTRICTED)
    keys = (("line", _list(line.points, frame)), ("width_m", decimal(width_m)))
    return Piece(feature.name, feature.role, area, keys, (*comments, *asked), (line,))


def _polygon_keys(polygon: Polygon, frame: Frame) -> tuple[tuple[str, str], ...]:
    holes = ", ".join(_list(hole, frame) for hole in polygon.holes)
    return (("polygon", _list(polygon.outline, frame)), *((("holes", f"[{holes}]"),) if holes else ()))


def _list(points: Sequence[Point], frame: Frame) -> str:
    return f"[{', '.join(map(frame.as_drawn, points))}]"


def unused(name: str, taken: Iterable[str]) -> str:
    """The name, with a number where it is taken."""
    names = set(taken)
    numbered = (f"{name}_{number}" for number in itertools.count(2))
    return next(each for each in itertools.chain([name], numbered) if each not in names)


def _nameable(name: str, role: Role | None) -> str:
    """The name as it was drawn, so far as a region can have it."""
    kept = "".join(c if shows(c) and c not in '"\\' else " " for c in name)
    words = " ".join(kept.split())[:_LONGEST_NAME].rstrip() or (role or "region")
    return f"region {words}" if re.fullmatch(OPERATOR_NAMES, words) else words


def together(pieces: Iterable[Piece]) -> Any:  # noqa: ANN401 - shapely has no types
    """The ground that pieces cover."""
    return shapely.union_all([piece.area for piece in pieces])
