"""The values that pass between the parts of the vehicle: measurements, estimate, setpoint, true motion.

All of them are north-east-down, in metres, seconds and radians; body axes are forward-right-down. The fast ones are
named tuples because the vehicle makes them a hundred times a second.
"""

from dataclasses import dataclass
from enum import IntFlag
from math import isfinite
from typing import NamedTuple

Vector = tuple[float, float, float]
PartialVector = tuple[float | None, float | None, float | None]
FourRotors = tuple[float, float, float, float]

GRAVITY_M_S2 = 9.80665
"""Standard gravity, the only gravity there is in the simulation."""

FREE: PartialVector = (None, None, None)
"""A setpoint's component that asks for nothing on any axis."""


class Geodetic(NamedTuple):
    """A place on or above the WGS 84 ellipsoid; the altitude counts as above mean sea level."""

    lat_deg: float
    lon_deg: float
    alt_m: float


class Motion(NamedTuple):
    """The true motion of the vehicle, relative to its true home position."""

    position_ned_m: Vector
    velocity_ned_m_s: Vector
    acceleration_ned_m_s2: Vector
    roll_rad: float
    pitch_rad: float
    yaw_rad: float
    rates_rad_s: Vector
    specific_force_m_s2: Vector
    on_ground: bool


class ImuReading(NamedTuple):
    """What the inertial unit measures: specific force and angular rates in body axes."""

    time_s: float
    specific_force_m_s2: Vector
    rates_rad_s: Vector


class GpsReading(NamedTuple):
    """One fix of the receiver; `fix_type` as in MAVLink's GPS_FIX_TYPE (1 none, 3 three-dimensional)."""

    time_s: float
    fix_type: int
    satellites: int
    position: Geodetic
    velocity_ned_m_s: Vector
    hdop: float
    vdop: float
    horizontal_accuracy_m: float
    vertical_accuracy_m: float
    speed_accuracy_m_s: float


class BaroReading(NamedTuple):
    """Static pressure, and the altitude that the standard atmosphere gives for it."""

    time_s: float
    pressure_hpa: float
    temperature_c: float
    altitude_m: float


class CompassReading(NamedTuple):
    """The earth's field in body axes, and the true heading that follows from it."""

    time_s: float
    field_gauss: Vector
    heading_rad: float


class EstimatorFlag(IntFlag):
    """What the estimator vouches for; the bits are those of MAVLink's ESTIMATOR_STATUS and EKF_STATUS_REPORT."""

    ATTITUDE = 1
    VELOCITY_HORIZONTAL = 2
    VELOCITY_VERTICAL = 4
    POSITION_HORIZONTAL_RELATIVE = 8
    POSITION_HORIZONTAL_ABSOLUTE = 16
    POSITION_VERTICAL_ABSOLUTE = 32
    POSITION_VERTICAL_ABOVE_GROUND = 64
    CONSTANT_POSITION = 128
    PREDICTED_HORIZONTAL_RELATIVE = 256
    PREDICTED_HORIZONTAL_ABSOLUTE = 512


class EstimatorStatus(NamedTuple):
    """Health of the estimator: flags, innovation test ratios (1 is the gate) and standard deviations."""

    flags: EstimatorFlag
    initialised: bool
    gps_glitch: bool
    velocity_ratio: float
    position_horizontal_ratio: float
    position_vertical_ratio: float
    compass_ratio: float
    horizontal_accuracy_m: float
    vertical_accuracy_m: float
    speed_accuracy_m_s: float

    @property
    def attitude_ok(self) -> bool:
        """Whether roll, pitch and yaw may be used."""
        return bool(self.flags & EstimatorFlag.ATTITUDE)

    @property
    def position_ok(self) -> bool:
        """Whether the horizontal position may be flown on."""
        return bool(self.flags & EstimatorFlag.POSITION_HORIZONTAL_ABSOLUTE)

    @property
    def height_ok(self) -> bool:
        """Whether the height may be flown on."""
        return bool(self.flags & EstimatorFlag.POSITION_VERTICAL_ABSOLUTE)


