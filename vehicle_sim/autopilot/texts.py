"""What each flavour says, in its own words."""

from collections.abc import Mapping
from typing import Final

from vehicle_sim.autopilot.modes import Failsafe, Severity, StatusText
from vehicle_sim.parameters import FenceType, Flavour

_AP, _PX4 = Flavour.ARDUPILOT, Flavour.PX4

ARMED: Final[Mapping[Flavour, StatusText]] = {
    _AP: StatusText(Severity.INFO, "Arming motors"),
    _PX4: StatusText(Severity.INFO, "Armed by external command"),
}
ARMED_BY_STICKS: Final[Mapping[Flavour, StatusText]] = {
    _AP: ARMED[_AP],
    _PX4: StatusText(Severity.INFO, "Armed by Stick gesture"),
}
DISARMED: Final[Mapping[Flavour, StatusText]] = {
    _AP: StatusText(Severity.INFO, "Disarming motors"),
    _PX4: StatusText(Severity.INFO, "Disarmed by external command"),
}
DISARMED_BY_STICKS: Final[Mapping[Flavour, StatusText]] = {
    _AP: DISARMED[_AP],
    _PX4: StatusText(Severity.INFO, "Disarmed by Stick gesture"),
}
DISARMED_BY_LANDING: Final[Mapping[Flavour, StatusText]] = {
    _AP: StatusText(Severity.INFO, "Disarming motors"),
    _PX4: StatusText(Severity.INFO, "Disarmed by landing"),
}
DISARM_REFUSED: Final[Mapping[Flavour, StatusText]] = {
    _AP: StatusText(Severity.WARNING, "Disarm: vehicle is flying"),
    _PX4: StatusText(Severity.CRITICAL, "Disarming denied: not landed"),
}
BOOTED: Final[Mapping[Flavour, tuple[StatusText, ...]]] = {
    _AP: (
        StatusText(Severity.DEBUG, "RCInput: decoding UDP (Pulses)"),
        StatusText(Severity.INFO, "Calibrating barometer"),
        StatusText(Severity.INFO, "Barometer 1 calibration complete"),
        StatusText(Severity.INFO, "ArduPilot Ready"),
        StatusText(Severity.INFO, "AHRS: DCM active"),
    ),
    _PX4: (),
}
ALIGNED: Final[Mapping[Flavour, tuple[StatusText, ...]]] = {
    _AP: (
        StatusText(Severity.INFO, "EKF3 IMU0 initialised"),
        StatusText(Severity.INFO, "AHRS: EKF3 active"),
        StatusText(Severity.INFO, "EKF3 IMU0 tilt alignment complete"),
        StatusText(Severity.INFO, "EKF3 IMU0 MAG0 initial yaw alignment complete"),
        StatusText(Severity.INFO, "GPS 1: probing for u-blox at 230400 baud"),
        StatusText(Severity.INFO, "GPS 1: detected u-blox"),
    ),
    _PX4: (),
}
ORIGIN_SET: Final[Mapping[Flavour, tuple[StatusText, ...]]] = {
    _AP: (
        StatusText(Severity.INFO, "EKF3 IMU0 origin set"),
        StatusText(Severity.INFO, "Field Elevation Set: {alt_m:.0f}m"),
        StatusText(Severity.INFO, "EKF3 IMU0 is using GPS"),
    ),
    _PX4: (),
}
CLIMBED: Final[Mapping[Flavour, tuple[StatusText, ...]]] = {
    _AP: (StatusText(Severity.INFO, "EKF3 IMU0 MAG0 in-flight yaw alignment complete"),),
    _PX4: (),
}
RETURNS: Final[Mapping[Flavour, tuple[StatusText, ...]]] = {
    _AP: (),
    _PX4: (StatusText(Severity.INFO, "RTL: start return at {alt_m:d} m ({height_m:d} m above destination)"),),
}
RETURNED: Final[Mapping[Flavour, tuple[StatusText, ...]]] = {
    _AP: (),
    _PX4: (StatusText(Severity.INFO, "RTL: land at destination"),),
}
GROUND_HIT: Final[Mapping[Flavour, tuple[StatusText, ...]]] = {
    _AP: (StatusText(Severity.INFO, "SIM Hit ground at {speed_m_s:.2f} m/s"),),
    _PX4: (),
}
"""Its simulator says so, not the autopilot."""

TAKEN_OFF: Final[Mapping[Flavour, tuple[StatusText, ...]]] = {
    _AP: (),
    _PX4: (StatusText(Severity.INFO, "Takeoff detected"),),
}
LANDED: Final[Mapping[Flavour, tuple[StatusText, ...]]] = {
    _AP: (),
    _PX4: (StatusText(Severity.INFO, "Landing detected"),),
}
FAILED: Final[Mapping[Flavour, Mapping[Failsafe, StatusText]]] = {
    _AP: {
        Failsafe.STICKS_LOST: StatusText(Severity.WARNING, "Radio Failsafe"),
        Failsafe.GROUND_LOST: StatusText(Severity.WARNING, "GCS Failsafe"),
        Failsafe.BATTERY_LOW: StatusText(Severity.WARNING, "Battery 1 is low"),
        Failsafe.BATTERY_CRITICAL: StatusText(Severity.WARNING, "Battery 1 is critical"),
        Failsafe.BATTERY_EMERGENCY: StatusText(Severity.WARNING, "Battery 1 is critical"),
        Failsafe.ESTIMATOR: StatusText(Severity.CRITICAL, "EKF variance"),
    },
    _PX4: {
        Failsafe.SETPOINTS_LOST: StatusText(Severity.CRITICAL, "Failsafe activated: No offboard signal"),
        Failsafe.STICKS_LOST: StatusText(Severity.CRITICAL, "Failsafe activated: Manual control lost"),
        Failsafe.GROUND_LOST: StatusText(Severity.CRITICAL, "Failsafe activated: Ground station lost"),
        Failsafe.BATTERY_LOW: StatusText(Severity.WARNING, "Low battery level"),
        Failsafe.BATTERY_CRITICAL: StatusText(Severity.CRITICAL, "Critical battery level"),
        Failsafe.BATTERY_EMERGENCY: StatusText(Severity.EMERGENCY, "Emergency battery level"),
        Failsafe.ESTIMATOR: StatusText(Severity.CRITICAL, "Failsafe activated: Position estimate invalid"),
        Failsafe.WIND: StatusText(Severity.CRITICAL, "Failsafe activated: Wind speed is above limit"),
    },
}
OVER: Final[Mapping[Flavour, Mapping[Failsafe, StatusText]]] = {
    _AP: {
        Failsafe.STICKS_LOST: StatusText(Severity.WARNING, "Radio Failsafe Cleared"),
        Failsafe.GROUND_LOST: StatusText(Severity.WARNING, "GCS Failsafe Cleared"),
        Failsafe.ESTIMATOR: StatusText(Severity.CRITICAL, "EKF Failsafe Cleared"),
        Failsafe.FENCE: StatusText(Severity.NOTICE, "Fence breach cleared"),
    },
    _PX4: {},
}
PX4_BREACHES: Final[Mapping[FenceType, StatusText]] = {
    FenceType.CIRCLE: StatusText(Severity.CRITICAL, "Geofence: exceeding maximum distance to Home"),
    FenceType.ALTITUDE: StatusText(Severity.CRITICAL, "Geofence: exceeding maximum altitude above Home"),
    FenceType.AREAS: StatusText(Severity.CRITICAL, "Geofence: approaching or outside geofence"),
}
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
