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
    RETURN = 6
    LAND = 7
    DISARM = 8
    TERMINATE = 9
