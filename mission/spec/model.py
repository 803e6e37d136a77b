"""The values of a mission file, frozen. ENU, metres, seconds, radians unless a name says otherwise."""

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Final, Literal

from mission.geometry.geodesy import LatLon
from mission.spec.battery import Battery
from mission.spec.heading import YAW_RATE_DEG_S, Heading
from mission.spec.motion import Motion
from mission.spec.task import Task
from mission.spec.tube import NO_MARGINS, Margins, causes, disturbed_m, disturbed_m_s

if TYPE_CHECKING:  # the command line reads these values before it loads a library
    from mission.logic.automata.automaton import GeneralisedBuchi

Point = tuple[float, float]

UNTIL_STOPPED: Final = "until_stopped"
"""In the place of a number of laps: as many as are flown until somebody says that it is enough."""

MOST_LAPS: Final = 10_000


SUFFIX_DECIDES: Final = "decides"
"""In the place of a weight of the suffix: it is made best first, whatever leads to it."""

MOST_WEIGHT: Final = 1_000_000


class RegionKind(StrEnum):
    """What a region is for; restricted ones are never entered, whatever the formula says, and areas are only named."""

    SURVEY = "survey"
    RESTRICTED = "restricted"
    HOME = "home"
    AREA = "area"


class Semantics(StrEnum):
    """Whether the word of a run begins with the label of the start triangle (standard) or after it (paper)."""

    STANDARD = "standard"
    PAPER = "paper"


class Cost(StrEnum):
    """What a run should have least of."""

    TRANSITIONS = "transitions"
    DISTANCE = "distance"
    TIME = "time"


class Extension(StrEnum):
    """How the planned path is extended before its Fourier series is taken."""

    EVEN = "even"
    ODD = "odd"


@dataclass(frozen=True)
class NodesDomain:
    """The convex hull of the nodes, triangulated by Delaunay (the paper's way).

    Attributes:
        nodes_m: Where they are at first.
        motions: Some of them, by number, and how these move.
    """

    nodes_m: tuple[Point, ...]
    motions: tuple[tuple[tuple[int, ...], Motion], ...] = ()


@dataclass(frozen=True)
class Refinement:
    """How fine a mesh is made.

    Attributes:
        smallest_angle_deg: No angle is smaller but where the outlines have one.
        largest_m: No edge is longer.
    """

    smallest_angle_deg: float
    largest_m: float


@dataclass(frozen=True)
class PolygonShape:
    """A simple polygon, without its holes."""

    corners_m: tuple[Point, ...]
    holes_m: tuple[tuple[Point, ...], ...] = ()


@dataclass(frozen=True)
class PolygonsShape:
    """Several polygons; they may touch and overlap."""

    parts: tuple[PolygonShape, ...]


@dataclass(frozen=True)
class CircleShape:
    """A circle with what is in it."""

    centre_m: Point
    radius_m: float


@dataclass(frozen=True)
class StripShape:
    """What lies beside a line, by half the width on each side; flat at the ends, round at the bends."""

    line_m: tuple[Point, ...]
    width_m: float


AreaShape = PolygonShape | PolygonsShape | CircleShape | StripShape


@dataclass(frozen=True)
class BoundaryDomain:
    """An area, whose mesh refines itself until all outlines are in it and no triangle is too thin or too large.

    Attributes:
        boundary: As it is drawn.
        refinement: How fine the mesh is.
        clearance_m: How far the vehicle keeps from the boundary.
        restricted_clearance_m: How far it keeps from restricted regions that say nothing of that.
    """

    boundary: AreaShape
    refinement: Refinement
    clearance_m: float = 0.0
    restricted_clearance_m: float = 0.0


@dataclass(frozen=True)
class TriangleShape:
    """A region that is one triangle, named by its three node indices in any order."""

    nodes: tuple[int, int, int]


@dataclass(frozen=True)
class PointShape:
    """A region that is the one triangle with this point inside."""

    point_m: Point


@dataclass(frozen=True)
class Camera:
    """A camera that looks straight down, the width of its image across the lanes.

    Attributes:
        field_of_view_deg: Angles of view across and along the lanes; None where the sensor is given.
        sensor_mm: Size of the sensor across and along the lanes.
        focal_length_mm: Of its lens.
        overlap: Share of an image that the next one in its lane shows too, from 0 to less than 1.
        sidelap: Share of an image that the one beside it in the next lane shows too.
    """

    field_of_view_deg: Point | None
    sensor_mm: Point | None
    focal_length_mm: float | None
    overlap: float
    sidelap: float


@dataclass(frozen=True)
class Cover:
    """How a region is covered by lanes whenever it is visited; exactly one of ``spacing_m`` and ``camera`` is given.

    Attributes:
        spacing_m: Distance between lanes.
        camera: From which it follows.
        heading_deg: Of the lanes, clockwise from north; None for the one that takes least time.
        share: How much of the region the flight must really cover.
    """

    spacing_m: float | None
    camera: Camera | None
    heading_deg: float | None
    share: float


@dataclass(frozen=True)
class Region:
    """A named region.

    Attributes:
        name: As the formula has it.
        kind: What it is for.
        shape: As it is drawn.
        loiter_s: How long the vehicle stands still inside each time that it enters. To start inside is not to enter.
        clearance_m: By how much it is larger than drawn, if it is restricted, or smaller, if not; None where the file
            says nothing of that.
        speed_m_s: The largest speed while any of the tube may be inside; None where the file says nothing of that.
        cover: How it is covered: a visit of it is complete when its lanes are flown; None where it is only visited.
        active_s: From when to when it is there, by the clock of the trajectory, both included, the end infinite where
            it is there from then on; None where it is there all the time.
        motion: How it moves; None where it stays where it is drawn.
    """

    name: str
    kind: RegionKind
    shape: TriangleShape | PointShape | AreaShape
    loiter_s: float = 0.0
    cover: Cover | None = None
    clearance_m: float | None = None
    speed_m_s: float | None = None
    active_s: tuple[float, float] | None = None
    motion: Motion | None = None

    @property
    def forbidden(self) -> bool:
        """Whether it is never entered, at no time."""
        return self.kind is RegionKind.RESTRICTED and self.active_s is None


