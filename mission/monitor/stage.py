"""The stages of a flight, and in which of them the vehicle spells a word."""

from enum import StrEnum
from typing import Final


class Stage(StrEnum):
    """Where a flight is, in words for people."""

    CONNECT = "waiting for the vehicle"
    STREAMS = "asking for telemetry"
    READY = "waiting for position and health"
    STANDBY = "ready"
    FENCE = "setting the geofence"
    MODE = "changing the flight mode"
    CHECKS = "waiting for the checks before arming"
    ARM = "arming"
    TAKE_OFF = "taking off"
    CLIMB = "climbing"
    STREAM = "streaming setpoints"
    OFFBOARD = "taking control"
    SETTLE = "settling at the start"
    FLY = "flying"
    ARRIVE = "arriving"
    HOLD = "holding"
    LAND = "going to land"
    TOUCH_DOWN = "landing"
    DISARM = "disarming"
    DONE = "done"


GUARDED: Final = (Stage.CLIMB, Stage.STREAM, Stage.OFFBOARD, Stage.SETTLE)
"""Nothing is spelled yet, but no restricted region may be entered."""

WATCHED: Final = (Stage.FLY, Stage.ARRIVE, Stage.HOLD, Stage.LAND, Stage.TOUCH_DOWN)
"""Each position counts, once the trajectory has begun."""

ALOFT: Final = (Stage.TAKE_OFF, *GUARDED, *WATCHED)
"""What is between arming and landing."""

LANDED: Final = (Stage.DISARM, Stage.DONE)
"""The vehicle is on the ground again."""
