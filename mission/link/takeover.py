"""Tells whether someone else flies the vehicle: a pilot, or a failsafe of its own."""

from mission.link.autopilot import Autopilot
from mission.link.ending import Ending
from mission.link.steps import Step
from mission.link.values import Heartbeat
from mission.link.vehicle_state import HEARTBEATS, VehicleState


def taken_over(
    heartbeat: Heartbeat, step: Step | None, kind: Autopilot | None, vehicle: VehicleState, since_s: float
) -> tuple[Ending, str] | None:
    """Look in a heartbeat for someone else who flies; one alone may have been late.

    Args:
        heartbeat: The newest.
        step: What the flight is at.
        kind: The autopilot.
        vehicle: What it has said, the heartbeat included.
        since_s: Vehicle time since when its words are about this.

    Returns:
        How the flight ends, and why in plain words; None where it goes on.
    """
    if step is None or step.modes is None or kind is None or not heartbeat.armed:
        return None
    if heartbeat.custom_mode in step.modes or vehicle.heartbeats_in_mode < HEARTBEATS:
        return None
    mode = kind.mode_name(heartbeat.custom_mode)
    if heartbeat.in_failsafe or vehicle.told_failsafe_since(since_s):
        return Ending.FAILSAFE, f"a failsafe put the vehicle into {mode}"
    return Ending.HANDED_OVER, f"someone else put the vehicle into {mode}"
