"""Faults on time: kinds of faults as a table, and when each acts how strongly.

A fault begins at a time of the vehicle's clock, since boot, since it was first armed, or since it first took off. Its
strength grows from 0 to 1 over `ramp_s`, stays, and falls again before the end. A gust is one period of (1 - cos) / 2,
the discrete gust of MIL-F-8785C.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from math import cos, inf, pi
from typing import Final, NamedTuple

from vehicle_sim.faults.conditions import PILOTED_US, Conditions, SensorState
from vehicle_sim.signals import Vector


class Since(StrEnum):
    """From which event the time of a fault counts."""

    BOOT = "boot"
    ARMING = "arming"
    TAKEOFF = "takeoff"


class Quantity(NamedTuple):
    """One number of a fault: its bounds, its default (None: it must be given), and whether it is a whole number."""

    least: float
    most: float
    default: float | None = 0.0
    whole: bool = False


@dataclass(frozen=True, slots=True)
class FaultKind:
    """What a fault is given by, and what it does: `apply` adds it, at a strength in (0, 1], to the conditions.

    `apply` is None for faults of links, which act on packets instead. `lasting` faults have a duration and a ramp;
    what is not lasting happens once and is not undone. `swells` replaces the ramp by the shape of a gust, which needs
    a duration.
    """

    quantities: Mapping[str, Quantity]
    apply: Callable[[Conditions, Mapping[str, float], float], Conditions] | None
    lasting: bool = True
    swells: bool = False


def _sum(first: Vector, second: Vector, share: float) -> Vector:
    return first[0] + share * second[0], first[1] + share * second[1], first[2] + share * second[2]


def _ned(values: Mapping[str, float], unit: str) -> Vector:
    return values[f"north_{unit}"], values[f"east_{unit}"], -values[f"up_{unit}"]


def _body(values: Mapping[str, float], unit: str) -> Vector:
    return values[f"x_{unit}"], values[f"y_{unit}"], values[f"z_{unit}"]


def _wind(now: Conditions, values: Mapping[str, float], share: float) -> Conditions:
    return now._replace(wind_ned_m_s=_sum(now.wind_ned_m_s, _ned(values, "m_s"), share))


def _gps_jump(now: Conditions, values: Mapping[str, float], share: float) -> Conditions:
    return now._replace(gps_offset_ned_m=_sum(now.gps_offset_ned_m, _ned(values, "m"), share))


def _gps_drift(now: Conditions, values: Mapping[str, float], share: float) -> Conditions:
    return now._replace(gps_drift_ned_m_s=_sum(now.gps_drift_ned_m_s, _ned(values, "m_s"), share))


def _satellites(now: Conditions, values: Mapping[str, float], _share: float) -> Conditions:
    return now._replace(gps_satellites=min(now.gps_satellites, int(values["count"])))


def _accelerometer_bias(now: Conditions, values: Mapping[str, float], share: float) -> Conditions:
    return now._replace(accelerometer_bias_m_s2=_sum(now.accelerometer_bias_m_s2, _body(values, "m_s2"), share))


def _gyro_bias(now: Conditions, values: Mapping[str, float], share: float) -> Conditions:
    return now._replace(gyro_bias_rad_s=_sum(now.gyro_bias_rad_s, _body(values, "rad_s"), share))


def _compass_offset(now: Conditions, values: Mapping[str, float], share: float) -> Conditions:
    return now._replace(field_offset_gauss=_sum(now.field_offset_gauss, _body(values, "gauss"), share))


def _motor(now: Conditions, values: Mapping[str, float], share: float) -> Conditions:
    rotor, left = int(values["rotor"]) - 1, 1.0 - share * (1.0 - values["efficiency"])
    first, second, third, fourth = (e * left if index == rotor else e for index, e in enumerate(now.efficiencies))
    return now._replace(efficiencies=(first, second, third, fourth))


def _radio(now: Conditions, values: Mapping[str, float], _share: float) -> Conditions:
    sent, changed = now.radio_us or PILOTED_US, int(values["channel"])
    pulses = enumerate(sent, start=1)
    return now._replace(radio_us=tuple(values["pulse_us"] if number == changed else pulse for number, pulse in pulses))


def _axes(names: tuple[str, ...], unit: str, most: float) -> dict[str, Quantity]:
    return {f"{name}_{unit}": Quantity(-most, most) for name in names}


_PLACE: Final = ("north", "east", "up")
_BODY: Final = ("x", "y", "z")
_LIKELIHOOD: Final = Quantity(0.0, 1.0)

KINDS: Final[Mapping[str, FaultKind]] = {
    "wind": FaultKind(_axes(_PLACE, "m_s", 30.0), _wind),
    "gust": FaultKind(_axes(_PLACE, "m_s", 30.0), _wind, swells=True),
    "gps_loss": FaultKind({}, lambda now, _values, _share: now._replace(gps=SensorState.SILENT)),
    "gps_stuck": FaultKind({}, lambda now, _values, _share: now._replace(gps=SensorState.STUCK)),
    "gps_jump": FaultKind(_axes(_PLACE, "m", 10_000.0), _gps_jump),
    "gps_drift": FaultKind(_axes(_PLACE, "m_s", 20.0), _gps_drift),
    "gps_noise": FaultKind(
        {"noise_m": Quantity(0.0, 100.0, None)},
        lambda now, values, share: now._replace(gps_noise_m=now.gps_noise_m + share * values["noise_m"]),
    ),
    "gps_lag": FaultKind(
        {"lag_s": Quantity(0.0, 1.0, None)}, lambda now, values, _share: now._replace(gps_lag_s=values["lag_s"])
    ),
    "gps_satellites": FaultKind({"count": Quantity(0, 30, None, whole=True)}, _satellites),
    "accelerometer_bias": FaultKind(_axes(_BODY, "m_s2", 5.0), _accelerometer_bias),
    "gyro_bias": FaultKind(_axes(_BODY, "rad_s", 1.0), _gyro_bias),
    "compass_loss": FaultKind({}, lambda now, _values, _share: now._replace(compass=SensorState.SILENT)),
    "compass_offset": FaultKind(_axes(_BODY, "gauss", 1.0), _compass_offset),
    "baro_loss": FaultKind({}, lambda now, _values, _share: now._replace(baro=SensorState.SILENT)),
    "baro_stuck": FaultKind({}, lambda now, _values, _share: now._replace(baro=SensorState.STUCK)),
    "baro_jump": FaultKind(
        {"up_m": Quantity(-1000.0, 1000.0, None)},
        lambda now, values, share: now._replace(baro_offset_m=now.baro_offset_m + share * values["up_m"]),
    ),
    "baro_drift": FaultKind(
        {"up_m_s": Quantity(-10.0, 10.0, None)},
        lambda now, values, share: now._replace(baro_drift_m_s=now.baro_drift_m_s + share * values["up_m_s"]),
    ),
    "motor": FaultKind({"rotor": Quantity(1, 4, None, whole=True), "efficiency": Quantity(0.0, 1.0, None)}, _motor),
    "battery": FaultKind(
        {"voltage_v": Quantity(0.0, 12.6, None)},
        lambda now, values, _share: now._replace(resting_v=values["voltage_v"]),
        lasting=False,
    ),
    "radio": FaultKind(
        {"channel": Quantity(1, 16, None, whole=True), "pulse_us": Quantity(800.0, 2200.0, None)}, _radio
    ),
    "radio_loss": FaultKind({}, lambda now, _values, _share: now._replace(radio_lost=True)),
    "link": FaultKind(
        {
            "up": Quantity(0, 1, 1, whole=True),
            "down": Quantity(0, 1, 1, whole=True),
            "drop": _LIKELIHOOD,
            "duplicate": _LIKELIHOOD,
            "corrupt": _LIKELIHOOD,
            "reorder": _LIKELIHOOD,
            "delay_s": Quantity(0.0, 10.0),
            "jitter_s": Quantity(0.0, 10.0),
        },
        None,
    ),
}
"""The kinds of faults by the names that files give them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ScheduledFault:
    """One fault: its kind, when it acts, and its numbers, complete."""

    kind: str
    values: Mapping[str, float]
    since: Since = Since.BOOT
    at_s: float = 0.0
    for_s: float = inf
    ramp_s: float = 0.0

    def strength(self, age_s: float) -> float:
        """Return how strongly it acts `age_s` after its beginning, 0 to 1."""
        if age_s < 0.0 or age_s >= self.for_s:
            return 0.0
        if KINDS[self.kind].swells:
            return 0.5 - 0.5 * cos(2.0 * pi * age_s / self.for_s)
        if self.ramp_s <= 0.0:
            return 1.0
        return min(1.0, age_s / self.ramp_s, (self.for_s - age_s) / self.ramp_s)


class Schedule(NamedTuple):
    """All faults of a flight."""

    faults: tuple[ScheduledFault, ...]


NO_FAULTS: Final = Schedule(())
"""Nothing ever goes wrong."""
