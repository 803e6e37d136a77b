"""MAVLink in and out as typed values: all of the planner that knows the dialect, but for three rooms beside it.

Those are ``framing``, ``packing`` and ``services``.

Message definitions: https://mavlink.io/en/messages/common.html and ardupilotmega.html; the latter contains the former,
so one dialect serves every vehicle. Frames go out as MAVLink 2, and are understood in either version.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from enum import IntEnum
from typing import Any, Final

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.link.frames import angles_of
from mission.link.framing import Frame, split
from mission.link.packing import Message, frame_of, message_of
from mission.link.services import READERS as OF_SERVICES
from mission.link.signing import Signatures
from mission.link.values import (
    Acknowledgement,
    Attitude,
    Battery,
    Body,
    Command,
    Estimates,
    EstimatorReport,
    Fix,
    GlobalPosition,
    Health,
    Heartbeat,
    Home,
    Image,
    LandedState,
    Landing,
    LocalPosition,
    LocalSetpoint,
    Origin,
    Ping,
    Received,
    Result,
    Sensors,
    TimeAnswer,
    TruePlace,
    Version,
    Wind,
    Words,
)

AUTOPILOT_COMPONENT: Final = 1
_E7: Final = 1e-7
_MM: Final = 1e-3
_NO_COUNT: Final = 255
_NO_DILUTION: Final = 65535


class Stream(IntEnum):
    """Messages that the planner asks for."""

    SYS_STATUS = mavlink.MAVLINK_MSG_ID_SYS_STATUS
    ATTITUDE = mavlink.MAVLINK_MSG_ID_ATTITUDE
    LOCAL_POSITION_NED = mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED
    GLOBAL_POSITION_INT = mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT
    GPS_GLOBAL_ORIGIN = mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN
    BATTERY_STATUS = mavlink.MAVLINK_MSG_ID_BATTERY_STATUS
    EKF_STATUS_REPORT = mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT
    ESTIMATOR_STATUS = mavlink.MAVLINK_MSG_ID_ESTIMATOR_STATUS
    EXTENDED_SYS_STATE = mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE
    AUTOPILOT_VERSION = mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION
    GPS_RAW_INT = mavlink.MAVLINK_MSG_ID_GPS_RAW_INT
    HOME_POSITION = mavlink.MAVLINK_MSG_ID_HOME_POSITION
    SIMSTATE = mavlink.MAVLINK_MSG_ID_SIMSTATE
    WIND = mavlink.MAVLINK_MSG_ID_WIND
    WIND_COV = mavlink.MAVLINK_MSG_ID_WIND_COV


_WHOLE: Final = 0
"""Nothing is to be ignored. ArduPilot takes position, velocity and acceleration each whole or not at all. Of a yaw with
a yaw rate both autopilots hold the first and turn ahead by the second: ArduCopter in its yaw mode ANGLE_RATE, which
goes on at this rate between messages; PX4 adds it to what its attitude loop asks for (``yawspeed`` of its
TrajectorySetpoint)."""

_CRITICAL_CHARGES: Final = (
    mavlink.MAV_BATTERY_CHARGE_STATE_CRITICAL,
    mavlink.MAV_BATTERY_CHARGE_STATE_EMERGENCY,
    mavlink.MAV_BATTERY_CHARGE_STATE_FAILED,
)


def _feedback(m: Any) -> Image:  # noqa: ANN401 - pymavlink ships no types
    """CAMERA_FEEDBACK: its time is that of the satellites; without a place it has zeros."""
    angles_rad = (math.radians(m.roll), math.radians(m.pitch), math.radians(m.yaw))
    place = (m.lat * _E7, m.lng * _E7, m.alt_msl) if (m.lat, m.lng) != (0, 0) else None
    return Image(m.img_idx, m.time_usec // 1000, None, m.time_usec, place, angles_rad)


def _captured(m: Any) -> Image:  # noqa: ANN401 - pymavlink ships no types
    """CAMERA_IMAGE_CAPTURED: the attitude is NaN where it is not known."""
    angles_rad = angles_of(m.q) if all(map(math.isfinite, m.q)) else None
    place = (m.lat * _E7, m.lon * _E7, m.alt * _MM) if (m.lat, m.lon) != (0, 0) else None
    boot_s = m.time_boot_ms * _MM
    return Image(m.image_index, m.time_boot_ms, boot_s, m.time_utc, place, angles_rad, captured=m.capture_result != 0)


def _released(m: Any) -> Image:  # noqa: ANN401 - pymavlink ships no types
    """CAMERA_TRIGGER: its time is that since boot."""
    return Image(m.seq, m.time_usec // 1000, m.time_usec * 1e-6, 0, None, None, released=True)


def _fix(m: Any) -> Fix:  # noqa: ANN401 - pymavlink ships no types
    """GPS_RAW_INT: accuracies are fields of MAVLink 2, 0 where they are not filled in."""
    return Fix(
        (m.h_acc * _MM, m.v_acc * _MM) if m.h_acc and m.v_acc else None,
        m.fix_type,
        None if m.satellites_visible == _NO_COUNT else m.satellites_visible,
        None if m.eph == _NO_DILUTION else m.eph / 100.0,
    )


def _estimator(flags: int, *ratios: float) -> EstimatorReport:
    """EKF_STATUS_REPORT or ESTIMATOR_STATUS; a ratio that is no number is none."""
    return EstimatorReport(Estimates(flags), max(filter(math.isfinite, ratios), default=0.0))


def _wind_of(north: float, east: float) -> Wind:
    """WIND_COV: where it blows to; NaN where nothing is known."""
    return Wind(math.hypot(north, east), math.degrees(math.atan2(-east, -north)) % 360.0)


_READERS: Final[Mapping[str, Callable[[Any], Body]]] = {
    "HEARTBEAT": lambda m: Heartbeat(m.type, m.autopilot, m.base_mode, m.custom_mode, m.system_status),
    "STATUSTEXT": lambda m: Words(m.severity, m.text, m.id, m.chunk_seq),
    "COMMAND_ACK": lambda m: Acknowledgement(m.command, Result(m.result), m.target_system, m.target_component),
    "LOCAL_POSITION_NED": lambda m: LocalPosition(m.time_boot_ms, (m.x, m.y, m.z), (m.vx, m.vy, m.vz)),
    "GLOBAL_POSITION_INT": lambda m: GlobalPosition(
        m.time_boot_ms, m.lat * _E7, m.lon * _E7, m.alt * _MM, m.relative_alt * _MM
    ),
    "ATTITUDE": lambda m: Attitude(m.time_boot_ms, (m.roll, m.pitch, m.yaw)),
    "GPS_GLOBAL_ORIGIN": lambda m: Origin(m.latitude * _E7, m.longitude * _E7, m.altitude * _MM),
    "SYS_STATUS": lambda m: Health(
        Sensors(m.onboard_control_sensors_present & m.onboard_control_sensors_enabled),
        Sensors(m.onboard_control_sensors_health),
        m.battery_remaining,
    ),
    "BATTERY_STATUS": lambda m: Battery(
        m.charge_state in _CRITICAL_CHARGES, _told(m.current_consumed), _told(m.battery_remaining)
    ),
    "HOME_POSITION": lambda m: Home(m.latitude * _E7, m.longitude * _E7),
    "SIMSTATE": lambda m: TruePlace(m.lat * _E7, m.lng * _E7),
    "WIND": lambda m: Wind(m.speed, m.direction % 360.0),
    "WIND_COV": lambda m: _wind_of(m.wind_x, m.wind_y),
    "EKF_STATUS_REPORT": lambda m: _estimator(
        m.flags, m.velocity_variance, m.pos_horiz_variance, m.pos_vert_variance, m.compass_variance
    ),
    "ESTIMATOR_STATUS": lambda m: _estimator(m.flags, m.vel_ratio, m.pos_horiz_ratio, m.pos_vert_ratio, m.mag_ratio),
    "EXTENDED_SYS_STATE": lambda m: Landing(LandedState(m.landed_state)),
    "GPS_RAW_INT": _fix,
    "CAMERA_FEEDBACK": _feedback,
    "CAMERA_IMAGE_CAPTURED": _captured,
    "CAMERA_TRIGGER": _released,
    "PING": lambda m: Ping(m.time_usec, m.seq, m.target_system),
    "TIMESYNC": lambda m: TimeAnswer(m.tc1, m.ts1),
    "AUTOPILOT_VERSION": lambda m: Version(
        (m.flight_sw_version >> 24, m.flight_sw_version >> 16 & 0xFF, m.flight_sw_version >> 8 & 0xFF),
        bytes(m.uid2).hex() if any(m.uid2) else f"{m.uid:x}" if m.uid else "",
    ),
    **OF_SERVICES,
}


def numbers_of(names: Iterable[str]) -> frozenset[int]:
    """The numbers of messages."""
    return frozenset(int(getattr(mavlink, f"MAVLINK_MSG_ID_{name}")) for name in names)


_READER_OF: Final = {number: reader for name, reader in _READERS.items() for number in numbers_of((name,))}


STATES: Final = frozenset(
    (
        Stream.ATTITUDE,
        Stream.GLOBAL_POSITION_INT,
        Stream.SYS_STATUS,
        Stream.EXTENDED_SYS_STATE,
        Stream.EKF_STATUS_REPORT,
        Stream.ESTIMATOR_STATUS,
        Stream.GPS_RAW_INT,
        Stream.SIMSTATE,
    )
)
"""Messages that are out of date once there is a newer one of the same sender."""

STAMPED: Final = frozenset((Stream.ATTITUDE, Stream.GLOBAL_POSITION_INT))
"""Those of them from which the vehicle's time is read."""


