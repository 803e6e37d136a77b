"""What a check before the flight is made of: a row asks one thing of what is known, and judges it."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Final, NamedTuple

from mission.link.values import Fix, Wind
from mission.spec.battery import Battery

ARDUPILOT: Final = "ArduPilot"
PX4: Final = "PX4"
"""The autopilots' names in tables."""

_DIGITS: Final = 2
_ROUNDING: Final = 1e-9


class Level(StrEnum):
    """What is thought of one thing; only the last keeps a vehicle on the ground."""

    GO = "go"
    UNKNOWN = "not known"
    CAUTION = "caution"
    NO_GO = "no-go"


@dataclass(frozen=True)
class Judgement:
    """What is thought of one thing.

    Attributes:
        level: Go or no-go.
        figure: The figures that it is judged by, in plain words.
        advice: What to do; empty where nothing is to be done.
        blames_file: Whether the mission file is wrong, and not the vehicle.
    """

    level: Level
    figure: str
    advice: str = ""
    blames_file: bool = False


@dataclass(frozen=True)
class Asked:
    """What a plan asks of a vehicle. Metres, seconds, radians.

    Attributes:
        speed_m_s: The largest.
        acceleration_m_s2: The largest, level.
        jerk_m_s3: The largest, level.
        tilt_rad: How far the vehicle may lean in wind.
        yaw_rate_rad_s: The largest; None where nothing waits for the nose.
        altitude_m: Above the take-off point.
        reach_m: The farthest from the take-off point, level.
        air_s: From take-off to touch-down; infinite where laps have no end.
        setpoint_s: Between two setpoints.
        disturbance_m_s2: What the proof allows for, on each axis.
        battery: What the file says of it.
        fenced: Whether the flight sets a geofence of its own.
        unfenced: Restricted regions that are no part of that, for they move.
        system_id: Ours on the link.
        chosen: Whether the vehicle was named by its system id.
    """

    speed_m_s: float
    acceleration_m_s2: float
    jerk_m_s3: float
    tilt_rad: float
    yaw_rate_rad_s: float | None
    altitude_m: float
    reach_m: float
    air_s: float
    setpoint_s: float
    disturbance_m_s2: float
    battery: Battery | None = None
    fenced: bool = True
    unfenced: tuple[str, ...] = ()
    system_id: int = 255
    chosen: bool = False


@dataclass(frozen=True)
class Told:
    """What a vehicle has told of itself.

    Attributes:
        autopilot: Its name in tables.
        parameters: Those that are known, by the names that it has for them, in its units.
        stand: Whether it stands where the mission can begin.
        mode: The name of its mode.
        busy: Why it is in no state to begin, empty where it is in one.
        unready: What its estimator or its sensors lack, likewise.
        worst_ratio: The estimator's largest test ratio; None where it does not say.
        fix: What its satellite receiver says; None where it does not.
        battery_percent: What is left; None where it is not known.
        battery_critical: Whether it calls that critical.
        wind: Its estimate; None where it has none.
        firmware: Major, minor and patch; None where it does not say.
        system_id: Its own.
        systems: Those of all vehicles that are heard.
    """

    autopilot: str
    parameters: Mapping[str, float] = field(default_factory=dict)
    stand: Judgement = Judgement(Level.UNKNOWN, "it has not told where it is")
    mode: str = ""
    busy: str = ""
    unready: str = ""
    worst_ratio: float | None = None
    fix: Fix | None = None
    battery_percent: float | None = None
    battery_critical: bool = False
    wind: Wind | None = None
    firmware: tuple[int, int, int] | None = None
    system_id: int = 1
    systems: frozenset[int] = frozenset({1})


class Value(NamedTuple):
    """A parameter that is known.

    Attributes:
        name: The vehicle's own.
        value: In the unit of here.
        unit: One of the vehicle's units in that of here.
    """

    name: str
    value: float
    unit: float

    def own(self, value: float) -> str:
        """A value in the vehicle's own unit."""
        return f"{value / self.unit:.4g}"

    def at_least(self, value: float) -> str:
        """The same to be copied: no less, though it is rounded."""
        exact = value / self.unit
        step = 10.0 ** (math.floor(math.log10(exact)) - _DIGITS) if exact > 0.0 else 1.0
        return f"{math.ceil(exact / step - _ROUNDING) * step:.{_DIGITS + 2}g}"

    def __str__(self) -> str:
        """The name with the value as the vehicle has it."""
        return f"{self.name} {self.own(self.value)}"


@dataclass(frozen=True)
class Setting:
    """One parameter of each autopilot, under the names that its versions have for it, newest first.

    Attributes:
        names: By autopilot, pairs of a name and of its unit in that of here; an autopilot that is left out has none.
        none_is_none: Whether values that are not positive stand for no limit at all.
    """

    names: Mapping[str, tuple[tuple[str, float], ...]]
    none_is_none: bool = False

    def of(self, told: Told) -> Value | None:
        """Its value; None where that is not known, or no limit."""
        for name, unit in self.names.get(told.autopilot, ()):
            if name in told.parameters:
                value = told.parameters[name] * unit
                return None if self.none_is_none and value <= 0.0 else Value(name, value, unit)
        return None

    def exists(self, told: Told) -> bool:
        """Whether this autopilot has one."""
        return told.autopilot in self.names


@dataclass(frozen=True)
class Row:
    """One thing that is looked at.

    Attributes:
        name: By which it is overridden.
        judge: What is thought of it.
        settings: The parameters that are read for it.
        firm: Why it cannot be overridden, with what to do; empty where it can.
    """

    name: str
    judge: Callable[[Asked, Told], Judgement]
    settings: tuple[Setting, ...] = ()
    firm: str = ""


def worst(judgements: tuple[Judgement, ...]) -> Judgement:
    """Several judgements as one, the gravest first."""
    order = tuple(Level)
    ranked = sorted(judgements, key=lambda each: -order.index(each.level))
    gravest = ranked[0]
    return Judgement(
        gravest.level,
        "; ".join(each.figure for each in ranked if each.figure),
        "; ".join(each.advice for each in ranked if each.advice),
        blames_file=gravest.blames_file,
    )
