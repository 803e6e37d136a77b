"""What each flavour says, in its own words."""

from collections.abc import Mapping
from typing import Final

from vehicle_sim.autopilot.modes import Failsafe, Severity, StatusText
from vehicle_sim.parameters import Flavour

_AP, _PX4 = Flavour.ARDUPILOT, Flavour.PX4

ARMED: Final[Mapping[Flavour, StatusText]] = {
    _AP: StatusText(Severity.INFO, "Arming motors"),
    _PX4: StatusText(Severity.INFO, "Armed by external command"),
}
DISARMED: Final[Mapping[Flavour, StatusText]] = {
    _AP: StatusText(Severity.INFO, "Disarming motors"),
    _PX4: StatusText(Severity.INFO, "Disarmed by external command"),
}
DISARMED_BY_LANDING: Final[Mapping[Flavour, StatusText]] = {
    _AP: StatusText(Severity.INFO, "Disarming motors"),
    _PX4: StatusText(Severity.INFO, "Disarmed by landing"),
}
DISARM_REFUSED: Final[Mapping[Flavour, StatusText]] = {
    _AP: StatusText(Severity.WARNING, "Disarm: vehicle is flying"),
    _PX4: StatusText(Severity.CRITICAL, "Disarming denied: not landed"),
}
ALIGNED: Final[Mapping[Flavour, tuple[StatusText, ...]]] = {
    _AP: (
        StatusText(Severity.INFO, "EKF3 IMU0 initialised"),
        StatusText(Severity.INFO, "EKF3 IMU0 tilt alignment complete"),
        StatusText(Severity.INFO, "EKF3 IMU0 MAG0 initial yaw alignment complete"),
    ),
    _PX4: (),
}
ORIGIN_SET: Final[Mapping[Flavour, tuple[StatusText, ...]]] = {
    _AP: (StatusText(Severity.INFO, "EKF3 IMU0 origin set"), StatusText(Severity.INFO, "EKF3 IMU0 is using GPS")),
    _PX4: (),
}
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
        Failsafe.GROUND_LOST: StatusText(Severity.WARNING, "GCS Failsafe"),
        Failsafe.BATTERY_LOW: StatusText(Severity.WARNING, "Battery 1 is low"),
        Failsafe.BATTERY_CRITICAL: StatusText(Severity.WARNING, "Battery 1 is critical"),
        Failsafe.BATTERY_EMERGENCY: StatusText(Severity.WARNING, "Battery 1 is critical"),
        Failsafe.ESTIMATOR: StatusText(Severity.CRITICAL, "EKF variance"),
    },
    _PX4: {
        Failsafe.SETPOINTS_LOST: StatusText(Severity.CRITICAL, "Failsafe activated: No offboard signal"),
        Failsafe.GROUND_LOST: StatusText(Severity.CRITICAL, "Failsafe activated: Ground station lost"),
        Failsafe.BATTERY_LOW: StatusText(Severity.WARNING, "Low battery level"),
        Failsafe.BATTERY_CRITICAL: StatusText(Severity.CRITICAL, "Critical battery level"),
        Failsafe.BATTERY_EMERGENCY: StatusText(Severity.EMERGENCY, "Emergency battery level"),
        Failsafe.ESTIMATOR: StatusText(Severity.CRITICAL, "Failsafe activated: Position estimate invalid"),
    },
}


def mode_refused(flavour: Flavour, mode_name: str, reason: str) -> StatusText:
    """Return what is said when a mode cannot be entered; ArduPilot adds the reason."""
    if flavour is _PX4:
        return StatusText(Severity.CRITICAL, f"Switching to {mode_name} is currently not available")
    return StatusText(Severity.WARNING, f"Mode change to {mode_name} failed: {reason}")