class Codec:
    """Turns bytes of one link into values, and values into frames that carry our own ids."""

    def __init__(self, system_id: int, component_id: int, signatures: Signatures | None = None) -> None:
        """Speak as component ``component_id`` of system ``system_id``; with a key, hear only what is signed with it."""
        self.system_id, self.component_id = system_id, component_id
        self._signatures = signatures
        self._mav = mavlink.MAVLink(None, srcSystem=system_id, srcComponent=component_id)
        if signatures is not None:
            self._mav.signing.secret_key, self._mav.signing.sign_outgoing = signatures.key, True

    @property
    def refused(self) -> int:
        """Frames that came without the right signature, where one is asked for."""
        return 0 if self._signatures is None else self._signatures.refused

    def decode(self, data: bytes) -> list[Received]:
        """The messages in a datagram, as far as the planner knows them; noise and all else is left out.

        A vehicle may send several hundred messages a second that nobody here asked for; they are not unpacked.
        """
        return [self.read(frame) for frame in self.judged(data)]

    def judged(self, data: bytes) -> list[Frame]:
        """The frames in a datagram that ``read`` can make something of, rightly signed where that is asked for."""
        return [
            frame
            for frame in split(data)[0]
            if frame.number in _READER_OF and (self._signatures is None or self._signatures.take(frame.data))
        ]

    def read(self, frame: Frame) -> Received:
        """The message in a frame of ``judged``."""
        system_id, component_id = frame.sender
        return Received(system_id, component_id, _READER_OF[frame.number](message_of(frame)))

    def heartbeat(self) -> bytes:
        """The HEARTBEAT of a ground station."""
        return self.packed(
            mavlink.MAVLink_heartbeat_message(
                mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, mavlink.MAV_STATE_ACTIVE, 3
            )
        )

    def answer(self, asked: Received, ping: Ping) -> bytes:
        """The answer to a PING: the same, to whoever sent it. https://mavlink.io/en/services/ping.html."""
        return self.packed(mavlink.MAVLink_ping_message(ping.time_us, ping.number, asked.system_id, asked.component_id))

    def time_request(self, asked_ns: int) -> bytes:
        """A TIMESYNC that asks for the vehicle's time, with one of ours that is not 0."""
        return self.packed(mavlink.MAVLink_timesync_message(0, asked_ns))

    def command(self, target_system: int, command: Command, attempt: int) -> bytes:
        """A COMMAND_LONG to the autopilot of a system; ``attempt`` counts from 0."""
        parameters = (*command.parameters, *(0.0,) * (7 - len(command.parameters)))
        return self.packed(
            mavlink.MAVLink_command_long_message(
                target_system, AUTOPILOT_COMPONENT, command.number, min(attempt, 255), *parameters
            )
        )

    def setpoint(self, target_system: int, setpoint: LocalSetpoint) -> bytes:
        """A SET_POSITION_TARGET_LOCAL_NED to the autopilot of a system."""
        return self.packed(
            mavlink.MAVLink_set_position_target_local_ned_message(
                setpoint.time_boot_ms & 0xFFFFFFFF,
                target_system,
                AUTOPILOT_COMPONENT,
                mavlink.MAV_FRAME_LOCAL_NED,
                _WHOLE,
                *setpoint.position_ned_m,
                *setpoint.velocity_ned_m_s,
                *setpoint.acceleration_ned_m_s2,
                setpoint.yaw_rad,
                setpoint.yaw_rate_rad_s,
            )
        )

    def packed(self, message: Message) -> bytes:
        """A frame of any message."""
        if self._signatures is not None:
            self._mav.signing.timestamp = self._signatures.stamp()
        frame = frame_of(message, self._mav)
        self._mav.seq = (self._mav.seq + 1) & 0xFF
        return frame


