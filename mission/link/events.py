"""What a session tells those who record and show the flight; vectors in the domain's frame (ENU, metres)."""

from dataclasses import dataclass
from typing import NamedTuple

from mission.link.course import Reference
from mission.link.frames import Vector
from mission.monitor.gaps import Gap
from mission.monitor.stage import Stage


@dataclass(frozen=True, slots=True)
class Identified:
    """Which vehicle it is."""

    autopilot: str
    vehicle_type: str
    system_id: int


@dataclass(frozen=True, slots=True)
class VersionTold:
    """Which firmware it runs, on which board; that is empty where it has told none."""

    firmware: str
    board: str


@dataclass(frozen=True, slots=True)
class StageEntered:
    """The session went on to another stage."""

    t_s: float | None
    stage: Stage


@dataclass(frozen=True, slots=True)
class Said:
    """A text of the vehicle; severity as in syslog, 0 the gravest."""

    t_s: float | None
    severity: int
    text: str


@dataclass(frozen=True, slots=True)
class Asked:
    """A command was sent; ``attempt`` counts from 0."""

    t_s: float | None
    command: str
    attempt: int


@dataclass(frozen=True, slots=True)
class Answered:
    """A command was answered, or given up."""

    t_s: float | None
    command: str
    result: str


@dataclass(frozen=True, slots=True)
class Anchored:
    """From now on positions are in the domain: where its origin lies in the vehicle's local frame (NED)."""

    t_s: float
    origin_ned_m: Vector


class Moved(NamedTuple):
    """The vehicle reported where it is; attitude is roll, pitch, yaw against NED, None before the first.

    ``planned_m`` is where it should have been then, ``planned_m_s`` how fast; ``trajectory_s`` is the time on the
    trajectory, None before its start and after its end.
    """

    t_s: float
    position_m: Vector
    velocity_m_s: Vector
    attitude_rad: Vector | None
    planned_m: Vector
    planned_m_s: Vector
    trajectory_s: float | None


class SetpointSent(NamedTuple):
    """A setpoint was sent; ``trajectory_s`` as in ``Moved``; ``gap`` is the pause of the trajectory that it ended."""

    t_s: float
    reference: Reference
    yaw_rad: float
    trajectory_s: float | None
    gap: Gap | None


@dataclass(frozen=True, slots=True)
class Held:
    """Somebody else took the vehicle and is waited for; without words, it was handed back."""

    t_s: float | None
    words: str


@dataclass(frozen=True, slots=True)
class WentOn:
    """A step was left although it did not come to its end; the words say what did not happen."""

    t_s: float | None
    words: str


@dataclass(frozen=True, slots=True)
class Photographed:
    """The vehicle told of a picture; what is not known is None.

    ``place`` is latitude and longitude in degrees and the height above mean sea level, ``attitude_rad`` roll, pitch and
    yaw against NED, ``accuracy_m`` how far off the place may be, level and in height, ``trajectory_s`` as in ``Moved``.
    """

    t_s: float
    number: int
    utc_us: int | None
    place: Vector | None
    position_m: Vector | None
    attitude_rad: Vector | None
    accuracy_m: tuple[float, float] | None
    trajectory_s: float | None


Event = (
    Identified
    | VersionTold
    | StageEntered
    | Said
    | Asked
    | Answered
    | Anchored
    | Moved
    | SetpointSent
    | Held
    | WentOn
    | Photographed
)
