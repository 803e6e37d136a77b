"""What a failsafe does, from harmless to grave."""

from enum import IntEnum


class Action(IntEnum):
    """An answer to a failure; a greater value is graver and wins over a lesser one."""

    NOTHING = 0
    POSITION = 1
    ALTITUDE = 2
    MANUAL = 3
    HOLD = 4
    BRAKE = 5
    RETRACE = 6
    RETURN = 7
    RETRACE_OR_LAND = 8
    LAND = 9
    DISARM = 10
    TERMINATE = 11
