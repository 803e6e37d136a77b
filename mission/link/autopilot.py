"""What the session has to know of an autopilot: one value for each kind that it can fly."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from mission.link.fence_rules import FenceRules
from mission.link.messages import Stream
from mission.link.steps import Step
from mission.link.values import Command


@dataclass(frozen=True, kw_only=True)
class Autopilot:
    """One kind of autopilot.

    Attributes:
        name: What people call it.
        number: Its MAV_AUTOPILOT.
        mode_names: Names of its modes, by its own numbers.
        offboard_mode: The mode in which it flies setpoints.
        hold_mode: The mode in which it stays where it is without a pilot.
        land_mode: The mode in which it lands.
        hold: The command that leads to ``hold_mode``.
        land: The command that leads to ``land_mode``.
        rates_hz: The messages that it is asked for, and how often.
        bytewise: Whether it sends the bytes of an integer parameter, and not its value.
        fence: What it has to be told of its geofence.
        departure: The steps from disarmed on the ground to flying setpoints, for an altitude above the take-off point.
        left_modes: The modes that whoever led it may have left it in: it stays where it is, and nobody else leads it.
        return_to_setpoints: The steps from there, in the air, to flying setpoints.
    """

    name: str
    number: int
    mode_names: Mapping[int, str]
    offboard_mode: int
    hold_mode: int
    land_mode: int
    hold: Command
    land: Command
    rates_hz: Mapping[Stream, float]
    bytewise: bool
    fence: FenceRules
    departure: Callable[[float], tuple[Step, ...]]
    left_modes: frozenset[int]
    return_to_setpoints: tuple[Step, ...]

    def mode_name(self, mode: int) -> str:
        """The name of a mode, or its number where it has none here."""
        return self.mode_names.get(mode, f"mode {mode}")


COMMON_RATES_HZ: Mapping[Stream, float] = {
    Stream.LOCAL_POSITION_NED: 30.0,
    Stream.ATTITUDE: 15.0,
    Stream.GLOBAL_POSITION_INT: 5.0,
    Stream.EXTENDED_SYS_STATE: 5.0,
    Stream.SYS_STATUS: 2.0,
    Stream.GPS_GLOBAL_ORIGIN: 1.0,
    Stream.BATTERY_STATUS: 0.5,
    Stream.GPS_RAW_INT: 1.0,
}
"""What every autopilot is asked for."""