class Estimate(NamedTuple):
    """What the vehicle believes of itself; the position is relative to the estimator's own origin."""

    time_s: float
    origin: Geodetic | None
    position_ned_m: Vector
    velocity_ned_m_s: Vector
    acceleration_ned_m_s2: Vector
    roll_rad: float
    pitch_rad: float
    yaw_rad: float
    rates_rad_s: Vector
    status: EstimatorStatus


class Command(NamedTuple):
    """What the controller asks of the airframe.

    `thrust_m_s2` is specific thrust along body up (U1/m of Eq. 6), `angular_acceleration_rad_s2` are the three body
    angular accelerations (U2/Ixx, U3/Iyy, U4/Izz). `outputs` is what each rotor is to give, as a share of its greatest
    thrust, for an airframe that has rotors: `RotorControl` fills it in.
    """

    thrust_m_s2: float
    angular_acceleration_rad_s2: Vector
    outputs: FourRotors = (0.0, 0.0, 0.0, 0.0)


IDLE = Command(0.0, (0.0, 0.0, 0.0))
"""Motors off or idling: nothing that moves the vehicle."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Setpoint:
    """What to fly: each axis of each quantity asked for or left free (None); relative to the estimator's origin.

    `lean_ne_rad`, where it is given, is flown instead of the horizontal axes: how far thrust leans to north and east.
    `thrust_m_s2`, where it is given, is flown instead of the down axis: specific thrust along body up.

    Raises:
        ValueError: A component that is asked for is not finite.
    """

    position_ned_m: PartialVector = FREE
    velocity_ned_m_s: PartialVector = FREE
    acceleration_ned_m_s2: PartialVector = FREE
    yaw_rad: float | None = None
    yaw_rate_rad_s: float | None = None
    lean_ne_rad: tuple[float, float] | None = None
    thrust_m_s2: float | None = None

    def __post_init__(self) -> None:
        """Refuse values that no controller can follow."""
        asked = (*self.position_ned_m, *self.velocity_ned_m_s, *self.acceleration_ned_m_s2)
        asked += (self.yaw_rad, self.yaw_rate_rad_s, self.thrust_m_s2, *(self.lean_ne_rad or ()))
        for value in asked:
            if value is not None and not isfinite(value):
                raise ValueError("a setpoint's components are finite numbers or absent")

    @property
    def asks_motion(self) -> bool:
        """Whether any axis of velocity or acceleration is asked for."""
        return self.velocity_ned_m_s != FREE or self.acceleration_ned_m_s2 != FREE


class Limits(NamedTuple):
    """How fast, how hard and how far tilted the controller may fly."""

    speed_m_s: float
    climb_m_s: float
    descent_m_s: float
    acceleration_m_s2: float
    braking_m_s2: float
    vertical_acceleration_m_s2: float
    tilt_rad: float
    yaw_rate_rad_s: float


class Guidance(NamedTuple):
    """What the autopilot hands to the controller: a setpoint (None: motors idle) and the limits to keep."""

    setpoint: Setpoint | None
    limits: Limits


class CameraOrder(NamedTuple):
    """What is asked of the camera: what is None stays as it is.

    Attributes:
        shoots: Whether a picture is taken at once.
        distance_m: A picture each time that the vehicle has come so far, level; 0 on ArduPilot never.
        interval_s: Time between the pictures of a series.
        pictures: How many of them are taken, -1 without end, 0 none any more (ArduPilot).
        enabled: Whether it is triggered at all (PX4).
        paused: Whether it is not for the time being (PX4).
        restarts: Whether pictures are counted from 0 again (PX4).
    """

    shoots: bool = False
    distance_m: float | None = None
    interval_s: float | None = None
    pictures: int | None = None
    enabled: bool | None = None
    paused: bool | None = None
    restarts: bool = False

    @property
    def triggers(self) -> bool:
        """Whether pictures are taken from then on, until another order."""
        return self.enabled is True or bool(self.pictures)
