"""What the map and the histories are drawn from: arrays and shapes, of a flight that is over or of one under way.

Domain ENU, metres, seconds of the vehicle's clock.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from shapely.geometry.base import BaseGeometry

from mission.geometry.arrays import FloatArray
from mission.spec.model import RegionKind


@dataclass(frozen=True, eq=False)
class Area:
    """A region as it is drawn; ``shape`` is a polygon, with holes or in several parts.

    Attributes:
        name: Its name.
        kind: What it is for.
        shape: Where it is; where it moves, at first.
        later: Where it is at each of the instants of the scene, its corners in the same order; empty where it stands.
    """

    name: str
    kind: RegionKind
    shape: BaseGeometry
    later: tuple[BaseGeometry, ...] = ()


@dataclass(frozen=True, eq=False)
class Margin:
    """The ground between an outline and where its clearance ends; ``later`` as of ``Area``."""

    shape: BaseGeometry
    later: tuple[BaseGeometry, ...] = ()


@dataclass(frozen=True, eq=False)
class Layer:
    """A line on the map that can be switched off; points have shape (N, 2), and rows of NaN interrupt it."""

    label: str
    points_m: FloatArray
    colour: str
    width: float
    dash: str = "solid"


@dataclass(frozen=True, eq=False)
class Cover:
    """A part of the ground on the map that can be switched off, such as the tube or what was left out."""

    label: str
    shape: BaseGeometry
    colour: str
    alpha: float


@dataclass(frozen=True, eq=False)
class Dots:
    """Places on the map that can be switched off: shape (N, 2), and N texts that tell one from another."""

    label: str
    points_m: FloatArray
    texts: tuple[str, ...]


@dataclass(frozen=True)
class Nearest:
    """Where a flight was nearest to a region: the two ends of the shortest line, and its length."""

    name: str
    flown_m: tuple[float, float]
    region_m: tuple[float, float]
    distance_m: float


@dataclass(frozen=True, eq=False)
class Scene:
    """All of a map but the path that is flown.

    Attributes:
        land: The domain.
        areas: Its regions.
        margins: Their clearances, and that of the domain.
        covers: Parts of the ground.
        layers: Lines.
        dots: Places.
        nearest: Where a flight was nearest to what is restricted.
        instants_s: On the clock of the trajectory, those between which all that moves goes straight.
    """

    land: BaseGeometry
    areas: tuple[Area, ...]
    margins: tuple[Margin, ...] = ()
    covers: tuple[Cover, ...] = ()
    layers: tuple[Layer, ...] = ()
    dots: tuple[Dots, ...] = ()
    nearest: tuple[Nearest, ...] = ()
    instants_s: tuple[float, ...] = ()


@dataclass(frozen=True, eq=False)
class Flown:
    """What was reported, at N times: ``t_s`` has shape (N,), ``position_m`` (N, 2), each of ``columns`` (N,).

    What is not known is NaN.
    """

    t_s: FloatArray
    position_m: FloatArray
    columns: Mapping[str, FloatArray]


@dataclass(frozen=True)
class Trace:
    """One line of a history: a column of ``Flown``, and what it is called beside the others."""

    column: str
    label: str
    colour: str
    width: float = 1.8
    dash: str = "solid"


@dataclass(frozen=True)
class Bound:
    """A level that a history is to be compared with."""

    label: str
    value: float


@dataclass(frozen=True)
class History:
    """A plot over time. Of its traces the first is what is said in words where somebody points at a time."""

    title: str
    unit: str
    traces: tuple[Trace, ...]
    bounds: tuple[Bound, ...] = ()
    digits: int = 2
    from_zero: bool = False


@dataclass(frozen=True)
class Band:
    """A stretch of time, such as that in a region or in a phase of the flight."""

    from_s: float
    to_s: float
    text: str
    colour: str


@dataclass(frozen=True)
class Timeline:
    """The histories of a flight, on one axis of time.

    Attributes:
        regions: When the vehicle was in which of them.
        phases: What it was doing.
        histories: From top to bottom.
        begun_s: When the clock of the trajectory began, by which regions move; None where it never did.
    """

    regions: tuple[Band, ...] = ()
    phases: tuple[Band, ...] = ()
    histories: tuple[History, ...] = ()
    begun_s: float | None = None
