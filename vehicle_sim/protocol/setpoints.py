"""Setpoints: SET_POSITION_TARGET_LOCAL_NED and SET_POSITION_TARGET_GLOBAL_INT. Neither is ever acknowledged.

ArduPilot takes whole groups (position; velocity, with or without acceleration; acceleration; position and velocity,
with or without acceleration), in GUIDED only, and stops for anything else. PX4 takes each axis by its own, free where
its bit is set or its value is not a number, and says what it cannot do. After ArduPilot `GCS_MAVLink_Copter.cpp` and
PX4 `mavlink_receiver.cpp`.
"""

from math import cos, isnan, sin
from typing import TYPE_CHECKING, Final, NamedTuple

from vehicle_sim.autopilot import Mode, Severity
from vehicle_sim.geodesy import ned_offset_m
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.host import Host, Sender
from vehicle_sim.protocol.motion import quaternion
from vehicle_sim.protocol.places import AMSL_FRAMES, GLOBAL_FRAMES, HOME_FRAMES, global_place
from vehicle_sim.signals import FREE, Estimate, PartialVector, Setpoint, Vector

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

_POSITION: Final = 0b111
_VELOCITY: Final = 0b111 << 3
_ACCELERATION: Final = 0b111 << 6
_FORCE: Final = mavlink.POSITION_TARGET_TYPEMASK_FORCE_SET
_YAW: Final = mavlink.POSITION_TARGET_TYPEMASK_YAW_IGNORE
_YAW_RATE: Final = mavlink.POSITION_TARGET_TYPEMASK_YAW_RATE_IGNORE

_LOCAL: Final = mavlink.MAV_FRAME_LOCAL_NED
_LOCAL_OFFSET: Final = mavlink.MAV_FRAME_LOCAL_OFFSET_NED
_BODY: Final = mavlink.MAV_FRAME_BODY_NED
_BODY_OFFSET: Final = mavlink.MAV_FRAME_BODY_OFFSET_NED
_ARDUPILOT_FRAMES: Final = frozenset((_LOCAL, _LOCAL_OFFSET, _BODY, _BODY_OFFSET))
_BODY_FRAMES: Final = frozenset((_BODY, _BODY_OFFSET))
_LOCAL_NAME: Final = "SET_POSITION_TARGET_LOCAL_NED"
_GLOBAL_NAME: Final = "SET_POSITION_TARGET_GLOBAL_INT"


class _Target(NamedTuple):
    """The fields that both messages share, as sent."""

    mask: int
    position: Vector
    velocity: Vector
    acceleration: Vector
    yaw_rad: float
    yaw_rate_rad_s: float


