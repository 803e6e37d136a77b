"""Arming checks: what keeps the vehicle from being armed, as reasons with the texts of each flavour."""

from collections.abc import Mapping
from enum import Enum, auto
from typing import Final, NamedTuple

from vehicle_sim.autopilot.hand import Pilot
from vehicle_sim.autopilot.modes import BY_ATTITUDE, DIRECT, KEEPING_PLACE, Mode, ModeRule, is_by_hand
from vehicle_sim.battery import BatteryLevel
from vehicle_sim.parameters import Flavour
from vehicle_sim.signals import Estimate


class ArmingReason(Enum):
    """Why the vehicle may not be armed."""

    CALIBRATING = auto()
    NO_POSITION = auto()
    NO_HEIGHT = auto()
    NO_HOME = auto()
    MODE = auto()
    NO_SETPOINTS = auto()
    BATTERY = auto()
    GROUND_LOST = auto()
    FENCE_BLIND = auto()
    OUTSIDE_FENCE = auto()
    NO_MISSION = auto()
    NO_RADIO = auto()
    RADIO_LOST = auto()
    THROTTLE_HIGH = auto()
    NO_STICKS = auto()


class ArmingFault(NamedTuple):
    """One check that failed: its reason, and the text that the ground station shows (without prefix; empty: none)."""

    reason: ArmingReason
    text: str


_TEXTS: Final[Mapping[Flavour, Mapping[ArmingReason, str]]] = {
    Flavour.ARDUPILOT: {
        ArmingReason.CALIBRATING: "Gyros not calibrated",
        ArmingReason.NO_POSITION: "Need Position Estimate",
        ArmingReason.NO_HEIGHT: "Need Alt Estimate",
        ArmingReason.NO_HOME: "Waiting for home",
        ArmingReason.MODE: "{mode} mode not armable",
        ArmingReason.NO_SETPOINTS: "No setpoints",
        ArmingReason.BATTERY: "Battery 1 below minimum arming voltage",
        ArmingReason.GROUND_LOST: "GCS failsafe on",
        ArmingReason.FENCE_BLIND: "Fence requires position",
        ArmingReason.OUTSIDE_FENCE: "vehicle outside fence",
        ArmingReason.NO_MISSION: "No mission",
        ArmingReason.NO_RADIO: "RC not found",
        ArmingReason.RADIO_LOST: "Throttle below failsafe",
        ArmingReason.THROTTLE_HIGH: "Throttle too high",
    },
    Flavour.PX4: {
        ArmingReason.CALIBRATING: "Attitude estimate not stable",
        ArmingReason.NO_POSITION: "Navigation failure! No valid position estimate",
        ArmingReason.NO_HEIGHT: "Height estimate not stable",
        ArmingReason.NO_HOME: "Home position not set",
        ArmingReason.MODE: "Mode not suitable for takeoff: {mode}",
        ArmingReason.NO_SETPOINTS: "No offboard signal",
        ArmingReason.BATTERY: "Low battery",
        ArmingReason.GROUND_LOST: "No connection to the ground control station",
        ArmingReason.FENCE_BLIND: "Geofence RTL requires valid home",
        ArmingReason.OUTSIDE_FENCE: "Geofence: approaching or outside geofence",
        ArmingReason.NO_MISSION: "No valid mission available",
        ArmingReason.NO_STICKS: "",
    },
}

REFUSALS: Final[Mapping[Flavour, str]] = {
    Flavour.ARDUPILOT: "Arm: {text}",
    Flavour.PX4: "Arming denied: Resolve system health failures first",
}
"""What is said when an arming request is refused."""

REMINDERS: Final[Mapping[Flavour, str]] = {Flavour.ARDUPILOT: "PreArm: {text}", Flavour.PX4: "Preflight Fail: {text}"}
"""What is said from time to time while a check fails."""

REMINDER_PERIOD_S: Final = 30.0

ON_REQUEST_ALONE: Final[Mapping[Flavour, frozenset[ArmingReason]]] = {
    Flavour.ARDUPILOT: frozenset({ArmingReason.MODE, ArmingReason.THROTTLE_HIGH}),
    Flavour.PX4: frozenset(),
}
"""What is looked at when arming is asked for, and not before: nothing reminds of it, no health bit tells of it."""