@dataclass(frozen=True)
class Origin(LatLon):
    """Where the domain's (0, 0) lies, WGS 84."""


@dataclass(frozen=True)
class Start:
    """Initial state of the steering system in the domain's frame."""

    position_m: Point
    velocity_m_s: Point = (0.0, 0.0)


FIELD: Final = "field"
TRAJECTORY: Final = "trajectory"
"""Of ``Flight.guidance``: by the affine field where the vehicle is, or along a trajectory by its time law."""


@dataclass(frozen=True)
class Flight:
    """How it is flown.

    Attributes:
        speed_m_s: Reference speed c of Eq. 19.
        altitude_m: Height above the take-off point.
        final_stay_s: Time under u_0 in the last triangle (of a run that ends in a stay).
        laps: How often the suffix of a recurrent run is flown before the vehicle returns.
        time_constant_s: tau of the tracking law, Eq. 12: K = [1/tau^2 I, 2/tau I].
        disturbance_m_s2: Bound w on each axis of the acceleration that the tracking law does not know of.
        margins: What else the tube has to hold, by which the certificate inflates the path.
        guidance: What leads the vehicle.
        heading: Where the nose looks; None where the file says nothing of that: it follows the flight as it can.
        replan: Whether a flight that has left the tube of its trajectory goes on by another plan.
        longest_s: How long it may take from arming to landing; None for as long as it takes.
    """

    speed_m_s: float
    altitude_m: float
    final_stay_s: float
    laps: int | Literal["until_stopped"]
    time_constant_s: float
    disturbance_m_s2: float
    margins: Margins = NO_MARGINS
    guidance: Literal["trajectory", "field"] = TRAJECTORY
    heading: Heading | None = None
    replan: bool = False
    longest_s: float | None = None

    @property
    def tube_m(self) -> float:
        """Half width of the tube on each axis: bounds the error under a disturbance w, and from the other causes."""
        return disturbed_m(self.disturbance_m_s2, self.time_constant_s) + self.margins.sum_m

    @property
    def landing_m(self) -> float:
        """How far a landing may drift on each axis from where the vehicle was in its tube, by the same causes."""
        return disturbed_m(self.disturbance_m_s2, self.time_constant_s) + self.margins.own_m

    @property
    def tube_m_s(self) -> float:
        """The same of the velocity's error."""
        return disturbed_m_s(self.disturbance_m_s2, self.time_constant_s) + self.margins.following_m_s

    @property
    def tube_causes(self) -> tuple[tuple[str, float], ...]:
        """What the tube is made of, in plain words, each with its share in metres."""
        return tuple(causes(self.disturbance_m_s2, self.time_constant_s, self.margins))


@dataclass(frozen=True)
class Search:
    """Which runs are best.

    Attributes:
        cost: What is counted.
        prefix_weight: How much the part that is flown once weighs.
        suffix_weight: How much the part that is repeated weighs; None where it decides.
    """

    cost: Cost = Cost.DISTANCE
    prefix_weight: int = 1
    suffix_weight: int | None = None


CORRIDOR: Final = "corridor"
"""Of ``MissionSpec.smoothing``: a curve in the corridor of a taut path."""


@dataclass(frozen=True)
class Smoothing:
    """Fourier smoothing of the path of the fields (Sec. 4.3); ``auto`` takes as few frequencies as the proof needs."""

    extension: Extension
    frequencies: int | Literal["auto"]


@dataclass(frozen=True)
class Limits:
    """What the vehicle can do; the trajectory is slowed down where it would exceed them.

    The default of the jerk is PX4's in its missions (MPC_JERK_AUTO); ArduCopter's is 5 m/s^3 (PSC_JERK_XY).
    """

    speed_m_s: float
    acceleration_m_s2: float
    tilt_rad: float
    jerk_m_s3: float = 4.0
    yaw_rate_rad_s: float = math.radians(YAW_RATE_DEG_S)


@dataclass(frozen=True)
class NamedAutomaton:
    """An automaton that a mission names instead of giving a formula.

    Attributes:
        file: Where it was read, as the mission file has it: relative to that file.
        text: What was read, in the Hanoi Omega-Automata format.
        automaton: The same, its propositions being names of regions.
    """

    file: str
    text: str
    automaton: "GeneralisedBuchi"


@dataclass(frozen=True)
class MissionSpec:
    """A whole, valid mission file.

    ``formula`` is as written, empty where the file names an automaton instead, or gives tasks only.
    """

    name: str
    description: str
    domain: NodesDomain | BoundaryDomain
    regions: tuple[Region, ...]
    formula: str
    semantics: Semantics
    run: int
    start: Start
    origin: Origin | None
    flight: Flight
    smoothing: Smoothing | Literal["corridor"]
    limits: Limits
    search: Search = Search()
    tasks: tuple[Task, ...] = ()
    automaton: NamedAutomaton | None = None
    battery: Battery | None = None

    @property
    def moves(self) -> bool:
        """Whether a part of its domain moves."""
        of_nodes = self.domain.motions if isinstance(self.domain, NodesDomain) else ()
        motions = (*(region.motion for region in self.regions), *(motion for _, motion in of_nodes))
        return any(motion is not None and motion.moves for motion in motions)
