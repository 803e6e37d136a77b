"""The autopilot: modes, arming, take-off and landing, failsafes; names and wire formats belong to the protocol."""

from vehicle_sim.autopilot.arming import ArmingFault, ArmingReason
from vehicle_sim.autopilot.mission import Mission, News, Progress
from vehicle_sim.autopilot.mission_items import Command, Datum, MissionItem, Place, SpeedAxis
from vehicle_sim.autopilot.modes import MODES, Failsafe, LandedState, Mode, ModeRule, Outcome, Severity, StatusText
from vehicle_sim.autopilot.requests import Autopilot

__all__ = [
    "MODES",
    "ArmingFault",
    "ArmingReason",
    "Autopilot",
    "Command",
    "Datum",
    "Failsafe",
    "LandedState",
    "Mission",
    "MissionItem",
    "Mode",
    "ModeRule",
    "News",
    "Outcome",
    "Place",
    "Progress",
    "Severity",
    "SpeedAxis",
    "StatusText",
]