class SetpointService:
    """Turns setpoints of the wire into the autopilot's."""

    def __init__(self, host: Host) -> None:
        self._host = host
        self.messages: Mapping[int, Callable[[Sender, Message], None]] = {
            mavlink.MAVLINK_MSG_ID_SET_POSITION_TARGET_LOCAL_NED: self.on_local,
            mavlink.MAVLINK_MSG_ID_SET_POSITION_TARGET_GLOBAL_INT: self.on_global,
        }

    @property
    def _is_px4(self) -> bool:
        return self._host.table.flavour is Flavour.PX4

    def on_local(self, _sender: Sender, message: Message) -> None:
        """Fly to a place, or with a velocity, of the local frame, or of one that hangs on the vehicle."""
        target = _target(message, (message.x, message.y, message.z))
        if self._is_px4:
            self._px4_local(target, message.coordinate_frame)
        else:
            self._ardupilot_local(target, message.coordinate_frame)

    def on_global(self, _sender: Sender, message: Message) -> None:
        """Fly to a place on earth; velocity and acceleration are north, east, down."""
        frame = message.coordinate_frame
        if self._is_px4 and frame not in AMSL_FRAMES | HOME_FRAMES:
            self._complain(f"{_GLOBAL_NAME} invalid coordinate frame {frame}")
            return
        vehicle = self._host.vehicle
        mask, position = message.type_mask, (0.0, 0.0, 0.0)
        if mask & _POSITION != _POSITION:
            home = vehicle.autopilot.home
            place = global_place(message.lat_int * 1e-7, message.lon_int * 1e-7, message.alt, frame, home)
            if vehicle.estimate.origin is None:
                return
            if place is None:
                if not self._is_px4:
                    self._stop()
                return
            position = ned_offset_m(vehicle.estimate.origin, place)
        elif not self._is_px4 and frame not in GLOBAL_FRAMES:
            self._stop()
            return
        target = _target(message, position)
        if self._is_px4:
            self._px4_local(target, _LOCAL)
        else:
            self._ardupilot_local(target, _LOCAL)

    def _ardupilot_local(self, target: _Target, frame: int) -> None:
        if self._host.vehicle.autopilot.mode is not Mode.GUIDED:
            return
        mask = target.mask
        groups = [mask & group for group in (_POSITION, _VELOCITY, _ACCELERATION)]
        asked = tuple(bits == 0 for bits in groups)
        is_partial = any(bits not in (0, whole) for bits, whole in zip(groups, _GROUPS, strict=True))
        is_force = asked[2] and mask & _FORCE
        if frame not in _ARDUPILOT_FRAMES or is_partial or asked not in _ARDUPILOT_COMBINATIONS or is_force:
            self._stop()
            return
        estimate = self._host.vehicle.estimate
        turns = frame in _BODY_FRAMES
        position = _turned(target.position, estimate.yaw_rad) if turns else target.position
        if frame != _LOCAL:
            north, east, down = estimate.position_ned_m
            position = (position[0] + north, position[1] + east, position[2] + down)
        velocity = _turned(target.velocity, estimate.yaw_rad) if turns else target.velocity
        acceleration = _turned(target.acceleration, estimate.yaw_rad) if turns else target.acceleration
        yaw = target.yaw_rad + estimate.yaw_rad if turns else target.yaw_rad
        self._fly(
            position if asked[0] else FREE,
            velocity if asked[1] else FREE,
            acceleration if asked[2] else FREE,
            None if mask & _YAW else yaw,
            None if mask & _YAW_RATE else target.yaw_rate_rad_s,
        )

    def _px4_local(self, target: _Target, frame: int) -> None:
        mask = target.mask
        position = _axes(target.position, mask)
        velocity = _axes(target.velocity, mask >> 3)
        acceleration = _axes(target.acceleration, mask >> 6)
        if frame == _BODY:
            estimate = self._host.vehicle.estimate
            position = FREE
            velocity = _from_body(velocity, estimate)
            acceleration = _from_body(acceleration, estimate)
        elif frame != _LOCAL:
            self._complain(f"{_LOCAL_NAME} coordinate frame {frame} unsupported")
            return
        if acceleration != FREE and mask & _FORCE:
            self._complain(f"{_LOCAL_NAME} force not supported")
            return
        if position == velocity == acceleration == FREE:
            self._complain(f"{_LOCAL_NAME} invalid")
            return
        yaw = None if mask & _YAW or isnan(target.yaw_rad) else target.yaw_rad
        rate = None if mask & _YAW_RATE or isnan(target.yaw_rate_rad_s) else target.yaw_rate_rad_s
        self._fly(position, velocity, acceleration, yaw, rate)

    def _fly(
        self,
        position: PartialVector,
        velocity: PartialVector,
        acceleration: PartialVector,
        yaw_rad: float | None,
        yaw_rate_rad_s: float | None,
    ) -> None:
        """Hand a setpoint to the autopilot; one with a component that is no number is dropped, the last one holds."""
        try:
            setpoint = Setpoint(
                position_ned_m=position,
                velocity_ned_m_s=velocity,
                acceleration_ned_m_s2=acceleration,
                yaw_rad=yaw_rad,
                yaw_rate_rad_s=yaw_rate_rad_s,
            )
        except ValueError:
            return
        self._host.vehicle.autopilot.setpoint(setpoint)

    def _stop(self) -> None:
        if self._host.vehicle.autopilot.mode is Mode.GUIDED:
            self._host.vehicle.autopilot.halt()

    def _complain(self, text: str) -> None:
        self._host.say(Severity.CRITICAL, text)


_GROUPS: Final = (_POSITION, _VELOCITY, _ACCELERATION)
_ARDUPILOT_COMBINATIONS: Final = frozenset(
    (
        (True, False, False),
        (False, True, False),
        (False, True, True),
        (False, False, True),
        (True, True, False),
        (True, True, True),
    )
)
"""Position, velocity, acceleration: what may be asked for together."""


def _target(message: Message, position: Vector) -> _Target:
    return _Target(
        message.type_mask,
        position,
        (message.vx, message.vy, message.vz),
        (message.afx, message.afy, message.afz),
        message.yaw,
        message.yaw_rate,
    )


def _turned(body: Vector, yaw_rad: float) -> Vector:
    """Turn forward, right, down of a level vehicle to north, east, down."""
    forward, right, down = body
    return (
        forward * cos(yaw_rad) - right * sin(yaw_rad),
        forward * sin(yaw_rad) + right * cos(yaw_rad),
        down,
    )


def _axes(vector: Vector, ignored: int) -> PartialVector:
    """Free the axes whose bit of `ignored` (1, 2, 4) is set, and those that are not numbers."""
    x, y, z = vector
    return (
        None if ignored & 1 or isnan(x) else x,
        None if ignored & 2 or isnan(y) else y,
        None if ignored & 4 or isnan(z) else z,
    )


def _from_body(body: PartialVector, estimate: Estimate) -> PartialVector:
    """Turn forward, right, down of the tilted vehicle to north, east, down; a free axis asks for nothing there."""
    if body == FREE:
        return FREE
    f, r, d = (value or 0.0 for value in body)
    w, x, y, z = quaternion(estimate)
    return (
        (1 - 2 * (y * y + z * z)) * f + 2 * (x * y - w * z) * r + 2 * (x * z + w * y) * d,
        2 * (x * y + w * z) * f + (1 - 2 * (x * x + z * z)) * r + 2 * (y * z - w * x) * d,
        2 * (x * z - w * y) * f + 2 * (y * z + w * x) * r + (1 - 2 * (x * x + y * y)) * d,
    )