def asked_last(datagram: bytes) -> Ping | None:
    """The PING for all with which an autopilot ends a datagram; None where it ends with anything else."""
    frames, _ = split(datagram)
    if not frames or frames[-1].number != mavlink.MAVLINK_MSG_ID_PING:
        return None
    message = message_of(frames[-1])
    if message.target_system != 0 or frames[-1].component_id != AUTOPILOT_COMPONENT:
        return None
    return Ping(message.time_usec, message.seq, message.target_system)


def set_message_interval(stream: Stream, hertz: float) -> Command:
    """Ask for a message that often."""
    name = f"set the rate of {stream.name}"
    return Command(name, mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, (float(stream), 1e6 / hertz))


def request_message(stream: Stream) -> Command:
    """Ask for a message once."""
    return Command(f"send {stream.name}", mavlink.MAV_CMD_REQUEST_MESSAGE, (float(stream),))


def arm() -> Command:
    """Arm the motors; never by force."""
    return Command("arm", mavlink.MAV_CMD_COMPONENT_ARM_DISARM, (1.0,))


def disarm() -> Command:
    """Disarm the motors; never by force."""
    return Command("disarm", mavlink.MAV_CMD_COMPONENT_ARM_DISARM, (0.0,))


def take_off(height_m: float, here: float) -> Command:
    """Take off on the spot; where the height counts from, and what means "here", differ between autopilots."""
    return Command("take off", mavlink.MAV_CMD_NAV_TAKEOFF, (0.0, 0.0, 0.0, here, here, here, height_m))


