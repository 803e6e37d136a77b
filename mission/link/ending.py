"""What a session may come to."""

from enum import Enum, auto


class Ending(Enum):
    """How a session came to its end."""

    LANDED = auto()
    HANDED_OVER = auto()
    FAILSAFE = auto()
    STOPPED = auto()