def arming_faults(
    *,
    flavour: Flavour,
    mode: Mode,
    rule: ModeRule,
    estimate: Estimate,
    home_known: bool,
    setpoints_fresh: bool,
    ground_lost: bool,
    battery: BatteryLevel,
    fence_blind: bool,
    outside_fence: bool,
    mission_flyable: bool,
    pilot: Pilot,
    now_s: float,
) -> tuple[ArmingFault, ...]:
    """Return every check that fails now, in the order in which an autopilot names them."""
    status = estimate.status
    # PX4 asks for setpoints before it arms in Offboard; ArduPilot is content with GUIDED alone.
    wants_setpoints = flavour is Flavour.PX4 and mode is Mode.GUIDED
    failed = {
        ArmingReason.CALIBRATING: not status.attitude_ok,
        ArmingReason.NO_POSITION: rule.needs_position and not status.position_ok,
        ArmingReason.NO_HEIGHT: not status.height_ok,
        ArmingReason.NO_HOME: rule.needs_position and not home_known,
        ArmingReason.NO_SETPOINTS: wants_setpoints and not setpoints_fresh,
        ArmingReason.BATTERY: battery >= BatteryLevel.CRITICAL,
        ArmingReason.GROUND_LOST: ground_lost,
        ArmingReason.FENCE_BLIND: fence_blind,
        ArmingReason.OUTSIDE_FENCE: outside_fence,
        # ArduPilot arms in AUTO, where that is allowed at all, with whatever mission there is.
        ArmingReason.NO_MISSION: flavour is Flavour.PX4 and mode is Mode.AUTO and not mission_flyable,
        **(_radio_faults(mode, pilot, now_s) if pilot.hand.radio_checked else {}),
        ArmingReason.NO_STICKS: lacks_sticks(flavour, mode, rule, pilot, now_s),
        ArmingReason.MODE: not rule.armable,
    }
    texts = _TEXTS[flavour]
    return tuple(
        ArmingFault(reason, texts[reason].format(mode=rule.name)) for reason, has_failed in failed.items() if has_failed
    )


def _radio_faults(mode: Mode, pilot: Pilot, now_s: float) -> dict[ArmingReason, bool]:
    """Return what ArduPilot asks of the radio; where sticks do not climb, it does not matter where the throttle is."""
    throttle, zone = pilot.throttle(now_s), pilot.hand.climb_dead_zone
    high = (mode in DIRECT and throttle > _DOWN) or (mode in _CLIMBING and throttle > zone)
    return {
        ArmingReason.NO_RADIO: pilot.heard_s is None,
        ArmingReason.RADIO_LOST: pilot.is_low(now_s),
        ArmingReason.THROTTLE_HIGH: high,
    }


def lacks_sticks(flavour: Flavour, mode: Mode, rule: ModeRule, pilot: Pilot, now_s: float) -> bool:
    """Whether PX4 misses the sticks of a mode that is flown by them; ArduPilot asks for a radio in every mode."""
    return flavour is Flavour.PX4 and is_by_hand(mode, rule) and not pilot.counts(now_s)


def stick_denial(flavour: Flavour, mode: Mode, rule: ModeRule, pilot: Pilot, now_s: float, *, by_sticks: bool) -> str:
    """Return why sticks, as they stand, do not arm or let nobody arm, as it is said; empty if they do."""
    if flavour is Flavour.ARDUPILOT:
        return f"Arm: {rule.name} mode not armable" if by_sticks and mode in BY_ATTITUDE else ""
    if not is_by_hand(mode, rule):
        return "Arming denied: switch to manual mode first" if by_sticks else ""
    if not pilot.counts(now_s):
        return ""
    throttle = pilot.standing(now_s).climb
    if mode in DIRECT:
        return "Arming denied: high throttle" if throttle >= _PX4_LOW else ""
    return "Arming denied: throttle above center" if throttle > _PX4_ABOVE else ""


_PX4_LOW: Final = -0.8
_PX4_ABOVE: Final = 0.2
_DOWN: Final = -0.94
"""A throttle up to here counts as down: RC3_DZ is 30 of 1000 microseconds."""

_CLIMBING: Final = KEEPING_PLACE | {Mode.ALT_HOLD}
"""Modes in which the throttle is a climb rate."""
