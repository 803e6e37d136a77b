"""Flight modes as a table: what each needs, whether it may be armed in, and where events lead.

Names are independent of the flavour; the numbers that stand for them on the wire are the protocol's business.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum, IntEnum, auto
from typing import Final, NamedTuple

from vehicle_sim.parameters import Action, Flavour


class Mode(Enum):
    """What the autopilot is doing, as the pilot names it."""

    MANUAL = auto()
    STABILIZE = auto()
    ACRO = auto()
    ALT_HOLD = auto()
    POSITION = auto()
    POSHOLD = auto()
    HOLD = auto()
    BRAKE = auto()
    GUIDED = auto()
    AUTO = auto()
    TAKEOFF = auto()
    RETURN = auto()
    LAND = auto()
    CIRCLE = auto()
    FOLLOW = auto()
    SLOW = auto()
    PRECISION_LAND = auto()
    DRIFT = auto()
    FLIP = auto()
    AUTOTUNE = auto()
    THROW = auto()
    AVOID_ADSB = auto()
    GUIDED_NOGPS = auto()
    SMART_RTL = auto()
    FLOWHOLD = auto()
    ZIGZAG = auto()
    SYSTEM_ID = auto()
    AUTO_RTL = auto()
    TURTLE = auto()


class Entry(Enum):
    """When a mode may be entered, whatever else it needs."""

    ALWAYS = auto()
    NEVER = auto()
    FLYING = auto()
    DISARMED = auto()


class Outcome(IntEnum):
    """Answer to a request; the values are those of MAV_RESULT."""

    ACCEPTED = 0
    TEMPORARILY_REJECTED = 1
    DENIED = 2
    UNSUPPORTED = 3
    FAILED = 4
    IN_PROGRESS = 5


class LandedState(IntEnum):
    """Where the vehicle is between ground and air; the values are those of MAV_LANDED_STATE."""

    UNDEFINED = 0
    ON_GROUND = 1
    IN_AIR = 2
    TAKEOFF = 3
    LANDING = 4


class Severity(IntEnum):
    """Urgency of a text; the values are those of MAV_SEVERITY."""

    EMERGENCY = 0
    ALERT = 1
    CRITICAL = 2
    ERROR = 3
    WARNING = 4
    NOTICE = 5
    INFO = 6
    DEBUG = 7


class StatusText(NamedTuple):
    """A sentence for the ground station."""

    severity: Severity
    text: str


class Failsafe(Enum):
    """What went wrong, worst last; NONE while nothing did."""

    NONE = 0
    BATTERY_LOW = 1
    SETPOINTS_LOST = 2
    STICKS_LOST = 3
    GROUND_LOST = 4
    WIND = 5
    FENCE = 6
    ESTIMATOR = 7
    BATTERY_CRITICAL = 8
    BATTERY_EMERGENCY = 9


class Event(Enum):
    """What happens to a mode from inside."""

    TAKEN_OFF = auto()
    MISSION_ENDED = auto()
    RETURN_DUE = auto()


@dataclass(frozen=True, slots=True)
class ModeRule:
    """What a mode needs of the estimator, whether the vehicle may be armed in it, and its name in texts.

    One that has no flight of its own is flown `like` another; `wants` is said of one that is not set up.
    """

    name: str
    needs_position: bool
    armable: bool
    manual: bool = False
    like: Mode | None = None
    entry: Entry = Entry.ALWAYS
    wants: str = ""
    refusal: str = "init failed"


def _refused(name: str, wants: str = "", refusal: str = "init failed") -> ModeRule:
    """Return the rule of a mode that wants what is not fitted, or not set up: optical flow, a leader, an axis."""
    return ModeRule(name, needs_position=False, armable=False, entry=Entry.NEVER, wants=wants, refusal=refusal)


MODES: Final[Mapping[Flavour, Mapping[Mode, ModeRule]]] = {
    Flavour.ARDUPILOT: {
        Mode.STABILIZE: ModeRule("STABILIZE", needs_position=False, armable=True, manual=True),
        Mode.ACRO: ModeRule("ACRO", needs_position=False, armable=True, manual=True),
        Mode.ALT_HOLD: ModeRule("ALT_HOLD", needs_position=False, armable=True, manual=True),
        Mode.POSITION: ModeRule("LOITER", needs_position=True, armable=True),
        Mode.POSHOLD: ModeRule("POSHOLD", needs_position=True, armable=True),
        Mode.BRAKE: ModeRule("BRAKE", needs_position=True, armable=False),
        Mode.GUIDED: ModeRule("GUIDED", needs_position=True, armable=True),
        Mode.AUTO: ModeRule("AUTO", needs_position=True, armable=False),
        Mode.RETURN: ModeRule("RTL", needs_position=True, armable=False),
        Mode.LAND: ModeRule("LAND", needs_position=False, armable=False),
        Mode.CIRCLE: ModeRule("CIRCLE", needs_position=True, armable=False),
        Mode.SMART_RTL: ModeRule("SMARTRTL", needs_position=True, armable=False, like=Mode.RETURN),
        Mode.GUIDED_NOGPS: ModeRule(
            "GUIDED_NOGPS", needs_position=False, armable=True, manual=True, like=Mode.ALT_HOLD
        ),
        Mode.ZIGZAG: ModeRule("ZIGZAG", needs_position=True, armable=True, like=Mode.POSITION),
        Mode.DRIFT: ModeRule("DRIFT", needs_position=True, armable=True, manual=True, like=Mode.STABILIZE),
        Mode.AVOID_ADSB: ModeRule("AVOID_ADSB", needs_position=True, armable=False, like=Mode.BRAKE),
        Mode.THROW: ModeRule("THROW", needs_position=True, armable=True, like=Mode.BRAKE, entry=Entry.DISARMED),
        Mode.AUTOTUNE: ModeRule(
            "AUTOTUNE", needs_position=False, armable=False, manual=True, like=Mode.ALT_HOLD, entry=Entry.FLYING
        ),
        Mode.FLIP: _refused("FLIP"),
        Mode.FLOWHOLD: _refused("FLOWHOLD"),
        Mode.FOLLOW: _refused("FOLLOW", "Set FOLL_ENABLE = 1"),
        Mode.SYSTEM_ID: _refused("SYSTEMID", "No axis selected, SID_AXIS = 0"),
        Mode.AUTO_RTL: _refused(
            "AUTO RTL", "Unable to start landing sequence", "No return path or landing sequence found"
        ),
        Mode.TURTLE: _refused("TURTLE"),
    },
    Flavour.PX4: {
        Mode.MANUAL: ModeRule("Manual", needs_position=False, armable=True, manual=True),
        Mode.STABILIZE: ModeRule("Stabilized", needs_position=False, armable=True, manual=True),
        Mode.ACRO: ModeRule("Acro", needs_position=False, armable=True, manual=True),
        Mode.ALT_HOLD: ModeRule("Altitude", needs_position=False, armable=True, manual=True),
        Mode.POSITION: ModeRule("Position", needs_position=True, armable=True),
        Mode.HOLD: ModeRule("Hold", needs_position=True, armable=True),
        Mode.GUIDED: ModeRule("Offboard", needs_position=True, armable=True),
        Mode.AUTO: ModeRule("Mission", needs_position=True, armable=True),
        Mode.TAKEOFF: ModeRule("Takeoff", needs_position=True, armable=True),
        Mode.RETURN: ModeRule("Return", needs_position=True, armable=False),
        Mode.LAND: ModeRule("Land", needs_position=False, armable=False),
        Mode.CIRCLE: ModeRule("Orbit", needs_position=True, armable=False),
        Mode.FOLLOW: ModeRule("Follow Target", needs_position=True, armable=False, like=Mode.HOLD),
        Mode.SLOW: ModeRule("Position Slow", needs_position=True, armable=True, like=Mode.POSITION),
        Mode.PRECISION_LAND: ModeRule("Precision Land", needs_position=True, armable=False, like=Mode.LAND),
    },
}
"""The modes of each flavour."""

FIRST_MODE: Final[Mapping[Flavour, Mode]] = {Flavour.ARDUPILOT: Mode.STABILIZE, Flavour.PX4: Mode.HOLD}
"""The mode after boot."""

HOLDING: Final[Mapping[Flavour, Mode]] = {Flavour.ARDUPILOT: Mode.POSITION, Flavour.PX4: Mode.HOLD}
"""The mode that keeps the vehicle where it is."""

BY_ATTITUDE: Final = frozenset((Mode.GUIDED, Mode.GUIDED_NOGPS))
"""The modes in which attitudes from outside are flown."""

KEEPING_PLACE: Final = frozenset((Mode.POSITION, Mode.POSHOLD))
"""The modes by hand in which a stick that is let go stops the vehicle where it is."""

DIRECT: Final = frozenset((Mode.MANUAL, Mode.STABILIZE, Mode.ACRO))
"""The modes in which the throttle is thrust."""


def is_by_hand(mode: Mode, rule: ModeRule) -> bool:
    """Whether a mode is flown by sticks."""
    return rule.manual or not KEEPING_PLACE.isdisjoint((mode, rule.like))


TRANSITIONS: Final[Mapping[Flavour, Mapping[tuple[Mode, Event], Mode]]] = {
    # ArduPilot takes off inside GUIDED and stays there.
    Flavour.ARDUPILOT: {(Mode.GUIDED, Event.TAKEN_OFF): Mode.GUIDED},
    Flavour.PX4: {
        (Mode.TAKEOFF, Event.TAKEN_OFF): Mode.HOLD,
        # ArduPilot loiters at the end of a mission, and returns by an item, without leaving the mode.
        (Mode.AUTO, Event.MISSION_ENDED): Mode.HOLD,
        (Mode.AUTO, Event.RETURN_DUE): Mode.RETURN,
    },
}
"""Where each event leads from each mode; an event that is not listed changes nothing."""

FAILSAFE_MODES: Final[Mapping[Flavour, Mapping[Action, tuple[Mode, ...]]]] = {
    Flavour.ARDUPILOT: {
        Action.ALTITUDE: (Mode.ALT_HOLD,),
        Action.BRAKE: (Mode.BRAKE, Mode.LAND),
        Action.HOLD: (Mode.POSITION, Mode.LAND),
        Action.RETRACE: (Mode.SMART_RTL, Mode.RETURN, Mode.LAND),
        Action.RETURN: (Mode.RETURN, Mode.LAND),
        Action.RETRACE_OR_LAND: (Mode.SMART_RTL, Mode.LAND),
        Action.LAND: (Mode.LAND,),
    },
    Flavour.PX4: {
        Action.POSITION: (Mode.POSITION, Mode.ALT_HOLD),
        Action.ALTITUDE: (Mode.ALT_HOLD,),
        Action.MANUAL: (Mode.MANUAL,),
        Action.HOLD: (Mode.HOLD, Mode.LAND),
        Action.RETURN: (Mode.RETURN, Mode.LAND),
        Action.LAND: (Mode.LAND,),
    },
}
"""The modes that carry out a failsafe's action: the first that the estimator allows.

When PX4's action ends with its failure, the mode that the pilot chose last is entered again."""
