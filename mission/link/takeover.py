"""Tells whether someone else flies the vehicle, a pilot or a failsafe of its own, and how it is left."""

from typing import Final

from mission.link.autopilot import Autopilot
from mission.link.ending import Ending
from mission.link.steps import Step
from mission.link.values import Heartbeat, LandedState
from mission.link.vehicle_state import HEARTBEATS, VehicleState
from mission.monitor.stage import Stage

_WAITS: Final = (Stage.FLY, Stage.ARRIVE)

_EXPLAINED: Final = 5
"""Heartbeats in a mode after which the pilot flies in it: what is told of a failsafe from then on did not bring it."""


class Takeover:
    """Who flies, by heartbeats.

    Attributes:
        words: That somebody else does and is waited for, in plain words; empty while nobody does.
        changed: Whether the last heartbeat changed that.
    """

    def __init__(self) -> None:
        """Nobody else flies."""
        self.words = ""
        self.changed = False

    def look(  # noqa: PLR0917 - all that a heartbeat is looked at with
        self,
        heartbeat: Heartbeat,
        step: Step | None,
        kind: Autopilot | None,
        vehicle: VehicleState,
        since_s: float,
        waits: bool,  # noqa: FBT001 - as the others
    ) -> tuple[Ending, str] | None:
        """Look in a heartbeat for someone else who flies; one alone may have been late.

        Args:
            heartbeat: The newest.
            step: What the flight is at.
            kind: The autopilot.
            vehicle: What it has said, the heartbeat included.
            since_s: Vehicle time since when its words are about this.
            waits: Whether a pilot who takes the vehicle in flight may hand it back.

        Returns:
            How the flight ends, and why in plain words; None where it goes on.
        """
        self.changed = False
        if step is None or step.modes is None or kind is None:
            return None
        if not heartbeat.armed:
            return (Ending.HANDED_OVER, f"{self.words} and disarmed it") if self.words else None
        stopped = step.armed and heartbeat.in_failsafe and heartbeat.custom_mode == kind.hold_mode
        if heartbeat.custom_mode in step.modes and not stopped:
            self.changed, self.words = bool(self.words), ""
            return None
        mode, seen = kind.mode_name(heartbeat.custom_mode), vehicle.heartbeats_in_mode
        words = f"someone else put the vehicle into {mode}"
        if seen < HEARTBEATS or (words == self.words and seen > _EXPLAINED):
            return None
        if heartbeat.in_failsafe or vehicle.told_failsafe_since(since_s):
            return Ending.FAILSAFE, f"a failsafe put the vehicle into {mode}"
        self.changed, self.words = words != self.words, words
        return None if waits and step.stage in _WAITS else (Ending.HANDED_OVER, self.words)


def how_left(kind: Autopilot, vehicle: VehicleState, stage: Stage) -> str:
    """How a vehicle is left at a stage, in plain words; empty where its motors are off and nothing is to be said."""
    if not vehicle.armed:
        return "that its motors stay off was not confirmed" if stage in (Stage.ARM, Stage.DISARM) else ""
    mode = kind.mode_name(vehicle.mode)
    if vehicle.landed is LandedState.ON_GROUND:
        return f"that its motors stop was not confirmed: it was last heard in {mode}"
    if vehicle.mode == kind.hold_mode:
        return f"the vehicle is left holding in {mode}"
    if vehicle.mode == kind.land_mode:
        return "the vehicle is landing"
    return f"that it holds was not confirmed: it was last heard in {mode}"
