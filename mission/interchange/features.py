"""What the files of other programs draw, whatever their format: named features with a shape and, maybe, a role."""

from dataclasses import dataclass
from enum import StrEnum

from mission.errors import Fault, SpecError

Point = tuple[float, float]
"""Longitude and latitude in degrees (WGS 84), or east and north in metres, as the drawing says."""

PATH, TAKE_OFF = "path", "take-off"

OF_A_FLIGHT = frozenset({"clearance", PATH, "triangle", "stop", TAKE_OFF, "landing"})
"""Values of the property ``kind`` with which an exported plan shows more than its areas: nothing to plan with."""


class Role(StrEnum):
    """What a feature is for in a mission."""

    BOUNDARY = "boundary"
    SURVEY = "survey"
    RESTRICTED = "restricted"
    HOME = "home"
    AREA = "area"


@dataclass(frozen=True)
class Polygon:
    """Rings that are not closed: the outline first, then the holes."""

    outline: tuple[Point, ...]
    holes: tuple[tuple[Point, ...], ...] = ()


@dataclass(frozen=True)
class Line:
    """An open line; ``width_m`` is its whole width, None where the file gives none."""

    points: tuple[Point, ...]
    width_m: float | None = None


@dataclass(frozen=True)
class Spot:
    """A circle, or a place where ``radius_m`` is None."""

    centre: Point
    radius_m: float | None = None


Shape = Polygon | Line | Spot


@dataclass(frozen=True)
class Camera:
    """The camera of a survey, as mission files have it: its view or its sensor and lens, and what images share."""

    field_of_view_deg: Point | None = None
    sensor_mm: Point | None = None
    focal_length_mm: float | None = None
    overlap: float | None = None
    sidelap: float | None = None


@dataclass(frozen=True)
class Lanes:
    """How a survey was planned by the program that drew it.

    Attributes:
        spacing_m: Between lanes; None where the file has only a camera.
        heading_deg: From north over east.
        camera: None where the file has none.
        share: How much is to be covered.
    """

    spacing_m: float | None
    heading_deg: float | None = None
    camera: Camera | None = None
    share: float | None = None


@dataclass(frozen=True)
class Feature:
    """One thing that a file draws.

    Attributes:
        name: As the file has it, empty where it has none.
        shapes: Its parts, at least one.
        role: What it is for; None where the file does not tell.
        reason: What tells that, for people: ``told by its name``.
        height_m: How high it reaches, or is flown over; None where the file does not tell.
        lanes: Of a survey that was planned already.
        clearance_m: How far to keep from it, or from its rim inside.
        loiter_s: How long to stand still inside.
        turn: Of a waypoint that is to be visited, its place in the order, from 1; 0 of anything else.
    """

    name: str
    shapes: tuple[Shape, ...]
    role: Role | None = None
    reason: str = ""
    height_m: float | None = None
    lanes: Lanes | None = None
    clearance_m: float = 0.0
    loiter_s: float = 0.0
    turn: int = 0


@dataclass(frozen=True)
class Drawing:
    """All that one file draws.

    Attributes:
        format: Of the file, for people.
        features: In the file's order.
        in_degrees: Whether points are longitudes and latitudes; otherwise they are metres.
        remarks: What of the file was left out, or read in a way that should be known.
        altitude_m: At which it was to be flown, above the start; None where the file does not tell.
        speed_m_s: The same for the speed.
        route: Waypoints of a flight, in its order.
        start: Where that took off.
        formula: What it was to satisfy, with the features' names.
        laps: How often its lap is flown, as mission files have it; empty where there is none.
        cost: What its run had least of, as mission files have it; empty where that is not told.
        smoothing: How its path was smoothed, likewise.
        tube_m: How far from its path the proof reached.
    """

    format: str
    features: tuple[Feature, ...]
    in_degrees: bool = True
    remarks: tuple[str, ...] = ()
    altitude_m: float | None = None
    speed_m_s: float | None = None
    route: tuple[Point, ...] = ()
    start: Point | None = None
    formula: str = ""
    laps: str = ""
    cost: str = ""
    smoothing: str = ""
    tube_m: float | None = None

    def points(self) -> list[Point]:
        """Every point of every feature and of the route, without the reach of circles and widths."""
        drawn = [point for feature in self.features for shape in feature.shapes for point in points_of(shape)]
        return [*drawn, *self.route]


def points_of(shape: Shape) -> tuple[Point, ...]:
    """The points that a shape is drawn by."""
    if isinstance(shape, Polygon):
        return shape.outline + tuple(point for hole in shape.holes for point in hole)
    return shape.points if isinstance(shape, Line) else (shape.centre,)


def flight_left_out(number: int) -> list[str]:
    """The remark that so many features of a flight were left out; none where there are none."""
    return [f"{number} features of a flight are left out: its path, its stops, its triangles"] * bool(number)


def broken(message: str, hint: str = "", *, path: str = "", line: int = 0, column: int = 0) -> SpecError:
    """The refusal of a file, with the place of what is wrong in it."""
    return SpecError((Fault(line, column, path, message, hint),))