def land(here: float) -> Command:
    """Land on the spot; what means "here" differs between autopilots."""
    return Command("land", mavlink.MAV_CMD_NAV_LAND, (0.0, 0.0, 0.0, here, here, here, 0.0))


def change_mode(name: str, main_mode: int, sub_mode: int = 0) -> Command:
    """Change the flight mode, by the autopilot's own numbers."""
    flag = float(mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED)
    return Command(f"change to {name}", mavlink.MAV_CMD_DO_SET_MODE, (flag, float(main_mode), float(sub_mode)))


def photograph_every(distance_m: float) -> Command:
    """Let the camera take a picture now and after each stretch of that length, in the order of both autopilots."""
    name = f"photograph every {distance_m:g} m"
    return Command(name, mavlink.MAV_CMD_DO_SET_CAM_TRIGG_DIST, (distance_m, 0.0, 1.0))


def stop_photographing() -> Command:
    """Take no more pictures by distance."""
    return Command("stop photographing", mavlink.MAV_CMD_DO_SET_CAM_TRIGG_DIST)


def photograph() -> Command:
    """Take one picture; of the commands for it this is the one that both autopilots take."""
    return Command("take a photograph", mavlink.MAV_CMD_DO_DIGICAM_CONTROL, (0.0, 0.0, 0.0, 0.0, 1.0))


AUTOPILOT_ARDUPILOT: Final = int(mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA)
AUTOPILOT_PX4: Final = int(mavlink.MAV_AUTOPILOT_PX4)
AUTOPILOT_NONE: Final = int(mavlink.MAV_AUTOPILOT_INVALID)
MULTICOPTERS: Final = frozenset(
    int(kind)
    for kind in (
        mavlink.MAV_TYPE_QUADROTOR,
        mavlink.MAV_TYPE_COAXIAL,
        mavlink.MAV_TYPE_HEXAROTOR,
        mavlink.MAV_TYPE_OCTOROTOR,
        mavlink.MAV_TYPE_TRICOPTER,
        mavlink.MAV_TYPE_DODECAROTOR,
        mavlink.MAV_TYPE_DECAROTOR,
    )
)


def autopilot_name(number: int) -> str:
    """The name of a MAV_AUTOPILOT."""
    return _enum_name("MAV_AUTOPILOT", number)


def vehicle_type_name(number: int) -> str:
    """The name of a MAV_TYPE."""
    return _enum_name("MAV_TYPE", number)


def _told(number: int) -> float | None:
    """A figure of which a negative one says that it is not known."""
    return float(number) if number >= 0 else None


def _enum_name(enum: str, number: int) -> str:
    entry = mavlink.enums[enum].get(number)
    return str(number) if entry is None else str(entry.name).removeprefix(f"{enum}_")
