"""What vehicles say and are told over MAVLink, as typed values; units and frames are in the names.

Message definitions: https://mavlink.io/en/messages/common.html.
"""

from dataclasses import dataclass
from enum import IntEnum, IntFlag
from typing import Final, NamedTuple

from mission.link.frames import Vector
from mission.link.plan_values import PlanBody

_SAFETY_ARMED: Final = 128
"""MAV_MODE_FLAG_SAFETY_ARMED."""

_ORIGIN_MOVED_DEG: Final = 5e-6

_FAILING: Final = (5, 6)
"""MAV_STATE_CRITICAL and MAV_STATE_EMERGENCY."""


class Result(IntEnum):
    """Answers to a command (MAV_RESULT)."""

    ACCEPTED = 0
    TEMPORARILY_REJECTED = 1
    DENIED = 2
    UNSUPPORTED = 3
    FAILED = 4
    IN_PROGRESS = 5
    CANCELLED = 6
    COMMAND_LONG_ONLY = 7
    COMMAND_INT_ONLY = 8
    UNSUPPORTED_FRAME = 9
    PERMISSION_DENIED = 10
    UNKNOWN = 255

    @classmethod
    def _missing_(cls, _value: object) -> "Result":
        return cls.UNKNOWN


class LandedState(IntEnum):
    """Between ground and air (MAV_LANDED_STATE)."""

    UNDEFINED = 0
    ON_GROUND = 1
    IN_AIR = 2
    TAKEOFF = 3
    LANDING = 4

    @classmethod
    def _missing_(cls, _value: object) -> "LandedState":
        return cls.UNDEFINED


class Estimates(IntFlag):
    """What an estimator vouches for (ESTIMATOR_STATUS_FLAGS; EKF_STATUS_FLAGS has the same low ten bits).

    The bit of a constant position (128) is left out on purpose: PX4 sets it whenever the vehicle is at rest, however
    well it knows where, and ArduPilot never sets it together with a position.
    """

    ATTITUDE = 1
    VELOCITY_HORIZONTAL = 2
    VELOCITY_VERTICAL = 4
    POSITION_RELATIVE = 8
    POSITION_ABSOLUTE = 16
    HEIGHT_ABSOLUTE = 32


class Sensors(IntFlag):
    """Parts of the vehicle that SYS_STATUS speaks of (MAV_SYS_STATUS_SENSOR)."""

    GYRO = 0x1
    ACCELEROMETER = 0x2
    COMPASS = 0x4
    GPS = 0x20
    PREARM_CHECK = 0x10000000


@dataclass(frozen=True, slots=True)
class Heartbeat:
    """HEARTBEAT: what it is and what it is doing."""

    vehicle_type: int
    autopilot: int
    base_mode: int
    custom_mode: int
    system_status: int

    @property
    def armed(self) -> bool:
        """The one truth of whether the motors are armed."""
        return bool(self.base_mode & _SAFETY_ARMED)

    @property
    def in_failsafe(self) -> bool:
        """Whether the vehicle says that something is badly wrong."""
        return self.system_status in _FAILING


@dataclass(frozen=True, slots=True)
class Words:
    """STATUSTEXT, or a piece of one: severity as in syslog (0 the gravest); ``group`` is 0 for a text in one piece."""

    severity: int
    text: str
    group: int
    piece: int


@dataclass(frozen=True, slots=True)
class Acknowledgement:
    """COMMAND_ACK; targets are 0 where the vehicle does not say whom it answers."""

    command: int
    result: Result
    target_system: int
    target_component: int


@dataclass(frozen=True, slots=True)
class LocalPosition:
    """LOCAL_POSITION_NED: relative to the estimator's origin, north, east, down."""

    time_boot_ms: int
    position_ned_m: Vector
    velocity_ned_m_s: Vector


@dataclass(frozen=True, slots=True)
class GlobalPosition:
    """GLOBAL_POSITION_INT: WGS 84; heights above mean sea level and above home."""

    time_boot_ms: int
    latitude_deg: float
    longitude_deg: float
    altitude_amsl_m: float
    height_above_home_m: float


@dataclass(frozen=True, slots=True)
class Attitude:
    """ATTITUDE: roll, pitch, yaw of the body against NED."""

    time_boot_ms: int
    angles_rad: Vector


@dataclass(frozen=True, slots=True)
class Origin:
    """GPS_GLOBAL_ORIGIN: where the estimator's local frame has its origin."""

    latitude_deg: float
    longitude_deg: float
    altitude_amsl_m: float

    def is_elsewhere(self, other: "Origin") -> bool:
        """Whether it is another place, and not the same one with other rounding."""
        north_deg, east_deg = self.latitude_deg - other.latitude_deg, self.longitude_deg - other.longitude_deg
        return max(abs(north_deg), abs(east_deg)) > _ORIGIN_MOVED_DEG


@dataclass(frozen=True, slots=True)
class Health:
    """SYS_STATUS: parts that are there and wanted, and those that are well; charge in percent, -1 unknown."""

    enabled: Sensors
    healthy: Sensors
    battery_percent: int


