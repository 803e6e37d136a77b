"""What each flavour says, in its own words."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from vehicle_sim.autopilot.modes import Failsafe, Mode, Severity, StatusText
from vehicle_sim.parameters import FenceType, Flavour

_AP, _PX4 = Flavour.ARDUPILOT, Flavour.PX4

_TABLES: Final[dict[str, Any]] = json.loads(Path(__file__).with_name("texts.json").read_text(encoding="utf-8"))


def _text(row: Sequence[str]) -> StatusText:
    return StatusText(Severity[row[0]], row[1])


def _said(name: str) -> dict[Flavour, tuple[StatusText, ...]]:
    """Return what each flavour says at once, as the file beside this one has it."""
    return {flavour: tuple(map(_text, _TABLES[name].get(flavour.value, ()))) for flavour in Flavour}


def _one(name: str) -> dict[Flavour, StatusText]:
    return {flavour: said[0] for flavour, said in _said(name).items()}


def _of_failures(name: str) -> dict[Flavour, dict[Failsafe, StatusText]]:
    return {
        Flavour(flavour): {Failsafe[key]: _text(row) for key, row in rows.items()}
        for flavour, rows in _TABLES[name].items()
    }


ARMED: Final = _one("ARMED")
ARMED_BY_STICKS: Final = _one("ARMED_BY_STICKS")
DISARMED: Final = _one("DISARMED")
DISARMED_BY_STICKS: Final = _one("DISARMED_BY_STICKS")
DISARMED_BY_LANDING: Final = _one("DISARMED_BY_LANDING")
DISARM_REFUSED: Final = _one("DISARM_REFUSED")
BOOTED: Final = _said("BOOTED")
ALIGNED: Final = _said("ALIGNED")
ORIGIN_SET: Final = _said("ORIGIN_SET")
CLIMBED: Final = _said("CLIMBED")
RETURNS: Final = _said("RETURNS")
RETURNED: Final = _said("RETURNED")
GROUND_HIT: Final = _said("GROUND_HIT")
"""ArduPilot's simulator says so, not the autopilot."""

TAKEN_OFF: Final = _said("TAKEN_OFF")
LANDED: Final = _said("LANDED")
FAILED: Final = _of_failures("FAILED")
OVER: Final = _of_failures("OVER")
PX4_BREACHES: Final[Mapping[FenceType, StatusText]] = {
    FenceType.CIRCLE: StatusText(Severity.CRITICAL, "Geofence: exceeding maximum distance to Home"),
    FenceType.ALTITUDE: StatusText(Severity.CRITICAL, "Geofence: exceeding maximum altitude above Home"),
    FenceType.AREAS: StatusText(Severity.CRITICAL, "Geofence: approaching or outside geofence"),
}
UNAVAILABLE: Final = {
    Mode.RETURN: "SmartRTL Unavailable, Trying RTL Mode",
    Mode.LAND: "SmartRTL Unavailable, Using Land Mode",
}
"""What is flown where there is no way back."""
REPOSITION_OUTSIDE: Final = StatusText(Severity.CRITICAL, "Reposition is outside geofence")


def filled(said: tuple[StatusText, ...], **numbers: float) -> list[StatusText]:
    """Return texts with their numbers."""
    return [StatusText(severity, text.format(**numbers)) for severity, text in said]


def fence_without(what: str) -> StatusText:
    """Return what PX4 says of an uploaded area that it leaves out."""
    return StatusText(Severity.CRITICAL, f"Geofence invalid, doesn't contain {what}")


def pausing(seconds: float) -> StatusText:
    """Return what PX4 says when it holds before it acts."""
    return StatusText(Severity.CRITICAL, f"Failsafe activated, entering Hold for {seconds:.0f} seconds")


def high_wind(speed_m_s: float) -> StatusText:
    """Return what PX4 says of a wind above COM_WIND_WARN."""
    return StatusText(Severity.WARNING, f"High wind speed detected ({speed_m_s:.1f} m/s), landing advised")


def estimator_changed(mode_name: str) -> StatusText:
    """Return what ArduPilot says when a failed estimator has led to another mode."""
    return StatusText(Severity.CRITICAL, f"EKF Failsafe: changed to {mode_name} Mode")


def mode_refused(flavour: Flavour, mode_name: str, reason: str) -> StatusText:
    """Return what is said when a mode cannot be entered; ArduPilot adds the reason."""
    if flavour is _PX4:
        return StatusText(Severity.CRITICAL, f"Switching to {mode_name} is currently not available")
    return StatusText(Severity.WARNING, f"Mode change to {mode_name} failed: {reason}")