@dataclass(frozen=True, slots=True)
class Battery:
    """BATTERY_STATUS: whether the charge is critical or worse, what was drawn, and per cent left; None unknown."""

    critical: bool
    consumed_mah: float | None = None
    percent: float | None = None


@dataclass(frozen=True, slots=True)
class ParameterValue:
    """PARAM_VALUE: the four bytes of its value, as a number and, for an integer sent by its bytes, as that.

    ``type`` is its MAV_PARAM_TYPE, which is told again where it is set.
    """

    name: str
    as_number: float
    as_bytes: int
    is_integer: bool
    type: int = 0

    def value(self, *, bytewise: bool) -> float:
        """The value, of an autopilot that sends integers by their bytes or not."""
        return float(self.as_bytes) if bytewise and self.is_integer else self.as_number


@dataclass(frozen=True, slots=True)
class Home:
    """HOME_POSITION: where the vehicle returns to, which is where it was armed, if nobody moved it; WGS 84."""

    latitude_deg: float
    longitude_deg: float


@dataclass(frozen=True, slots=True)
class Wind:
    """WIND or WIND_COV: the vehicle's own estimate, level; where it comes from, clockwise from north."""

    speed_m_s: float
    from_deg: float


@dataclass(frozen=True, slots=True)
class TruePlace:
    """SIMSTATE: where a simulated vehicle really is, whatever it estimates; WGS 84."""

    latitude_deg: float
    longitude_deg: float


@dataclass(frozen=True, slots=True)
class EstimatorReport:
    """EKF_STATUS_REPORT or ESTIMATOR_STATUS.

    Attributes:
        flags: What it vouches for.
        worst_ratio: The largest of the test ratios of velocity, level position, height and compass: above 1 what is
            measured is refused.
    """

    flags: Estimates
    worst_ratio: float = 0.0


@dataclass(frozen=True, slots=True)
class Landing:
    """EXTENDED_SYS_STATE."""

    state: LandedState


@dataclass(frozen=True, slots=True)
class Version:
    """AUTOPILOT_VERSION: major, minor and patch of the firmware; the board's own number, empty where it tells none."""

    firmware: tuple[int, int, int]
    board: str = ""


@dataclass(frozen=True, slots=True)
class TimeAnswer:
    """TIMESYNC: the vehicle's time and that of the request that it answers; of a request of its own, 0 and its time."""

    told_ns: int
    asked_ns: int


@dataclass(frozen=True, slots=True)
class Ping:
    """PING: a request that is for all, of target 0, or what one system was answered; the time is the asker's."""

    time_us: int
    number: int
    target_system: int


@dataclass(frozen=True, slots=True)
class Fix:
    """GPS_RAW_INT; None is what the receiver does not say.

    Attributes:
        accuracy_m: How far off its place may be, level and in height.
        kind: GPS_FIX_TYPE; from 3 on it has a height.
        satellites: How many are used.
        dilution: Of the level position, HDOP.
    """

    accuracy_m: tuple[float, float] | None
    kind: int = 0
    satellites: int | None = None
    dilution: float | None = None


@dataclass(frozen=True, slots=True)
class Image:
    """CAMERA_FEEDBACK, CAMERA_IMAGE_CAPTURED or CAMERA_TRIGGER: a picture.

    Attributes:
        number: As the autopilot counts them.
        stamp: Its time in milliseconds, of whichever clock: with the number it tells pictures apart.
        boot_s: Its time since boot; None where that is not told.
        utc_us: Microseconds since 1970, 0 where that is not known.
        place: Latitude and longitude in degrees and height above mean sea level; None where they are not told.
        angles_rad: Roll, pitch and yaw against NED; None likewise.
        captured: Whether it was taken.
        released: Whether no more is told than that the shutter was released.
    """

    number: int
    stamp: int
    boot_s: float | None
    utc_us: int
    place: Vector | None
    angles_rad: Vector | None
    captured: bool = True
    released: bool = False


Body = (
    Heartbeat
    | Words
    | Acknowledgement
    | LocalPosition
    | GlobalPosition
    | Attitude
    | Origin
    | Health
    | Battery
    | ParameterValue
    | Home
    | Wind
    | TruePlace
    | EstimatorReport
    | Landing
    | Version
    | Ping
    | TimeAnswer
    | Fix
    | Image
    | PlanBody
)


class Received(NamedTuple):
    """One message and who sent it."""

    system_id: int
    component_id: int
    body: Body


@dataclass(frozen=True)
class Command:
    """A COMMAND_LONG: number and up to seven parameters, the rest 0; ``name`` is for people."""

    name: str
    number: int
    parameters: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class LocalSetpoint:
    """Position, velocity, acceleration, heading and yaw rate, all of them, in the vehicle's local frame (NED)."""

    time_boot_ms: int
    position_ned_m: Vector
    velocity_ned_m_s: Vector
    acceleration_ned_m_s2: Vector
    yaw_rad: float
    yaw_rate_rad_s: float
